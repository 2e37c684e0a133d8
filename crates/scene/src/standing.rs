//! What would be the case if an object stood elsewhere.

use crate::contact::{Placed, clearances};
use crate::equilibrium::{Push, Weight, fall};
use crate::patch::patch;
use crate::stability::{EDGE, on_fixtures, weight};
use crate::support::{Under, support};
use crate::{FORGIVEN, Scene, Support};
use clearway_geometry::{Pose, Vec2, Vec3};
use clearway_plan::{ObjectId, ObjectSet};

/// What is put down elsewhere touches what carries it within this, metres.
pub const TOUCH: f64 = 1e-4;
/// What rounding may add.
const ROUNDING: f64 = 1e-5;

/// Corner to corner.
type Box = (Vec3, Vec3);

/// Whether what fills the boxes could touch within so much, one above the other.
fn may_touch(a: Box, b: Box, within: f64) -> bool {
    let grown = (b.0 - within, b.1 + within);
    a.0.cmple(grown.1).all() && grown.0.cmple(a.1).all()
}

impl Scene {
    /// What rests on an object directly.
    pub fn loads(&self, object: ObjectId) -> ObjectSet {
        let rests = |support: &Support| matches!(support, Support::Objects(below) if below.contains(&object));
        self.all().iter().filter(|o| rests(&self.objects[o.index()].support)).collect()
    }

    /// The scene with one object at another pose (world from object), which is taken as it is, not snapped.
    ///
    /// What carries what is found anew. Nothing is judged: an object may now be in another, or float, and
    /// then its support is [`Support::Objects`] of none. `file` and `hidden` stay as they were read.
    pub fn moved(&self, object: ObjectId, pose: Pose) -> Scene {
        let mut scene = self.clone();
        scene.objects[object.index()].pose = pose;
        let boxes: Vec<Box> = scene.objects.iter().map(|o| o.solid.aabb(o.pose)).collect();
        let there = Placed::new(&self.objects[object.index()].solid, pose);
        let before = self.loads(object);
        for index in 0..self.objects.len() {
            let now = || {
                let above = &self.objects[index];
                may_touch(boxes[index], boxes[object.index()], FORGIVEN)
                    && carried(&Placed::new(&above.solid, above.pose), &there).is_some()
            };
            if index == object.index() || before.contains(ObjectId(index as u16)) || now() {
                scene.objects[index].support = scene.support(index, &boxes);
            }
        }
        scene
    }

    /// Found anew.
    fn support(&self, index: usize, boxes: &[Box]) -> Support {
        let object = &self.objects[index];
        let placed = Placed::new(&object.solid, object.pose);
        let mut below: Vec<(Under, f64)> = Vec::new();
        for (j, fixture) in self.near_fixtures(boxes[index]).enumerate() {
            below.extend(carried(&placed, &fixture).map(|c| (Under::Fixture(j), c)));
        }
        for (j, other) in self.objects.iter().enumerate() {
            if j != index && may_touch(boxes[index], boxes[j], FORGIVEN) {
                let found = carried(&placed, &Placed::new(&other.solid, other.pose));
                below.extend(found.map(|c| (Under::Object(j), c)));
            }
        }
        if below.is_empty() { Support::Objects(Vec::new()) } else { support(&below) }
    }

    /// What of each fixture is near a box, seen from above.
    fn near_fixtures(&self, around: Box) -> impl Iterator<Item = Placed<'_>> {
        self.fixtures.iter().map(move |f| Placed::near(&f.solid, f.pose, around))
    }

    /// Of some objects, standing where the scene has them and no others, those on other objects that would fall. What
    /// was moved to where nothing carries it is left alone: a place may be no fixture.
    pub fn fallen(&self, standing: ObjectSet) -> ObjectSet {
        let stacked =
            |o: &ObjectId| matches!(&self.objects[o.index()].support, Support::Objects(below) if !below.is_empty());
        let falls = |o: &ObjectId| !self.stands(*o, &self.objects[o.index()].pose, standing);
        standing.iter().filter(stacked).filter(falls).collect()
    }

    /// Whether an object would stay where it is put: at `pose` (world from object), with only fixtures and
    /// these other objects there, each where the scene has it.
    ///
    /// Something within [`TOUCH`] under it carries it, and all that hangs together with it then balances:
    /// what carries it, and what else that carries. At a new pose nothing past an edge is forgiven; at the
    /// pose that it has in the scene, as much is forgiven as when the scene was read. Overlaps are not
    /// looked for, here or elsewhere: that is the collision check's.
    pub fn stands(&self, object: ObjectId, pose: &Pose, standing: ObjectSet) -> bool {
        let unmoved = *pose == self.objects[object.index()].pose;
        let (within, forgiven) = if unmoved { (FORGIVEN, EDGE) } else { (TOUCH, ROUNDING) };
        let others = standing.intersection(self.all()).iter().filter(|o| *o != object);
        let others = others.map(|o| (o.index(), self.objects[o.index()].pose));
        let all: Vec<(usize, Pose)> = std::iter::once((object.index(), *pose)).chain(others).collect();
        let (bodies, pushes) = self.together(&all, within);
        fall(&bodies, &pushes, forgiven).is_none()
    }

    /// How far what carries an object at `pose` (world from object) reaches beyond its centre of mass in a level
    /// direction, metres; `None` where it would not stay. With only fixtures there.
    pub fn foothold(&self, object: ObjectId, pose: &Pose, direction: Vec2) -> Option<f64> {
        let (bodies, pushes) = self.together(&[(object.index(), *pose)], TOUCH);
        if fall(&bodies, &pushes, ROUNDING).is_some() {
            return None;
        }
        let centre = bodies.first()?.centre;
        pushes.iter().flat_map(|push| &push.patch).map(|p| (*p - centre).dot(direction)).max_by(f64::total_cmp)
    }

    /// The first of these objects at these poses and all that hangs together with it, itself first, and
    /// how they push each other. It touches others within so much.
    fn together(&self, all: &[(usize, Pose)], within: f64) -> (Vec<Weight>, Vec<Push>) {
        let boxes: Vec<Box> = all.iter().map(|(i, pose)| self.objects[*i].solid.aabb(*pose)).collect();
        let placed = |k: usize| Placed::new(&self.objects[all[k].0].solid, all[k].1);
        let mut members: Vec<(usize, Placed)> = vec![(0, placed(0))];
        let mut outsiders: Vec<usize> = (1..all.len()).collect();
        let mut pushes: Vec<Push> = Vec::new();
        let mut turn = 0;
        // Pairs are looked at when the turn of the one that came in first has come.
        while let Some((k, body)) = members.get(turn) {
            let near = |other: usize| if *k == 0 || other == 0 { within } else { FORGIVEN };
            let touch = |other: usize| may_touch(boxes[*k], boxes[other], near(other));
            let fixtures: Vec<Placed> = self.near_fixtures(boxes[*k]).collect();
            let push = |upper, lower, patch: Vec<Vec2>| (!patch.is_empty()).then_some(Push { upper, lower, patch });
            let both = |m: usize, other: usize, there: &Placed| {
                let upon = push(m, Some(turn), patch(there, body, near(other)));
                let under = push(turn, Some(m), patch(body, there, near(other)));
                upon.into_iter().chain(under)
            };
            pushes.extend(push(turn, None, on_fixtures(body, fixtures.iter(), near(*k))));
            for (m, (other, there)) in members.iter().enumerate().skip(turn + 1).filter(|(_, (o, _))| touch(*o)) {
                pushes.extend(both(m, *other, there));
            }
            let mut new: Vec<(usize, Placed)> = Vec::new();
            for other in outsiders.iter().copied().filter(|o| touch(*o)) {
                let there = placed(other);
                let known = pushes.len();
                pushes.extend(both(members.len() + new.len(), other, &there));
                if pushes.len() > known {
                    new.push((other, there));
                }
            }
            outsiders.retain(|o| new.iter().all(|(n, _)| n != o));
            members.extend(new);
            turn += 1;
        }
        let bodies = members.iter().map(|(k, _)| weight(&self.objects[all[*k].0].mass, &all[*k].1));
        (bodies.collect(), pushes)
    }
}

/// How far *a* is above what of *b* carries it, if it does.
fn carried(a: &Placed, b: &Placed) -> Option<f64> {
    clearances(a, b, -FORGIVEN, |_| FORGIVEN).into_iter().filter(|c| *c <= FORGIVEN).min_by(f64::total_cmp)
}
