//! What stands, and where it rests on what: kept up while things are taken and put down.

use super::mass::Mass;
use super::patch::patch;
use super::polygon::{Point, hull};
use crate::case::{Case, Thing};
use crate::error::CannotJudge;
use crate::placement::place_under;
use crate::rest::{REST, SHIFT, Standing, rests_on};
use crate::shapes::{Piece, cuboid, extent};
use clearway_plan::Budget;
use parry3d_f64::math::{Pose, Vector};
use std::borrow::Cow;

/// A place without a fixture is as thick as this, metres.
const THICK: f64 = 0.01;

pub(super) struct Stack<'a> {
    pub case: &'a Case,
    pub masses: Vec<Mass>,
    /// Of each object that stands, with what carries it.
    pub contacts: Vec<Vec<Contact>>,
    standing: Vec<Option<Stand>>,
    fixtures: Vec<Bounds>,
}

pub(super) struct Contact {
    pub on: Carrier,
    pub patch: Vec<Point>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Carrier {
    Fixture(usize),
    Object(usize),
    /// One of the scene's places, where no fixture is.
    Place(usize),
}

/// The smallest and the largest coordinates.
type Bounds = (Vector, Vector);

struct Stand {
    pose: Pose,
    bounds: Bounds,
}

impl<'a> Stack<'a> {
    pub fn new(case: &'a Case, standing: &Standing, budget: &Budget) -> Result<Self, CannotJudge> {
        let stand = |(thing, pose): (&Thing, &Option<Pose>)| pose.map(|pose| Stand::new(thing, pose));
        let mut stack = Self {
            case,
            masses: case.objects.iter().map(|o| Mass::of(&o.pieces)).collect(),
            contacts: Vec::new(),
            standing: case.objects.iter().zip(standing).map(stand).collect(),
            fixtures: case.fixtures.iter().map(|f| extent(&f.pieces, &f.pose)).collect(),
        };
        for object in 0..case.objects.len() {
            budget.check()?;
            let contacts = stack.carriers(object);
            stack.contacts.push(contacts);
        }
        Ok(stack)
    }

    pub fn all(&self) -> Vec<usize> {
        (0..self.contacts.len()).collect()
    }

    pub fn is_carried(&self, object: usize) -> bool {
        !self.contacts[object].is_empty()
    }

    /// Takes an object away. Returns what carried it, and what it carried.
    pub fn lift(&mut self, object: usize) -> Vec<usize> {
        self.standing[object] = None;
        let below = std::mem::take(&mut self.contacts[object]).into_iter().filter_map(|c| c.on.object());
        let mut touched: Vec<usize> = below.collect();
        for (above, contacts) in self.contacts.iter_mut().enumerate() {
            let before = contacts.len();
            contacts.retain(|c| c.on != Carrier::Object(object));
            if contacts.len() < before {
                touched.push(above);
            }
        }
        touched
    }

    /// Puts down an object that was lifted.
    pub fn put(&mut self, object: usize, at: &Pose) {
        self.standing[object] = Some(Stand::new(&self.case.objects[object], *at));
        self.contacts[object] = self.carriers(object);
        if self.contacts[object].is_empty() {
            self.contacts[object] = self.on_place(object, at).into_iter().collect();
        }
        for above in (0..self.contacts.len()).filter(|above| *above != object) {
            if let Some(contact) = self.contact(above, Carrier::Object(object)) {
                self.contacts[above].push(contact);
            }
        }
    }

    fn carriers(&self, object: usize) -> Vec<Contact> {
        let fixtures = (0..self.fixtures.len()).map(Carrier::Fixture);
        let objects = (0..self.standing.len()).filter(|o| *o != object).map(Carrier::Object);
        fixtures.chain(objects).filter_map(|on| self.contact(object, on)).collect()
    }

    /// How a fixture or an object carries another object.
    fn contact(&self, object: usize, on: Carrier) -> Option<Contact> {
        let Stand { pose: at, bounds } = self.standing[object].as_ref()?;
        let (below, below_at, below_bounds) = match on {
            Carrier::Fixture(i) => (&self.case.fixtures[i], self.case.fixtures[i].pose, &self.fixtures[i]),
            Carrier::Object(i) => {
                let stand = self.standing[i].as_ref()?;
                (&self.case.objects[i], stand.pose, &stand.bounds)
            }
            Carrier::Place(_) => return None,
        };
        let above = &self.case.objects[object];
        if !near(bounds, below_bounds) || !rests_on(above, at, below, &below_at) {
            return None;
        }
        let patch = patch(above, at, below, &below_at);
        (!patch.is_empty()).then_some(Contact { on, patch })
    }

    /// A place carries what is put down in it, whether or not a fixture is there.
    fn on_place(&self, object: usize, at: &Pose) -> Option<Contact> {
        let thing = &self.case.objects[object];
        let area = place_under(self.case, &thing.pieces, at, REST)?;
        let on = Carrier::Place(self.case.places.iter().position(|p| std::ptr::eq(p, area))?);
        let [x, y] = area.size.map(|s| s.max(THICK));
        let pose = Pose::from_translation(Vector::from(area.position) - Vector::Z * (THICK / 2.0));
        let pieces = vec![Piece::new(Pose::IDENTITY, cuboid([x, y, THICK]))];
        let patch = patch(thing, at, &Thing { id: area.id.clone(), pieces, pose }, &pose);
        (!patch.is_empty()).then_some(Contact { on, patch })
    }

    /// Objects that rest on each other, for all lots that have one of these. What nothing carries is
    /// left out.
    pub fn groups(&self, of: &[usize]) -> Vec<Vec<usize>> {
        let mut beside = vec![Vec::new(); self.contacts.len()];
        for (above, contacts) in self.contacts.iter().enumerate() {
            for below in contacts.iter().filter_map(|c| c.on.object()) {
                beside[above].push(below);
                beside[below].push(above);
            }
        }
        let mut left: Vec<bool> = (0..self.contacts.len()).map(|o| self.is_carried(o)).collect();
        let mut groups = Vec::new();
        for first in of {
            let mut group = Vec::new();
            let mut next = vec![*first];
            while let Some(object) = next.pop() {
                if std::mem::take(&mut left[object]) {
                    group.push(object);
                    next.extend(&beside[object]);
                }
            }
            if !group.is_empty() {
                groups.push(group);
            }
        }
        groups
    }

    /// Of mass.
    pub fn centre(&self, object: usize) -> Point {
        let stand = self.standing[object].as_ref();
        stand.map_or(Point::ZERO, |s| s.pose.transform_point(self.masses[object].centre).truncate())
    }

    pub fn bottom(&self, object: usize) -> f64 {
        self.standing[object].as_ref().map_or(f64::INFINITY, |s| s.bounds.0.z)
    }

    /// Where the object meets all that carries it.
    pub fn under(&self, object: usize) -> Cow<'_, [Point]> {
        joined(self.contacts[object].iter())
    }

    /// The same, of what bears anything: fixtures, places, and objects that nothing carries.
    pub fn ground(&self, object: usize) -> Cow<'_, [Point]> {
        joined(self.contacts[object].iter().filter(|c| c.on.object().is_none_or(|o| !self.is_carried(o))))
    }

    /// What rests on the object.
    pub fn on(&self, object: usize) -> Vec<Carrier> {
        let rests = |above: &usize| self.contacts[*above].iter().any(|c| c.on == Carrier::Object(object));
        (0..self.contacts.len()).filter(rests).map(Carrier::Object).collect()
    }

    pub fn id(&self, carrier: Carrier) -> &str {
        match carrier {
            Carrier::Fixture(i) => &self.case.fixtures[i].id,
            Carrier::Object(i) => &self.case.objects[i].id,
            Carrier::Place(i) => &self.case.places[i].id,
        }
    }
}

impl Stand {
    fn new(thing: &Thing, pose: Pose) -> Self {
        Self { pose, bounds: extent(&thing.pieces, &pose) }
    }
}

impl Carrier {
    pub fn object(self) -> Option<usize> {
        match self {
            Carrier::Object(object) => Some(object),
            Carrier::Fixture(_) | Carrier::Place(_) => None,
        }
    }
}

fn near(a: &Bounds, b: &Bounds) -> bool {
    (a.0 - b.1).max(b.0 - a.1).max_element() <= 2.0 * SHIFT
}

/// The hull of all patches.
fn joined<'b>(mut contacts: impl Iterator<Item = &'b Contact>) -> Cow<'b, [Point]> {
    match (contacts.next(), contacts.next()) {
        (None, _) => Cow::Borrowed(&[]),
        (Some(one), None) => Cow::Borrowed(&one.patch),
        (Some(one), Some(two)) => {
            let all = [one, two].into_iter().chain(contacts);
            Cow::Owned(hull(all.flat_map(|c| c.patch.iter().copied()).collect()))
        }
    }
}
