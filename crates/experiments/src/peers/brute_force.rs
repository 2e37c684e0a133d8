//! Brute force (section VI-F): all subsets of objects in all orders, the smallest first. Nothing is learned
//! from a failure, but a beginning that fails is not begun again.

use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_retrieval::Feasibility;
use clearway_retrieval::feasibility::Journey;

pub fn brute_force(
    arm: &mut Feasibility,
    journey: &mut Journey,
    budget: &Budget,
    sequences: &mut usize,
) -> Result<Option<Vec<ObjectId>>, Stop> {
    let count = arm.scene().objects.len();
    for removals in 1..=count {
        let mut order = Vec::new();
        if extend(arm, journey, budget, sequences, &mut order, removals)? {
            return Ok(Some(order));
        }
    }
    Ok(None)
}

/// All orders of `left` more objects, the target last.
fn extend(
    arm: &mut Feasibility,
    journey: &mut Journey,
    budget: &Budget,
    sequences: &mut usize,
    order: &mut Vec<ObjectId>,
    left: usize,
) -> Result<bool, Stop> {
    budget.check()?;
    let target = arm.scene().target;
    let removed: ObjectSet = order.iter().copied().collect();
    if left == 1 {
        *sequences += 1;
        order.push(target);
        if arm.can_pick(target, &removed, budget)? && arm.carry(order, journey, budget, |_| {})?.is_ok() {
            return Ok(true);
        }
        order.pop();
        return Ok(false);
    }
    let standing = arm.scene().all().difference(removed.with(target));
    for object in standing.iter() {
        if arm.can_pick(object, &removed, budget)? {
            order.push(object);
            if extend(arm, journey, budget, sequences, order, left - 1)? {
                return Ok(true);
            }
            order.pop();
        }
    }
    Ok(false)
}
