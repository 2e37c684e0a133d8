//! What rests on what: a body rests on another if it is within 1 mm of it, above or sunk in,
//! and would be free of it if lifted.
//!
//! Found by moving the body 1.05 mm down (it must then overlap) and up (it must not): no reliance
//! on contact normals. It does not weigh: a body that would tip over counts as resting
//! ([`stability`](crate::stability) weighs).

use crate::case::{Case, Thing};
use crate::gap::Gap;
use crate::shapes::body_gap;
use parry3d_f64::math::{Pose, Vector};

/// Overlap or gap that counts as resting, metres.
pub(crate) const REST: f64 = 1e-3;
/// Overlapping by more is touching, metres.
pub(crate) const TOUCH: f64 = 1e-4;
/// 1 mm, and what finite digits may add.
pub(crate) const SHIFT: f64 = REST + 5e-5;

/// Where everything that stands still is. `None`: not standing (held, or being pushed).
pub(crate) type Standing = Vec<Option<Pose>>;

pub(crate) fn rests_on(above: &Thing, at: &Pose, below: &Thing, below_at: &Pose) -> bool {
    let overlaps = |shift: f64| {
        let moved = Pose::from_parts(at.translation + Vector::Z * shift, at.rotation);
        body_gap(&above.pieces, &moved, &below.pieces, below_at, 0.0).is_some_and(|g| g.distance < -1e-6)
    };
    overlaps(-SHIFT) && !overlaps(SHIFT)
}

/// Everything that stands still, other than one object, with its pose.
pub(crate) fn others<'a>(
    case: &'a Case,
    standing: &'a Standing,
    except: usize,
) -> impl Iterator<Item = (&'a Thing, Pose)> {
    let objects = case.objects.iter().zip(standing).enumerate();
    let objects = objects.filter_map(move |(i, (thing, pose))| (i != except).then_some((thing, (*pose)?)));
    case.fixtures.iter().map(|f| (f, f.pose)).chain(objects)
}

/// What carries an object that is at `at`, other than itself.
pub(crate) fn carriers<'a>(case: &'a Case, standing: &'a Standing, object: usize, at: &Pose) -> Vec<&'a str> {
    others(case, standing, object)
        .filter(|(below, below_at)| rests_on(&case.objects[object], at, below, below_at))
        .map(|(below, _)| below.id.as_str())
        .collect()
}

/// How an object at `at` overlaps what stands still, what it rests on within 1 mm aside.
pub(crate) fn overlaps<'a>(case: &'a Case, standing: &'a Standing, object: usize, at: &Pose) -> Vec<(&'a str, Gap)> {
    let thing = &case.objects[object];
    others(case, standing, object)
        .filter_map(|(other, other_at)| {
            let found = body_gap(&thing.pieces, at, &other.pieces, &other_at, 0.0)?;
            let resting = |found: Gap| {
                found.distance >= -REST - TOUCH
                    && (rests_on(thing, at, other, &other_at) || rests_on(other, &other_at, thing, at))
            };
            (found.distance < -TOUCH && !resting(found)).then_some((other.id.as_str(), found))
        })
        .collect()
}
