//! Alignment template of a model file: any bytes, and its fit to any gesture.

use shared::stream::alignment::{Alignment, Profile, TEMPLATE_BYTES, Template};

use crate::input::Input;

/// Takes a template, then the mean activity of eight electrodes.
pub fn run(data: &[u8]) {
    let _ = Template::from_bytes(data);
    let mut input = Input(data);
    let bytes: [u8; TEMPLATE_BYTES] = input.array();
    let means = [(); 8].map(|()| input.word());
    let Ok(template) = Template::from_bytes(&bytes) else {
        return;
    };
    assert_eq!(template.to_bytes(), bytes, "what is read is written back");
    let profile = Profile::new(means);
    assert!(
        profile
            .values()
            .into_iter()
            .all(|value| (-1793..=1794).contains(&value))
    );
    let fits = template.fit(profile);
    let fit = fits.nearest;
    for arm in [fit, fits.other_arm] {
        assert!(Alignment::all().any(|one| one == arm.alignment));
    }
    assert_ne!(
        fit.alignment.mirrored(),
        fits.other_arm.alignment.mirrored()
    );
    assert_eq!(fits.lead(), fits.other_arm.distance - fit.distance);
    // An armband turned by the answer needs no further turn and fits as well as before; so does the other arm.
    let turned = fit.alignment.apply(means);
    let again = template.fit(Profile::new(turned));
    assert_eq!(again.nearest.distance, fit.distance);
    assert_eq!(again.other_arm.distance, fits.other_arm.distance);
}
