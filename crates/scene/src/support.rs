//! Objects rest: found floating or sunk by no more than noise, they are set down exactly.
//!
//! What carries an object is what it would first fall onto, straight down. All shifts are
//! vertical, so that clearances measured once stay known: *a* over *b* changes by *a*'s shift less
//! *b*'s. The snapped scene is snapped again until nothing moves, so that reading it back gives
//! the same scene; one round is the rule.

use crate::contact::{Placed, clearances, near_pairs};
use crate::source::Source;
use crate::{FORGIVEN, Fixture, Support, overlap, stability};
use clearway_files::{FileError, quoted};
use clearway_geometry::{Mass, Pose, Solid};
use clearway_plan::ObjectId;
use std::sync::Arc;

/// Closer than this an object rests, and is left where it stands.
const EXACT: f64 = 1e-6;
/// Each round moves what the last one's shifts brought within reach of something else.
const ROUNDS: usize = 8;
/// Pairs of parts that may stand close to each other, so that no scene takes minutes to check.
const MAX_PAIRS: usize = 1_000_000;

/// An object whose support is not known yet.
pub(crate) struct Resting {
    pub(crate) id: String,
    pub(crate) solid: Arc<Solid>,
    pub(crate) mass: Mass,
    pub(crate) pose: Pose,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Under {
    Fixture(usize),
    Object(usize),
}

/// Checks that nothing overlaps and everything rests, and stays; sets the objects down; says on what.
pub(crate) fn settle(
    source: &Source,
    objects: &mut [Resting],
    fixtures: &[Fixture],
) -> Result<Vec<Support>, FileError> {
    let placed_fixtures: Vec<Placed> = fixtures.iter().map(|f| Placed::new(&f.solid, f.pose)).collect();
    let mut round = 0;
    loop {
        let solids: Vec<Arc<Solid>> = objects.iter().map(|o| o.solid.clone()).collect();
        let placed: Vec<Placed> = solids.iter().zip(objects.iter()).map(|(s, o)| Placed::new(s, o.pose)).collect();
        if round == 0 {
            crowded(source, objects, &placed, &placed_fixtures)?;
        }
        overlap::check(source, objects, &placed, fixtures, &placed_fixtures)?;
        let below: Vec<Vec<(Under, f64)>> = (0..objects.len()).map(|i| beneath(i, &placed, &placed_fixtures)).collect();
        for (i, found) in below.iter().enumerate() {
            rests(source, objects, fixtures, i, found)?;
        }
        let shifts = shifts(&below);
        round += 1;
        if round == ROUNDS || shifts.iter().all(|s| *s == 0.0) {
            stability::check(source, objects, &placed, fixtures, &placed_fixtures)?;
            return Ok(below.iter().map(|found| support(found)).collect());
        }
        for (object, shift) in objects.iter_mut().zip(shifts) {
            object.pose.translation.z += shift;
        }
    }
}

/// An error if checking would take too long.
fn crowded(source: &Source, objects: &[Resting], placed: &[Placed], fixtures: &[Placed]) -> Result<(), FileError> {
    let mut pairs = 0;
    for (i, a) in placed.iter().enumerate() {
        pairs += fixtures.iter().chain(&placed[..i]).map(|b| near_pairs(a, b)).sum::<usize>();
        if pairs > MAX_PAIRS {
            return Err(source
                .error(
                    &format!("objects.{i}"),
                    format!(
                        "too many convex parts and points near each other, up to object {}",
                        quoted(&objects[i].id)
                    ),
                )
                .expected(format!("at most {MAX_PAIRS} pairs above each other"))
                .help("thin point clouds out, and use simplified collision meshes"));
        }
    }
    Ok(())
}

/// What object `i` stands above, and how high: of each body the least clearance, sunk at most by
/// noise. The nearest bodies are all there; what is farther than they are may be left out.
fn beneath(i: usize, placed: &[Placed], fixtures: &[Placed]) -> Vec<(Under, f64)> {
    let mut found: Vec<(Under, f64)> = Vec::new();
    let mut nearest = f64::INFINITY;
    let fixtures = fixtures.iter().enumerate().map(|(j, b)| (Under::Fixture(j), b));
    let objects = placed.iter().enumerate().filter(|(j, _)| *j != i).map(|(j, b)| (Under::Object(j), b));
    for (under, b) in fixtures.chain(objects) {
        let highest = |least: f64| least.min(nearest).max(2.0 * FORGIVEN);
        if let Some(least) = clearances(&placed[i], b, -FORGIVEN, highest).into_iter().min_by(f64::total_cmp) {
            nearest = nearest.min(least);
            found.push((under, least));
        }
    }
    found
}

/// An error if object `i` floats.
fn rests(
    source: &Source,
    objects: &[Resting],
    fixtures: &[Fixture],
    i: usize,
    below: &[(Under, f64)],
) -> Result<(), FileError> {
    let keys = format!("objects.{i}.position");
    let (id, pose) = (quoted(&objects[i].id), objects[i].pose);
    let Some((under, gap)) = below.iter().min_by(|x, y| x.1.total_cmp(&y.1)) else {
        return Err(source
            .error(&keys, format!("object {id} floats: nothing is below it"))
            .expected("objects that rest on a fixture or on another object")
            .help("add what carries it as a fixture"));
    };
    if *gap <= FORGIVEN {
        return Ok(());
    }
    let name = match under {
        Under::Fixture(j) => format!("the fixture {}", quoted(&fixtures[*j].id)),
        Under::Object(j) => format!("the object {}", quoted(&objects[*j].id)),
    };
    Err(source
        .error(&keys, format!("object {id} floats {:.1} mm above {name}", 1000.0 * gap))
        .expected("at most 1 mm, which is taken for noise")
        .help(format!("`position` is the shape's centre: at z = {:.4} it would rest", pose.translation.z - gap)))
}

/// How far up each object goes, so that it rests on the first thing below it, which may itself go
/// up or down.
fn shifts(below: &[Vec<(Under, f64)>]) -> Vec<f64> {
    /// `None` while it is being worked out: two hooks in each other have no order.
    fn of(i: usize, below: &[Vec<(Under, f64)>], known: &mut [Option<Option<f64>>]) -> f64 {
        if let Some(known) = known[i] {
            return known.unwrap_or(0.0);
        }
        known[i] = Some(None);
        let shift = below[i]
            .iter()
            .map(|(under, clearance)| match under {
                Under::Fixture(_) => -clearance,
                Under::Object(j) => of(*j, below, known) - clearance,
            })
            .fold(f64::NEG_INFINITY, f64::max);
        let shift = if shift.abs() <= EXACT || !shift.is_finite() { 0.0 } else { shift };
        known[i] = Some(Some(shift));
        shift
    }
    let mut known = vec![None; below.len()];
    (0..below.len()).map(|i| of(i, below, &mut known)).collect()
}

/// Everything within noise carries.
pub(crate) fn support(below: &[(Under, f64)]) -> Support {
    let mut carriers: Vec<&(Under, f64)> = below.iter().filter(|(_, c)| *c <= FORGIVEN).collect();
    carriers.sort_by(|x, y| x.1.abs().total_cmp(&y.1.abs()));
    let mut objects: Vec<ObjectId> = Vec::new();
    let mut fixture = 0;
    for (under, _) in carriers.iter().rev() {
        match under {
            Under::Object(j) => objects.push(ObjectId(*j as u16)),
            Under::Fixture(j) => fixture = *j,
        }
    }
    objects.sort();
    if objects.is_empty() { Support::Fixture(fixture) } else { Support::Objects(objects) }
}
