//! Why a plan could not be played at all. A plan that goes wrong is not an error: it is an
//! [`Outcome`](crate::Outcome) that says so.

use clearway_plan::Stop;
use clearway_verify::played::CannotPlay;

#[derive(Debug, thiserror::Error)]
pub enum CannotSimulate {
    #[error(transparent)]
    Plan(#[from] CannotPlay),
    /// A setting, or noise, that makes no sense.
    #[error("{0}")]
    Settings(String),
    #[error("robot.hand: {0}")]
    Hand(String),
    #[error("object {object:?}: {what}")]
    Object { object: String, what: String },
    #[error("the simulation stopped before its end: {}", match .0 {
        Stop::Deadline => "the deadline passed",
        Stop::Iterations => "the iterations are spent",
        Stop::Cancelled => "cancelled",
    })]
    Stopped(Stop),
}

impl From<Stop> for CannotSimulate {
    fn from(stop: Stop) -> Self {
        Self::Stopped(stop)
    }
}
