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
        let told = FileError::new(path, found);
        // Line 0 is how the reader says that it does not know.
        if error.line() == 0 { told } else { told.at(error.line(), error.column().max(1)) }
    })
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
        let deep = "[".repeat(200_000);
        assert!(from_str::<serde_json::Value>(Path::new("p.json"), &deep).is_err());
    }
}
