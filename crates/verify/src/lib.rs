//! A second opinion on a finished plan. Judges a [`PlanFile`](clearway_plan::PlanFile) against its
//! contract: structure, limits, what may go unchecked, what is held and where it is put down, that
//! what stands is stable, that pushes go as they say, that nothing touches anything at any instant, and that
//! motions keep the room that the scene asks for; what they keep it measures.
//!
//! Shares no kinematics, collision or interpolation code with the planner: it has its own reading of
//! URDFs and forward kinematics, exact shapes from `parry3d-f64`, and its own interpolation.
//! SI units, world frame with z up. Touching means overlapping by more than 0.1 mm.
//!
//! ```no_run
//! use clearway_plan::Budget;
//! let report = clearway_verify::verify_file("plan.json".as_ref(), &Budget::unlimited())?;
//! print!("{report}");
//! # Ok::<(), clearway_verify::CannotJudge>(())
//! ```
//!
//! It does not judge: proofs of lower bounds for other hands and arms than [`grasps`] knows, whether what stands
//! slides or is shaken, the force of a grip, and how far an object slips within the hand that pushes it: what a
//! push says of its margin of error. The proofs are listed in [`Report::not_checked`] where a plan has them.

mod accept;
mod barriers;
mod carry;
mod case;
mod clearance;
mod collisions;
mod error;
mod gap;
mod grasps;
mod gripper;
mod jerk;
mod judge;
mod limits;
mod lower_bound;
mod meshes;
mod model;
mod names;
mod passes;
mod placement;
pub mod played;
mod push;
mod read;
mod region;
mod report;
mod rest;
mod rows;
mod shapes;
mod sight;
mod stability;
mod steps;
mod sweep;
mod unchecked;
mod urdf;
mod watch;

pub use accept::{Rejected, VerifiedPlan, accept};
pub use error::CannotJudge;
pub use judge::verify;
pub use read::{read_plan, verify_file};
pub use report::{Report, Summary, Violation, ViolationKind};
