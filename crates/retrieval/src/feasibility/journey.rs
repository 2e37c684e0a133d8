//! Motions for objects that can be picked in a given order.

use super::{Feasibility, NoPush, Taking};
use crate::carry::{Carried, Carrier, Obstruction, Situation};
use crate::mobile::bring::Elsewhere;
use crate::push::Pushes;
use clearway_plan::plan_file::{Action, Segment, Timing};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::time::{Duration, Instant};

/// Motions planned so far, and what they are planned with.
pub struct Journey {
    pub(super) random: Xoshiro256PlusPlus,
    pub(crate) carried: Vec<Carried>,
    /// Of each object looked at, why it is not pushed.
    pub(crate) not_pushed: Vec<(ObjectId, NoPush)>,
    /// The last motion that could not be had.
    pub(crate) obstruction: Option<(ObjectId, &'static str)>,
    /// Spent on motions.
    spent: Duration,
}

impl Journey {
    pub fn new(seed: u64) -> Self {
        let random = Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x4d6f_7665);
        Self { random, carried: Vec::new(), not_pushed: Vec::new(), obstruction: None, spent: Duration::ZERO }
    }

    /// Counts the time that motions of another journey took.
    pub fn took_as_well(&mut self, other: &Self) {
        self.spent += other.spent;
    }

    /// What motions took so far.
    pub fn moving(&self) -> Duration {
        self.spent
    }

    /// Of planning that took so long in all.
    pub fn timing(&self, total: Duration) -> Timing {
        Timing {
            total: total.as_secs_f64(),
            task: total.saturating_sub(self.spent).as_secs_f64(),
            motion: self.spent.as_secs_f64(),
        }
    }
}

/// An object that could be picked, but no motion was found.
#[derive(Clone, Debug)]
pub struct NoMotion {
    pub object: ObjectId,
    pub removed: ObjectSet,
    /// Each with `removed`: rid of all of one, one of the ways tried may do.
    pub blamed: Vec<ObjectSet>,
}

/// What carries objects at a stand; a macro, for it borrows only some of the fields.
macro_rules! carrier {
    ($self:ident, $stand:expr, $before:ident, $journey:ident, $budget:ident) => {
        Carrier {
            world: &$self.stands[$stand].world,
            base: $before.base.clone(),
            within: None,
            scene: &$self.scene,
            inverse: &$self.inverse,
            settings: &$self.carrying,
            random: &mut $journey.random,
            budget: $budget,
            trees: &mut $self.trees,
            quicker_than: f64::INFINITY,
        }
    };
}

pub(super) use carrier;

impl Feasibility {
    /// Plans the motions for objects that can all be picked in this order, steps of the journey that
    /// begin alike kept; `taken` hears of each new one.
    pub fn carry(
        &mut self,
        objects: &[ObjectId],
        journey: &mut Journey,
        budget: &Budget,
        mut taken: impl FnMut(&str),
    ) -> Result<Result<(), NoMotion>, Stop> {
        match self.carry_all(objects, self.pushing.when, journey, budget, &mut taken)? {
            Err(_) if journey.carried.iter().any(pushed) => {
                // What was pushed may be what stands in the way.
                let first = journey.carried.iter().position(pushed).unwrap_or_default();
                journey.carried.truncate(first);
                self.carry_all(objects, Pushes::Never, journey, budget, &mut taken)
            }
            outcome => Ok(outcome),
        }
    }

    fn carry_all(
        &mut self,
        objects: &[ObjectId],
        pushes: Pushes,
        journey: &mut Journey,
        budget: &Budget,
        taken: &mut impl FnMut(&str),
    ) -> Result<Result<(), NoMotion>, Stop> {
        let names = self.scene.names.clone();
        let kept = journey.carried.iter().zip(objects).take_while(|(c, o)| c.step.object == names[o.index()]).count();
        journey.carried.truncate(kept);
        let stops = self.stops_for(objects, journey, budget)?;
        for (i, &object) in objects.iter().enumerate().skip(kept) {
            let removed: ObjectSet = objects[..i].iter().copied().collect();
            let began = Instant::now();
            let fallen = self.scene.fallen(self.scene.all().difference(removed.with(object)));
            if !fallen.is_empty() {
                journey.obstruction = Some((object, "taking it from under what would fall"));
                return Ok(Err(NoMotion { object, removed, blamed: vec![fallen.union(removed)] }));
            }
            let carried = self.push_or_carry(&objects[i..], &removed, stops[i - kept], pushes, journey, budget);
            journey.spent += began.elapsed();
            match carried? {
                Ok(carried) => {
                    taken(&names[object.index()]);
                    journey.carried.push(carried);
                }
                Err(blamed) => {
                    // Rid of what stood in the way, one of the ways tried may do.
                    let blamed = blamed.into_iter().map(|b| b.union(removed)).collect();
                    return Ok(Err(NoMotion { object, removed, blamed }));
                }
            }
        }
        Ok(Ok(()))
    }

    pub(super) fn situation(&self, journey: &Journey) -> Situation {
        journey.carried.last().map_or_else(|| self.start_situation(), |carried| carried.after.clone())
    }

    /// How things are before anything is done.
    pub(crate) fn start_situation(&self) -> Situation {
        Situation {
            stand: 0,
            base: self.base.as_ref().map_or(Vec::new(), |base| base.start.to_vec()),
            posture: self.start.clone(),
            standing: self.scene.all(),
            placed: Vec::new(),
            pushed: Vec::new(),
        }
    }

    /// The first of some objects pushed aside, so that the others can be taken, or picked and put down. The pick is
    /// looked at along its first way, and to the first spot, before it is given up as slower.
    fn push_or_carry(
        &mut self,
        objects: &[ObjectId],
        removed: &ObjectSet,
        stop: usize,
        pushes: Pushes,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<Carried, Vec<ObjectSet>>, Stop> {
        let (object, later) = (objects[0], &objects[1..]);
        if pushes == Pushes::Never || object == self.scene.target {
            return self.carry_one(object, removed, stop, f64::INFINITY, journey, budget);
        }
        let before = self.situation(journey);
        journey.not_pushed.retain(|(o, _)| *o != object);
        let pushed = match self.push_aside(stop, object, removed, later, &before, journey, budget)? {
            Ok(pushed) if pushes == Pushes::Prefer => return Ok(Ok(pushed)),
            Ok(pushed) => pushed,
            Err(reason) => {
                // Where nothing is ever pushed there is nothing to tell, unless it was asked for.
                if pushes == Pushes::Prefer || !reason.is_of_scene() {
                    journey.not_pushed.push((object, reason));
                }
                return self.carry_one(object, removed, stop, f64::INFINITY, journey, budget);
            }
        };
        let lasts = pushed.step.duration();
        match self.carry_one(object, removed, stop, lasts, journey, budget)? {
            Ok(carried) if carried.step.duration() <= lasts => {
                journey.not_pushed.push((object, NoPush::Slower));
                Ok(Ok(carried))
            }
            _ => Ok(Ok(pushed)),
        }
    }

    /// One object's motion along one of its free ways, from a stand if it can be, given up if it surely lasts as long
    /// as `quicker_than`; on failure what was blamed.
    fn carry_one(
        &mut self,
        object: ObjectId,
        removed: &ObjectSet,
        stop: usize,
        quicker_than: f64,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<Carried, Vec<ObjectSet>>, Stop> {
        let before = self.situation(journey);
        let mut stops = vec![stop];
        if self.stands.len() > 1 {
            let others = (0..self.stands.len()).filter(|&s| s != stop);
            stops.extend(others.filter(|&s| self.stands[s].ways[object.index()].is_some()));
        }
        let mut blamed = Vec::new();
        for stop in stops {
            match self.carry_from(stop, object, removed, &before, quicker_than, journey, budget)? {
                Ok(carried) => return Ok(Ok(carried)),
                Err(sets) => blamed.extend(sets),
            }
        }
        Ok(Err(ObjectSet::minimal(blamed)))
    }

    /// The same from one stand, to which a mobile base drives if it is not there.
    #[allow(clippy::too_many_arguments)]
    fn carry_from(
        &mut self,
        stop: usize,
        object: ObjectId,
        removed: &ObjectSet,
        before: &Situation,
        quicker_than: f64,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<Carried, Vec<ObjectSet>>, Stop> {
        const WAYS_TRIED: usize = 5;
        // The target comes last; then the arm goes home.
        let last = self.homing && object == self.scene.target;
        let mut blamed = Vec::new();
        if self.free_ways_from(stop, object, removed, 1, budget)?.is_empty() {
            return Ok(Err(blamed));
        }
        let mut driven = Vec::new();
        let mut before = before.clone();
        if stop != before.stand {
            match self.drive_to(stop, &before, journey, budget)? {
                Ok((segments, there)) => (driven, before) = (segments, there),
                Err(obstruction) => {
                    journey.obstruction = Some((object, obstruction.what));
                    return Ok(Err(Some(obstruction.blamed).filter(|b| !b.is_empty()).into_iter().collect()));
                }
            }
        }
        for tried in 0..WAYS_TRIED {
            // Those that failed least come first.
            let candidates = self.free_ways_from(stop, object, removed, tried + 1, budget)?;
            let (Some(&Taking { way: index, .. }), true) = (candidates.first(), candidates.len() > tried) else {
                break;
            };
            let order = self.put_down_at(stop).into_iter().filter(|&s| s != stop).collect();
            let Some(ways) = self.stands[stop].ways[object.index()].take() else { break };
            let elsewhere = self.base.as_deref().filter(|base| base.settings.drives).map(|base| Elsewhere {
                base,
                stands: &self.stands,
                order,
            });
            let mut carrier = Carrier { quicker_than, ..carrier!(self, stop, before, journey, budget) };
            let way = &ways.ways[index];
            let taken = carrier.take(object, &ways.grasps[way.grasp], way, &before, last, elsewhere.as_ref());
            let ways = self.stands[stop].ways[object.index()].insert(ways);
            match taken? {
                Ok(mut carried) => {
                    ways.ways[index].failures = 0;
                    carried.step.segments.splice(0..0, driven);
                    return Ok(Ok(carried));
                }
                Err(obstruction) if obstruction.slower => return Ok(Err(blamed)),
                Err(obstruction) => {
                    ways.ways[index].failures += 1;
                    journey.obstruction = Some((object, obstruction.what));
                    if !obstruction.blamed.is_empty() {
                        blamed.push(obstruction.blamed);
                    }
                }
            }
        }
        Ok(Err(blamed))
    }

    /// To another stand, the arm at rest.
    #[allow(clippy::type_complexity)]
    fn drive_to(
        &mut self,
        stop: usize,
        before: &Situation,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<(Vec<Segment>, Situation), Obstruction>, Stop> {
        let Some(base) = &self.base else { return Ok(Ok((Vec::new(), before.clone()))) };
        let mut carrier = carrier!(self, before.stand, before, journey, budget);
        let mut segments = match carrier.tuck(before)? {
            Ok(segments) => segments,
            Err(obstruction) => return Ok(Err(obstruction)),
        };
        let home = self.stands[stop].world.model.robot.home.clone();
        match base.drive(&mut carrier, before, &self.stands[stop].placement, &home, None)? {
            Ok(drive) => {
                let base = drive.positions.last().map_or(Vec::new(), |row| row[..before.base.len()].to_vec());
                carrier.base.clear();
                segments.push(carrier.transit(drive));
                Ok(Ok((segments, Situation { stand: stop, base, posture: home, ..before.clone() })))
            }
            Err(obstruction) => Ok(Err(obstruction)),
        }
    }
}

fn pushed(carried: &Carried) -> bool {
    carried.step.action == Action::Push
}
