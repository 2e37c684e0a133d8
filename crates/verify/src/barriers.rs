//! Barriers ([`BarriersProof`]), judged without trusting the planner: the target's core and the room it
//! has are measured anew, and every chain is followed with exact shapes.
//!
//! The point *c* of the target's axis cannot leave a chain's closed line, as the level disc about it
//! would meet one of the bodies. docs/lower-bounds.md says why.

use crate::case::{Case, Thing};
use crate::gap::gap;
use crate::shapes::{Piece, cylinder_along_z};
use clearway_plan::proof::{Barrier, BarriersProof, Enclosure, Level};
use parry3d_f64::math::{Pose, Vector};
use std::collections::BTreeSet;

/// Metres, as in the theorem: so much of the target is beside the upright line from *c*, and so far
/// *c* may be beyond floor and ceiling.
const SLACK: f64 = 0.0015;
/// What is looked at beyond them, which leaves room for rounding.
const BEYOND: f64 = 0.0012;
/// Overlaps that plans may have.
const TOUCH: f64 = 1e-4;
/// Snapping on reading, metres.
const NOISE: f64 = 1.1e-3;
/// Rounding.
const SAME: f64 = 1e-6;

/// The objects of each barrier, or what is wrong.
pub(crate) fn sets(case: &Case, target: usize, proof: &BarriersProof) -> Result<Vec<BTreeSet<usize>>, String> {
    if proof.barriers.is_empty() {
        return Ok(Vec::new());
    }
    let enclosure = proof.enclosure.as_ref().ok_or("barriers are listed, but no enclosure")?;
    let judge = Judge::new(case, target, enclosure)?;
    let told =
        |(index, barrier): (usize, &Barrier)| judge.barrier(barrier).map_err(|e| format!("barrier {index}: {e}"));
    proof.barriers.iter().enumerate().map(told).collect()
}

/// The bound that the weights prove, given the objects of each barrier.
pub(crate) fn packed(proof: &BarriersProof, sets: &[BTreeSet<usize>]) -> Result<usize, String> {
    let weights: Vec<f64> = proof.barriers.iter().map(|b| b.weight).collect();
    if !weights.iter().all(|w| (0.0..=1.0 + SAME).contains(w)) {
        return Err("a weight is not from 0 to 1".to_owned());
    }
    for object in sets.iter().flatten() {
        let borne: f64 = sets.iter().zip(&weights).filter(|(s, _)| s.contains(object)).map(|(_, w)| w).sum();
        if borne > 1.0 + SAME {
            return Err(format!("the weights of an object's barriers add up to {borne:.4}, more than 1"));
        }
    }
    Ok(1 + (weights.iter().sum::<f64>() - 1e-4).ceil().max(0.0) as usize)
}

struct Judge<'a> {
    case: &'a Case,
    target: usize,
    enclosure: &'a Enclosure,
    /// Of the target's core, upright: its middle.
    middle: Vector,
    /// How low and how high *c* can be.
    heights: [f64; 2],
}

impl<'a> Judge<'a> {
    fn new(case: &'a Case, target: usize, enclosure: &'a Enclosure) -> Result<Self, String> {
        let Enclosure { radius, height, lean, floor, ceiling } = enclosure;
        let middle = core(&case.objects[target], *radius, *height).ok_or(format!(
            "the target holds no upright cylinder of radius {radius} and height {height} about its centre"
        ))?;
        if !(lean.is_finite() && *lean >= 0.0 && lean.sin() * height <= radius - SLACK + SAME) {
            return Err(format!("the target may lean by {lean} rad, farther than its proportions allow"));
        }
        let (foot, head) = (middle.z - height / 2.0, middle.z + height / 2.0);
        if floor.z > foot + NOISE || ceiling.z < head - NOISE {
            return Err("the target is not between floor and ceiling".to_owned());
        }
        let up = radius * lean.sin();
        let heights = [floor.z + up * lean.cos() - TOUCH, ceiling.z - (height - up - SLACK) + TOUCH];
        Ok(Self { case, target, enclosure, middle, heights })
    }

    fn barrier(&self, barrier: &Barrier) -> Result<BTreeSet<usize>, String> {
        let line: Vec<Vector> = barrier.chain.iter().map(|l| Vector::new(l.to[0], l.to[1], 0.0)).collect();
        if line.len() < 3 || !line.iter().all(|p| p.is_finite()) {
            return Err("its chain is no closed line".to_owned());
        }
        if !encloses(&line, self.middle) {
            return Err("its chain does not go round the target".to_owned());
        }
        self.covered(&self.enclosure.floor, &line, -1.0)?;
        self.covered(&self.enclosure.ceiling, &line, 1.0)?;
        for place in &self.case.places {
            let (at, half) = (Vector::from(place.position), [place.size[0] / 2.0, place.size[1] / 2.0]);
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let corners: Vec<Vector> =
                corners.iter().map(|[s, t]| at + Vector::new(s * half[0], t * half[1], 0.0)).collect();
            if meet(&line, &corners) {
                return Err(format!("the place {:?} is not outside its chain", place.id));
            }
        }
        let mut objects = BTreeSet::new();
        let mut from = line[line.len() - 1];
        for (link, &to) in barrier.chain.iter().zip(&line) {
            let object = self.case.object(&link.body).filter(|o| *o != self.target);
            let fixtures = self.case.fixtures.iter().filter(|f| f.id == link.body);
            let bodies = object.map(|o| &self.case.objects[o]).into_iter().chain(fixtures);
            if !bodies.clone().any(|body| body.pieces.iter().any(|p| self.bars(body, p, [from, to]))) {
                return Err(match bodies.clone().next() {
                    Some(_) => format!(
                        "{} does not bar the way from ({:.4}, {:.4}) to ({:.4}, {:.4})",
                        link.body, from.x, from.y, to.x, to.y
                    ),
                    None => format!("{:?} is no fixture and no other object", link.body),
                });
            }
            objects.extend(object);
            from = to;
        }
        let told: BTreeSet<&str> = barrier.objects.iter().map(String::as_str).collect();
        if told != objects.iter().map(|o| self.case.objects[*o].id.as_str()).collect() {
            return Err("its objects are not those of its chain".to_owned());
        }
        Ok(objects)
    }

    /// Whether the disc meets a convex piece at both ends of the line, lowest and highest; then it
    /// does in between.
    fn bars(&self, body: &Thing, piece: &Piece, ends: [Vector; 2]) -> bool {
        let disc = |p: &Vector| {
            self.heights.iter().all(|&z| meets(body, piece, Vector::new(p.x, p.y, z), self.enclosure.radius - TOUCH))
        };
        piece.shape.is_convex() && ends.iter().all(disc)
    }

    /// Whether the face is there, all along the line and hence inside it.
    fn covered(&self, level: &Level, line: &[Vector], side: f64) -> Result<(), String> {
        let z = level.z + side * TOUCH;
        let covers = |body: &Thing, piece: &Piece| {
            piece.shape.is_convex() && line.iter().all(|p| meets(body, piece, Vector::new(p.x, p.y, z), BEYOND))
        };
        let mut fixtures = self.case.fixtures.iter().filter(|f| f.id == level.fixture);
        match fixtures.any(|f| f.pieces.iter().any(|p| covers(f, p))) {
            true => Ok(()),
            false => Err(format!("no face of {:?} at z = {} covers its chain", level.fixture, level.z)),
        }
    }
}

/// The middle of the upright cylinder, if some piece of the body holds it about its centre.
fn core(body: &Thing, radius: f64, height: f64) -> Option<Vector> {
    let small = |a: f64, b: f64| a.is_finite() && a > 0.0 && a <= b + SAME;
    body.pieces.iter().find_map(|piece| {
        let pose = body.pose * piece.pose;
        let upright = |axis: Vector| (pose.rotation * axis).z.abs() > 1.0 - SAME;
        let holds = if let Some(cylinder) = piece.shape.as_cylinder() {
            upright(Vector::Y) && small(radius, cylinder.radius) && small(height, 2.0 * cylinder.half_height)
        } else if let Some(capsule) = piece.shape.as_capsule() {
            let along = capsule.segment.b - capsule.segment.a;
            upright(along.normalize()) && small(radius, capsule.radius) && small(height, along.length())
        } else if let Some(cuboid) = piece.shape.as_cuboid() {
            let [x, y, z] = cuboid.half_extents.into();
            let stands =
                |axis, half: f64, a: f64, b: f64| upright(axis) && small(radius, a.min(b)) && small(height, 2.0 * half);
            stands(Vector::X, x, y, z) || stands(Vector::Y, y, z, x) || stands(Vector::Z, z, x, y)
        } else {
            false
        };
        holds.then_some(body.pose.transform_point(piece.center))
    })
}

/// Whether a level disc meets the piece; the disc is a tenth of a millimetre thick.
fn meets(body: &Thing, piece: &Piece, centre: Vector, radius: f64) -> bool {
    let (turn, disc) = cylinder_along_z(radius, TOUCH);
    let at = Pose::from_translation(centre) * turn;
    let near = (body.pose.transform_point(piece.center) - centre).length() < radius + piece.radius + TOUCH;
    near && gap(&at.inv_mul(&(body.pose * piece.pose)), &*disc, &*piece.shape, TOUCH).is_some_and(|g| g.distance <= 0.0)
}

/// Whether the closed line goes round the point, seen from above: a ray along x crosses it an odd number of times.
fn encloses(line: &[Vector], p: Vector) -> bool {
    let crossed =
        |(a, b): (&Vector, &Vector)| (a.y > p.y) != (b.y > p.y) && a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) > p.x;
    sides(line).filter(|s| crossed(*s)).count() % 2 == 1
}

fn sides(line: &[Vector]) -> impl Iterator<Item = (&Vector, &Vector)> {
    line.iter().zip(line.iter().cycle().skip(1))
}

/// Whether what two closed lines enclose has a point in common, seen from above.
fn meet(a: &[Vector], b: &[Vector]) -> bool {
    let side = |o: &Vector, d: &Vector, p: &Vector| (d.x - o.x) * (p.y - o.y) - (d.y - o.y) * (p.x - o.x);
    let cross = |(a, b): (&Vector, &Vector), (p, q): (&Vector, &Vector)| {
        side(a, b, p) * side(a, b, q) <= 0.0 && side(p, q, a) * side(p, q, b) <= 0.0
    };
    a.iter().any(|p| encloses(b, *p))
        || b.iter().any(|p| encloses(a, *p))
        || sides(a).any(|s| sides(b).any(|t| cross(s, t)))
}
