//! Plain motion planning: a robot of spheres, obstacles, a start and goals; a path.

use crate::{Halton, Path, Posture, RrtSettings, SimplifySettings, SphereSpace, Trees, connect, length, simplify};
use clearway_collision::Scratch;
use clearway_collision::lanes::exact::{Contact, contact, unchecked_pairs};
use clearway_collision::lanes::{Around, Body, Kernel, Obstacles, Piece, Settings as BodySettings};
use clearway_collision::shapes::{Among, Shapes};
use clearway_geometry::{Convex, Pose, Solid};
use clearway_plan::{Budget, Stop};
use clearway_robot::{Group, Sphere};
use std::time::{Duration, Instant};

/// How to plan.
#[derive(Clone, Debug)]
pub struct Settings {
    pub rrt: RrtSettings,
    pub simplify: SimplifySettings,
    /// Samples per radian of joint distance, at least; what lies between them is checked as well.
    pub checks_per_rad: f64,
    /// Where in the Halton sequence to begin: another value is another attempt.
    pub skip: u32,
    /// Closer than this to an obstacle counts as touching it, metres.
    pub margin: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rrt: RrtSettings { range: 1.0, iterations: 1_000_000, ..RrtSettings::default() },
            simplify: SimplifySettings::default(),
            checks_per_rad: 32.0,
            skip: 0,
            margin: 0.0,
        }
    }
}

impl Settings {
    pub fn validate(&self) -> Result<(), String> {
        self.rrt.validate()?;
        if !(self.checks_per_rad >= 1.0 && self.checks_per_rad <= 1e4) {
            return Err(format!("checks per radian are {}, must lie in 1..=10000", self.checks_per_rad));
        }
        if !(self.margin >= 0.0 && self.margin.is_finite()) {
            return Err(format!("margin is {}, must not be negative", self.margin));
        }
        Ok(())
    }
}

/// Tags that obstacles leave to the robot's links.
const ROBOT_TAGS: usize = 1 << 12;

/// Something to keep clear of, in the root link's frame.
#[derive(Clone, Debug)]
pub struct Obstacle {
    pub name: String,
    pub root_from_solid: Pose,
    pub solid: Solid,
}

/// A robot, ready to plan for among any obstacles.
#[derive(Clone, Debug)]
pub struct MotionPlanner {
    pub group: Group,
    /// By link, in its frame: they cover the link.
    pub spheres: Vec<Vec<Sphere>>,
    /// Pairs of links that are not checked against each other.
    pub unchecked: Vec<(usize, usize)>,
    pub kernel: Kernel,
    /// The links' own shapes, which decide where spheres touch; none where the spheres are the shapes.
    shapes: Option<Shapes>,
}

/// Obstacles ready to plan among.
#[derive(Clone, Debug)]
pub struct Surroundings {
    pub obstacles: Vec<Obstacle>,
    /// Part by part, with the number of its obstacle.
    parts: Vec<(Pose, Convex)>,
    owners: Vec<usize>,
    /// Whole, for exact answers.
    solids: Vec<clearway_collision::Obstacle>,
    indexed: Obstacles,
    standing: Vec<u16>,
}

impl Surroundings {
    pub fn new(obstacles: Vec<Obstacle>) -> Self {
        let mut pieces = Vec::new();
        let (mut parts, mut owners, mut solids) = (Vec::new(), Vec::new(), Vec::new());
        for (number, obstacle) in obstacles.iter().enumerate() {
            pieces.extend(Piece::of_solid(&obstacle.solid, &obstacle.root_from_solid, number as u32));
            // Tags only choose slots; the robot's come first.
            let tag = ROBOT_TAGS + parts.len();
            solids.push(clearway_collision::Obstacle::new(&obstacle.solid, &obstacle.root_from_solid, tag));
            for (pose, convex) in &obstacle.solid.parts {
                parts.push((obstacle.root_from_solid * *pose, convex.clone()));
                owners.push(number);
            }
        }
        let indexed = Obstacles::new(pieces);
        let mut standing = Vec::new();
        indexed.mask(|_| true, &mut standing);
        Self { obstacles, parts, owners, solids, indexed, standing }
    }
}

/// A path, and what it took.
#[derive(Clone, Debug)]
pub struct Solution {
    pub path: Path,
    pub initial_cost: f64,
    pub cost: f64,
    pub plan: Duration,
    pub simplify: Duration,
}

impl MotionPlanner {
    /// Covers the links with spheres where they are not spheres already.
    pub fn new(group: Group) -> Self {
        let spheres: Vec<Vec<Sphere>> = group.links.iter().map(|l| clearway_robot::cover_link(&l.collision)).collect();
        let shapes = Shapes::of(&group, &spheres);
        let unchecked = unchecked_pairs(&group, &spheres);
        let settings = BodySettings::default();
        let kernel = match shapes {
            Some(_) => Kernel::of_covers(&group, &spheres, unchecked.clone(), &settings),
            None => Kernel::new(Body::new(&group, &spheres, &unchecked, &settings)),
        };
        Self { group, spheres, unchecked, kernel, shapes }
    }

    /// The exact shapes among some obstacles, where spheres only cover them.
    fn among<'a>(&'a self, around: &'a Surroundings, margin: f64) -> Option<Among<'a>> {
        let shapes = self.shapes.as_ref()?;
        Some(Among { group: &self.group, shapes, obstacles: &around.solids, margin })
    }

    /// Why a configuration cannot be an end of a motion, if it cannot: a joint out of its limits, or
    /// a collision, with names.
    pub fn refusal(&self, q: &[f64], around: &Surroundings, margin: f64) -> Option<String> {
        const ROUNDING: f64 = 1e-6;
        if q.len() != self.group.names.len() {
            return Some(format!("{} values for {} joints", q.len(), self.group.names.len()));
        }
        for ((name, v), (low, high)) in
            self.group.names.iter().zip(q).zip(self.group.lower.iter().zip(&self.group.upper))
        {
            if !(*low - ROUNDING..=*high + ROUNDING).contains(v) {
                return Some(format!("joint {name} at {v} is out of its limits, {low} to {high}"));
            }
        }
        let link = |l: usize| &self.group.links[l].name;
        // With the obstacle's number.
        let found = match self.among(around, margin) {
            Some(among) => among.contact(q, &self.unchecked, &mut Scratch::default()),
            None => match contact(&self.group, &self.spheres, &self.unchecked, &around.parts, q, margin) {
                Some(Contact::Obstacle(l, part)) => Some(Contact::Obstacle(l, around.owners[part])),
                found => found,
            },
        };
        Some(match found? {
            Contact::Links(a, b) => format!("in collision: {} touches {}", link(a), link(b)),
            Contact::Obstacle(l, number) => {
                format!("in collision: {} touches {}", link(l), around.obstacles[number].name)
            }
        })
    }

    /// The joint space among some obstacles.
    pub fn space<'a>(&'a self, around: &'a Surroundings, settings: &Settings) -> SphereSpace<'a> {
        let all = Around {
            obstacles: &around.indexed,
            standing: &around.standing,
            margin: settings.margin as f32,
            hand: self.group.hand[0] as f32,
            upright: None,
            never: &[],
        };
        let exact = self.among(around, settings.margin);
        SphereSpace::new(&self.kernel, all, exact, &self.group.lower, &self.group.upper, settings.checks_per_rad)
    }

    /// A path from `start` to one of `goals`, all of them free; `None` when the iterations ran out.
    pub fn plan(
        &self,
        space: &mut SphereSpace,
        start: &[f64],
        goals: &[Posture],
        settings: &Settings,
        trees: &mut Trees,
        budget: &Budget,
    ) -> Result<Option<Solution>, Stop> {
        let started = Instant::now();
        let mut sampler = Halton::near_ends(space, settings.skip, start, goals);
        let Some(path) = connect(space, start, goals, &mut sampler, &settings.rrt, trees, budget)? else {
            return Ok(None);
        };
        let plan = started.elapsed();
        let started = Instant::now();
        let initial_cost = length(&path);
        let path = simplify(space, path, &settings.simplify, budget)?;
        Ok(Some(Solution { cost: length(&path), path, initial_cost, plan, simplify: started.elapsed() }))
    }
}
