//! What of PDDL is not read, by the words that it begins with.

use super::sexpr::{Place, Source};
use clearway_files::{FileError, quoted};

const NUMBERS: &str = "numbers and costs are not read: leave it out";
const TIME: &str = "actions have no durations here: write `(:action …)`";
const SOFT: &str = "only what must hold at the end can be asked for: write it into the goal, or leave it out";

const SECTIONS: [(&str, &str); 13] = [
    (":functions", NUMBERS),
    (":function", "costs of streams are not read: leave it out"),
    (":optimizer", "only `(:stream …)` is read: leave it out"),
    (":rule", "write it as `(:derived …)` in the domain"),
    (":axiom", "write it as `(:derived …)`"),
    (":durative-action", TIME),
    (":process", TIME),
    (":event", TIME),
    (":constraints", SOFT),
    (":metric", NUMBERS),
    (":duration", TIME),
    (":condition", TIME),
    (":length", NUMBERS),
];

const WORDS: [(&str, &str); 22] = [
    ("increase", NUMBERS),
    ("decrease", NUMBERS),
    ("assign", NUMBERS),
    ("scale-up", NUMBERS),
    ("scale-down", NUMBERS),
    ("total-cost", NUMBERS),
    (">", NUMBERS),
    ("<", NUMBERS),
    (">=", NUMBERS),
    ("<=", NUMBERS),
    ("+", NUMBERS),
    ("-", NUMBERS),
    ("*", NUMBERS),
    ("/", NUMBERS),
    ("over", TIME),
    ("preference", SOFT),
    ("always", SOFT),
    ("sometime", SOFT),
    ("within", SOFT),
    ("at-most-once", SOFT),
    ("sometime-after", SOFT),
    ("sometime-before", SOFT),
];

/// The remedy, where `name` begins a section or property that is not read.
pub(super) fn section(name: &str) -> Option<&'static str> {
    of(&SECTIONS, name)
}

/// The remedy, where `name` begins a formula or an effect that is not read.
pub(super) fn word(name: &str) -> Option<&'static str> {
    of(&WORDS, name)
}

fn of(table: &[(&str, &'static str)], name: &str) -> Option<&'static str> {
    table.iter().find(|(word, _)| word.eq_ignore_ascii_case(name)).map(|&(_, why)| why)
}

pub(super) fn error(source: Source, place: Place, name: &str, why: &str) -> FileError {
    source.error(place, format!("{} is not supported", quoted(name))).help(why)
}
