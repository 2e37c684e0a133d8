//! What is wrong with a file, told so that its author can mend it.

use std::fmt;
use std::path::{Path, PathBuf};

/// Longest part of a message that may come out of the file itself, in characters.
const LONGEST: usize = 400;

/// A file that cannot be used: where, what was found, what was expected, what to do.
///
/// Printed as `shelf.yaml:12:5: unknown key `raduis`, expected one of `radius`, `height`` with the
/// remedy on a line of its own. One pointer wide, so cheap to return.
#[derive(Clone, PartialEq, Eq)]
pub struct FileError(Box<Parts>);

#[derive(Clone, PartialEq, Eq)]
struct Parts {
    path: PathBuf,
    /// Line and column, from 1.
    position: Option<(usize, usize)>,
    found: String,
    expected: Option<String>,
    help: Option<String>,
}

impl FileError {
    /// `found` says what is wrong, in lower case and without a full stop.
    pub fn new(path: impl AsRef<Path>, found: impl Into<String>) -> Self {
        Self(Box::new(Parts {
            path: path.as_ref().to_owned(),
            position: None,
            found: clean(&found.into()),
            expected: None,
            help: None,
        }))
    }

    /// Line and column, both from 1.
    #[must_use]
    pub fn at(mut self, line: usize, column: usize) -> Self {
        self.0.position = Some((line, column));
        self
    }

    /// The same, where the place may be unknown.
    #[must_use]
    pub fn at_position(mut self, position: Option<(usize, usize)>) -> Self {
        self.0.position = position;
        self
    }

    /// The same, told of `whose`.
    #[must_use]
    pub fn about(mut self, whose: &str) -> Self {
        self.0.found = clean(&format!("{whose}: {}", self.0.found));
        self
    }

    /// What should have been there; printed after `, expected `.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.0.expected = Some(clean(&expected.into()));
        self
    }

    /// What to do about it.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help = Some(clean(&help.into()));
        self
    }

    /// This error as seen from the file that named the broken one: it points at the place in
    /// `path` and carries the whole of the first message.
    #[must_use]
    pub fn referenced_from(self, path: impl AsRef<Path>, position: Option<(usize, usize)>) -> Self {
        let found = self.headline();
        Self(Box::new(Parts { path: path.as_ref().to_owned(), position, found, expected: None, help: self.0.help }))
    }

    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Line and column, from 1.
    pub fn position(&self) -> Option<(usize, usize)> {
        self.0.position
    }

    /// What is wrong, without the place.
    pub fn found(&self) -> &str {
        &self.0.found
    }

    /// Everything but the remedy, on one line.
    fn headline(&self) -> String {
        let mut line = format!("{}", self.0.path.display());
        if let Some((row, column)) = self.0.position {
            line += &format!(":{row}:{column}");
        }
        line += ": ";
        line += &self.0.found;
        if let Some(expected) = &self.0.expected {
            line += ", expected ";
            line += expected;
        }
        line
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.headline())?;
        match &self.0.help {
            Some(help) => write!(f, "\n  help: {help}"),
            None => Ok(()),
        }
    }
}

/// As printed: what `unwrap` in a test and `main` that returns an error show.
impl fmt::Debug for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for FileError {}

/// Text out of a file, between backticks, shortened and without control characters, so that it
/// can neither flood nor steer a terminal.
pub fn quoted(text: &str) -> String {
    const SHOWN: usize = 60;
    let mut shown: String = text.chars().take(SHOWN).map(visible).collect();
    if text.chars().nth(SHOWN).is_some() {
        shown.push('…');
    }
    format!("`{shown}`")
}

fn clean(text: &str) -> String {
    let mut shown: String = text.chars().take(LONGEST).map(visible).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    shown
}

fn visible(c: char) -> char {
    // The bidirectional overrides can make a message read as another one.
    if c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}') {
        '\u{fffd}'
    } else {
        c
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_as_the_contract_shows_it() {
        let error = FileError::new("shelf.yaml", "unknown key `raduis`")
            .at(12, 5)
            .expected("one of `radius`, `height`")
            .help("did you mean `radius`?");
        assert_eq!(
            error.to_string(),
            "shelf.yaml:12:5: unknown key `raduis`, expected one of `radius`, `height`\n  help: did you mean `radius`?"
        );
        let seen = error.referenced_from("plan.json", Some((1, 2)));
        assert_eq!(
            seen.to_string(),
            "plan.json:1:2: shelf.yaml:12:5: unknown key `raduis`, expected one of `radius`, `height`\n  help: did you mean `radius`?"
        );
    }

    #[test]
    fn what_the_file_says_cannot_flood_or_steer_the_terminal() {
        assert_eq!(quoted("a\x1b[2Jb\nc"), "`a\u{fffd}[2Jb\u{fffd}c`");
        assert!(quoted(&"x".repeat(1_000_000)).len() < 100);
        assert!(FileError::new("f", "y".repeat(1_000_000)).to_string().len() < 1000);
    }
}
