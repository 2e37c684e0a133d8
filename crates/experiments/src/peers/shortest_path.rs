//! "Clear whatever the shortest path hits": the disc of target and gripper goes straight to the way out;
//! what it hits is taken, whatever can be had first nearest to the robot first, and then the target.

use crate::peers::step_by_step::take;
use clearway_plan::{Budget, ObjectId, Stop};
use clearway_retrieval::Feasibility;
use clearway_retrieval::feasibility::Journey;

pub fn shortest_path(
    arm: &mut Feasibility,
    journey: &mut Journey,
    budget: &Budget,
    sequences: &mut usize,
) -> Result<Option<Vec<ObjectId>>, Stop> {
    let floor = arm.floor();
    let target = arm.scene().target;
    let (exit, hit) = (floor.exit, floor.edge_collisions(floor.goal, floor.exit));
    let at = |o: &ObjectId| arm.scene().objects[o.index()].pose.translation.truncate();
    let mut first: Vec<ObjectId> = hit.iter().collect();
    first.sort_by(|a, b| at(a).distance(exit).total_cmp(&at(b).distance(exit)));
    first.push(target);
    take(arm, journey, budget, sequences, |removed, failed| {
        let standing = |o: &&ObjectId| !removed.contains(**o);
        let mut left = first.iter().filter(standing).copied().filter(|o| !failed.contains(*o));
        // The target's turn is when all others are gone.
        let waiting = first.iter().filter(standing).count() > 1;
        left.find(|o| !(*o == target && waiting))
    })
}
