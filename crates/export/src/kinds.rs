//! What things are called in plan files, and so in all exports.

use clearway_plan::plan_file::{SegmentKind, Status};

pub(crate) fn kind_name(kind: SegmentKind) -> &'static str {
    match kind {
        SegmentKind::Transit => "transit",
        SegmentKind::Approach => "approach",
        SegmentKind::Grasp => "grasp",
        SegmentKind::Transfer => "transfer",
        SegmentKind::Release => "release",
        SegmentKind::Retreat => "retreat",
        SegmentKind::Push => "push",
    }
}

pub(crate) fn status_name(status: Status) -> &'static str {
    match status {
        Status::Solved => "solved",
        Status::Impossible => "impossible",
        Status::OutOfBudget => "out_of_budget",
    }
}
