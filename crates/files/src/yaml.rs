//! YAML, and JSON as the part of YAML that it is: strict, bounded, with places.
//!
//! Unknown and repeated keys are errors (the former where the type denies them). Depth, nodes and
//! what aliases blow up to are bounded. Numbers may be `.nan` or `.inf`: whether that makes sense
//! the caller checks, and points at the place with [`Located::error`].

use crate::error::{FileError, quoted};
use crate::suggest::closest;
use granit_parser::{Event, Parser, Span};
use serde::de::DeserializeOwned;
use serde_saphyr::{Error, MessageFormatter};
use std::path::{Path, PathBuf};

/// Sequences and mappings within each other.
pub const MAX_DEPTH: usize = 64;

/// A value read from a document, and the document, to say where in it something stands.
#[derive(Clone, Debug)]
pub struct Located<T> {
    pub value: T,
    path: PathBuf,
    text: String,
}

/// Reads `text`, of which `path` is the name for messages.
pub fn from_str<T: DeserializeOwned>(path: &Path, text: &str) -> Result<Located<T>, FileError> {
    let options = serde_saphyr::options! {
        budget: serde_saphyr::budget! {
            max_depth: MAX_DEPTH,
            max_documents: 2,
            max_nodes: 1_000_000,
            max_events: 3_000_000,
            max_aliases: 10_000,
            max_anchors: 10_000,
        },
        alias_limits: serde_saphyr::alias_limits! {
            max_total_replayed_events: 100_000,
            max_replay_stack_depth: 16,
            max_alias_expansions_per_anchor: 10_000,
        },
        // Rendered by `FileError`.
        with_snippet: false,
    };
    match serde_saphyr::from_str_with_options(text, options) {
        Ok(value) => Ok(Located { value, path: path.to_owned(), text: text.to_owned() }),
        Err(error) => Err(explain(path, text, &error)),
    }
}

impl<T> Located<T> {
    /// The name for messages that the document was read under.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The document as it was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Line and column of the value at `keys` (an index counts as the key of a sequence), or of
    /// the nearest thing round it that the text holds. Walks the text: for error messages.
    pub fn position(&self, keys: &[&str]) -> Option<(usize, usize)> {
        position(&self.text, keys)
    }

    /// An error about the value at `keys`.
    pub fn error(&self, keys: &[&str], found: impl Into<String>) -> FileError {
        FileError::new(&self.path, found).at_position(self.position(keys))
    }
}

/// What [`Located::position`] says, of a text. No recursion, no memory, linear in the text.
pub fn position(text: &str, keys: &[&str]) -> Option<(usize, usize)> {
    let mut events = Parser::new_from_str(text).filter_map(Result::ok).filter(is_node_or_end);
    let mut keys = keys.iter();
    let mut node = events.next()?;
    loop {
        let here = Some((node.1.start.line(), node.1.start.col() + 1));
        let Some(&key) = keys.next() else { return here };
        node = match node.0 {
            Event::MappingStart(..) => loop {
                let Some(name) = events.next() else { return here };
                let found = match &name.0 {
                    Event::MappingEnd => return here,
                    Event::Scalar(text, ..) => text == key,
                    _ => false,
                };
                skip_rest_of(&name, &mut events);
                let Some(value) = events.next() else { return here };
                if found {
                    break value;
                }
                skip_rest_of(&value, &mut events);
            },
            Event::SequenceStart(..) => {
                let Ok(index) = key.parse::<usize>() else { return here };
                let mut count = 0;
                loop {
                    let Some(item) = events.next() else { return here };
                    if item.0 == Event::SequenceEnd {
                        return here;
                    }
                    if count == index {
                        break item;
                    }
                    skip_rest_of(&item, &mut events);
                    count += 1;
                }
            }
            _ => return here,
        };
    }
}

fn is_node_or_end((event, _): &(Event, Span)) -> bool {
    matches!(
        event,
        Event::Scalar(..)
            | Event::Alias(..)
            | Event::SequenceStart(..)
            | Event::SequenceEnd
            | Event::MappingStart(..)
            | Event::MappingEnd
    )
}

/// Goes on to the end of a node of which the first event was taken.
fn skip_rest_of<'i>(first: &(Event<'i>, Span), events: &mut impl Iterator<Item = (Event<'i>, Span)>) {
    let step = |event: &Event| match event {
        Event::SequenceStart(..) | Event::MappingStart(..) => 1,
        Event::SequenceEnd | Event::MappingEnd => -1,
        _ => 0,
    };
    let mut depth = step(&first.0);
    while depth > 0 {
        let Some((event, _)) = events.next() else { return };
        depth += step(&event);
    }
}

/// The reader's error in our words.
fn explain(path: &Path, text: &str, error: &Error) -> FileError {
    let mut error = error.without_snippet();
    while let Error::AliasError { error: inner, .. } = error {
        error = inner;
    }
    let place = error.location().filter(|l| l.line() > 0).map(|l| (l.line() as usize, l.column() as usize));
    let told = |found: String| FileError::new(path, found).at_position(place);
    match error {
        Error::SerdeUnknownField { field, expected, .. } => {
            let told = told(format!("unknown key {}", quoted(field))).expected(one_of(expected));
            match closest(field, expected.iter().copied()) {
                Some(near) => told.help(format!("did you mean `{near}`?")),
                None => told.help("delete the key, or correct it"),
            }
        }
        Error::SerdeUnknownVariant { variant, expected, .. } => {
            let told = told(format!("unknown value {}", quoted(variant))).expected(one_of(expected));
            match closest(variant, expected.iter().copied()) {
                Some(near) => told.help(format!("did you mean `{near}`?")),
                None => told,
            }
        }
        Error::SerdeMissingField { field, .. } => told(format!("the key `{field}` is missing"))
            .help(format!("add `{field}: …` to the mapping that this stands in")),
        Error::DuplicateMappingKey { key, .. } => {
            let key = key.as_deref().map_or_else(|| "a key".to_owned(), |k| format!("the key {}", quoted(k)));
            told(format!("{key} is given twice")).help("keep one of the two")
        }
        Error::SerdeInvalidType { unexpected, expected, .. }
        | Error::SerdeInvalidValue { unexpected, expected, .. } => {
            told(format!("found {}", plain_words(unexpected))).expected(plain_words(expected))
        }
        Error::SerdeInvalidLength { len, expected, .. } => {
            told(format!("found {len} item{}", if *len == 1 { "" } else { "s" })).expected(expected.as_str())
        }
        Error::NonFiniteFloat { value, .. } => told(format!("found {}", quoted(value))).expected("a finite number"),
        Error::InvalidScalar { ty, .. } => told(found_at(text, place)).expected(plain_type(ty)),
        Error::Unexpected { expected, .. } => told(found_at(text, place)).expected(plain_type(expected)),
        Error::NullIntoString { .. } => told("found nothing".to_owned())
            .expected("text")
            .help("write the value after the key; `\"\"` is the empty text"),
        Error::Budget { .. }
        | Error::AliasReplayLimitExceeded { .. }
        | Error::AliasExpansionLimitExceeded { .. }
        | Error::AliasReplayStackDepthExceeded { .. }
        | Error::AliasReplayCounterOverflow { .. } => {
            told(format!("too large or too deep: {}", message(error))).help("is this the right file?")
        }
        Error::MultipleDocuments { .. } => {
            told("a second document".to_owned()).expected("one document").help("delete the `---` and what follows it")
        }
        Error::Eof { .. } if text.trim().is_empty() => {
            FileError::new(path, "an empty file").at(1, 1).expected("a YAML document").help("is this the right file?")
        }
        Error::Message { msg, .. } if msg.contains("did not match any variant of untagged enum") => {
            told("a value of no accepted form".to_owned())
                .help("see the file's schema: `clearway schema scene|robot|plan|motion`")
        }
        _ => told(message(error)),
    }
}

fn message(error: &Error) -> String {
    serde_saphyr::DefaultMessageFormatter.format_message(error).into_owned()
}

fn one_of(names: &[&str]) -> String {
    match names {
        [] => "no keys here".to_owned(),
        [one] => format!("`{one}`"),
        _ => format!("one of `{}`", names.join("`, `")),
    }
}

fn found_at(text: &str, place: Option<(usize, usize)>) -> String {
    match place.and_then(|p| word_at(text, p)) {
        // The place of a value that is left out is that of the colon after its key.
        Some(":") => "found nothing".to_owned(),
        Some(word) => format!("found {}", quoted(word)),
        None => "an unreadable value".to_owned(),
    }
}

/// The reader's names for kinds of values, in words.
fn plain_words(said: &str) -> &str {
    match said {
        "unit value" => "nothing",
        "map" => "a mapping",
        "a map" => "a mapping, `key: value`",
        "sequence" => "a list",
        "a sequence" => "a list, `[…]` or lines of `- …`",
        other => other,
    }
}

/// `f64` and `mapping start` are no words for the people who write these files.
fn plain_type(ty: &str) -> String {
    if ty == "mapping start" {
        "a mapping, `key: value`".to_owned()
    } else if ty == "sequence start" {
        "a list, `[…]` or lines of `- …`".to_owned()
    } else if ty == "string scalar" {
        "text".to_owned()
    } else if ty.contains("float") || matches!(ty, "f64" | "f32") {
        "a number".to_owned()
    } else if ty.contains("int") || matches!(ty, "usize" | "u8" | "u16" | "u32" | "u64" | "i8" | "i16" | "i32" | "i64")
    {
        "a whole number".to_owned()
    } else {
        ty.to_owned()
    }
}

/// The word at a place in the text.
fn word_at(text: &str, (line, column): (usize, usize)) -> Option<&str> {
    let line = text.lines().nth(line.checked_sub(1)?)?;
    let (start, _) = line.char_indices().nth(column.checked_sub(1)?)?;
    line[start..].split([',', ']', '}', '#']).next().map(str::trim).filter(|w| !w.is_empty())
}
