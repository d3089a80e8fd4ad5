//! No line is left out, and an instant has one class, whatever happens between the samples.

use super::*;
use crate::stream::alignment::Alignment;
use crate::stream::smoother::{Early, Reaction};

/// Event between two samples.
#[derive(Clone, Copy, Debug)]
enum Between {
    /// The encoder takes the samples again, with the electrodes in another order.
    Aligned(u8),
    /// Another model takes the samples again.
    OtherModel,
    /// Lost samples that are filled in.
    Gap(u32),
}

fn any_between() -> impl Strategy<Value = Between> {
    prop_oneof![
        (0..8_u8).prop_map(Between::Aligned),
        Just(Between::OtherModel),
        (1..6_u32).prop_map(Between::Gap),
    ]
}

/// When it happens, and what: also soon after one another, as long as the encoder has samples to take.
fn any_schedule() -> impl Strategy<Value = Vec<(u32, Between)>> {
    let pauses = prop::collection::vec((prop_oneof![0..300_u32, 50..70_u32], any_between()), 1..8);
    pauses.prop_map(|pauses| {
        let times = pauses.into_iter().scan(650, |time, (pause, between)| {
            *time += pause;
            Some((*time, between))
        });
        times.collect()
    })
}

/// The paper's settings with these margins of early labels.
fn early(early: Option<Early>) -> Settings {
    let mut settings = Settings::PAPER_IN_PATCHES;
    settings.margins.early = early;
    settings
}

#[test]
fn an_early_label_keeps_its_class_where_the_samples_are_taken_again_at_once() {
    let settings = Settings {
        hold: 1,
        ..early(Reaction::Fast.margins().early)
    };
    let mut pipeline = pipeline_of(SumModel, settings);
    // The model counts on channel 0, where an exchange of the electrodes puts rest in place of open.
    let open = core::array::from_fn(|channel| i8::from(channel == 0));
    let mut samples = [open; 900];
    samples[..700].fill(constant(0));
    let (mut reports, _) = run(&mut pipeline, &samples, 0..711);
    pipeline.set_alignment(Alignment::new(1, false));
    reports.extend(run(&mut pipeline, &samples, 711..900).0);
    let labels = labels(reports, 0);
    let changes = labels.windows(2).filter(|two| two[0].1 != two[1].1);
    let changes: Vec<_> = changes.map(|two| [two[0].0, two[1].0]).collect();
    assert_eq!(changes.len(), 2, "to open and to relax: {labels:?}");
    let rising = changes.iter().all(|[before, after]| before < after);
    assert!(rising, "{changes:?}");
}

#[test]
fn the_first_label_comes_with_the_sample_that_the_documentation_names() {
    let page = include_str!("../../../../docs/uart.md");
    let balanced = Reaction::Balanced.margins().early;
    for (margins, class, samples) in [
        (balanced, 1, 651),
        (balanced, 0, 661),
        (None, 1, 661),
        (None, 0, 661),
    ] {
        let mut pipeline = pipeline_of(SumModel, early(margins));
        let first = (0..1000).find(|&index| {
            let reports = pipeline.sample(at(index), constant(class)).into_iter();
            reports.count() > 0
        });
        assert_eq!(first, Some(samples - 1), "{margins:?}, class {class}");
        let named = page.contains(&alloc::format!("the {samples}st"));
        assert!(named, "docs/uart.md lacks the {samples}st sample");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]
    #[test]
    fn lines_are_counted_and_another_class_has_a_later_instant_whatever_happens(
        hold in 1..4_usize,
        look_ahead in prop_oneof![0..LOOK_BACK, Just(LOOK_BACK - 1)],
        reaction in prop::sample::select(Reaction::ALL.to_vec()),
        recording in prop::collection::vec(any::<Sample>(), 300),
        schedule in any_schedule(),
    ) {
        let settings = Settings {
            look_ahead,
            hold,
            ..early(reaction.margins().early)
        };
        let mut pipeline = pipeline_of(SumModel, settings);
        let mut lines = 0;
        let mut before: Option<Report> = None;
        let mut check = |reports: Reports| {
            for report in reports {
                prop_assert_eq!(report.sequence, lines, "{}", report);
                lines += 1;
                if report.kind == ReportKind::State {
                    continue;
                }
                if let Some(before) = before {
                    let is_same = report.status.label() == before.status.label();
                    let least = before.instant.plus(u32::from(!is_same));
                    prop_assert!(report.instant >= least, "{}, then {}", before, report);
                }
                before = Some(report);
            }
            Ok(())
        };
        for index in 0..2000 {
            let now = at(index);
            for (_, between) in schedule.iter().filter(|(time, _)| *time == index) {
                match *between {
                    // Without the report of an alignment, which would count as a line.
                    Between::Aligned(steps) => pipeline.realign(Alignment::new(steps, false)),
                    Between::OtherModel => {
                        check(pipeline.suspend(now))?;
                        let smoother = Smoother::new(settings, 3).unwrap();
                        let input = ModelInput { preprocessing: Preprocessing::default(), template: None, alignment: Alignment::NONE };
                        pipeline.resume(now, SumModel, smoother, input);
                    }
                    Between::Gap(missing) => check(pipeline.gap(now, missing))?,
                }
            }
            check(pipeline.sample(now, recording[index as usize % 300]))?;
        }
    }
}
