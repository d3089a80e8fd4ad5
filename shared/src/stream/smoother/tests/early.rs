//! Gates and early labels against a twin that stores every window, counts windows from the start and sums in f64.

use super::*;

const USED: usize = CLASSES - 1;

/// Labels so far, by numbers of windows; an instant has the number of the window that it is the newest of.
struct Twin {
    settings: Settings,
    windows: Vec<Rows>,
    class: usize,
    /// Instant of the last change and window that brought it.
    change: Option<[usize; 2]>,
    /// Window of the last label.
    label: Option<usize>,
    /// Share of movement outside the vocabulary.
    otherwise: f64,
}

/// Label after a window.
struct After {
    class: usize,
    /// Instant of the label, if one is due.
    instant: Option<usize>,
    is_changed: bool,
}

impl Twin {
    /// Mean logits of an instant, over all rows that are summed for it so far.
    fn means(&self, instant: usize) -> [f64; CLASSES] {
        let ahead = self.windows.len() - 1 - instant;
        let settings = Settings {
            look_ahead: ahead,
            ..self.settings
        };
        let rows = match settings.aggregation {
            AggregationMode::AllRowsFrom => (1..=ahead + 1).sum::<usize>(),
            AggregationMode::SameInstant => ahead + 1,
        };
        naive_sums(&settings, &self.windows).map(|sum| sum / rows as f64)
    }

    fn margins(&self, class: usize, ahead: usize) -> [f64; 2] {
        let Margins {
            entry,
            other,
            early,
        } = self.settings.margins;
        let early = early.map_or([0.0; 3], |own| [own.entry, own.other, own.caution]);
        let [early_entry, early_other, caution] = early.map(f64::from);
        let look_ahead = self.settings.look_ahead;
        let share = (look_ahead - ahead) as f64 / look_ahead.max(1) as f64;
        if class == 0 {
            [self.leave() + share, f64::NEG_INFINITY]
        } else {
            [
                f64::from(entry) + early_entry * share,
                other.map_or(f64::NEG_INFINITY, |other| {
                    f64::from(other) + early_other * share + caution * self.otherwise
                }),
            ]
        }
    }

    /// Margin of relax over the label that it ends.
    fn leave(&self) -> f64 {
        self.settings.margins.early.map_or(0.0, |_| 0.5)
    }

    /// The class that an instant asks for.
    fn asked(&self, instant: usize) -> usize {
        let ahead = self.windows.len() - 1 - instant;
        let means = self.means(instant);
        let over = |class: usize| {
            let others = (0..USED).filter(|other| *other != class);
            others.fold(f64::INFINITY, |least, other| {
                least.min(means[class] - means[other])
            })
        };
        let sure = (0..USED).find(|&class| {
            let [from_classes, from_other] = self.margins(class, ahead);
            over(class) >= from_classes.max(0.0) && means[class] - means[USED] >= from_other
        });
        if ahead < self.settings.look_ahead {
            return sure.unwrap_or(self.class);
        }
        match sure {
            Some(class) if class != 0 => class,
            _ if self.class == 0 => 0,
            _ if over(self.class) >= 0.0 => self.class,
            _ if means[0] - means[self.class] < self.leave() => self.class,
            _ => 0,
        }
    }

    /// Stores a window; follows movement outside the vocabulary while there is no label.
    fn take(&mut self, window: Rows) {
        self.windows.push(window);
        if self.class == 0 {
            let is_other = (0..USED).all(|class| window[0][USED] > window[0][class]);
            let weight = f64::from(self.settings.row_samples) / 4000.0;
            self.otherwise += (f64::from(u8::from(is_other)) - self.otherwise) * weight;
        }
    }

    fn push(&mut self, window: Rows) -> After {
        self.take(window);
        let newest = self.windows.len() - 1;
        let Settings {
            look_ahead, hold, ..
        } = self.settings;
        let mut after = After {
            class: self.class,
            instant: None,
            is_changed: false,
        };
        if newest < look_ahead {
            return after;
        }
        let oldest = newest - look_ahead;
        if self.settings.margins.early.is_none() {
            if newest.is_multiple_of(hold) {
                self.class = self.asked(oldest);
                after.class = self.class;
                after.instant = Some(oldest);
            }
            return after;
        }
        if self
            .change
            .is_none_or(|[_, window]| newest - window >= hold)
        {
            let first = self
                .change
                .map_or(oldest, |[instant, _]| oldest.max(instant + 1));
            let changing = (first..=newest)
                .rev()
                .find(|&instant| self.asked(instant) != self.class);
            if let Some(instant) = changing {
                self.class = self.asked(instant);
                self.change = Some([instant, newest]);
                after.is_changed = true;
            }
        }
        after.class = self.class;
        let is_due = match self.label {
            Some(label) => (newest - label).is_multiple_of(hold),
            None => newest.is_multiple_of(hold),
        };
        if after.is_changed || is_due {
            self.label = Some(newest);
            let change = self.change.map_or(oldest, |[instant, _]| instant);
            after.instant = Some(oldest.max(change));
        }
        after
    }
}

/// No margins, or ones with a fraction that no difference of whole logits has.
pub(super) fn any_margins() -> impl Strategy<Value = Settings> {
    let margin = || (0..4_u8).prop_map(|margin| f32::from(margin) + 0.137);
    let entry = prop_oneof![Just(0.0), margin()];
    let other = prop::option::weighted(0.7, margin());
    let early = prop::option::weighted(0.7, [margin(), margin(), margin()]);
    (any_settings(), entry, other, early).prop_map(|(settings, entry, other, early)| {
        let early = early.map(|[entry, other, caution]| Early {
            entry,
            other,
            caution,
        });
        let margins = Margins {
            entry,
            other,
            early,
        };
        Settings {
            margins,
            ..settings
        }
    })
}

/// Windows that follow one of their classes for some time, whole logits; those of relax have a fraction that no margin of
/// relax has.
pub(super) fn any_intents() -> impl Strategy<Value = Vec<Rows>> {
    let noise = prop::array::uniform6(prop::array::uniform4(-3..4_i8));
    let stretch = (0..CLASSES, 0..8_i8, prop::collection::vec(noise, 1..12));
    prop::collection::vec(stretch, 1..8).prop_map(|stretches| {
        let windows = stretches
            .into_iter()
            .flat_map(|(class, strength, windows)| {
                windows.into_iter().map(move |mut rows| {
                    for row in &mut rows {
                        row[class] += strength;
                    }
                    rows.map(|row| {
                        let mut row = row.map(f32::from);
                        row[0] += 0.037;
                        row
                    })
                })
            });
        windows.collect()
    })
}

proptest! {
    #[test]
    fn labels_are_those_of_the_twin(settings in any_margins(), windows in any_intents()) {
        let mut smoother = Smoother::<CLASSES, ROWS>::new(settings, USED).unwrap();
        let mut twin = Twin { settings, windows: vec![], class: 0, change: None, label: None, otherwise: 0.0 };
        for (number, window) in windows.iter().enumerate() {
            let sample = |number: usize| SampleIndex(number as u32 * settings.row_samples);
            let decision = smoother.push(sample(number), window);
            let after = twin.push(*window);
            let expected = after.instant.map(|instant| Decision {
                class: after.class,
                instant: sample(instant),
                window_end: sample(number),
            });
            prop_assert_eq!(decision, expected, "window {}", number);
        }
    }
}

/// Gates that a wearer may put in place: none, and all named ones.
fn any_gate() -> impl Strategy<Value = Gate> {
    let reactions = Reaction::ALL.map(Some);
    let reaction = prop_oneof![Just(None), prop::sample::select(reactions.to_vec())];
    reaction.prop_map(|reaction| Gate {
        reaction,
        ..Gate::default()
    })
}

proptest! {
    #[test]
    fn instants_never_go_back_and_another_class_has_a_later_one_whatever_gates_are_put_in_place(
        settings in any_settings(),
        windows in any_intents(),
        gates in prop::collection::vec((0..20_usize, any_gate()), 0..6),
    ) {
        let mut smoother = Smoother::<CLASSES, ROWS>::new(settings, USED).unwrap();
        let mut before: Option<Decision> = None;
        for (number, window) in windows.iter().enumerate() {
            for (_, gate) in gates.iter().filter(|(at, _)| *at == number) {
                smoother.set_gate(*gate);
            }
            let end = SampleIndex(number as u32 * settings.row_samples);
            let Some(label) = smoother.push(end, window) else {
                continue;
            };
            if let Some(before) = before {
                let least = if label.class == before.class { before.instant } else { before.instant.plus(1) };
                prop_assert!(label.instant >= least, "window {}: {:?}, {:?}", number, before, label);
            }
            before = Some(label);
        }
    }
}

#[test]
fn a_class_is_asked_for_more_after_other_movement_and_for_less_after_rest() {
    let mut settings = Settings::PAPER_IN_PATCHES;
    settings.margins.other = Some(-1.5);
    settings.margins.early = Some(Early {
        entry: 0.0,
        other: 0.0,
        caution: 8.0,
    });
    // The label of a class that other movement exceeds by 1, after `other` patches of it and `rest` of rest.
    let class = |other: usize, rest: usize| {
        let mut smoother = Smoother::<CLASSES, ROWS>::new(settings, USED).unwrap();
        let mut rows = Rows::default();
        let before = [[-3.0, -3.0, -3.0, 3.0], [3.0, -3.0, -3.0, 0.0]];
        let times = [
            vec![before[0]; other],
            vec![before[1]; rest],
            vec![[-3.0, 3.0, 0.0, 4.0]; 20],
        ];
        let labels = times.concat().into_iter().enumerate().map(|(number, row)| {
            rows.rotate_right(1);
            rows[0] = row;
            smoother.push(SampleIndex(10 * number as u32), &rows)
        });
        labels.flatten().last().unwrap().class
    };
    assert_eq!(class(0, 100), 1, "a quiet hand");
    assert_eq!(class(400, 0), 0, "20 s of other movement");
    assert_eq!(class(400, 400), 0, "20 s later");
    assert_eq!(class(400, 1200), 1, "a minute later");
}
