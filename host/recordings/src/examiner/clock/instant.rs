//! Times as text: numbers, dates and times of day.

/// Seconds in a day.
const DAY: f64 = 86_400.0;

/// Parses a number, a date with a time of day, or a time of day, as seconds.
pub(crate) fn seconds_of(text: &str) -> Option<f64> {
    let text = text.trim().trim_matches('"');
    if let Ok(number) = text.parse::<f64>() {
        return number.is_finite().then_some(number);
    }
    let (date, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) => (days(date)?, time.trim_start()),
        None => (0.0, text),
    };
    Some(date * DAY + time_of_day(time)?)
}

/// Days of a date such as `2021-03-04` or `4.3.2021` since a fixed day.
fn days(text: &str) -> Option<f64> {
    let mut parts = text.split(['-', '/', '.']).map(str::parse::<u32>);
    let mut next = || parts.next()?.ok();
    let (year, month, day) = match (next()?, next()?, next()?) {
        // The year stands last; of two numbers above it, one above 12 is the day.
        (month, day @ 13.., year @ 32..) | (day, month, year @ 32..) => (year, month, day),
        own => own,
    };
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || year > 9999 {
        return None;
    }
    // Days from March on, as calendars are computed: leap days come last in a year.
    let (year, month) = if month < 3 {
        (year.checked_sub(1)?, month + 9)
    } else {
        (year, month - 3)
    };
    let leaps = year / 4 + year / 400 - year / 100;
    Some(f64::from(365 * year + leaps + (153 * month + 2) / 5 + day))
}

/// Seconds of a time of day such as `12:30:05.125`; a time zone behind it is ignored.
fn time_of_day(text: &str) -> Option<f64> {
    let text = text.trim_end_matches('Z');
    let zone = text.rfind(['+', '-']).filter(|&at| at > 0);
    let text = zone.map_or(text, |at| &text[..at]).trim_end();
    let mut parts = text.split(':');
    let mut next = || {
        let part = parts.next()?.parse::<f64>().ok();
        part.filter(|part| *part >= 0.0)
    };
    let (hours, minutes, seconds) = (next()?, next()?, next()?);
    let whole = parts.next().is_none() && hours.fract() == 0.0 && minutes.fract() == 0.0;
    (whole && minutes < 60.0 && seconds < 61.0).then_some(3600.0 * hours + 60.0 * minutes + seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_in_every_spelling() {
        let leap = seconds_of("2024-02-29 23:59:10.5").unwrap();
        for text in [
            "2024-02-29T23:59:10.500Z",
            "2024/02/29 23:59:10.5",
            "29.02.2024 23:59:10.5",
            "2/29/2024 23:59:10.5",
            "\"2024-02-29 23:59:10.5+01:00\"",
        ] {
            assert_eq!(seconds_of(text), Some(leap), "{text}");
        }
        assert_eq!(seconds_of("10:00:00.005"), Some(36_000.005));
        assert_eq!(seconds_of(" 12.5 "), Some(12.5));
        for text in ["", "noon", "2024-13-01 00:00:00", "10:61:00", "inf"] {
            assert_eq!(seconds_of(text), None, "{text}");
        }
    }
}
