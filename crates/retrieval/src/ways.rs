//! Ways in: for each grasp and each branch of the inverse kinematics, the straight motion of the
//! hand out of the clutter, and which objects stand in its way.
//!
//! A way begins with the posture that grips the object, lifts it a little, and draws it straight
//! back against the approach direction until it is beyond the clutter. The hand comes in along
//! the same postures in reverse. Sets are over all objects where the scene has them, whatever was
//! removed before, so a way is judged once: it is free when its set is gone.
//!
//! Ways are first sampled coarsely, which can miss an object but never invents one; a way is made
//! exact only when its coarse set leaves it in the running.

use crate::floor::Floor;
use crate::grasps::{Grasp, preset_grasps};
use clearway_collision::{Held, Moment, Scratch, Touch, World};
use clearway_geometry::Pose;
use clearway_motion::Posture;
use clearway_plan::plan_file::GraspCount;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::InverseKinematics;

/// How the hand goes in and out.
#[derive(Clone, Debug)]
pub struct Settings {
    /// An object is lifted by this much before it is drawn back, metres.
    pub lift: f64,
    /// Between postures of a way, metres: coarse, then exact.
    pub coarse: f64,
    pub fine: f64,
    /// A way never goes back farther than this, metres.
    pub farthest: f64,
    /// Room kept from everything along the way, metres.
    pub margin: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { lift: 0.01, coarse: 0.04, fine: 0.01, farthest: 0.9, margin: 0.001 }
    }
}

/// One straight way out (and in).
#[derive(Clone, Debug)]
pub struct Way {
    pub grasp: usize,
    /// At the grasp, lifted, and then outwards.
    pub postures: Vec<Posture>,
    /// What stands in the way; a subset of it while not `exact`.
    pub blocked_by: ObjectSet,
    pub exact: bool,
    /// Ends beyond the clutter; otherwise it ends where the arm or a fixture ends it.
    pub clear: bool,
}

/// All ways to one object.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    pub grasps: Vec<Grasp>,
    pub ways: Vec<Way>,
    pub counts: Counts,
}

/// What became of the grasp postures.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    pub too_wide: usize,
    pub out_of_reach: usize,
    /// At the grasp itself the arm meets a fixture or itself.
    pub fixed_at_grasp: usize,
    /// The hand cannot come straight from the standoff: out of reach, a fixture, or the arm itself.
    pub fixed_on_approach: usize,
    pub ways: usize,
}

impl Counts {
    pub fn list(&self) -> Vec<GraspCount> {
        [
            ("too wide for the hand there, or not reached by the fingers", self.too_wide),
            ("out of the arm's reach", self.out_of_reach),
            ("the arm meets a fixture or itself at the grasp", self.fixed_at_grasp),
            ("the straight approach meets a fixture, the arm itself, or the end of reach", self.fixed_on_approach),
            ("a way in, free but for movable objects", self.ways),
        ]
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .map(|(outcome, count)| GraspCount { outcome: outcome.to_owned(), count })
        .collect()
    }

    pub fn total(&self) -> usize {
        self.too_wide + self.out_of_reach + self.fixed_at_grasp + self.fixed_on_approach + self.ways
    }
}

/// What ways are made with.
pub struct Explorer<'a> {
    pub world: &'a World,
    pub inverse: &'a InverseKinematics,
    pub floor: &'a Floor,
    pub settings: &'a Settings,
    /// All objects of the scene.
    pub all: ObjectSet,
}

enum Ended {
    Way(Way),
    FixedAtGrasp,
    FixedOnApproach,
}

impl Explorer<'_> {
    /// Samples every way to an object coarsely.
    pub fn explore(&self, object: ObjectId, scratch: &mut Scratch, budget: &Budget) -> Result<Ways, Stop> {
        let (grasps, too_wide) = preset_grasps(self.world, object);
        let mut found = Ways { counts: Counts { too_wide, ..Counts::default() }, ..Ways::default() };
        for (index, grasp) in grasps.iter().enumerate() {
            budget.check()?;
            let root_from_tool = self.world.poses[object.index()] * grasp.object_from_tool;
            let branches = self.inverse.solve(&root_from_tool, &self.world.robot.home);
            if branches.is_empty() {
                found.counts.out_of_reach += 1;
            }
            for posture in branches {
                match self.way(object, index, grasp, posture, self.settings.coarse, scratch) {
                    Ended::Way(way) => {
                        found.counts.ways += 1;
                        found.ways.push(way);
                    }
                    Ended::FixedAtGrasp => found.counts.fixed_at_grasp += 1,
                    Ended::FixedOnApproach => found.counts.fixed_on_approach += 1,
                }
            }
        }
        found.grasps = grasps;
        // Few objects in the way first; then those that lead out, then short ones.
        found.ways.sort_by_key(|w| (w.blocked_by.len(), !w.clear, w.postures.len()));
        Ok(found)
    }

    /// The way from one grasp posture, with postures `step` apart.
    fn way(&self, object: ObjectId, index: usize, grasp: &Grasp, at_grasp: Posture, step: f64, scratch: &mut Scratch) -> Ended {
        let world = self.world;
        let mut moment = self.moment(object, grasp);
        moment.resting = true;
        let mut blocked_by = match world.touched(&at_grasp, &moment, scratch) {
            Touch::Fixed => return Ended::FixedAtGrasp,
            Touch::Objects(set) => set,
        };
        let mut postures = vec![at_grasp];
        let start = world.poses[object.index()] * grasp.object_from_tool;
        let back = -start.rotation.z_axis;
        let standoff = world.robot.grasps.standoff;
        let centre = world.poses[object.index()].translation;
        let mut out = 0.0;
        let mut clear = false;
        let lifted = Pose::new(start.rotation, start.translation + world.up() * self.settings.lift);
        loop {
            let target = Pose::new(lifted.rotation, lifted.translation + back * out);
            let last = &postures[postures.len() - 1];
            let Some(posture) = self.inverse.follow(&target, last, 0.6) else { break };
            // Only the lift itself is resting.
            moment.resting = false;
            match world.touched(&posture, &moment, scratch) {
                Touch::Fixed => break,
                Touch::Objects(set) => blocked_by = blocked_by.union(set),
            }
            postures.push(posture);
            let object_at = world.world_from_root.point(centre + back * out).truncate();
            clear = self.floor.beyond_clutter(object_at);
            if (clear && out >= standoff) || out >= self.settings.farthest {
                break;
            }
            out += step;
        }
        if out < standoff && !clear {
            return Ended::FixedOnApproach;
        }
        if postures.len() < 3 {
            return Ended::FixedOnApproach;
        }
        let exact = step <= self.settings.fine;
        Ended::Way(Way { grasp: index, postures, blocked_by, exact, clear })
    }

    /// The hand open and the object in it: what is touched then is in the way of coming or going.
    fn moment(&self, object: ObjectId, grasp: &Grasp) -> Moment {
        let world = self.world;
        let (fixtures_below, objects_below) = world.below(object, &world.poses[object.index()], self.settings.margin);
        let mut moment = Moment::new(self.all.difference(ObjectSet::of(object)), world.robot.hand.open(), self.settings.margin);
        moment.held = Some(Held {
            object,
            solid: world.solids[object.index()].clone(),
            tool_from_object: grasp.object_from_tool.inverse(),
            fixtures_below,
            objects_below,
        });
        moment
    }

    /// Samples way `index` finely. False when it turns out to be none, and is then removed.
    fn refine(&self, object: ObjectId, ways: &mut Ways, index: usize, scratch: &mut Scratch) -> bool {
        let way = &ways.ways[index];
        let (grasp, at_grasp) = (way.grasp, way.postures[0].clone());
        match self.way(object, grasp, &ways.grasps[grasp].clone(), at_grasp, self.settings.fine, scratch) {
            Ended::Way(better) => {
                ways.ways[index] = better;
                true
            }
            _ => {
                ways.ways.remove(index);
                ways.counts.ways -= 1;
                ways.counts.fixed_on_approach += 1;
                false
            }
        }
    }

    /// Ways that are free once `removed` is gone, as many as `most`, best first; each is exact.
    pub fn free_ways(
        &self,
        object: ObjectId,
        ways: &mut Ways,
        removed: &ObjectSet,
        most: usize,
        scratch: &mut Scratch,
        budget: &Budget,
    ) -> Result<Vec<usize>, Stop> {
        let mut free = Vec::new();
        let mut i = 0;
        while i < ways.ways.len() && free.len() < most {
            budget.check()?;
            if ways.ways[i].blocked_by.is_subset(removed) {
                if !ways.ways[i].exact && !self.refine(object, ways, i, scratch) {
                    continue;
                }
                if ways.ways[i].blocked_by.is_subset(removed) {
                    free.push(i);
                }
            }
            i += 1;
        }
        Ok(free)
    }

    /// The minimal sets over all ways: each is one way in. Ways that cannot be minimal stay coarse.
    pub fn minimal_sets(&self, object: ObjectId, ways: &mut Ways, scratch: &mut Scratch, budget: &Budget) -> Result<Vec<ObjectSet>, Stop> {
        let mut minimal: Vec<ObjectSet> = Vec::new();
        let mut i = 0;
        while i < ways.ways.len() {
            budget.check()?;
            if minimal.iter().any(|m| m.is_subset(&ways.ways[i].blocked_by)) {
                i += 1;
                continue;
            }
            if !ways.ways[i].exact && !self.refine(object, ways, i, scratch) {
                continue;
            }
            minimal.push(ways.ways[i].blocked_by);
            minimal = ObjectSet::minimal(minimal);
            i += 1;
        }
        Ok(minimal)
    }
}
