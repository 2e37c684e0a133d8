//! Why a plan could not be exported, and where in it.

use thiserror::Error;

#[derive(Debug, PartialEq, Error)]
pub enum ExportError {
    #[error("the plan has no motion to export (its status is `{status}`); export a solved plan")]
    NoMotion { status: &'static str },

    #[error("{place}: found {found}, expected {expected}; run `clearway verify` on the plan")]
    Malformed { place: String, found: String, expected: String },

    #[error("the trajectory cannot be written as JSON: {0}")]
    Json(String),
}

impl ExportError {
    pub(crate) fn malformed(place: String, found: impl ToString, expected: impl ToString) -> Self {
        Self::Malformed { place, found: found.to_string(), expected: expected.to_string() }
    }
}
