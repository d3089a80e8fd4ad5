//! Pages on one person and on few people, and tables on a narrow terminal.

use super::*;

/// Evaluation of a number of people with all three classes.
fn people(count: usize) -> Evaluated {
    let made_up = |at| EvaluatedRecording::made_up(&format!("synthetic/{at}"), &[0, 1, 0, 2, 0]);
    Evaluated::new((0..count).map(made_up).collect())
}

#[test]
fn of_one_person_nothing_is_the_worst_or_best_and_no_interval_is_promised() {
    let evaluated = people(1);
    let entry = || evaluated.entry();
    for entries in [vec![entry()], vec![entry(), entry()]] {
        let html = page(&evaluated, &entries).html().unwrap();
        let words = "the worst first|the best one|its best one|the lowest|with 95 % intervals|Means over people|1 people";
        for several in words.split('|') {
            assert!(!html.contains(several), "{several}");
        }
        assert!(html.contains("One person: no intervals."));
    }
}

#[test]
fn intervals_are_told_of_where_they_are_drawn_and_elsewhere_the_page_says_why_there_are_none() {
    let page_of = |evaluated: &Evaluated| page(evaluated, &[evaluated.entry()]).html().unwrap();
    let (three, six) = (page_of(&people(3)), page_of(&people(6)));
    assert!(three.contains("Fewer than six people: no intervals."));
    assert!(!three.contains("with 95 % intervals") && six.contains("with 95 % intervals"));
    assert!(six.contains("the worst first"));
}

#[test]
fn what_a_terminal_shows_has_at_most_100_columns() {
    let evaluated = four_people();
    for table in [true, false]
        .into_iter()
        .flat_map(|all| tables(&evaluated.results, all))
    {
        let text = table.text(false);
        let widest = text.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(100), "{text}");
    }
}
