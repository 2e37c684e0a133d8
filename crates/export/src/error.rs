//! Why a plan could not be exported, and where in it.

use thiserror::Error;

#[derive(Debug, PartialEq, Error)]
pub enum ExportError {
    #[error("the plan has no motion to export (its status is `{status}`); export a solved plan")]
    NoMotion { status: &'static str },

    #[error("{place}: found {found}, expected {expected}; run `clearway verify` on the plan")]
    Malformed { place: String, found: String, expected: String },

    #[error(
        "the scene's frame and a link of the robot are both called `{frame}`; plan again with another name for `frame` in the scene file"
    )]
    FrameTaken { frame: String },

    #[error("no joint's name begins with `{old}`; `clearway robot` lists them")]
    NoSuchName { old: String },

    #[error("with `{new}` for `{old}` two joints have the same name")]
    SameName { old: String, new: String },

    #[error("the plan cannot be written as JSON: {0}")]
    Json(String),

    #[error("the plan cannot be written as MCAP: {0}")]
    Mcap(String),
}

impl ExportError {
    pub(crate) fn malformed(place: impl ToString, found: impl ToString, expected: impl ToString) -> Self {
        Self::Malformed { place: place.to_string(), found: found.to_string(), expected: expected.to_string() }
    }
}

impl From<serde_json::Error> for ExportError {
    fn from(error: serde_json::Error) -> Self {
        Self::Json(error.to_string())
    }
}

impl From<mcap::McapError> for ExportError {
    fn from(error: mcap::McapError) -> Self {
        Self::Mcap(error.to_string())
    }
}
