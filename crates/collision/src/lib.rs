//! Which objects does this posture touch? Answers in sets.
//!
//! Everything is in the robot's root frame, metres. Links are covered by spheres that dismiss
//! what is far; where a sphere meets an obstacle, the exact convex parts decide (GJK). So a
//! posture called free keeps at least the asked margin between exact shapes, and nothing is
//! called blocked because a sphere is too fat.
//!
//! A [`World`] holds what never changes (robot, fixtures, objects where they stand first); a
//! [`Moment`] says what is the case now: which objects still stand, where others were put down,
//! what the hand holds. Removing an object from the moment's set rebuilds nothing.

mod between;
mod directions;
pub mod lanes;
mod model;
mod moment;
mod obstacle;
mod pairs;
mod probe;
mod query;
mod quick;
mod report;
pub mod shapes;
mod suspects;
mod world;

pub use model::{CollisionModel, Standing};
pub use moment::{Close, Held, Lean, Moment};
pub use obstacle::Obstacle;
pub use pairs::unchecked_pairs;
pub use probe::{Probe, Slack};
pub use query::{LinksAt, Scratch, Touch};
pub use quick::Quick;
pub use report::Contact;
pub use world::World;
