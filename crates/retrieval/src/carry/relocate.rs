//! An object brought from where it stands, wherever that is, to a given pose: out along one way, in along
//! another, and the hand back out along that.

use super::motions::AtEnds;
use super::{Attempt, Carried, Carrier, Situation, attempt, obstructed};
use crate::grasps::Grasp;
use crate::ways::Way;
use clearway_collision::{Moment, Touch};
use clearway_geometry::Pose;
use clearway_plan::{ObjectId, ObjectSet};
use rand::Rng;

/// What is to be brought where.
#[derive(Clone, Copy, Debug)]
pub struct Relocation<'a> {
    pub object: ObjectId,
    pub grasp: &'a Grasp,
    /// From where the object is to where it is to be: in the root frame, with the way that the hand goes there.
    pub from: (Pose, &'a Way),
    pub to: (Pose, &'a Way),
}

impl<R: Rng> Carrier<'_, R> {
    /// The hand ends where the way in began; at home after the `last`.
    pub fn relocate(&mut self, relocation: &Relocation, before: &Situation, last: bool) -> Attempt<Carried> {
        let Relocation { object, grasp, from: (from, out), to: (to, into) } = *relocation;
        let world = self.world;
        let there = attempt!(self.come(object, grasp, out, before));
        let (Some(entry), Some(exit)) = (out.postures.last(), into.postures.last()) else {
            return obstructed("the way is empty", ObjectSet::EMPTY);
        };
        let mut others = before.clone();
        others.standing.remove(object);
        others.placed.retain(|(o, _)| *o != object);
        let mut carrying = Moment::new(others.standing, grasp.closed, self.settings.margin);
        carrying.placed = others.placed(world);
        let mut held = world.in_hand(object, &grasp.object_from_tool);
        held.kernel = Some(world.model.holding(&held.solid()));
        carrying.held = Some(held.clone());
        let across = attempt!(self.level_motion(&carrying, entry, exit, "the motion with the object in hand"));
        let mut path = out.postures.clone();
        path.extend(across.into_iter().skip(1));
        path.extend(into.postures.iter().rev().skip(1).cloned());
        for pose in [from, to] {
            let (fixtures, objects) = world.below(object, &pose);
            held.fixtures_below.extend(fixtures);
            held.objects_below = held.objects_below.union(objects.intersection(others.standing));
            let placed = carrying.placed.iter().filter(|(_, o)| world.carries(o, object, &pose)).map(|(id, _)| *id);
            held.objects_below = held.objects_below.union(placed.collect());
        }
        let moment = self.finished(Moment { held: Some(held), ..carrying });
        let across = attempt!(self.timed(
            &moment,
            &path,
            AtEnds::Resting { within: self.settings.lower_from },
            "the motion with the object in hand"
        ));

        let mut after = others;
        after.placed.push((object, world.world_from_root * to));
        match self.hand_turning(&into.postures[0], &self.leaving(object, &after), grasp.closed) {
            Touch::FREE => {}
            Touch::Objects(touched) => return obstructed("opening the hand", touched),
            Touch::Fixed => return obstructed("opening the hand", ObjectSet::EMPTY),
        }
        let leaving = attempt!(self.leave(object, grasp, &mut after, into.postures.clone(), last));
        let mut segments = self.taking_segments(object, grasp, there, vec![self.widened(across)]);
        segments.extend(leaving);
        let step = self.step(object, segments, &(world.world_from_root * to));
        Ok(Ok(Carried { step, after, way_blocked_by: out.blocked_by, loosely: !grasp.firm }))
    }
}
