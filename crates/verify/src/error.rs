//! Why a plan could not be judged at all. A plan that is wrong is not an error: it is a
//! [`Report`](crate::Report) with violations.

use clearway_files::FileError;
use clearway_plan::Stop;
use std::path::PathBuf;

/// The verifier had nothing it could judge, or was stopped.
#[derive(Debug, thiserror::Error)]
pub enum CannotJudge {
    /// A file that cannot be read, or is no plan.
    #[error(transparent)]
    File(#[from] FileError),
    #[error("robot.urdf: {0}")]
    Urdf(String),
    #[error("scene, {place}: {what}")]
    Scene { place: String, what: String },
    #[error("robot.meshes has no entry for {uri:?}, which {user} names: list its file and sha256 there")]
    MeshNotListed { uri: String, user: String },
    #[error("mesh {}: sha256 is {found}, robot.meshes says {expected}: the mesh is not the one planned with", path.display())]
    MeshChanged { path: PathBuf, found: String, expected: String },
    #[error("verification stopped before its end: {}", match .0 {
        Stop::Deadline => "the deadline passed",
        Stop::Iterations => "the iterations are spent",
        Stop::Cancelled => "cancelled",
    })]
    Stopped(Stop),
}

impl From<Stop> for CannotJudge {
    fn from(stop: Stop) -> Self {
        Self::Stopped(stop)
    }
}
