//! Who tips, in words: an object whose own centre of mass is beside what carries it; or else the
//! lowest that does not stand with what is on it.

use super::polygon::{outside, widened};
use super::stack::{Carrier, Stack};
use super::{Change, LENIENT};

/// Of objects that do not balance together.
pub(super) fn falls(stack: &Stack, members: &[usize], change: Change) -> String {
    let beside = |object: &usize| outside(&widened(&stack.under(*object), LENIENT), stack.centre(*object)) > 0.0;
    let carriers = |object: usize| names(stack, stack.contacts[object].iter().map(|c| c.on));
    if let Some(&object) = members.iter().find(|o| beside(o)) {
        let away = outside(&stack.under(object), stack.centre(object)) * 1e3;
        return format!(
            "{}{} is not stable: its centre of mass is {away:.1} mm outside what carries it ({})",
            when(stack, change, Some(object)),
            stack.id(Carrier::Object(object)),
            carriers(object)
        );
    }
    let loaded = members.iter().copied().filter(|o| !stack.on(*o).is_empty());
    let lowest = loaded.min_by(|a, b| stack.bottom(*a).total_cmp(&stack.bottom(*b)));
    match lowest {
        Some(object) => format!(
            "{}{} does not stand with {} on it, on what carries it ({})",
            when(stack, change, Some(object)),
            stack.id(Carrier::Object(object)),
            names(stack, stack.on(object).into_iter()),
            carriers(object)
        ),
        None => format!("{}{} do not balance", when(stack, change, None), objects(stack, members)),
    }
}

/// Of objects that were too many for the solver.
pub(super) fn unknown(stack: &Stack, members: &[usize], change: Change) -> String {
    format!("{}whether {} balance", when(stack, change, None), objects(stack, members))
}

fn when(stack: &Stack, change: Change, blamed: Option<usize>) -> String {
    match change {
        Change::Start => "at the start ".to_owned(),
        Change::Taken(object) => format!("with {} taken, ", stack.id(Carrier::Object(object))),
        Change::Put(object) if blamed == Some(object) => "put down, ".to_owned(),
        Change::Pushed(object) if blamed == Some(object) => "on its way ".to_owned(),
        Change::Pushed(object) => format!("with {} pushed, ", stack.id(Carrier::Object(object))),
        Change::Put(object) => format!("with {} put down, ", stack.id(Carrier::Object(object))),
    }
}

fn objects(stack: &Stack, members: &[usize]) -> String {
    names(stack, members.iter().map(|o| Carrier::Object(*o)))
}

fn names(stack: &Stack, carriers: impl Iterator<Item = Carrier>) -> String {
    carriers.map(|c| stack.id(c)).collect::<Vec<&str>>().join(", ")
}
