//! Objects that may stand anywhere: the ways to them there, spots for them, and motions that bring them from
//! one pose to another, in any order and as often as asked. It is what a symbolic planner asks of the arm, and
//! plans nothing by itself.
//!
//! Poses are those of objects in the world. A mobile base stays where it starts.

use crate::carry::relocate::Relocation;
use crate::carry::{Carried, Carrier, Obstruction, Situation};
use crate::direct::{Direct, Directly};
use crate::feasibility::{Feasibility, Journey, Unfit};
use crate::grasps::Grasp;
use crate::order;
use crate::place::{self, Spot};
use crate::planner::Settings;
use crate::push::Pushes;
use crate::trace;
use crate::ways::{self, Explorer, Stage, Way};
use clearway_collision::{CollisionModel, Touch};
use clearway_geometry::{Pose, Vec2};
use clearway_motion::distance;
use clearway_plan::plan_file::{PlanFile, Timing};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_scene::{Fixture, Place, Scene, Support};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// What something can be put down on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// One of the scene's places.
    Place(usize),
    /// The top of a fixture, or of an object that stands like this.
    Fixture(usize),
    Object(ObjectId, Pose),
}

/// What an object rests on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rests {
    pub fixtures: Vec<usize>,
    pub objects: ObjectSet,
}

/// One arm in one scene, asked about objects wherever they are.
pub struct Handling {
    arm: Feasibility,
    seed: u64,
    random: Xoshiro256PlusPlus,
}

/// An object to be brought somewhere.
#[derive(Clone, Debug)]
pub struct Bring {
    pub object: ObjectId,
    pub grasp: Grasp,
    pub from: (Pose, Way),
    pub to: (Pose, Way),
}

impl Handling {
    pub fn new(scene: Scene, model: Arc<CollisionModel>, settings: Settings, seed: u64) -> Result<Self, Unfit> {
        let Settings { ways, carry, push, mobile, .. } = settings;
        let mut arm = Feasibility::new(scene, model, ways, carry, push, mobile)?;
        // Whoever asks for grasps takes them in their order, the firm ones first.
        arm.settings.loosely = true;
        Ok(Self { arm, seed, random: Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x4861_6e64) })
    }

    /// What the arm can do with objects where the scene has them.
    pub fn arm(&mut self) -> &mut Feasibility {
        &mut self.arm
    }

    pub fn scene(&self) -> &Scene {
        &self.arm.scene
    }

    /// The grasps of an object where the scene has it: firm ones before others, and of those the ones that the fewest
    /// objects stand in the way of first; those that do not reach it there last.
    pub fn grasps(&mut self, object: ObjectId, budget: &Budget) -> Result<Vec<Grasp>, Stop> {
        self.arm.minimal_sets(object, ObjectSet::CAPACITY, budget)?;
        let Some(ways) = &self.arm.stands[0].ways[object.index()] else { return Ok(Vec::new()) };
        let rank = |grasp: usize| {
            let of = ways.ways.iter().filter(|w| w.grasp == grasp);
            let least = of.map(|w| (w.stage < Stage::Exact, w.blocked_by.len(), !w.clear)).min();
            (!ways.grasps[grasp].firm, least.unwrap_or((true, usize::MAX, true)))
        };
        let mut order: Vec<usize> = (0..ways.grasps.len()).collect();
        order.sort_by_cached_key(|g| rank(*g));
        Ok(order.into_iter().map(|g| ways.grasps[g].clone()).collect())
    }

    /// The ways to an object that stands like this, held like this: the freest first; as soon as there are `enough` that
    /// nothing stands in, no more. What stands in them is told of the other objects where the scene has them.
    pub fn ways(&mut self, object: ObjectId, at: &Pose, grasp: &Grasp, enough: usize) -> Vec<Way> {
        let moved_to = (*at != self.arm.scene.objects[object.index()].pose).then_some(*at);
        let Feasibility { stands, inverse, floor, settings, scratch, .. } = &mut self.arm;
        let world = &stands[0].world;
        let moved_to = moved_to.map(|at| world.root_from_world * at);
        let mut ways = Explorer { world, inverse, floor, settings, moved_to, empty: false }
            .with_grasp(object, grasp, enough, scratch);
        let home = &world.model.robot.home;
        let from_home = |w: &Way| w.postures.last().map_or(f64::INFINITY, |q| distance(q, home));
        ways.sort_by(|a, b| {
            (a.blocked_by.len(), !a.clear)
                .cmp(&(b.blocked_by.len(), !b.clear))
                .then(from_home(a).total_cmp(&from_home(b)))
        });
        ways
    }

    /// Whether an object that stands like `other_at` is in a way to another.
    pub fn in_way(
        &mut self,
        (object, at, grasp, way): (ObjectId, &Pose, &Grasp, &Way),
        other: ObjectId,
        other_at: &Pose,
    ) -> bool {
        if *other_at == self.arm.scene.objects[other.index()].pose {
            return way.blocked_by.contains(other);
        }
        let Feasibility { stands, settings, scratch, .. } = &mut self.arm;
        let world = &stands[0].world;
        let placed = world.placed(other, &(world.root_from_world * *other_at));
        let mut moment = ways::moment(world, settings, object, grasp);
        moment.standing = ObjectSet::EMPTY;
        if let Some(held) = &mut moment.held {
            let at = world.root_from_world * *at;
            (held.fixtures_below, held.objects_below) = world.below(object, &at);
            if world.carries(&placed, object, &at) {
                held.objects_below.insert(other);
            }
        }
        moment.placed = vec![(other, placed)];
        way.postures.iter().enumerate().any(|(i, posture)| {
            moment.resting = i == 0;
            world.touched(posture, &moment, scratch) != Touch::FREE
        })
    }

    /// Whether two objects that stand like this are in each other's place.
    pub fn overlap(&self, (object, at): (ObjectId, &Pose), (other, other_at): (ObjectId, &Pose)) -> bool {
        let world = &self.arm.stands[0].world;
        let pose = |at: &Pose| world.root_from_world * *at;
        let (a, b) = (world.placed(object, &pose(at)), world.placed(other, &pose(other_at)));
        a.near(&b, self.arm.settings.held_margin)
            && !world.carries(&b, object, &pose(at))
            && !world.carries(&a, other, &pose(other_at))
    }

    /// What carries an object that stands like this, of fixtures and of objects that stand like those.
    pub fn rests(&self, object: ObjectId, at: &Pose, others: &[(ObjectId, Pose)]) -> Rests {
        let world = &self.arm.stands[0].world;
        let at = world.root_from_world * *at;
        let carries = |other: ObjectId, pose: &Pose| {
            world.carries(&world.placed(other, &(world.root_from_world * *pose)), object, &at)
        };
        let objects = others
            .iter()
            .filter(|(other, pose)| *other != object && carries(*other, pose))
            .map(|(other, _)| *other)
            .collect();
        Rests { fixtures: world.below(object, &at).0, objects }
    }

    /// Poses on a surface in which an object, held like this, would be inside its edges, each spot first with one
    /// turn of the object, then with others: on places those far from the robot first, elsewhere those near where it
    /// stood. Whether it [may stand](Self::may_stand) there is another question.
    pub fn spots(&self, object: ObjectId, grasp: &Grasp, surface: Surface) -> Vec<Pose> {
        let world = &self.arm.stands[0].world;
        let scene = &self.arm.scene;
        let pose = scene.objects[object.index()].pose;
        let base = world.world_from_root.translation.truncate();
        let area = match surface {
            Surface::Place(index) => scene.places[index].clone(),
            Surface::Fixture(index) => {
                top_of(&scene.fixtures[index].id, &scene.fixtures[index].solid.aabb(scene.fixtures[index].pose))
            }
            Surface::Object(id, at) => top_of(&scene.names[id.index()], &scene.objects[id.index()].solid.aabb(at)),
        };
        let away = matches!(surface, Surface::Place(_));
        // On another object it may stick out, as long as it does not fall.
        let inside = match surface {
            Surface::Object(..) => {
                let (low, high) = scene.objects[object.index()].solid.aabb(pose);
                Place { size: area.size + 2.0 * (high - low).truncate().max_element(), ..area.clone() }
            }
            _ => area.clone(),
        };
        let mut spots = match surface {
            Surface::Object(..) => amid(&area),
            _ => place::spots(std::slice::from_ref(&area), base),
        };
        let near = match surface {
            Surface::Object(..) => area.centre.truncate(),
            _ => pose.translation.truncate(),
        };
        if !away {
            spots.sort_by(|a, b| a.at.truncate().distance(near).total_cmp(&b.at.truncate().distance(near)));
        }
        let forward = (pose * grasp.object_from_tool).rotation.z_axis.truncate();
        let solid = &world.solids[object.index()];
        // On a place the hand points away from the robot, or nearly; elsewhere as it does where the object stood.
        let turns: Vec<Vec<f64>> = spots
            .iter()
            .map(|spot| {
                if away {
                    place::yaws(forward, spot.at.truncate() - base).collect()
                } else {
                    place::yaws(Vec2::X, Vec2::X).take(5).collect()
                }
            })
            .collect();
        let most = turns.iter().map(Vec::len).max().unwrap_or(0);
        let each = (0..most)
            .flat_map(|turn| spots.iter().zip(&turns).filter_map(move |(spot, turns)| Some((spot, *turns.get(turn)?))));
        each.filter_map(|(spot, yaw)| place::standing_at(solid, &pose, yaw, spot, &inside)).collect()
    }

    /// Whether an object may stand like this on a surface: it meets no fixture, and does not fall.
    pub fn may_stand(&self, object: ObjectId, at: &Pose, surface: Surface) -> bool {
        /// As much as an object is raised for what it stands on not to count.
        const RAISED: f64 = 0.02;
        let world = &self.arm.stands[0].world;
        let scene = &self.arm.scene;
        let mut raised = world.root_from_world * *at;
        raised.translation += world.up() * RAISED;
        let above = world.placed(object, &raised);
        if world.fixtures.iter().any(|f| above.near(f, self.arm.settings.held_margin)) {
            return false;
        }
        match surface {
            Surface::Place(_) => true,
            Surface::Fixture(_) => scene.stands(object, at, ObjectSet::EMPTY),
            Surface::Object(id, pose) => {
                // As if that stood fast: whether it does hangs on what it stands on then.
                let below = &scene.objects[id.index()];
                let mut fast = scene.clone();
                fast.fixtures.push(Fixture { id: below.id.clone(), solid: below.solid.clone(), pose });
                fast.stands(object, at, ObjectSet::EMPTY)
            }
        }
    }

    /// How things are before anything is done.
    pub fn start(&self) -> Situation {
        self.arm.start_situation()
    }

    /// The motions that bring an object somewhere, or what stood in their way.
    pub fn bring(
        &mut self,
        bring: &Bring,
        before: &Situation,
        budget: &Budget,
    ) -> Result<Result<Carried, Obstruction>, Stop> {
        let (grasp, object) = (&bring.grasp, bring.object);
        let root = self.arm.stands[0].world.root_from_world;
        let relocation = Relocation {
            object,
            grasp,
            from: (root * bring.from.0, &bring.from.1),
            to: (root * bring.to.0, &bring.to.1),
        };
        let mut without = before.clone();
        without.standing.remove(object);
        without.placed.retain(|(o, _)| *o != object);
        let mut with = without.clone();
        with.placed.push((object, bring.to.0));
        for (situation, what) in
            [(&without, "taking it from under what would fall"), (&with, "putting it where something would fall")]
        {
            let fallen = self.fallen(situation);
            if !fallen.is_empty() {
                return Ok(Err(Obstruction { what, blamed: fallen, slower: false }));
            }
        }
        self.carrier(before, budget).relocate(&relocation, before, false)
    }

    /// Of what stands on other objects, that which would fall.
    fn fallen(&self, situation: &Situation) -> ObjectSet {
        let scene = &self.arm.scene;
        let mut now = scene.clone();
        let mut standing = situation.standing;
        for (object, pose) in &situation.placed {
            now = now.moved(*object, *pose);
            standing.insert(*object);
        }
        now.fallen(standing)
    }

    /// Adds the arm's way home to a step; false when none was found.
    pub fn go_home(&mut self, last: &mut Carried, budget: &Budget) -> Result<bool, Stop> {
        let before = last.after.clone();
        let home = self.carrier(&before, budget).tuck(&before)?;
        Ok(home.map(|segments| last.step.segments.extend(segments)).is_ok())
    }

    fn carrier<'a>(&'a mut self, before: &Situation, budget: &'a Budget) -> Carrier<'a, Xoshiro256PlusPlus> {
        let Self { arm: Feasibility { stands, scene, inverse, carrying, trees, .. }, random, .. } = self;
        let (world, base) = (&stands[0].world, before.base.clone());
        Carrier {
            world,
            base,
            within: None,
            scene,
            inverse,
            settings: carrying,
            random,
            budget,
            trees,
            quicker_than: f64::INFINITY,
        }
    }

    /// A plan of these steps; without a goal of its own it is to have the target.
    pub fn plan_file(&self, carried: Vec<Carried>, goal: Option<&str>, timing: Timing, seed: u64) -> PlanFile {
        PlanFile { seed, timing, ..trace::handled(&self.arm, carried, goal) }
    }

    /// No plan, for this reason, which is a proof or not.
    pub fn no_plan(&self, why: String, proved: bool, goal: Option<&str>, timing: Timing, seed: u64) -> PlanFile {
        PlanFile { seed, timing, ..trace::not_handled(&self.arm, why, proved, goal) }
    }

    /// Puts all of some objects on places, and what has to go before them, as in a retrieval of one: each held firmly,
    /// and on one of the places that are allowed for it, if that is told. `None`: the fewest objects that have to go are
    /// more than `may_go`, or no motions were found soon, which proves nothing. With the time that motions took.
    pub fn put_on_places(
        &mut self,
        wanted: ObjectSet,
        allowed: BTreeMap<ObjectId, Vec<usize>>,
        may_go: impl Fn(ObjectSet) -> bool,
        budget: &Budget,
    ) -> Result<Option<(Vec<Carried>, Duration)>, Stop> {
        let count = self.arm.scene.objects.len();
        if self.arm.base.is_some() || wanted.is_empty() || count >= ObjectSet::CAPACITY {
            return Ok(None);
        }
        let (target, pushes) = (self.arm.scene.target, self.arm.pushing.when);
        self.arm.set_loosely(false);
        self.arm.pushing.when = Pushes::Never;
        self.arm.carrying.only_on = allowed;
        let found = self.sequences_on_places(wanted, may_go, budget);
        self.arm.carrying.only_on.clear();
        (self.arm.scene.target, self.arm.pushing.when) = (target, pushes);
        found
    }

    /// From now on objects may turn or slip in the hand, as they may at first.
    pub fn hold_loosely(&mut self) {
        self.arm.set_loosely(true);
    }

    fn sequences_on_places(
        &mut self,
        wanted: ObjectSet,
        may_go: impl Fn(ObjectSet) -> bool,
        budget: &Budget,
    ) -> Result<Option<(Vec<Carried>, Duration)>, Stop> {
        /// Sequences tried.
        const TRIES: usize = 40;
        let count = self.arm.scene.objects.len();
        let mut direct = Direct::for_all(count, wanted);
        let mut journey = Journey::new(self.seed);
        let (mut limit, mut tries) = (wanted.len() + 1, 0);
        while tries < TRIES {
            match direct.search(&mut self.arm, &mut limit, budget)? {
                Directly::Objects(objects) => {
                    tries += 1;
                    // The arm goes home after the last.
                    let Some(last) = objects.last() else { return Ok(None) };
                    if !may_go(objects.iter().copied().collect()) {
                        return Ok(None);
                    }
                    self.arm.scene.target = *last;
                    match self.arm.carry(&objects, &mut journey, budget, |_| {})? {
                        Ok(()) => {
                            let moving = journey.moving();
                            return Ok(Some((journey.carried, moving)));
                        }
                        Err(failure) => direct.failed(failure),
                    }
                }
                Directly::Nothing { next: Some(next) } if next <= count + 1 => limit = next.max(limit + 1),
                Directly::Nothing { .. } => return Ok(None),
            }
        }
        Ok(None)
    }

    /// Whether no declared grasp leads to an object where the scene has it, as far as was found.
    pub fn has_no_way(&mut self, object: ObjectId, budget: &Budget) -> Result<bool, Stop> {
        self.arm.minimal_sets(object, ObjectSet::CAPACITY, budget)?;
        Ok(self.arm.no_way_is_known(object))
    }

    /// Objects that, as far as was found, are never taken from where the scene has them, whatever goes first.
    pub fn seem_stuck(&mut self, budget: &Budget) -> Result<ObjectSet, Stop> {
        let all = self.arm.scene.all();
        Ok(all.difference(order::takable(&self.arm.frozen(budget)?, &all)))
    }

    /// Objects that certainly are never taken from where the scene has them, whatever goes first, `object` among them;
    /// none where that is not proved.
    pub fn proved_stuck(&mut self, object: ObjectId, budget: &Budget) -> Result<ObjectSet, Stop> {
        // What is not looked into yet is not known to have no way.
        self.has_no_way(object, budget)?;
        self.arm.proved_stuck(object, budget)
    }

    /// Why it is proved that an object cannot be taken; `stuck`: all of which that is proved.
    pub fn never_taken(&self, object: ObjectId, stuck: ObjectSet) -> String {
        trace::never_taken(&self.arm, object, stuck)
    }

    /// The places that an object which stands like this is on.
    pub fn places_under(&self, object: ObjectId, at: &Pose) -> Vec<usize> {
        /// A body's bottom is as high as a place up to this, metres.
        const LEVEL: f64 = 1e-3;
        let (low, high) = self.arm.scene.objects[object.index()].solid.aabb(*at);
        let on = |place: &Place| {
            let (corner, half) = (place.centre.truncate() - place.size / 2.0, place.size / 2.0);
            (low.z - place.centre.z).abs() <= LEVEL
                && low.truncate().cmpge(corner).all()
                && high.truncate().cmple(corner + half * 2.0).all()
        };
        let places = &self.arm.scene.places;
        (0..places.len()).filter(|i| on(&places[*i])).collect()
    }

    /// The fixtures that carry objects where the scene has them.
    pub fn shelves(&self) -> Vec<usize> {
        let scene = &self.arm.scene;
        let carry =
            |index: &usize| self.arm.stands[0].world.carriers.iter().any(|(fixtures, _)| fixtures.contains(index));
        let mut shelves: Vec<usize> = (0..scene.fixtures.len()).filter(carry).collect();
        for object in &scene.objects {
            if let Support::Fixture(index) = &object.support
                && !shelves.contains(index)
            {
                shelves.push(*index);
            }
        }
        shelves
    }
}

/// The middle of an area, and spots round it halfway to its edges.
fn amid(area: &Place) -> Vec<Spot> {
    let parts = [0.0, 0.25, -0.25];
    let offsets = parts.iter().flat_map(|x| parts.iter().map(|y| Vec2::new(*x, *y)));
    offsets.map(|offset| Spot { at: area.centre + (area.size * offset).extend(0.0), place: 0 }).collect()
}

fn top_of(id: &str, (low, high): &(clearway_geometry::Vec3, clearway_geometry::Vec3)) -> Place {
    let size = (*high - *low).truncate();
    Place { id: id.to_owned(), size, centre: ((*low + *high) / 2.0).truncate().extend(high.z) }
}
