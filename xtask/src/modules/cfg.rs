//! Which items are compiled for tests alone.

use syn::{Attribute, Meta, MetaList, Token, punctuated::Punctuated};

/// Whether an item with this attribute is compiled for tests alone.
pub fn is_test(attribute: &Attribute) -> bool {
    if attribute.path().is_ident("test") {
        return true;
    }
    attribute.path().is_ident("cfg")
        && attribute
            .parse_args::<Meta>()
            .is_ok_and(|predicate| without_test(&predicate) == Some(false))
}

/// What a `cfg` predicate is where `test` is not set; none where other settings decide.
fn without_test(predicate: &Meta) -> Option<bool> {
    let inner = |list: &MetaList| -> Vec<Option<bool>> {
        let parsed = list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated);
        let predicates = parsed.into_iter().flatten();
        predicates.map(|inner| without_test(&inner)).collect()
    };
    match predicate {
        Meta::Path(path) => path.is_ident("test").then_some(false),
        Meta::List(list) if list.path.is_ident("all") => {
            inner(list).contains(&Some(false)).then_some(false)
        }
        Meta::List(list) if list.path.is_ident("any") => {
            let all_false = inner(list).iter().all(|value| *value == Some(false));
            all_false.then_some(false)
        }
        Meta::List(list) if list.path.is_ident("not") => {
            inner(list).first().copied().flatten().map(|value| !value)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predicates_that_need_test_are_recognised() {
        let is_test = |attribute: &str| {
            let text = format!("#[{attribute}] fn f() {{}}");
            let syn::Item::Fn(item) = syn::parse_str(&text).unwrap() else {
                panic!("no function");
            };
            is_test(&item.attrs[0])
        };
        for attribute in [
            "cfg(test)",
            "test",
            "cfg(all(test, unix))",
            "cfg(any(test))",
            "cfg(not(not(test)))",
        ] {
            assert!(is_test(attribute), "{attribute}");
        }
        for attribute in [
            "cfg(any(test, unix))",
            "cfg(not(test))",
            "cfg(not(all(test, unix)))",
            "cfg(unix)",
            "inline",
        ] {
            assert!(!is_test(attribute), "{attribute}");
        }
    }
}
