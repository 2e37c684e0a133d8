//! The paper's experiments (section VI): scenes, planners, rows, tables.

mod chart;
pub mod report;
pub mod row;

pub use row::Row;
