//! Faults to plant into any valid plan. Each planter changes a plan so that it certainly breaks its
//! contract in one known way, or returns `None` where the plan gives no occasion for it.

pub mod intruders;
pub mod motion;
pub mod objects;
pub mod pushes;
pub mod robot;
pub mod structure;

use clearway_plan::PlanFile;
use clearway_plan::plan_file::{Segment, SegmentKind};
use clearway_verify::ViolationKind;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use robot::Robot;

pub type Random = Xoshiro256PlusPlus;

/// A way to break a plan.
pub struct Fault {
    pub name: &'static str,
    /// At least one of these must be reported.
    pub expected: &'static [ViolationKind],
    pub plant: fn(&mut PlanFile, &Robot, &mut Random) -> Option<()>,
}

/// Every fault there is.
pub fn all() -> Vec<Fault> {
    [structure::FAULTS, motion::FAULTS, objects::FAULTS, pushes::FAULTS, intruders::FAULTS]
        .into_iter()
        .flat_map(|list| list())
        .collect()
}

/// A segment of a kind that `wanted` likes, with at least `rows` rows.
pub fn segment_of(
    plan: &PlanFile,
    random: &mut Random,
    rows: usize,
    wanted: impl Fn(&Segment) -> bool,
) -> Option<(usize, usize)> {
    let mut found = Vec::new();
    for (i, step) in plan.steps.iter().enumerate() {
        for (j, segment) in step.segments.iter().enumerate() {
            if segment.times.len() >= rows && wanted(segment) {
                found.push((i, j));
            }
        }
    }
    pick(&found, random)
}

pub fn pick<T: Clone>(items: &[T], random: &mut Random) -> Option<T> {
    (!items.is_empty()).then(|| items[random.random_range(0..items.len())].clone())
}

pub fn moves(segment: &Segment) -> bool {
    matches!(segment.kind, SegmentKind::Transit | SegmentKind::Approach | SegmentKind::Transfer | SegmentKind::Retreat)
        && segment.positions.first() != segment.positions.last()
}

/// A number between, and a sign.
pub fn either_sign(random: &mut Random, low: f64, high: f64) -> f64 {
    let size = random.random_range(low..high);
    if random.random_bool(0.5) { size } else { -size }
}
