//! The deepest stack that the emulated board was seen to use, kept beside its image.
//!
//! The tasks are the same in every image, and with them what they need of the stack.

use std::{
    fs,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    path::{Path, PathBuf},
    process,
};

use anyhow::{Context as _, Result};

/// Keeps what a run of the image used, if no run of it used more.
///
/// # Errors
/// Where a file cannot be read or written.
pub fn record(image: &Path, used: u64) -> Result<()> {
    if measured(image)?.is_some_and(|most| most >= used) {
        return Ok(());
    }
    let kept = beside(image);
    // Whoever reads meanwhile finds the old number or the new one.
    let fresh = kept.with_extension(format!("stack-{}", process::id()));
    fs::write(&fresh, format!("{used}\n{:016x}\n", fingerprint(image)?))
        .and_then(|()| fs::rename(&fresh, &kept))
        .with_context(|| format!("{} cannot be written", kept.display()))
}

/// The most bytes that any run of the image used; none where no run was recorded.
///
/// # Errors
/// Where there is no image.
pub fn measured(image: &Path) -> Result<Option<u64>> {
    let text = fs::read_to_string(beside(image)).unwrap_or_default();
    let Some((used, of)) = text.trim_end().split_once('\n') else {
        return Ok(None);
    };
    let of_this = of == format!("{:016x}", fingerprint(image)?);
    Ok(used.parse().ok().filter(|_| of_this))
}

fn beside(image: &Path) -> PathBuf {
    image.with_extension("stack")
}

/// Tells one image from the next. Another compiler's may differ: then the measuring starts anew.
fn fingerprint(image: &Path) -> Result<u64> {
    let bytes = fs::read(image).with_context(|| format!("{} cannot be read", image.display()))?;
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    Ok(hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_is_kept_until_the_image_is_another() -> Result<()> {
        let folder = std::env::temp_dir().join(format!("myointent-stack-{}", process::id()));
        fs::create_dir_all(&folder)?;
        let image = folder.join("emulator.elf");
        fs::write(&image, "one")?;
        assert_eq!(measured(&image)?, None);
        for (used, most) in [(5000, 5000), (6000, 6000), (5500, 6000)] {
            record(&image, used)?;
            assert_eq!(measured(&image)?, Some(most));
        }
        fs::write(&image, "two")?;
        assert_eq!(measured(&image)?, None);
        record(&image, 4000)?;
        assert_eq!(measured(&image)?, Some(4000));
        // Nothing is left over but the image and the number.
        assert_eq!(fs::read_dir(&folder)?.count(), 2);
        fs::remove_dir_all(&folder)?;
        Ok(())
    }
}
