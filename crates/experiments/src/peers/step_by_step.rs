//! Planners that decide on one object at a time, and look again once it is gone.

use crate::peers::traversability::{Disc, Side, Traversability, Workspace};
use clearway_geometry::Vec2;
use clearway_geometry::footprint::enclosing_circle;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_retrieval::Feasibility;
use clearway_retrieval::feasibility::Journey;

/// Takes the object that `next` names, given what is gone and which objects could not be had since, until
/// that is the target.
pub fn take(
    arm: &mut Feasibility,
    journey: &mut Journey,
    budget: &Budget,
    sequences: &mut usize,
    mut next: impl FnMut(&ObjectSet, &ObjectSet) -> Option<ObjectId>,
) -> Result<Option<Vec<ObjectId>>, Stop> {
    let target = arm.scene().target;
    let mut order: Vec<ObjectId> = Vec::new();
    let mut failed = ObjectSet::EMPTY;
    *sequences += 1;
    loop {
        budget.check()?;
        let removed: ObjectSet = order.iter().copied().collect();
        let Some(object) = next(&removed, &failed) else { return Ok(None) };
        order.push(object);
        if arm.can_pick(object, &removed, budget)? && arm.carry(&order, journey, budget, |_| {})?.is_ok() {
            if object == target {
                return Ok(Some(order));
            }
            failed = ObjectSet::EMPTY;
        } else {
            order.pop();
            failed.insert(object);
            *sequences += 1;
        }
    }
}

/// [3]: the first object on the least-hop path through the traversability graph, which is made anew once
/// something is gone; an object that could not be had loses its edge to the robot until then.
pub fn traversability(
    arm: &mut Feasibility,
    journey: &mut Journey,
    budget: &Budget,
    sequences: &mut usize,
) -> Result<Option<Vec<ObjectId>>, Stop> {
    let (objects, workspace, robot) = seen_from_above(arm);
    let (target, all) = (arm.scene().target, arm.scene().all());
    let mut graph: Option<(ObjectSet, Traversability)> = None;
    take(arm, journey, budget, sequences, |removed, failed| {
        if graph.as_ref().is_none_or(|(known, _)| known != removed) {
            let standing = all.difference(*removed);
            graph = Some((*removed, Traversability::new(&objects, &standing, robot, &workspace)));
        }
        let path = graph.as_ref()?.1.path(target, failed)?;
        path.first().copied()
    })
}

/// Between the outermost objects and the walls' lines, metres: as in the published example.
const BESIDE: f64 = 0.055;

/// The objects' discs, a box round them that is open towards where the target leaves, and the robot on the
/// open side's line.
fn seen_from_above(arm: &Feasibility) -> (Vec<Disc>, Workspace, Disc) {
    let circles: Vec<_> = arm.scene().objects.iter().map(|o| enclosing_circle(&o.solid, &o.pose)).collect();
    let discs = circles.iter().map(|c| Disc { at: c.centre, radius: c.radius }).collect();
    let low = circles.iter().map(|c| c.centre - c.radius).fold(Vec2::INFINITY, Vec2::min) - BESIDE;
    let high = circles.iter().map(|c| c.centre + c.radius).fold(Vec2::NEG_INFINITY, Vec2::max) + BESIDE;
    let exit = arm.floor().exit;
    let beyond = [
        (low.x - exit.x, Side::MinX, Vec2::new(low.x, exit.y)),
        (exit.x - high.x, Side::MaxX, Vec2::new(high.x, exit.y)),
        (low.y - exit.y, Side::MinY, Vec2::new(exit.x, low.y)),
        (exit.y - high.y, Side::MaxY, Vec2::new(exit.x, high.y)),
    ];
    let (_, open, at) =
        beyond.into_iter().reduce(|a, b| if b.0 > a.0 { b } else { a }).unwrap_or((0.0, Side::MinX, exit));
    let radius = circles.iter().map(|c| c.radius).fold(0.0, f64::max);
    (discs, Workspace { min: low, max: high, open }, Disc { at, radius })
}
