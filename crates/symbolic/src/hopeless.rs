//! Goals that are proved to be out of reach: something has to be moved for them that never can be.

use crate::arm::Arm;
use crate::facts::Value;
use crate::necessity::Necessity;
use crate::pddl::TypeId;
use crate::problem::Asked;
use crate::search::NoPlan;
use crate::telling::{Begun, begin, constants};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_retrieval::handling::Handling;

/// What has to be moved for a goal, and what of it cannot be.
pub struct Hopeless<'a> {
    asked: &'a Asked<'a>,
    /// Nothing for domains other than the built-in one.
    necessity: Option<Necessity<'a>>,
    names: Vec<String>,
    /// One by one.
    needed: ObjectSet,
}

impl<'a> Hopeless<'a> {
    pub fn of(asked: &'a Asked<'a>, handling: &mut Handling, budget: &Budget) -> Result<Self, NoPlan> {
        let necessity = necessity(asked, handling, budget).map_err(NoPlan::Engine)?;
        let (names, all) = (handling.scene().names.clone(), handling.scene().all());
        let mut new = Self { asked, necessity, names, needed: ObjectSet::EMPTY };
        new.needed = all.iter().filter(|o| new.forbidden_by(ObjectSet::of(*o))).collect();
        Ok(new)
    }

    /// Whether the goal does not hold as long as none of these is moved.
    fn forbidden_by(&self, unmoved: ObjectSet) -> bool {
        let unmoved = unmoved.names(&self.names);
        let unmoved: Vec<&str> = unmoved.iter().map(String::as_str).collect();
        self.necessity.as_ref().is_some_and(|necessity| necessity.forbids(self.asked.goal, &unmoved))
    }

    /// What has to be moved, and no way to it was found.
    pub fn without_way(&self, handling: &mut Handling, budget: &Budget) -> Result<ObjectSet, Stop> {
        let mut without = ObjectSet::EMPTY;
        for object in self.needed.iter() {
            if handling.has_no_way(object, budget)? {
                without.insert(object);
            }
        }
        Ok(without)
    }

    /// Ends with an error where one of some objects has to be moved and is proved never to be.
    pub fn prove_of(&self, some: ObjectSet, handling: &mut Handling, budget: &Budget) -> Result<(), NoPlan> {
        for object in some.intersection(self.needed).iter() {
            let stuck = handling.proved_stuck(object, budget)?;
            if !stuck.is_empty() {
                let needed = ObjectSet::of(object);
                return Err(NoPlan::Stuck { needed, others: stuck.difference(needed) });
            }
        }
        Ok(())
    }

    /// The same of whatever cannot be moved, be it one thing or several of which one has to be.
    pub fn prove(&self, handling: &mut Handling, budget: &Budget) -> Result<(), NoPlan> {
        if self.necessity.is_none() {
            return Ok(());
        }
        let suspects = handling.seem_stuck(budget)?;
        self.prove_of(suspects, handling, budget)?;
        let mut stuck = ObjectSet::EMPTY;
        for object in suspects.iter() {
            if !handling.proved_stuck(object, budget)?.is_empty() {
                stuck.insert(object);
            }
        }
        if !self.forbidden_by(stuck) {
            return Ok(());
        }
        let without = |set: ObjectSet, object: ObjectId| set.difference(ObjectSet::of(object));
        // Those that do not matter for it are not told.
        let needed = stuck.iter().fold(stuck, |needed, object| {
            let fewer = without(needed, object);
            if self.forbidden_by(fewer) { fewer } else { needed }
        });
        Err(NoPlan::Stuck { needed, others: ObjectSet::EMPTY })
    }
}

fn necessity<'a>(
    asked: &'a Asked<'a>,
    handling: &mut Handling,
    budget: &Budget,
) -> Result<Option<Necessity<'a>>, String> {
    let Asked { domain, streams, goal, retrieval, .. } = *asked;
    let (Some(on), true) = (domain.predicate("On"), *domain == crate::domain()) else { return Ok(None) };
    let all = handling.scene().all();
    let mut arm = Arm::new(handling, ObjectSet::EMPTY, budget);
    let Begun { values, state, .. } = begin(domain, goal, &mut arm, all, retrieval)?;
    let name = |value: &Value| values.name(*value).to_owned();
    let supports = state.iter().filter(|fact| fact.predicate == on).filter_map(|fact| match fact.values.as_slice() {
        [above, below] => Some((name(above), name(below))),
        _ => None,
    });
    let open: Vec<TypeId> = streams.iter().flat_map(|s| s.outputs.iter().map(|output| output.of)).collect();
    Ok(Some(Necessity { domain, things: constants(domain, handling)?, open, on, supports: supports.collect() }))
}
