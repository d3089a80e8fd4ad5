//! The template of a model: mean and covariance of people's profiles of an open hand, and how people can be aligned to one another.

use shared::intent::Intent;
use shared::stream::alignment::{Alignment, OCTAVE, PRECISION_ONE, Template};
use shared::units::CHANNELS;

use super::matrix::{Matrix, inverse};
use super::profiles::Profiles;

/// Fewest people who open the hand; fewer make no template.
pub const FEWEST_PEOPLE: usize = 3;

/// Least share of the covariance that is that of a sphere.
const SHRINKAGE: f64 = 0.2;
/// Least variance of an electrode, in square octaves: a tenth of an octave.
const LEAST_VARIANCE: f64 = 0.01;
/// Most rounds in which people are turned. They settle within five.
const ROUNDS: usize = 8;

/// Places that a person may be turned by: sets are in one frame, people sit one place off.
const TURNS: [Alignment; 3] = [
    Alignment::NONE,
    Alignment::new(1, false),
    Alignment::new(7, false),
];

/// A normal density of profiles, in octaves.
struct Density {
    mean: [f64; CHANNELS],
    precision: Matrix,
    people: f64,
}

/// How people of one frame are to be turned, by one place at most, so that their gestures agree best.
///
/// In turn, the densities of all gestures are made of the people as they are turned, and each person is turned to where the
/// densities of the others fit best over all gestures.
#[must_use]
pub fn common_turns(people: &[Profiles]) -> Vec<Alignment> {
    let mut turns = vec![Alignment::NONE; people.len()];
    for _ in 0..ROUNDS {
        let densities: Vec<(Intent, Density)> = Intent::ALL
            .into_iter()
            .filter_map(|intent| Some((intent, density(people, &turns, intent)?)))
            .collect();
        let next: Vec<Alignment> = people
            .iter()
            .zip(&turns)
            .map(|(profiles, &turn)| best_turn(profiles, turn, &densities))
            .collect();
        if next == turns {
            break;
        }
        turns = next;
    }
    turns
}

/// The template of people as they sat in training: turned as the model was shown them. None with fewer than
/// [`FEWEST_PEOPLE`] who open the hand.
///
/// The covariance is shrunk to a multiple of the identity. People turned otherwise than in training make a template that is
/// sharper and a model that sees them where it was not trained: measured in docs/alignment.md.
#[must_use]
pub fn template(people: &[Profiles], turns: &[Alignment]) -> Option<Template> {
    quantized(&density(people, turns, Intent::Open)?)
}

/// The density of an intent's profiles over the people who have one; none with fewer than [`FEWEST_PEOPLE`].
fn density(people: &[Profiles], turns: &[Alignment], intent: Intent) -> Option<Density> {
    let aligned: Vec<[f64; CHANNELS]> = people
        .iter()
        .zip(turns)
        .filter_map(|(profiles, turn)| Some(turn.apply(*profiles.get(&intent)?)))
        .collect();
    if aligned.len() < FEWEST_PEOPLE {
        return None;
    }
    let count = aligned.len() as f64;
    let mean: [f64; CHANNELS] = std::array::from_fn(|electrode| {
        aligned.iter().map(|values| values[electrode]).sum::<f64>() / count
    });
    let mut covariance = Matrix::default();
    for values in &aligned {
        for row in 0..CHANNELS {
            for column in 0..CHANNELS {
                let product = (values[row] - mean[row]) * (values[column] - mean[column]);
                covariance[row][column] += product / (count - 1.0);
            }
        }
    }
    let variance = (0..CHANNELS).map(|at| covariance[at][at]).sum::<f64>() / CHANNELS as f64;
    let variance = variance.max(LEAST_VARIANCE);
    // Few people say little about how electrodes vary together.
    let shrinkage = (CHANNELS as f64 / count).clamp(SHRINKAGE, 1.0);
    for (row, values) in covariance.iter_mut().enumerate() {
        for value in &mut *values {
            *value *= 1.0 - shrinkage;
        }
        values[row] += shrinkage * variance;
    }
    Some(Density {
        mean,
        precision: inverse(covariance),
        people: count,
    })
}

/// The turn in which a person's profiles are nearest to the others'.
fn best_turn(
    profiles: &Profiles,
    present: Alignment,
    densities: &[(Intent, Density)],
) -> Alignment {
    let distance = |turn: Alignment| -> f64 {
        densities
            .iter()
            .filter_map(|(intent, density)| {
                let own = profiles.get(intent)?;
                let here = present.apply(*own);
                let there = turn.apply(*own);
                let deviation: [f64; CHANNELS] = std::array::from_fn(|at| {
                    let others = density.mean[at] * density.people - here[at];
                    there[at] - others / (density.people - 1.0)
                });
                Some(square(&deviation, &density.precision))
            })
            .sum()
    };
    let distances = TURNS.map(|turn| (distance(turn), turn));
    let nearest = distances.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map_or(present, |(_, turn)| turn)
}

fn square(deviation: &[f64; CHANNELS], precision: &Matrix) -> f64 {
    (0..CHANNELS)
        .flat_map(|row| (0..CHANNELS).map(move |column| (row, column)))
        .map(|(row, column)| deviation[row] * precision[row][column] * deviation[column])
        .sum()
}

/// In the device's units.
fn quantized(density: &Density) -> Option<Template> {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a conversion to an integer saturates"
    )]
    let rounded = |value: f64, unit: i16| (value * f64::from(unit)).round() as i16;
    let mut upper = (0..CHANNELS).flat_map(|row| (row..CHANNELS).map(move |column| (row, column)));
    let precision = std::array::from_fn(|_| {
        let (row, column) = upper.next().unwrap_or_default();
        rounded(density.precision[row][column], PRECISION_ONE)
    });
    Template::new(density.mean.map(|mean| rounded(mean, OCTAVE)), precision).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use shared::stream::alignment::Profile;

    /// Mean activity of an open hand and of a fist, in 1/64 counts.
    const OPEN: [f64; CHANNELS] = [2400.0, 1900.0, 1500.0, 1000.0, 700.0, 400.0, 300.0, 200.0];
    const CLOSE: [f64; CHANNELS] = [300.0, 700.0, 2400.0, 1500.0, 600.0, 500.0, 900.0, 400.0];

    fn person(random: &mut ChaCha8Rng, worn: Alignment) -> Profiles {
        let mut profile = |mean: [f64; CHANNELS]| {
            let varied = mean.map(|mean| (mean * random.random_range(0.75..1.33)) as u32);
            let values = Profile::new(varied).values();
            worn.inverse()
                .apply(values.map(|value| f64::from(value) / 256.0))
        };
        Profiles::from([
            (Intent::Open, profile(OPEN)),
            (Intent::Close, profile(CLOSE)),
        ])
    }

    /// Forty people, of whom every fourth sits one place off.
    fn people(off: Alignment) -> Vec<Profiles> {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        (0..40)
            .map(|number| {
                person(
                    &mut random,
                    if number % 4 == 0 {
                        off
                    } else {
                        Alignment::NONE
                    },
                )
            })
            .collect()
    }

    fn fit(template: &Template, open: [f64; CHANNELS]) -> shared::stream::alignment::Fit {
        template.fit(Profile::new(open.map(|mean| mean as u32)))
    }

    #[test]
    fn people_who_sit_one_place_off_are_turned_first() {
        let made = |off| {
            let people = people(off);
            let turns = common_turns(&people);
            let wrong = turns.iter().enumerate().filter(|&(number, &turn)| {
                turn != if number % 4 == 0 {
                    off
                } else {
                    Alignment::NONE
                }
            });
            assert_eq!(wrong.count(), 0);
            template(&people, &turns).unwrap()
        };
        let all = made(Alignment::NONE);
        let off = made(Alignment::new(1, false));
        let [all, off] = [all, off].map(|template| fit(&template, OPEN));
        assert_eq!(
            (all.alignment, off.alignment),
            (Alignment::NONE, Alignment::NONE)
        );
        // Unturned, a fourth of them would widen the density.
        assert!(off.margin * 10 > all.margin * 8, "{off:?} {all:?}");
        assert!(all.distance < 100 && all.margin > 500, "{all:?}");
    }

    #[test]
    fn strangers_are_placed_by_it() {
        let template = template(&people(Alignment::NONE), &[Alignment::NONE; 40]).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(11);
        for worn in Alignment::all() {
            let open = person(&mut random, worn)[&Intent::Open];
            let counts = open.map(|octaves| 640.0 * octaves.exp2());
            assert_eq!(fit(&template, counts).alignment, worn);
        }
    }

    #[test]
    fn too_few_people_make_none_and_equal_ones_have_a_width() {
        let unturned = [Alignment::NONE; 40];
        assert_eq!(template(&people(Alignment::NONE)[..2], &unturned), None);
        let same = vec![people(Alignment::NONE)[1].clone(); 5];
        assert!(template(&same, &unturned).is_some());
        let closed: Vec<Profiles> = people(Alignment::NONE)
            .into_iter()
            .map(|mut profiles| {
                profiles.remove(&Intent::Open);
                profiles
            })
            .collect();
        assert_eq!(template(&closed, &unturned), None);
    }
}
