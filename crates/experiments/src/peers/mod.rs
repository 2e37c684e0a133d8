//! Task planners to measure against. They ask the same questions of the arm
//! ([`clearway_retrieval::Feasibility`]) as Clearway's own, so that only the task planning differs.

pub mod brute_force;
pub mod shortest_path;
pub mod step_by_step;
pub mod traversability;

use clearway_plan::PlanFile;
use clearway_plan::plan_file::Stats;
use clearway_plan::{Budget, ObjectId, Stop};
use clearway_retrieval::feasibility::{Ending, Journey};
use clearway_retrieval::{Feasibility, Request};
use std::time::Instant;

/// One of them: objects that were carried, the target last; `None` when it knows no further. The count
/// is of the sequences that it tried.
pub type Peer = dyn Fn(&mut Feasibility, &mut Journey, &Budget, &mut usize) -> Result<Option<Vec<ObjectId>>, Stop>;

/// Plans with a peer, and writes down what it came to.
pub fn plan(arm: &mut Feasibility, peer: &Peer, request: &Request) -> PlanFile {
    let began = Instant::now();
    let mut journey = Journey::new(request.seed);
    let mut sequences = 0;
    let outcome = peer(arm, &mut journey, &request.budget, &mut sequences);
    let timing = journey.timing(began.elapsed());
    let ending = match outcome {
        Ok(Some(order)) => Ending::Solved(order),
        Ok(None) => Ending::Stopped(None),
        Err(stop) => Ending::Stopped(Some(stop)),
    };
    let mut plan = arm.plan_file(&ending, journey, &request.budget);
    plan.seed = request.seed;
    plan.timing = timing;
    plan.stats = Stats { sequences_tried: sequences, ..plan.stats };
    plan
}
