//! The alignment template of a model file: any bytes, and what it fits to any gesture.

use shared::stream::alignment::{Alignment, Profile, TEMPLATE_BYTES, Template};

use crate::input::Input;

/// A template, then the mean activity of eight electrodes.
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
    let fit = template.fit(profile);
    assert!(fit.alignment.turn() < 8);
    assert!(Alignment::all().any(|one| one == fit.alignment));
    // An armband turned by the answer fits best as it is, and as well.
    let turned = fit.alignment.apply(means);
    let again = template.fit(Profile::new(turned));
    assert_eq!(again.distance, fit.distance);
}
