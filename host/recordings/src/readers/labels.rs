//! Labels in our own numbering (that of ReactEMG), as a number or as a name.

use shared::intent::Intent;

use super::error::Fault;

/// Label of a class number, 0 to 5, or -1 for none.
pub(crate) fn from_number(value: f64) -> Result<Option<Intent>, Fault> {
    let fault = || Fault::Label {
        expected: "-1, 0, 1, 2, 3, 4, 5",
        found: value.to_string(),
    };
    if value == -1.0 {
        return Ok(None);
    }
    let class = (value.fract() == 0.0 && value >= 0.0).then_some(value as usize);
    class
        .and_then(Intent::from_class)
        .map(Some)
        .ok_or_else(fault)
}

/// Label of an intent's name, of a class number, or for none of `none`, -1 or an empty field.
pub(crate) fn from_text(text: &str) -> Result<Option<Intent>, Fault> {
    if text.is_empty() || text == "none" {
        return Ok(None);
    }
    if let Some(intent) = Intent::from_name(text) {
        return Ok(Some(intent));
    }
    let fault = || Fault::Label {
        expected: "-1 to 5, an intent's name, or none",
        found: text.to_owned(),
    };
    from_number(text.parse().map_err(|_| fault())?).map_err(|_| fault())
}
