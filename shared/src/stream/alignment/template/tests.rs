//! The template, and the profiles that fit it.

use super::*;
use proptest::prelude::*;

/// A template of this precision about a pattern that falls round the arm, which its mirror image does not.
pub(crate) fn template_of(nats: i16) -> Template {
    Template::round([400, 290, 170, 60, -60, -170, -290, -400], nats).unwrap()
}

pub(crate) fn template() -> Template {
    template_of(10)
}

/// The profile that the template's mean makes with the armband placed like this.
fn worn(alignment: Alignment) -> Profile {
    Profile(alignment.inverse().apply(template().mean))
}

#[test]
fn every_placement_is_found_and_the_best_of_the_other_arm_with_how_much_further_it_is() {
    for alignment in Alignment::all() {
        let profile = worn(alignment);
        let fits = template().fit(profile);
        assert_eq!(fits.nearest.alignment, alignment);
        assert!(fits.nearest.distance == 0 && fits.nearest.margin > 5 * NAT);
        let others = Alignment::all().filter(|other| other.mirrored() != alignment.mirrored());
        let distance = |other: Alignment| template().distance(other.apply(profile.0));
        let nearest = others.min_by_key(|&other| distance(other)).unwrap();
        assert_eq!(fits.other_arm.alignment, nearest);
        assert_eq!(fits.other_arm.distance, distance(nearest));
        assert_eq!(fits.lead(), distance(nearest) - fits.nearest.distance);
        assert!(fits.lead() > 4 * NAT, "{fits:?}");
    }
}

#[test]
fn the_distance_is_half_the_squared_mahalanobis_distance() {
    // One octave off in one electrode, at 10 nats per square octave.
    let mut profile = template().mean;
    profile[3] += OCTAVE;
    assert_eq!(template().distance(profile), 5 * NAT);
    // Off the diagonal: rows 0 and 1, both halves of the matrix.
    let mut other = template();
    other.precision[1] = 4 * PRECISION_ONE;
    profile = other.mean;
    profile[0] += OCTAVE;
    profile[1] += OCTAVE;
    assert_eq!(other.distance(profile), (5 + 5 + 4) * NAT);
}

#[test]
fn a_symmetrical_pattern_is_taken_for_the_arm_of_training() {
    let mut template = template();
    template.mean = [400, 200, 0, -200, -300, -200, 0, 200];
    for turn in 0..8 {
        let mirrored = Alignment::new(turn, true);
        let fits = template.fit(Profile(mirrored.inverse().apply(template.mean)));
        assert_eq!(fits.nearest.alignment, Alignment::new(turn, false));
        assert_eq!((fits.other_arm.alignment, fits.lead()), (mirrored, 0));
    }
}

#[test]
fn each_wrong_number_is_refused() {
    let bytes = template().to_bytes();
    assert_eq!(Template::from_bytes(&bytes), Ok(template()));
    let length = |found| Err(TemplateError::Length { found });
    assert_eq!(
        Template::from_bytes(&bytes[1..]),
        length(TEMPLATE_BYTES - 1)
    );
    assert_eq!(Template::from_bytes(&[]), length(0));
    let with = |place: usize, number: i16| {
        let mut changed = bytes;
        changed[2 * place..][..2].copy_from_slice(&number.to_le_bytes());
        Template::from_bytes(&changed)
    };
    let mean = |electrode, found| TemplateError::Mean { electrode, found };
    let precision = |electrode, found| TemplateError::Precision { electrode, found };
    for (place, number, refused) in [
        (2, 2049, mean(2, 2049)),
        (7, i16::MIN, mean(7, i16::MIN)),
        (8 + 8, 0, precision(1, 0)),
        (8 + 35, -1, precision(7, -1)),
    ] {
        assert_eq!(with(place, number), Err(refused));
    }
}

proptest! {
    /// The answer to an armband turned or on the other arm is that answer turned; of placements that are equally far, either.
    #[test]
    fn turning_the_armband_turns_the_answer(
        mean in prop::array::uniform8(-2048_i16..=2048),
        // Distances of wider ones end at the largest number.
        widths in prop::array::uniform8(1_i16..=4000),
        profile in prop::array::uniform8(-1793_i16..=1794),
        (turn, mirrored) in (0_u8..8, any::<bool>()),
    ) {
        let mut precision = [0; TRIANGLE];
        for (row, width) in widths.into_iter().enumerate() {
            precision[row * (2 * CHANNELS + 1 - row) / 2] = width;
        }
        let template = Template::new(mean, precision).unwrap();
        let turned = Alignment::new(turn, mirrored);
        let here = template.fit(Profile(profile));
        let there = template.fit(Profile(turned.inverse().apply(profile)));
        for (here, there) in [(here.nearest, there.nearest), (here.other_arm, there.other_arm)] {
            prop_assert_eq!(here.distance, there.distance);
            let back = turned.inverse().then(there.alignment);
            prop_assert_eq!(template.distance(back.apply(profile)), here.distance);
            if back == here.alignment {
                prop_assert_eq!(here.margin, there.margin);
            }
        }
    }
}
