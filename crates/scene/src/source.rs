//! Where a scene came from, so that errors found late still point at the line.

use clearway_files::{FileError, Located};
use clearway_plan::SceneFile;

/// The document that is being checked.
pub(crate) struct Source<'a> {
    located: Option<&'a Located<SceneFile>>,
}

impl<'a> Source<'a> {
    pub(crate) fn text(located: &'a Located<SceneFile>) -> Self {
        Self { located: Some(located) }
    }

    /// A scene that was never a file.
    pub(crate) fn unwritten() -> Self {
        Self { located: None }
    }

    /// An error about the value at `keys`, written with dots: `objects.3.cylinder.radius`.
    pub(crate) fn error(&self, keys: &str, found: impl Into<String>) -> FileError {
        match self.located {
            Some(located) => located.error(&keys.split('.').collect::<Vec<_>>(), found),
            None => FileError::new("scene", format!("{keys}: {}", found.into())),
        }
    }

    /// An error about a file that the value at `keys` names.
    pub(crate) fn reference(&self, keys: &str, error: FileError) -> FileError {
        match self.located {
            Some(located) => {
                let position = located.position(&keys.split('.').collect::<Vec<_>>());
                error.referenced_from(located.path(), position)
            }
            None => error.referenced_from("scene", None),
        }
    }
}
