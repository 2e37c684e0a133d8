//! JSON documents that other programs wrote: plan files, mostly. Unknown keys are the type's affair.

use crate::error::FileError;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Reads `text`, of which `path` is the name for messages. Nesting deeper than 128 is an error.
pub fn from_str<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, FileError> {
    serde_json::from_str(text).map_err(|error| {
        let place = format!(" at line {} column {}", error.line(), error.column());
        let message = error.to_string();
        let found = message.strip_suffix(&place).unwrap_or(&message);
        let told = match no_number(text, error.line(), error.column()) {
            Some(word) => FileError::new(path, format!("found `{word}`"))
                .expected("a finite number")
                .help("JSON has no word for what is no number: correct the program that wrote the file"),
            None => FileError::new(path, found),
        };
        // Line 0 is how the reader says that it does not know.
        if error.line() == 0 { told } else { told.at(error.line(), error.column().max(1)) }
    })
}

/// What other languages' writers make of a value that is no number, at the place of an error.
fn no_number(text: &str, line: usize, column: usize) -> Option<&'static str> {
    let line = text.lines().nth(line.checked_sub(1)?)?;
    let rest = line.get(column.checked_sub(1)?..)?;
    // The reader stops at the second letter of `-Infinity`.
    ["NaN", "nan", "Infinity", "inf"].into_iter().find(|word| rest.starts_with(word))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_their_place() {
        let error = from_str::<Vec<f64>>(Path::new("p.json"), "[1,\n 2,\n x]").unwrap_err();
        assert_eq!(error.position(), Some((3, 2)));
        assert!(error.to_string().starts_with("p.json:3:2: expected value"), "{error}");
        let error = from_str::<Vec<f64>>(Path::new("p.json"), "[1,\n NaN]").unwrap_err();
        assert!(error.to_string().starts_with("p.json:2:2: found `NaN`, expected a finite number"), "{error}");
        for text in ["[Infinity]", "[-Infinity]"] {
            let error = from_str::<Vec<f64>>(Path::new("p.json"), text).unwrap_err();
            assert!(error.to_string().contains("found `Infinity`"), "{error}");
        }
        let deep = "[".repeat(200_000);
        assert!(from_str::<serde_json::Value>(Path::new("p.json"), &deep).is_err());
    }
}
