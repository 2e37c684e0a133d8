//! Which touches the plan intends, and a record of the others.
//!
//! Intended: the hand's links with the object of the step, except in transit; an object with what carries it where
//! it stands or is put, and while it is held within a centimetre of either place; and what touched before the
//! robot moved.

use crate::outcome::{Thing, ThingKind, Touch};
use crate::world::{Contact, Owner};
use clearway_plan::plan_file::SegmentKind;
use clearway_verify::played::Played;
use parry3d_f64::math::Pose;
use std::collections::{HashMap, HashSet};

/// Depth that counts where nothing gives way, metres.
const TOUCH: f64 = 1e-4;
/// Newtons: less is the solver's noise.
const FEEBLE: f64 = 1e-2;
/// What is held may touch what carried it so near to where it stood, metres.
const NEAR: f64 = 0.01;

/// What is going on while contacts are looked at.
#[derive(Clone, Copy)]
pub(crate) struct Stage<'a> {
    /// From the plan's start, seconds.
    pub time: f64,
    /// `None`: things come to rest.
    pub moving: Option<(usize, usize, SegmentKind)>,
    /// The object of the step.
    pub object: usize,
    pub held: bool,
    /// Where the object of the step stood, and is put, with what carries it there.
    pub ends: [&'a (Pose, Vec<String>); 2],
    pub object_at: Pose,
}

pub(crate) struct Touches<'a> {
    played: &'a Played,
    /// By object: what carries it.
    carried: Vec<Vec<String>>,
    before: HashSet<(Owner, Owner)>,
    found: Vec<Touch>,
    /// Step, segment, and the two: which of `found`.
    known: HashMap<(usize, usize, Owner, Owner), usize>,
    dt: f64,
}

impl<'a> Touches<'a> {
    pub fn new(played: &'a Played, carried: Vec<Vec<String>>, dt: f64) -> Self {
        Self { played, carried, before: HashSet::new(), found: Vec::new(), known: HashMap::new(), dt }
    }

    pub fn put_down(&mut self, object: usize, on: &[String]) {
        on.clone_into(&mut self.carried[object]);
    }

    pub fn found(mut self) -> Vec<Touch> {
        self.found.sort_by(|a, b| a.time.total_cmp(&b.time));
        self.found
    }

    /// One contact of one step of the physics.
    pub fn note(&mut self, contact: &Contact, stage: &Stage) {
        let (first, second) = (contact.first, contact.second);
        let gives = matches!(second, Owner::Object(_));
        if (if gives { contact.force < FEEBLE } else { contact.depth < TOUCH }) || self.intended(first, second, stage) {
            return;
        }
        let Some((step, segment, kind)) = stage.moving else {
            // Standing against each other from the beginning is nobody's doing; coming to it is.
            if matches!((first, second), (Owner::Object(_) | Owner::Fixture(_), Owner::Object(_))) && stage.time < 0.0 {
                self.before.insert((first, second));
            }
            return;
        };
        let index = *self.known.entry((step, segment, first, second)).or_insert_with(|| {
            let thing = |owner| thing(self.played, owner, stage);
            self.found.push(Touch {
                time: stage.time,
                step,
                object: self.played.objects[stage.object].id.clone(),
                segment: kind,
                first: thing(first),
                second: thing(second),
                force: gives.then_some(0.0),
                impulse: gives.then_some(0.0),
                depth: 0.0,
            });
            self.found.len() - 1
        });
        let touch = &mut self.found[index];
        touch.depth = touch.depth.max(contact.depth);
        if let (Some(force), Some(impulse)) = (&mut touch.force, &mut touch.impulse) {
            *force = force.max(contact.force);
            *impulse += contact.force * self.dt;
        }
    }

    fn intended(&self, first: Owner, second: Owner, stage: &Stage) -> bool {
        match (first, second) {
            (Owner::Link(link), Owner::Object(object)) => {
                let transit = stage.moving.is_none_or(|(_, _, kind)| kind == SegmentKind::Transit);
                self.played.links[link].in_hand && object == stage.object && !transit
            }
            (Owner::Fixture(_) | Owner::Object(_), Owner::Object(_)) => {
                self.before.contains(&(first, second))
                    || self.carries(first, second, stage)
                    || self.carries(second, first, stage)
            }
            _ => false,
        }
    }

    /// Whether `below` is what `above` stands on, or may.
    fn carries(&self, below: Owner, above: Owner, stage: &Stage) -> bool {
        let Owner::Object(above) = above else { return false };
        let below = match below {
            Owner::Fixture(i) => &self.played.fixtures[i].id,
            Owner::Object(i) => &self.played.objects[i].id,
            Owner::Link(_) => return false,
        };
        if above != stage.object {
            return self.carried[above].contains(below);
        }
        let near = |end: &Pose| (stage.object_at.translation - end.translation).length() <= NEAR;
        stage.ends.iter().any(|(pose, carriers)| carriers.contains(below) && (!stage.held || near(pose)))
    }
}

fn thing(played: &Played, owner: Owner, stage: &Stage) -> Thing {
    let (kind, id) = match owner {
        Owner::Link(i) => (ThingKind::Link, &played.links[i].name),
        Owner::Fixture(i) => (ThingKind::Fixture, &played.fixtures[i].id),
        Owner::Object(i) if stage.held && i == stage.object => (ThingKind::Held, &played.objects[i].id),
        Owner::Object(i) => (ThingKind::Object, &played.objects[i].id),
    };
    Thing { kind, id: id.clone() }
}
