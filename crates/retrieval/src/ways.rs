//! Ways in: for each grasp and each branch of the inverse kinematics, how the hand draws the object
//! out of the clutter, and which objects stand in its way.
//!
//! A way begins with the posture that grips the object, lifts it a little, and draws it out level
//! with the hand's direction kept: straight back against the approach, or along a route that the
//! roadmap shows. It ends beyond the clutter. The hand comes in along the same postures in
//! reverse. Sets are over all objects where the scene has them, whatever was removed before, so a
//! way is judged once: it is free when its set is gone.
//!
//! Ways are looked into only as far as needed: first the grasp alone, then the whole way coarsely,
//! then finely. Each stage can only add to the set, so one that is already too large goes no
//! further.

use crate::floor::Floor;
use crate::grasps::{Grasp, Presets, in_twos, preset_grasps};
use clearway_collision::lanes::{LANES, Suspects};
use clearway_collision::{Held, Moment, Quick, Scratch, Touch, World};
use clearway_geometry::{Pose, Vec2};
use clearway_motion::{Posture, distance};
use clearway_plan::plan_file::GraspCount;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::InverseKinematics;
use std::sync::Arc;

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
    /// Room that the arm and the hand keep from everything along the way, metres.
    pub margin: f64,
    /// Room that the object keeps, metres: it may stand close to others.
    pub held_margin: f64,
    /// Objects may turn or slip in the hand.
    pub loosely: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { lift: 0.01, coarse: 0.05, fine: 0.02, farthest: 0.9, margin: 0.001, held_margin: 0.0004, loosely: false }
    }
}

impl Settings {
    /// With so much room kept from everything, metres.
    #[must_use]
    pub fn with_clearance(self, clearance: f64) -> Self {
        Self {
            lift: self.lift.max(1.2 * clearance + 0.003),
            margin: clearance + self.margin,
            held_margin: clearance + self.held_margin,
            ..self
        }
    }
}

/// No joint turns farther from one posture of a way to the next, radians.
pub(crate) const REACH: f64 = 0.6;

/// How far a way has been looked into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    Grasp,
    Coarse,
    Exact,
}

/// One way out (and in).
#[derive(Clone, Debug)]
pub struct Way {
    pub grasp: usize,
    /// At the grasp; from [`Stage::Coarse`] on lifted, and then outwards.
    pub postures: Vec<Posture>,
    /// What stands in the way; a subset of it until the stage is exact.
    pub blocked_by: ObjectSet,
    pub stage: Stage,
    /// The route out, world offsets from where the object stands; empty for straight back.
    pub route: Arc<Vec<Vec2>>,
    /// Ends beyond the clutter; otherwise where the arm or a fixture ends it.
    pub clear: bool,
    /// How often no motion was found along it.
    pub failures: u32,
}

/// What became of drawing an object out.
enum Drawn {
    /// Out, or as far as it goes; `clear` when it ends beyond the clutter.
    Out { postures: Vec<Posture>, blocked_by: ObjectSet, clear: bool },
    /// More stands in the way than asked for: some of what does.
    Blocked(ObjectSet),
    /// It does not even come as far as the standoff.
    Stuck,
}

/// All ways to one object.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    pub grasps: Vec<Grasp>,
    pub ways: Vec<Way>,
    pub counts: Counts,
    /// Grasp postures not looked at yet: grasps and postures, the farthest from the resting posture
    /// first.
    unseen: Vec<(usize, Posture)>,
    /// How many of the first ways are straight; the others follow routes.
    straight: usize,
}

/// What became of the grasp postures looked at.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    pub too_wide: usize,
    /// Held so it would turn or slip in the hand, and otherwise it would not.
    pub askew: usize,
    pub out_of_reach: usize,
    /// At the grasp itself the arm meets a fixture or itself.
    pub fixed_at_grasp: usize,
    /// The hand cannot come straight from the standoff: out of reach, a fixture, or the arm itself.
    pub fixed_on_approach: usize,
    pub ways: usize,
}

impl Counts {
    fn list(&self) -> Vec<GraspCount> {
        [
            ("too wide for the hand there, or not reached by the fingers", self.too_wide),
            ("not firm: it would turn or slip in the hand", self.askew),
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
        self.too_wide + self.askew + self.out_of_reach + self.fixed_at_grasp + self.fixed_on_approach + self.ways
    }
}

impl Ways {
    /// Adds ways that draw the object out straight as far as the standoff, and then along a route if
    /// `route` knows one from there: it is asked with the direction back, level and in the root frame,
    /// and answers with offsets from where the object stands.
    pub fn add_routes(&mut self, object: &Pose, mut route: impl FnMut(Vec2) -> Option<Arc<Vec<Vec2>>>) -> bool {
        let mut known: Vec<(Vec2, Option<Arc<Vec<Vec2>>>)> = Vec::new();
        let before = self.ways.len();
        for i in 0..self.straight {
            let way = &self.ways[i];
            let back = -(object.rotation * self.grasps[way.grasp].object_from_tool.rotation.z_axis).truncate();
            let found = match known.iter().find(|(direction, _)| direction.abs_diff_eq(back, 1e-9)) {
                Some((_, found)) => found.clone(),
                None => {
                    known.push((back, route(back)));
                    known[known.len() - 1].1.clone()
                }
            };
            let Some(route) = found else { continue };
            // What the grasp posture touches is known from the straight way with the same posture.
            self.ways.push(Way { postures: vec![way.postures[0].clone()], stage: Stage::Grasp, route, ..way.clone() });
        }
        self.ways.len() > before
    }

    /// Those known to be free once `removed` is gone.
    fn free_now(&self, removed: &ObjectSet) -> impl Iterator<Item = usize> {
        let free = |w: &Way| w.stage == Stage::Exact && w.blocked_by.is_subset(removed);
        (0..self.ways.len()).filter(move |&i| free(&self.ways[i]))
    }

    /// Forgets ways along which no motion was found.
    pub(crate) fn drop_failed(&mut self) {
        self.straight = self.ways[..self.straight].iter().filter(|w| w.failures == 0).count();
        self.ways.retain(|w| w.failures == 0);
    }

    /// What became of the grasp postures, those not looked at included.
    pub fn grasp_counts(&self) -> Vec<GraspCount> {
        let mut counts = self.counts.list();
        if !self.unseen.is_empty() {
            counts.push(GraspCount {
                outcome: "not looked at: there were ways enough".to_owned(),
                count: self.unseen.len(),
            });
        }
        counts
    }
}

/// What ways are made with.
pub struct Explorer<'a> {
    pub world: &'a World,
    pub inverse: &'a InverseKinematics,
    pub floor: &'a Floor,
    pub settings: &'a Settings,
    /// Where the object stands, in the root frame, if not where the scene has it.
    pub moved_to: Option<Pose>,
    /// The hand goes in and out without the object, which stays where it stands.
    pub empty: bool,
}

impl Explorer<'_> {
    fn pose(&self, object: ObjectId) -> Pose {
        self.moved_to.unwrap_or(self.world.poses[object.index()])
    }

    /// The ways to hold an object like this and no other: as soon as there are `enough` that lead out and nothing stands
    /// in, no more; else all, whatever objects stand in them.
    pub fn with_grasp(&self, object: ObjectId, grasp: &Grasp, enough: usize, scratch: &mut Scratch) -> Vec<Way> {
        let root_from_tool = self.pose(object) * grasp.object_from_tool;
        let home = &self.world.model.robot.home;
        let mut branches = self.inverse.solve(&root_from_tool, home);
        branches.sort_by(|a, b| distance(b, home).total_cmp(&distance(a, home)));
        let unseen = branches.into_iter().map(|q| (0, q)).collect();
        let mut ways = Ways { grasps: vec![grasp.clone()], unseen, ..Ways::default() };
        loop {
            let exact = |w: &Way| w.stage == Stage::Exact;
            if ways.ways.iter().filter(|w| exact(w) && w.clear && w.blocked_by.is_empty()).count() >= enough {
                break;
            }
            let open = ways.ways.iter().position(|w| !exact(w) && w.blocked_by.is_empty());
            match open.or_else(|| if ways.unseen.is_empty() { ways.ways.iter().position(|w| !exact(w)) } else { None })
            {
                Some(next) => self.advance(object, &mut ways, next, ObjectSet::CAPACITY, scratch),
                None if self.see(object, &mut ways, scratch) => {}
                None => break,
            }
        }
        ways.ways.retain(|w| w.stage == Stage::Exact);
        ways.ways
    }

    /// Finds every grasp posture of an object; none is looked at yet.
    pub fn explore(&self, object: ObjectId, budget: &Budget) -> Result<Ways, Stop> {
        let Presets { grasps, too_wide, askew } = preset_grasps(self.world, object, self.settings.loosely);
        let mut found = Ways { counts: Counts { too_wide, askew, ..Counts::default() }, ..Ways::default() };
        let home = &self.world.model.robot.home;
        let in_twos = in_twos(self.world);
        for (index, grasp) in grasps.iter().enumerate() {
            budget.check()?;
            let root_from_tool = self.pose(object) * grasp.object_from_tool;
            let branches = if in_twos {
                self.inverse.solve_of_two(&root_from_tool, home)
            } else {
                self.inverse.solve(&root_from_tool, home)
            };
            found.counts.out_of_reach += usize::from(branches.is_empty());
            found.unseen.extend(branches.into_iter().map(|q| (index, q)));
        }
        // Ways that end near the resting posture are taken first, so they are looked at first; loose holds last.
        found.unseen.sort_by_cached_key(|(grasp, q)| {
            (grasps[*grasp].firm, std::cmp::Reverse((distance(q, home) * 1e9) as u64))
        });
        found.grasps = grasps;
        Ok(found)
    }

    /// Looks at what sixteen more grasp postures touch; false when all have been looked at.
    fn see(&self, object: ObjectId, found: &mut Ways, scratch: &mut Scratch) -> bool {
        let some = found.unseen.split_off(found.unseen.len().saturating_sub(LANES));
        let Some((first, _)) = some.first() else { return false };
        let moment = |grasp: usize| Moment { resting: true, ..self.moment(object, &found.grasps[grasp]) };
        let mut suspects = Suspects::default();
        let postures: Vec<Posture> = some.iter().map(|(_, q)| q.clone()).collect();
        Quick::links(self.world, &moment(*first)).suspects(&postures, &mut suspects);
        let route = Arc::new(Vec::new());
        let mut seen = Vec::with_capacity(LANES);
        for (lane, (grasp, posture)) in some.into_iter().enumerate().rev() {
            match self.world.touched_among(&posture, &moment(grasp), &suspects, lane, scratch) {
                Touch::Fixed => found.counts.fixed_at_grasp += 1,
                Touch::Objects(touched) => {
                    // Nothing is lifted from under a load.
                    let loads =
                        if self.moved_to.is_some() { ObjectSet::EMPTY } else { self.world.loads[object.index()] };
                    let blocked_by = touched.union(loads);
                    found.counts.ways += 1;
                    seen.push(Way {
                        grasp,
                        postures: vec![posture],
                        blocked_by,
                        stage: Stage::Grasp,
                        route: route.clone(),
                        clear: false,
                        failures: 0,
                    });
                }
            }
        }
        let count = seen.len();
        found.ways.splice(found.straight..found.straight, seen);
        found.straight += count;
        true
    }

    /// Looks one stage further into a way, as long as no more than `most` objects turn out to be in
    /// it. A way that is none is removed.
    fn advance(&self, object: ObjectId, ways: &mut Ways, index: usize, most: usize, scratch: &mut Scratch) {
        let way = &ways.ways[index];
        let (next, step) = match way.stage {
            Stage::Grasp => (Stage::Coarse, self.settings.coarse),
            _ => (Stage::Exact, self.settings.fine),
        };
        let drawn = self.draw_out(object, &ways.grasps[way.grasp], way, step, most, scratch);
        let way = &mut ways.ways[index];
        match drawn {
            Drawn::Out { postures, blocked_by, clear } => {
                *way = Way { postures, blocked_by, clear, stage: next, ..way.clone() };
            }
            Drawn::Blocked(blocked_by) => way.blocked_by = blocked_by,
            Drawn::Stuck => {
                ways.ways.remove(index);
                if index < ways.straight {
                    ways.straight -= 1;
                    ways.counts.ways -= 1;
                    ways.counts.fixed_on_approach += 1;
                }
            }
        }
    }

    /// The way from its grasp posture outwards, postures `step` apart.
    fn draw_out(
        &self,
        object: ObjectId,
        grasp: &Grasp,
        way: &Way,
        step: f64,
        most: usize,
        scratch: &mut Scratch,
    ) -> Drawn {
        let world = self.world;
        let moment = self.moment(object, grasp);
        let stands = self.pose(object);
        let start = stands * grasp.object_from_tool;
        let back = -start.rotation.z_axis;
        let lifted = start.translation + world.up() * self.settings.lift;
        // Not one step more for rounding.
        let standoff = world.model.robot.grasps.standoff - 1e-9;
        let standing = world.world_from_root * stands;
        let below = standing.translation.z - world.solids[object.index()].aabb(standing).0.z;
        // Along a bend the hand comes in sideways in the end: it must not sweep through the object.
        let mut coming = Moment::new(ObjectSet::of(object), moment.hand, self.settings.margin);
        coming.gripping = Some(object);
        let offset = |out: f64| match way.route.as_slice() {
            [] => Some(back * out),
            route => along(route, out).map(|p| world.root_from_world.rotation * p.extend(0.0)),
        };
        let mut blocked_by = way.blocked_by;
        let mut postures = vec![way.postures[0].clone()];
        let mut quick = Quick::links(world, &moment);
        let mut suspects = Suspects::default();
        // What is known of the last posture that is good, and the next to look at.
        let (mut reached, mut clear, mut out) = (0.0, false, 0.0);
        let mut ends = false;
        while !ends {
            // As far as the arm reaches; then what it meets on the way, sixteen postures at a time.
            let from = postures.len();
            let mut outs = [(0.0, false); LANES];
            while postures.len() - from < LANES && !ends {
                let Some(moved) = offset(out) else {
                    ends = true;
                    break;
                };
                let target = Pose::new(start.rotation, lifted + moved);
                let Some(posture) = self.inverse.follow(&target, &postures, REACH) else {
                    ends = true;
                    break;
                };
                let object_at = world.world_from_root.point(stands.translation + moved);
                let clear = self.floor.beyond_clutter(object_at.truncate(), object_at.z - below);
                outs[postures.len() - from] = (out, clear);
                postures.push(posture);
                ends = (clear && out >= standoff) || out >= self.settings.farthest;
                out += step;
            }
            let count = postures.len() - from;
            if count == 0 {
                break;
            }
            quick.suspects(&postures[from..], &mut suspects);
            for lane in 0..count {
                let posture = &postures[from + lane];
                match world.touched_among(posture, &moment, &suspects, lane, scratch) {
                    Touch::Fixed => {
                        postures.truncate(from + lane);
                        ends = true;
                        break;
                    }
                    Touch::Objects(set) => blocked_by = blocked_by.union(set),
                }
                if blocked_by.len() > most {
                    return Drawn::Blocked(blocked_by);
                }
                if !way.route.is_empty() && !world.free(posture, &coming, scratch) {
                    return Drawn::Stuck;
                }
                (reached, clear) = outs[lane];
            }
        }
        if reached >= standoff { Drawn::Out { postures, blocked_by, clear } } else { Drawn::Stuck }
    }

    fn moment(&self, object: ObjectId, grasp: &Grasp) -> Moment {
        if self.empty {
            let others = ObjectSet::first(self.world.objects.len()).difference(ObjectSet::of(object));
            let mut moment = Moment::new(others, self.world.model.robot.hand.open(), self.settings.margin);
            moment.placed = vec![(object, self.world.placed(object, &self.pose(object)))];
            moment.gripping = Some(object);
            return moment;
        }
        let mut moment = moment(self.world, self.settings, object, grasp);
        if let (Some(pose), Some(held)) = (self.moved_to, &mut moment.held) {
            (held.fixtures_below, held.objects_below) = self.world.below(object, &pose);
        }
        moment
    }

    /// Ways that are free once `removed` is gone, as many as `most`; each is exact. Those that lead
    /// out of the clutter come first, then those that failed least often, then those that end near
    /// the resting posture.
    pub fn free_ways(
        &self,
        object: ObjectId,
        ways: &mut Ways,
        removed: &ObjectSet,
        most: usize,
        scratch: &mut Scratch,
        budget: &Budget,
    ) -> Result<Vec<usize>, Stop> {
        let mut i = 0;
        let mut free = 0;
        loop {
            budget.check()?;
            if i == ways.ways.len() {
                // Those seen now come before the routes; the count of free ones starts anew.
                (i, free) = (0, 0);
                let enough = ways.free_now(removed).count() >= most.max(3);
                if enough || !self.see(object, ways, scratch) {
                    break;
                }
                continue;
            }
            let way = &ways.ways[i];
            let open = way.blocked_by.is_subset(removed);
            // A few more than asked for are found, so that there is a choice.
            if open && way.stage < Stage::Exact && free < most.max(3) {
                self.advance(object, ways, i, ObjectSet::CAPACITY, scratch);
                continue;
            }
            free += usize::from(open && way.stage == Stage::Exact && way.clear && way.failures == 0);
            i += 1;
        }
        let mut free: Vec<usize> = ways.free_now(removed).collect();
        let home = &self.world.model.robot.home;
        let from_home = |i: usize| ways.ways[i].postures.last().map_or(f64::INFINITY, |q| distance(q, home));
        let key = |i: usize| {
            let way = &ways.ways[i];
            (!way.clear, way.failures, !ways.grasps[way.grasp].firm)
        };
        free.sort_by(|&a, &b| key(a).cmp(&key(b)).then(from_home(a).total_cmp(&from_home(b))));
        free.truncate(most);
        Ok(free)
    }

    /// The minimal sets over all ways: each is one way in. Ways that cannot be minimal, or that more
    /// than `most` objects stand in, are not looked into.
    pub fn minimal_sets(
        &self,
        object: ObjectId,
        ways: &mut Ways,
        most: usize,
        scratch: &mut Scratch,
        budget: &Budget,
    ) -> Result<Vec<ObjectSet>, Stop> {
        // With one that nothing stands in, no other matters.
        loop {
            budget.check()?;
            let open = (0..ways.ways.len())
                .filter(|&i| ways.ways[i].blocked_by.is_empty())
                .max_by_key(|&i| ways.ways[i].stage);
            match open {
                Some(i) if ways.ways[i].stage == Stage::Exact => return Ok(vec![ObjectSet::EMPTY]),
                Some(i) => self.advance(object, ways, i, most, scratch),
                None if self.see(object, ways, scratch) => {}
                None => break,
            }
        }
        loop {
            budget.check()?;
            let exact = |w: &&Way| w.stage == Stage::Exact && w.blocked_by.len() <= most;
            let minimal = ObjectSet::minimal(ways.ways.iter().filter(exact).map(|w| w.blocked_by).collect());
            let next = (0..ways.ways.len())
                .filter(|&i| ways.ways[i].stage < Stage::Exact)
                .filter(|&i| ways.ways[i].blocked_by.len() <= most)
                .filter(|&i| !minimal.iter().any(|m| m.is_subset(&ways.ways[i].blocked_by)))
                .min_by_key(|&i| (ways.ways[i].blocked_by.len(), std::cmp::Reverse(ways.ways[i].stage)));
            match next {
                Some(i) => self.advance(object, ways, i, most, scratch),
                None => return Ok(minimal),
            };
        }
    }
}

/// The hand open and the object in it, all others standing: what is touched then is in the way of coming
/// or going.
pub(crate) fn moment(world: &World, settings: &Settings, object: ObjectId, grasp: &Grasp) -> Moment {
    let (fixtures_below, objects_below) = world.carriers[object.index()].clone();
    let others = ObjectSet::first(world.objects.len()).difference(ObjectSet::of(object));
    let mut moment = Moment::new(others, world.model.robot.hand.open(), settings.margin);
    moment.held_margin = settings.held_margin;
    moment.placed = world.with_unseen(Vec::new(), object);
    moment.held = Some(Held { fixtures_below, objects_below, ..world.in_hand(object, &grasp.object_from_tool) });
    moment
}

/// The point at a distance along a polyline; `None` past its end.
fn along(route: &[Vec2], mut distance: f64) -> Option<Vec2> {
    for leg in route.windows(2) {
        let length = leg[0].distance(leg[1]);
        if distance <= length {
            return Some(leg[0] + (leg[1] - leg[0]) * (distance / length.max(1e-12)));
        }
        distance -= length;
    }
    None
}
