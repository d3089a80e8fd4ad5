use super::*;

fn columns(header: &str) -> Result<Columns, TableError> {
    Columns::of(&format!("{header}\n1,2,3\n"))
}

fn found(header: &str) -> String {
    columns(header).unwrap_err().damage.to_string()
}

/// Eight names, numbered from `first` on.
fn eight(name: &str, first: usize, separator: &str) -> String {
    let numbers: [usize; 8] = std::array::from_fn(|at| first + at);
    let names = numbers.map(|number| format!("{name}{number}"));
    names.join(separator)
}

#[test]
fn channels_are_eight_numbered_columns_of_one_name() {
    for (name, first) in [
        ("emg_", 0),
        ("emg", 1),
        ("EMG ", 1),
        ("channel_", 1),
        ("Ch", 0),
        ("myo.emg.", 0),
        ("e", 1),
    ] {
        let found = columns(&eight(name, first, ",")).unwrap();
        assert_eq!(found.channels, [0, 1, 2, 3, 4, 5, 6, 7], "{name}");
        assert_eq!((found.label, found.first_line), (None, 2));
    }
    let backwards = columns("emg_7,emg_6,emg_5,emg_4,emg_3,emg_2,emg_1,emg_0").unwrap();
    assert_eq!(backwards.channels, [7, 6, 5, 4, 3, 2, 1, 0]);
    for name in ["Ch% [uV]", "\"emg.%\""] {
        let names = (1..=8).map(|number| name.replace('%', &number.to_string()));
        let header = names.collect::<Vec<_>>().join(",");
        assert_eq!(columns(&header).unwrap().channels, [0, 1, 2, 3, 4, 5, 6, 7]);
    }
    // As pandas writes a table without names.
    let pandas = columns(",0,1,2,3,4,5,6,7").unwrap().channels;
    assert_eq!(pandas, [1, 2, 3, 4, 5, 6, 7, 8]);
    let (emg, imu) = (eight("emg_", 0, ";"), eight("imu_", 0, ";"));
    let found = columns(&format!("Time;{emg};{imu};gyro_0;Class")).unwrap();
    assert_eq!((found.channels[0], found.label), (1, Some(18)));
    assert_eq!(found.separator, Separator::Semicolon);
}

#[test]
fn what_is_not_eight_channels_of_one_armband_is_told() {
    let both = |one, other| format!("{},{}", eight(one, 0, ","), eight(other, 0, ","));
    let two = both("emg_", "emg2_");
    let one_to = |last: usize| eight("emg_", 0, ",") + &format!(",emg_{last}");
    for (header, words) in [
        (&both("left_", "right_"), "6 7) and 8 columns right (0 1"),
        (&both("L_emg", "R_emg"), "6 7) and 8 columns r_emg (0 1"),
        (&two, "8 columns emg (0 1 2 3 4 5 6 7) and 8 columns emg2"),
        (&one_to(8), "9 columns emg (0 1 2 3 4 5 6 7 8)"),
        (&one_to(7), "some twice"),
        (&eight("emg_", 2, ","), "(2 3 4 5 6 7 8 9)"),
        (&"name,age".to_owned(), "no numbered columns"),
    ] {
        assert!(found(header).contains(words), "{header}: {}", found(header));
    }
    assert!(!columns("name,age").unwrap_err().is_meant);
    let sixteen: Vec<String> = (0..16).map(|number| format!("myo{number}")).collect();
    for meant in [two, both("left_", "left_"), sixteen.join(",")] {
        assert!(columns(&meant).unwrap_err().is_meant, "{meant}");
    }
}

#[test]
fn the_label_is_in_a_column_that_is_called_so() {
    let emg = eight("emg_", 0, ",");
    let label = |name: &str| columns(&format!("{name},{emg}")).unwrap().label;
    for name in ["gt", "Label", "ann", "class", "gesture", "Ground Truth"] {
        assert_eq!(label(name), Some(0), "{name}");
    }
    assert_eq!(label("stimulus"), None);
    // `gt` takes precedence.
    assert_eq!(label("label,gt"), Some(1));
    assert!(found(&format!("label,class,{emg}")).contains("label, class"));
}

#[test]
fn what_stands_before_the_table_is_passed_over() {
    for before in ["sep=;\n", "\n", "# made by hand\n"] {
        let text = format!("{before}{}\n", eight("emg_", 0, ";"));
        assert_eq!(Columns::of(&text).unwrap().first_line, 3, "{before}");
    }
    let commented = format!("# {}\n1 2 3 4 5 6 7 8\n", eight("emg", 0, " "));
    assert_eq!(Columns::of(&commented).unwrap().first_line, 2);
}

#[test]
fn columns_called_by_number_are_told_from_samples() {
    let rows = "1,-2,3,4,5,6,7,8\n".repeat(30);
    let first = |head: &str| Columns::of(&format!("{head}\n{rows}")).unwrap().first_line;
    assert_eq!(first("0,1,2,3,4,5,6,7"), 2);
    assert_eq!(first("1,2,3,4,5,6,7,9"), 1);
    let equal = Columns::of(&"1,2,3,4,5,6,7,8\n".repeat(30)).unwrap();
    assert_eq!(equal.first_line, 1);
    // One damaged value makes no header.
    assert_eq!(first("1,x,3,4,5,6,7,8"), 1);
}
