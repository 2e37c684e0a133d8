//! What certainly has to be moved for a goal in a scene.

use crate::arm::Arm;
use crate::facts::Value;
use crate::necessity::Necessity;
use crate::pddl::TypeId;
use crate::problem::Asked;
use crate::search::NoPlan;
use crate::telling::{Begun, begin, constants};
use clearway_plan::{Budget, ObjectSet};
use clearway_retrieval::handling::Handling;

/// What has to be moved for a goal.
pub struct Needs<'a> {
    pub(crate) asked: &'a Asked<'a>,
    /// Nothing for domains other than the built-in one.
    pub(crate) necessity: Option<Necessity<'a>>,
    pub(crate) names: Vec<String>,
    /// One by one.
    pub(crate) needed: ObjectSet,
}

impl<'a> Needs<'a> {
    pub fn of(asked: &'a Asked<'a>, handling: &mut Handling, budget: &Budget) -> Result<Self, NoPlan> {
        let necessity = necessity(asked, handling, budget).map_err(NoPlan::Engine)?;
        let (names, all) = (handling.scene().names.clone(), handling.scene().all());
        let mut new = Self { asked, necessity, names, needed: ObjectSet::EMPTY };
        new.needed = all.iter().filter(|o| new.forbidden_by(ObjectSet::of(*o))).collect();
        Ok(new)
    }

    /// Whether the goal does not hold as long as none of these is moved.
    pub(crate) fn forbidden_by(&self, unmoved: ObjectSet) -> bool {
        let unmoved = unmoved.names(&self.names);
        let unmoved: Vec<&str> = unmoved.iter().map(String::as_str).collect();
        self.necessity.as_ref().is_some_and(|necessity| necessity.forbids(self.asked.goal, &unmoved))
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
    let (in_place, hand_empty) = (domain.predicate("InPlace"), domain.predicate("HandEmpty"));
    Ok(Some(Necessity {
        domain,
        in_place,
        hand_empty,
        things: constants(domain, handling)?,
        open,
        on,
        supports: supports.collect(),
    }))
}
