//! Names of folders that are sessions of a person, not people.

/// Kind of session that a folder's name shows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum SessionName {
    /// Date, weekday or numbered session, anywhere in a path.
    Time,
    /// Part of a session, below a person's folder.
    Part,
    /// Folder named after its content, below a person's folder.
    Container,
    /// Number alone: a session below a folder, else a person.
    Number,
}

/// Words for the time of a session.
#[rustfmt::skip]
const TIMES: [&str; 19] = [
    "session", "sessions", "sitting", "day", "week", "visit", "date", "monday", "tuesday", "wednesday", "thursday",
    "friday", "saturday", "sunday", "morning", "noon", "afternoon", "evening", "night",
];
/// Words for a part of a session.
#[rustfmt::skip]
const PARTS: [&str; 20] = [
    "trial", "trials", "run", "rep", "repetition", "round", "block", "take", "part", "train", "training", "test",
    "testing", "evaluation", "validation", "calibration", "left", "right", "hand", "arm",
];
/// Words for the content of a folder.
#[rustfmt::skip]
const CONTAINERS: [&str; 12] = [
    "data", "raw", "csv", "emg", "recording", "recordings", "old", "backup", "copy", "stream", "tmp", "new",
];

/// Kind of session that a folder's name shows; none if it may be a person's.
pub(crate) fn session(name: &str) -> Option<SessionName> {
    if name.starts_with('.') {
        return Some(SessionName::Container);
    }
    let name = name.to_lowercase();
    let of = |is_own: fn(char) -> bool| -> Vec<&str> {
        let parts = name.split(|c| !is_own(c));
        parts.filter(|part| !part.is_empty()).collect()
    };
    let (words, numbers) = (of(char::is_alphabetic), of(|c| c.is_ascii_digit()));
    let known = |list: &[&str]| words.iter().all(|word| list.contains(word));
    if words.is_empty() || known(&["t"]) || known(&["t", "z"]) {
        return match numbers[..] {
            [] => None,
            _ if is_date(&numbers) => Some(SessionName::Time),
            _ => Some(SessionName::Number),
        };
    }
    if words.iter().any(|word| TIMES.contains(word)) && known(&[&TIMES[..], &PARTS].concat()) {
        return Some(SessionName::Time);
    }
    if known(&PARTS) {
        return Some(SessionName::Part);
    }
    known(&[&PARTS[..], &CONTAINERS].concat()).then_some(SessionName::Container)
}

/// Whether numbers begin with a date: 2026-11-25, 25.11.2026 or 20261125.
fn is_date(numbers: &[&str]) -> bool {
    let value = |text: &str| text.parse::<u32>().unwrap_or(u32::MAX);
    let plausible = |year: &str, month: &str, day: &str| {
        (1990..2100).contains(&value(year))
            && (1..=12).contains(&value(month))
            && (1..=31).contains(&value(day))
    };
    match *numbers {
        [whole, ..] if whole.len() == 8 => plausible(&whole[..4], &whole[4..6], &whole[6..]),
        [first, month, last, ..] => plausible(first, month, last) || plausible(last, month, first),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sessions_are_told_from_people() {
        let are = |kind, names: &str| {
            for name in names.split(',') {
                assert_eq!(session(name), kind, "{name}");
            }
        };
        let times = "monday,Session 1,session_2,day3,2026-11-25,25.11.2026,20261125,20261125T110323Z,\
                     monday_morning,visit-2";
        are(Some(SessionName::Time), times);
        are(Some(SessionName::Part), "trial_1,training0,Test1,left_hand");
        let containers = ".ipynb_checkpoints,backup,raw_data,emg";
        are(Some(SessionName::Container), containers);
        are(Some(SessionName::Number), "1,07,12345-1,99999999");
        are(None, "anna,P01,s3,subject_1,Day Lewis,zbackup,握,t,user10");
    }
}
