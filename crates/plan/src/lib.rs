//! The nouns that all of Clearway shares, as plain data: which objects ([`ObjectSet`]), how long
//! ([`Budget`]), what happens ([`Event`]), and the documents that are read and written: [`SceneFile`],
//! [`RobotFile`], [`PlanFile`]; [`MotionFile`] and its [`MotionAnswer`].
//!
//! SI units throughout; world frame right-handed with z up; quaternions `[x, y, z, w]`.

pub mod budget;
pub mod clearance;
pub mod event;
pub mod motion_answer;
pub mod motion_file;
mod number_or;
pub mod object_set;
pub mod parallel;
pub mod plan_file;
pub mod proof;
pub mod push;
pub mod robot_file;
pub mod scene_file;

pub use budget::{Budget, Stop};
pub use event::{Event, Observer};
pub use motion_answer::MotionAnswer;
pub use motion_file::MotionFile;
pub use object_set::{ObjectId, ObjectSet};
pub use plan_file::PlanFile;
pub use robot_file::RobotFile;
pub use scene_file::SceneFile;
