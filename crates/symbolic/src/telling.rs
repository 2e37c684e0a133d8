//! A scene told in facts: what there is, where it stands and what it stands on.

use crate::arm::{Arm, Thing, type_named};
use crate::facts::{Fact, Facts, Value, Values};
use crate::pddl::{Constant, Domain, Formula, Goal, PredicateId, Term, Types};
use clearway_geometry::Pose;
use clearway_plan::{ObjectId, ObjectSet};
use clearway_retrieval::handling::{Handling, Surface};

/// What a scene's things are called in PDDL, and their types.
pub fn constants(domain: &Domain, handling: &Handling) -> Result<Vec<Constant>, String> {
    let scene = handling.scene();
    let (item, place, shelf) = (type_named(domain, "item")?, type_named(domain, "place")?, type_named(domain, "shelf")?);
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
            found.ok_or_else(|| format!("the domain has no predicate `{name}` of {count} arguments, with which the scene is told"))
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

/// Whether a domain has what a scene is told with.
pub fn check(domain: &Domain) -> Result<(), String> {
    ["item", "place", "shelf", "pose"].into_iter().try_for_each(|name| type_named(domain, name).map(|_| ()))?;
    Vocabulary::of(domain).map(|_| ())
}

/// Tells the scene, with only these objects movable: the others are not mentioned. With `retrieval` nothing is put down but
/// on places.
pub fn begin(domain: &Domain, goal: &Goal, arm: &mut Arm, movable: ObjectSet, retrieval: bool) -> Result<Begun, String> {
    let Vocabulary { home, pose, supported, rests, surface, stackable, at_pose, on, hand_empty } = Vocabulary::of(domain)?;
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
    let items: Vec<(ObjectId, Value, Value)> = movable
        .iter()
        .map(|object| {
            let name = &scene.names[object.index()];
            let item = named(&mut values, name);
            let at = values.add(&format!("{name}-home"), of_pose);
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
        let mut supports: Vec<Value> = shelves.iter().filter(|(i, _)| under.fixtures.contains(i)).map(|(_, v)| *v).collect();
        supports.extend(arm.handling.places_under(*object, where_it_is).into_iter().map(|i| places[i]));
        for (other, below, at_below) in items.iter().filter(|(o, ..)| under.objects.contains(*o)) {
            debug_assert_ne!(other, object);
            supports.push(*below);
            facts.insert(fact(rests, &[*item, *at, *below, *at_below]));
        }
        for support in supports {
            facts.insert(fact(supported, &[*item, *at, support]));
            state.push(fact(on, &[*item, support]));
        }
    }
    let mut pairs = Vec::new();
    stacked(&goal.formula, on, &mut pairs);
    for (above, below) in pairs {
        if let (Some(above), Some(below)) = (values.named(above), values.named(below)) {
            facts.insert(fact(stackable, &[above, below]));
        }
    }
    Ok(Begun { values, facts, state })
}

/// The pairs that a goal has one on the other: what `On` says of two objects.
fn stacked<'f>(formula: &'f Formula, on: PredicateId, pairs: &mut Vec<(&'f str, &'f str)>) {
    match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().for_each(|p| stacked(p, on, pairs)),
        Formula::Not(inner) | Formula::Forall(_, inner) | Formula::Exists(_, inner) => stacked(inner, on, pairs),
        Formula::Atom(atom) if atom.predicate == on => {
            if let [Term::Constant(above), Term::Constant(below)] = atom.terms.as_slice() {
                pairs.push((above, below));
            }
        }
        Formula::Atom(_) | Formula::Equal(..) => {}
    }
}
