//! Where a scene came from, so that errors found late still point at the line.

use clearway_files::{FileError, Located, yaml};
use std::path::Path;

/// The document that is being checked.
pub(crate) struct Source<'a> {
    written: Option<(&'a Path, &'a str)>,
}

impl<'a> Source<'a> {
    pub(crate) fn text<T>(located: &'a Located<T>) -> Self {
        Self { written: Some((located.path(), located.text())) }
    }

    /// A scene that was never a file.
    pub(crate) fn unwritten() -> Self {
        Self { written: None }
    }

    /// An error about the value at `keys`, written with dots: `objects.3.cylinder.radius`.
    pub(crate) fn error(&self, keys: &str, found: impl Into<String>) -> FileError {
        match self.written {
            Some((path, text)) => FileError::new(path, found).at_position(position(text, keys)),
            None => FileError::new("scene", format!("{keys}: {}", found.into())),
        }
    }

    /// An error about a file that the value at `keys` names.
    pub(crate) fn reference(&self, keys: &str, error: FileError) -> FileError {
        match self.written {
            Some((path, text)) => error.referenced_from(path, position(text, keys)),
            None => error.referenced_from("scene", None),
        }
    }
}

fn position(text: &str, keys: &str) -> Option<(usize, usize)> {
    yaml::position(text, &keys.split('.').collect::<Vec<_>>())
}
