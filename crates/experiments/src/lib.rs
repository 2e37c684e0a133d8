//! Experiments that can be run again.

pub mod motion;
pub mod motion_problems;
