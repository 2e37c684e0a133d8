//! Experiments that can be run again.

mod machine;
pub mod motion;
pub mod motion_peer;
pub mod motion_problems;
pub mod motion_summary;
pub mod peers;
pub mod retrieval;
pub mod statistics;

pub use machine::Machine;
