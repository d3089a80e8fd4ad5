//! The deepest stack that runs of the emulated board have used, recorded in a file beside its image.
//!
//! The tasks are the same in every image, and so is their use of the stack.

use std::{
    fs,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    path::{Path, PathBuf},
    process,
    sync::{Mutex, PoisonError},
};

use anyhow::{Context as _, Result};

/// Records the bytes that a run of the image used, if no run of it used more.
///
/// # Errors
/// Where a file cannot be read or written.
pub fn record(image: &Path, used: u64) -> Result<()> {
    // Runs of one program that end together keep the larger number.
    static ONE: Mutex<()> = Mutex::new(());
    let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    if measured(image)?.is_some_and(|most| most >= used) {
        return Ok(());
    }
    let kept = record_file(image);
    // Written apart and renamed: a concurrent reader finds the old number or the new one.
    let fresh = kept.with_extension(format!("stack-{}", process::id()));
    fs::write(&fresh, format!("{used}\n{:016x}\n", fingerprint(image)?))
        .and_then(|()| fs::rename(&fresh, &kept))
        .with_context(|| format!("{} cannot be written", kept.display()))
}

/// The most bytes that any run of this image used; none where no run was recorded.
///
/// # Errors
/// Where there is no image.
pub fn measured(image: &Path) -> Result<Option<u64>> {
    let text = fs::read_to_string(record_file(image)).unwrap_or_default();
    let Some((used, of)) = text.trim_end().split_once('\n') else {
        return Ok(None);
    };
    let of_this = of == format!("{:016x}", fingerprint(image)?);
    Ok(used.parse().ok().filter(|_| of_this))
}

fn record_file(image: &Path) -> PathBuf {
    image.with_extension("stack")
}

/// Identifies the image. It may differ between compilers: then the record is ignored.
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
    fn the_largest_is_kept_until_the_image_changes() -> Result<()> {
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
        // No temporary file is left.
        assert_eq!(fs::read_dir(&folder)?.count(), 2);
        fs::remove_dir_all(&folder)?;
        Ok(())
    }
}
