//! The streams of pick-and-place over the arm: grasps, placements, inverse kinematics, collision tests, motions.
//!
//! A collision test costs a look into a set: what stands in a way is found once, over all objects where the scene
//! has them. Placements are sought where nothing stands and nothing else was put as yet; poses that something is
//! in the way of come after those.

use crate::facts::{Fact, Value, Values};
use crate::pddl::{Provided, Stream, TypeId};
use crate::store::Procedures;
use clearway_geometry::Pose;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_retrieval::carry::Carried;
use clearway_retrieval::grasps::Grasp;
use clearway_retrieval::handling::{Bring, Handling, Surface};
use clearway_retrieval::ways::Way;
use std::collections::{HashMap, VecDeque};
use std::time::{Duration, Instant};

/// The streams that there are.
pub const PROVIDED: [Provided; 7] = [
    Provided { name: "sample-grasp", inputs: 1, outputs: 1 },
    Provided { name: "sample-placement", inputs: 3, outputs: 1 },
    Provided { name: "sample-stacking", inputs: 4, outputs: 1 },
    Provided { name: "inverse-kinematics", inputs: 3, outputs: 1 },
    Provided { name: "plan-motion", inputs: 6, outputs: 1 },
    Provided { name: "test-cfree-way", inputs: 3, outputs: 0 },
    Provided { name: "test-cfree-pose", inputs: 4, outputs: 0 },
];

/// What names of values begin with that no file can name.
pub(crate) const GENERATED: char = '\0';

/// Candidates looked at for one placement before one that something stands in the way of will do.
const CANDIDATES: usize = 40;

/// Ways that nothing stands in, after which no more are looked for at first.
const ENOUGH: usize = 3;

/// An object in the way of a placement is as bad as this placement being in the way of so many others, which may be
/// put down before it.
const HINDERED: usize = 100;

/// What a value is.
#[derive(Clone, Debug)]
pub enum Thing {
    Item(ObjectId),
    Surface(Surface),
    Grasp(Grasp),
    Pose(ObjectId, Pose),
    Way { object: ObjectId, at: Pose, grasp: Grasp, way: Box<Way> },
}

/// Placements of one object, held in one way, on one surface.
#[derive(Default)]
struct Placements {
    candidates: std::vec::IntoIter<Pose>,
    /// Those that something stands in the way of now, by how many objects, each with a way to it.
    blocked: Vec<(usize, Pose, Way)>,
}

/// Ways to an object that stands and is held like this: how many were given out, and those left, as far as they were looked for.
#[derive(Default)]
struct WaysGiven {
    count: usize,
    left: VecDeque<Way>,
    looked: bool,
    all: bool,
}

/// A pose given out, with a way to it.
struct Given {
    object: ObjectId,
    at: Pose,
    grasp: Grasp,
    way: Way,
}

/// The arm as streams see it.
pub struct Arm<'b> {
    pub handling: &'b mut Handling,
    /// Objects that stay where the scene has them.
    fixed: ObjectSet,
    budget: &'b Budget,
    things: HashMap<Value, Thing>,
    grasps: HashMap<Value, std::vec::IntoIter<Grasp>>,
    placements: HashMap<Vec<Value>, Placements>,
    ways: HashMap<Vec<Value>, WaysGiven>,
    given: Vec<Given>,
    /// By object: the fixed ones in each of its ways at home, as far as there are any.
    blamed: HashMap<ObjectId, Vec<ObjectSet>>,
    /// Objects with a way at home that no fixed one is in.
    free: ObjectSet,
    /// By object: what stood in the way of motions with it.
    obstructed: HashMap<ObjectId, Vec<ObjectSet>>,
    /// Motions planned, each with the stream's inputs.
    carried: Vec<(Vec<Value>, Carried)>,
    /// How many of them the plan that is being carried out has used.
    used: usize,
    /// Spent on motions.
    pub moving: Duration,
}

impl<'b> Arm<'b> {
    pub fn new(handling: &'b mut Handling, fixed: ObjectSet, budget: &'b Budget) -> Self {
        Self {
            handling,
            fixed,
            budget,
            things: HashMap::new(),
            grasps: HashMap::new(),
            placements: HashMap::new(),
            ways: HashMap::new(),
            given: Vec::new(),
            blamed: HashMap::new(),
            free: ObjectSet::EMPTY,
            obstructed: HashMap::new(),
            carried: Vec::new(),
            used: 0,
            moving: Duration::ZERO,
        }
    }

    /// Says what a value is.
    pub fn know(&mut self, value: Value, thing: Thing) {
        self.things.insert(value, thing);
    }

    /// The motions of the plan carried out last.
    pub fn into_carried(self) -> Vec<Carried> {
        self.carried.into_iter().take(self.used).map(|(_, carried)| carried).collect()
    }

    /// The sets of objects of which one would have to go for an object to be had, or brought where it should;
    /// `None` when nothing speaks against it.
    pub fn blamed(&self, object: ObjectId) -> Option<Vec<ObjectSet>> {
        let at_home = self.blamed.get(&object).filter(|_| !self.free.contains(object));
        let sets = at_home.or_else(|| self.obstructed.get(&object))?;
        Some(ObjectSet::minimal(sets.iter().filter(|s| s.intersects(&self.fixed)).copied().collect()))
    }

    fn object(&self, value: Value) -> Option<ObjectId> {
        match self.things.get(&value)? {
            Thing::Item(object) => Some(*object),
            _ => None,
        }
    }

    fn pose(&self, value: Value) -> Option<Pose> {
        match self.things.get(&value)? {
            Thing::Pose(_, pose) => Some(*pose),
            _ => None,
        }
    }

    fn grasp(&self, value: Value) -> Option<Grasp> {
        match self.things.get(&value)? {
            Thing::Grasp(grasp) => Some(grasp.clone()),
            _ => None,
        }
    }

    fn way(&self, value: Value) -> Option<Way> {
        match self.things.get(&value)? {
            Thing::Way { way, .. } => Some((**way).clone()),
            _ => None,
        }
    }

    fn next_grasp(&mut self, inputs: &[Value]) -> Result<Option<Thing>, Stop> {
        let Some(object) = self.object(inputs[0]) else { return Ok(None) };
        if !self.grasps.contains_key(&inputs[0]) {
            let grasps = self.handling.grasps(object, self.budget)?;
            self.grasps.insert(inputs[0], grasps.into_iter());
        }
        Ok(self.grasps.get_mut(&inputs[0]).and_then(Iterator::next).map(Thing::Grasp))
    }

    fn next_pose(&mut self, inputs: &[Value], surface: Surface) -> Result<Option<Thing>, Stop> {
        let (Some(object), Some(grasp)) = (self.object(inputs[0]), self.grasp(inputs[1])) else { return Ok(None) };
        let mut placements = match self.placements.remove(inputs) {
            Some(known) => known,
            None => {
                Placements { candidates: self.handling.spots(object, &grasp, surface).into_iter(), blocked: Vec::new() }
            }
        };
        let mut looked = 0;
        let found = loop {
            self.budget.check()?;
            let Some(at) = placements.candidates.next().filter(|_| looked < CANDIDATES) else {
                let least = (0..placements.blocked.len()).min_by_key(|i| placements.blocked[*i].0);
                match least {
                    Some(least) => break Some(placements.blocked.remove(least)),
                    None if placements.candidates.len() == 0 => break None,
                    None => {
                        looked = 0;
                        continue;
                    }
                }
            };
            if !self.handling.may_stand(object, &at, surface) {
                continue;
            }
            let home: Vec<(ObjectId, Pose)> = {
                let scene = self.handling.scene();
                scene.all().iter().filter(|o| *o != object).map(|o| (o, scene.objects[o.index()].pose)).collect()
            };
            let meets =
                |(other, other_at): &&(ObjectId, Pose)| self.handling.overlap((object, &at), (*other, other_at));
            if home.iter().filter(|(o, _)| self.fixed.contains(*o)).any(|other| meets(&other)) {
                continue;
            }
            let overlapped = home.iter().filter(meets).count();
            looked += 1;
            let ways = self.handling.ways(object, &at, &grasp, 1);
            let Some(way) = ways.into_iter().find(|w| !w.blocked_by.intersects(&self.fixed)) else { continue };
            let (hindered, hinders) = self.conflicts(object, &at, &grasp, &way);
            let conflicts = HINDERED * (way.blocked_by.len() + overlapped + hindered) + hinders;
            placements.blocked.push((conflicts, at, way));
            if conflicts == 0 {
                break placements.blocked.pop();
            }
        };
        self.placements.insert(inputs.to_vec(), placements);
        let Some((_, at, way)) = found else { return Ok(None) };
        self.given.push(Given { object, at, grasp, way });
        Ok(Some(Thing::Pose(object, at)))
    }

    /// How many of the poses given out to other objects are in the way of this one, and of how many of those it
    /// would be in the way.
    fn conflicts(&mut self, object: ObjectId, at: &Pose, grasp: &Grasp, way: &Way) -> (usize, usize) {
        let Self { handling, given, .. } = self;
        let mut count = (0, 0);
        for other in given.iter().filter(|other| other.object != object) {
            if handling.overlap((object, at), (other.object, &other.at))
                || handling.in_way((object, at, grasp, way), other.object, &other.at)
            {
                count.0 += 1;
            } else if handling.in_way((other.object, &other.at, &other.grasp, &other.way), object, at) {
                count.1 += 1;
            }
        }
        count
    }

    fn next_way(&mut self, inputs: &[Value]) -> Option<Thing> {
        let (object, at, grasp) = (self.object(inputs[0])?, self.pose(inputs[1])?, self.grasp(inputs[2])?);
        let mut given = self.ways.remove(inputs).unwrap_or_default();
        while given.left.is_empty() && !given.all {
            // A few first; all of them when those are spent.
            given.all = given.looked;
            given.looked = true;
            let ways = self.handling.ways(object, &at, &grasp, if given.all { usize::MAX } else { ENOUGH });
            given.all |= ways.len() < ENOUGH;
            let (open, shut): (Vec<Way>, Vec<Way>) =
                ways.into_iter().partition(|w| !w.blocked_by.intersects(&self.fixed));
            if at == self.handling.scene().objects[object.index()].pose {
                self.blamed.entry(object).or_default().extend(shut.iter().map(|w| w.blocked_by));
                if !open.is_empty() {
                    self.free.insert(object);
                }
            }
            given.left = open.into_iter().skip(given.count).collect();
        }
        let way = given.left.pop_front();
        given.count += usize::from(way.is_some());
        self.ways.insert(inputs.to_vec(), given);
        Some(Thing::Way { object, at, grasp, way: Box::new(way?) })
    }
}

impl Procedures for Arm<'_> {
    fn next(&mut self, stream: &Stream, inputs: &[Value], values: &mut Values) -> Result<Option<Vec<Value>>, Stop> {
        let found = match stream.name.as_str() {
            "sample-grasp" => self.next_grasp(inputs)?,
            "sample-placement" => match self.things.get(&inputs[2]) {
                Some(Thing::Surface(surface)) => {
                    let surface = *surface;
                    self.next_pose(inputs, surface)?
                }
                _ => None,
            },
            "sample-stacking" => match (self.object(inputs[2]), self.pose(inputs[3])) {
                (Some(below), Some(at)) => self.next_pose(inputs, Surface::Object(below, at))?,
                _ => None,
            },
            "inverse-kinematics" => self.next_way(inputs),
            _ => None,
        };
        let (Some(thing), Some(output)) = (found, stream.outputs.first()) else { return Ok(None) };
        let name = format!("{GENERATED}{}-{}{}", values.name(inputs[0]), &output.name[1..], self.things.len());
        let value = values.add(&name, output.of);
        self.know(value, thing);
        Ok(Some(vec![value]))
    }

    fn none(&self, stream: &Stream, inputs: &[Value]) -> bool {
        stream.name == "sample-grasp" && self.object(inputs[0]).is_none_or(|object| self.fixed.contains(object))
    }

    fn test(&mut self, stream: &Stream, inputs: &[Value]) -> bool {
        match stream.name.as_str() {
            "test-cfree-way" => {
                let (Some(other), Some(other_at)) = (self.object(inputs[1]), self.pose(inputs[2])) else {
                    return false;
                };
                let Some(Thing::Way { object, at, grasp, way }) = self.things.get(&inputs[0]) else { return false };
                *object == other || !self.handling.in_way((*object, at, grasp, way), other, &other_at)
            }
            "test-cfree-pose" => {
                let (Some(object), Some(at)) = (self.object(inputs[0]), self.pose(inputs[1])) else { return false };
                let (Some(other), Some(other_at)) = (self.object(inputs[2]), self.pose(inputs[3])) else {
                    return false;
                };
                object == other || !self.handling.overlap((object, &at), (other, &other_at))
            }
            _ => false,
        }
    }

    fn begin(&mut self) {
        self.used = 0;
    }

    fn in_state(&mut self, _: &Stream, inputs: &[Value], _: &[Fact]) -> Result<bool, Stop> {
        if self.carried.get(self.used).is_some_and(|(known, _)| known == inputs) {
            self.used += 1;
            return Ok(true);
        }
        self.carried.truncate(self.used);
        let &[object, grasp, p1, from, p2, to] = inputs else { return Ok(false) };
        let bring = (|| {
            Some(Bring {
                object: self.object(object)?,
                grasp: self.grasp(grasp)?,
                from: (self.pose(p1)?, self.way(from)?),
                to: (self.pose(p2)?, self.way(to)?),
            })
        })();
        let Some(bring) = bring else { return Ok(false) };
        let before = self.carried.last().map_or_else(|| self.handling.start(), |(_, carried)| carried.after.clone());
        let began = Instant::now();
        let carried = self.handling.bring(&bring, &before, self.budget)?;
        self.moving += began.elapsed();
        let carried = match carried {
            Ok(carried) => carried,
            Err(obstruction) => {
                self.obstructed.entry(bring.object).or_default().push(obstruction.blamed);
                return Ok(false);
            }
        };
        self.carried.push((inputs.to_vec(), carried));
        self.used += 1;
        Ok(true)
    }

    /// The arm goes home.
    fn end(&mut self) -> Result<bool, Stop> {
        self.carried.truncate(self.used);
        let Some((_, last)) = self.carried.last_mut() else { return Ok(true) };
        let began = Instant::now();
        let home = self.handling.go_home(last, self.budget);
        self.moving += began.elapsed();
        home
    }
}

/// Names the type that a domain has for something, or says which is missing.
pub(crate) fn type_named(domain: &crate::pddl::Domain, name: &str) -> Result<TypeId, String> {
    domain.types.named(name).ok_or_else(|| format!("the domain has no type `{name}`, which the scene's things are of"))
}
