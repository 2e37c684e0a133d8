//! Task planners to measure against. They ask the same questions of the arm
//! ([`clearway_retrieval::Feasibility`]) as Clearway's own, so that only the task planning differs.

pub mod traversability;
