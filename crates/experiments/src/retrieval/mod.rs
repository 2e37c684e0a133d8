//! The paper's experiments (section VI): scenes, planners, rows, tables.

mod chart;
pub mod experiment;
pub mod report;
pub mod row;
pub mod run;
pub mod runner;
mod table;

pub use experiment::Experiment;
pub use row::Row;
