//! A scene told in facts: what there is, where it stands and what it stands on.

use crate::arm::{Arm, GENERATED, Thing, type_named};
use crate::facts::{Fact, Facts, Value, Values};
use crate::pddl::{Constant, Domain, Formula, Goal, PredicateId, Stream, Term, Types};
use clearway_geometry::Pose;
use clearway_plan::{ObjectId, ObjectSet};
use clearway_retrieval::handling::{Handling, Surface};

/// What a scene's things are called in PDDL, and their types.
pub fn constants(domain: &Domain, handling: &Handling) -> Result<Vec<Constant>, String> {
    let scene = handling.scene();
    let (item, place, shelf) =
        (type_named(domain, "item")?, type_named(domain, "place")?, type_named(domain, "shelf")?);
    let shelf_names = handling.shelves().into_iter().map(|i| &scene.fixtures[i].id);
    let names: Vec<&String> = scene.names.iter().chain(scene.places.iter().map(|p| &p.id)).chain(shelf_names).collect();
    if let Some((_, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        return Err(format!(
            "the scene gives the name `{name}` to two of its objects, places and shelves, which a goal could not tell apart"
        ));
    }
    let items = scene.names.iter().map(|name| Constant { name: name.clone(), of: item });
    let places = scene.places.iter().map(|p| Constant { name: p.id.clone(), of: place });
    let shelves = handling.shelves().into_iter().map(|i| Constant { name: scene.fixtures[i].id.clone(), of: shelf });
    Ok(items.chain(places).chain(shelves).collect())
}

/// A scene in facts.
pub struct Begun {
    pub values: Values,
    /// Static.
    pub facts: Facts,
    /// What changes.
    pub state: Vec<Fact>,
}

/// The predicates with which a scene is told.
struct Vocabulary {
    home: PredicateId,
    pose: PredicateId,
    supported: PredicateId,
    rests: PredicateId,
    surface: PredicateId,
    stackable: PredicateId,
    at_pose: PredicateId,
    on: PredicateId,
    hand_empty: PredicateId,
}

impl Vocabulary {
    fn of(domain: &Domain) -> Result<Self, String> {
        let predicate = |name: &str, count: usize| {
            let found = domain.predicate(name).filter(|p| domain.predicates[p.0].parameters.len() == count);
            found.ok_or_else(|| {
                format!("the domain has no predicate `{name}` of {count} arguments, with which the scene is told")
            })
        };
        Ok(Self {
            home: predicate("Home", 2)?,
            pose: predicate("Pose", 2)?,
            supported: predicate("Supported", 3)?,
            rests: predicate("Rests", 4)?,
            surface: predicate("Surface", 1)?,
            stackable: predicate("Stackable", 2)?,
            at_pose: predicate("AtPose", 2)?,
            on: predicate("On", 2)?,
            hand_empty: predicate("HandEmpty", 0)?,
        })
    }
}

/// Whether a domain has what a scene is told with, and goes together with its streams.
pub fn check(domain: &Domain, streams: &[Stream]) -> Result<(), String> {
    ["item", "place", "shelf", "pose"].into_iter().try_for_each(|name| type_named(domain, name).map(|_| ()))?;
    if let Some(stream) = streams.iter().find(|s| (s.name == "plan-motion") == s.fluents.is_empty()) {
        let needs = if stream.fluents.is_empty() { "needs" } else { "has no use for" };
        return Err(format!("the stream `{}` {needs} `:fluents`: motions are planned in a state", stream.name));
    }
    // What streams find is asked for where an action plainly needs it, and nowhere else.
    let found = streams.iter().filter(|s| !s.outputs.is_empty()).flat_map(|s| s.certified.iter().map(|a| a.predicate));
    let found: Vec<PredicateId> = found.collect();
    let hidden = |formula: &Formula| hidden(formula, true, &found).map(|p| domain.predicates[p.0].name.clone());
    let told = |name: String, whose: String| {
        format!(
            "`{name}`, which a stream certifies, is under `or`, `exists` or in a derived predicate of {whose}: it must be a plain part of an action's `and`"
        )
    };
    for action in &domain.actions {
        let formulas = std::iter::once(&action.precondition).chain(action.effects.iter().map(|e| &e.condition));
        if let Some(name) = formulas.filter_map(&hidden).next() {
            return Err(told(name, format!("the action `{}`", action.name)));
        }
    }
    for derived in &domain.derived {
        if let Some(predicate) = anywhere(&derived.body, &found) {
            return Err(told(
                domain.predicates[predicate.0].name.clone(),
                format!("`{}`", domain.predicates[derived.predicate.0].name),
            ));
        }
    }
    Vocabulary::of(domain).map(|_| ())
}

/// Whether a goal asks for nothing that only streams know.
pub fn check_goal(domain: &Domain, streams: &[Stream], goal: &Goal) -> Result<(), String> {
    let found: Vec<PredicateId> = streams.iter().flat_map(|s| s.certified.iter().map(|a| a.predicate)).collect();
    match anywhere(&goal.formula, &found) {
        Some(predicate) => {
            Err(format!("the goal asks for `{}`, which streams certify", domain.predicates[predicate.0].name))
        }
        None => Ok(()),
    }
}

/// A predicate of `found` that a formula asks for otherwise than plainly; guards, as the antecedent of `imply`, are none.
fn hidden(formula: &Formula, plain: bool, found: &[PredicateId]) -> Option<PredicateId> {
    match formula {
        Formula::And(parts) => parts.iter().find_map(|p| hidden(p, plain, found)),
        Formula::Or(parts) => parts.iter().find_map(|p| hidden(p, false, found)),
        Formula::Forall(_, inner) | Formula::Exists(_, inner) => hidden(inner, false, found),
        Formula::Atom(atom) if !plain => found.contains(&atom.predicate).then_some(atom.predicate),
        Formula::Not(_) | Formula::Atom(_) | Formula::Equal(..) => None,
    }
}

/// A predicate of `found` anywhere in a formula.
fn anywhere(formula: &Formula, found: &[PredicateId]) -> Option<PredicateId> {
    match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().find_map(|p| anywhere(p, found)),
        Formula::Not(inner) | Formula::Forall(_, inner) | Formula::Exists(_, inner) => anywhere(inner, found),
        Formula::Atom(atom) => found.contains(&atom.predicate).then_some(atom.predicate),
        Formula::Equal(..) => None,
    }
}

/// Tells of some objects. With `retrieval` nothing is put down but on places.
pub fn begin(
    domain: &Domain,
    goal: &Goal,
    arm: &mut Arm,
    objects: ObjectSet,
    retrieval: bool,
) -> Result<Begun, String> {
    let Vocabulary { home, pose, supported, rests, surface, stackable, at_pose, on, hand_empty } =
        Vocabulary::of(domain)?;
    let of_pose = type_named(domain, "pose")?;
    let mut values = Values::default();
    for constant in &domain.constants {
        values.add(&constant.name, constant.of);
    }
    let constants = constants(domain, arm.handling)?;
    let scene = arm.handling.scene().clone();
    let mut facts = Facts::default();
    let mut state = vec![Fact { predicate: hand_empty, values: Vec::new() }];
    let fact = |predicate: PredicateId, values: &[Value]| Fact { predicate, values: values.to_vec() };
    let named = |values: &mut Values, name: &str| -> Value {
        let of = constants.iter().find(|c| c.name == name).map_or(Types::OBJECT, |c| c.of);
        values.add(name, of)
    };
    let items: Vec<(ObjectId, Value, Value)> = objects
        .iter()
        .map(|object| {
            let name = &scene.names[object.index()];
            let item = named(&mut values, name);
            let at = values.add(&format!("{GENERATED}{name}-home"), of_pose);
            arm.know(item, Thing::Item(object));
            arm.know(at, Thing::Pose(object, scene.objects[object.index()].pose));
            (object, item, at)
        })
        .collect();
    let places: Vec<Value> = (0..scene.places.len())
        .map(|index| {
            let value = named(&mut values, &scene.places[index].id);
            arm.know(value, Thing::Surface(Surface::Place(index)));
            facts.insert(fact(surface, &[value]));
            value
        })
        .collect();
    let shelves: Vec<(usize, Value)> = arm
        .handling
        .shelves()
        .into_iter()
        .map(|index| {
            let value = named(&mut values, &scene.fixtures[index].id);
            arm.know(value, Thing::Surface(Surface::Fixture(index)));
            if !retrieval {
                facts.insert(fact(surface, &[value]));
            }
            (index, value)
        })
        .collect();
    let poses: Vec<(ObjectId, Pose)> = items.iter().map(|(o, ..)| (*o, scene.objects[o.index()].pose)).collect();
    for (object, item, at) in &items {
        facts.insert(fact(home, &[*item, *at]));
        facts.insert(fact(pose, &[*item, *at]));
        state.push(fact(at_pose, &[*item, *at]));
        let where_it_is = &scene.objects[object.index()].pose;
        let under = arm.handling.rests(*object, where_it_is, &poses);
        // A place is named for itself, not for the fixture below it, as it is for what is put there later.
        let mut supports: Vec<Value> =
            arm.handling.places_under(*object, where_it_is).into_iter().map(|i| places[i]).collect();
        if supports.is_empty() {
            supports.extend(shelves.iter().filter(|(i, _)| under.fixtures.contains(i)).map(|(_, v)| *v));
        }
        for (_, below, at_below) in items.iter().filter(|(o, ..)| under.objects.contains(*o)) {
            supports.push(*below);
            facts.insert(fact(rests, &[*item, *at, *below, *at_below]));
        }
        for support in supports {
            facts.insert(fact(supported, &[*item, *at, support]));
            state.push(fact(on, &[*item, support]));
        }
    }
    let mut pairs = Vec::new();
    stacked(domain, &goal.formula, true, &[], &mut pairs);
    for (above, below) in pairs {
        let among = |name: Option<&str>| -> Vec<Value> {
            let named = name.map(|name| values.named(name));
            items.iter().map(|(_, item, _)| *item).filter(|item| named.is_none_or(|n| n == Some(*item))).collect()
        };
        for above in among(above) {
            for below in among(below).into_iter().filter(|below| *below != above) {
                facts.insert(fact(stackable, &[above, below]));
            }
        }
    }
    Ok(Begun { values, facts, state })
}

/// What a goal may have on what: `On`'s arguments, `None` for any. Where it only asks for what is not on what,
/// nothing has to be put there. `bound`: what the parameters of a derived predicate stand for, by slot.
fn stacked<'f>(
    domain: &'f Domain,
    formula: &'f Formula,
    holds: bool,
    bound: &[Option<&'f str>],
    pairs: &mut Vec<(Option<&'f str>, Option<&'f str>)>,
) {
    match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().for_each(|p| stacked(domain, p, holds, bound, pairs)),
        Formula::Not(inner) => stacked(domain, inner, !holds, bound, pairs),
        Formula::Forall(_, inner) | Formula::Exists(_, inner) => stacked(domain, inner, holds, bound, pairs),
        Formula::Atom(atom) => {
            let name = |term: &'f Term| match term {
                Term::Constant(name) => Some(name.as_str()),
                Term::Variable(slot) => bound.get(*slot).copied().flatten(),
            };
            let names: Vec<Option<&str>> = atom.terms.iter().map(name).collect();
            if let Some(derived) = domain.derived.iter().find(|d| d.predicate == atom.predicate) {
                stacked(domain, &derived.body, holds, &names, pairs);
            } else if let (true, [above, below]) = (holds && domain.predicate("On") == Some(atom.predicate), &names[..])
            {
                pairs.push((*above, *below));
            }
        }
        Formula::Equal(..) => {}
    }
}
