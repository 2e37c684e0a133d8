//! How the program ends, and how it says why.

use crate::commands::output::tell;
use clearway::FileError;

/// Exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// Solved; valid.
    Done = 0,
    /// `verify` found violations; `simulate` ended elsewhere than planned.
    Violations = 1,
    /// The input or the command line is wrong.
    BadInput = 2,
    /// Proved impossible.
    Impossible = 3,
    /// Budget spent without a plan, nothing proved.
    OutOfBudget = 4,
    /// An internal error.
    Internal = 5,
    Interrupted = 130,
}

/// An end that has something to say on stderr.
pub struct Failure {
    pub exit: Exit,
    pub message: String,
}

impl Failure {
    pub fn bad_input(message: impl Into<String>) -> Self {
        Self { exit: Exit::BadInput, message: message.into() }
    }

    pub fn internal(message: impl Into<String>) -> Self {
        Self { exit: Exit::Internal, message: message.into() }
    }

    pub fn tell(&self) -> Exit {
        tell(&format!("error: {}", self.message));
        self.exit
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::bad_input(error.to_string())
    }
}
