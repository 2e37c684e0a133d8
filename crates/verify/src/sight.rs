//! A partly observed scene: nothing is taken before it was seen, and nothing moves through space that was not.
//!
//! Before each step the camera looks, the objects being where the steps before left them, the robot out of the
//! picture. By rays at exact shapes: an object is seen when a quarter of it is in view at some look; a point of the
//! scene's surroundings is seen when the line from the camera to it is clear at some look. Points inside the
//! robot's links and what it holds or pushes are looked up, row by row. What the object being taken hides begins
//! behind it: its own back is not in view.

use crate::carry::Stage;
use crate::case::{Case, Thing, Track};
use crate::error::CannotJudge;
use crate::report::{Report, ViolationKind};
use crate::shapes::{Piece, extent};
use crate::sweep::When;
use clearway_plan::{Budget, PlanFile};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::Ray;

/// This part of an object has to be in view, and how well that is measured.
const ENOUGH: f64 = 0.25;
const MEASURED: f64 = 0.04;
const RAYS: usize = 32;
/// Between points inside a link, metres, and rows looked at.
const GRID: f64 = 0.02;
const EVERY: usize = 3;
/// Beyond the objects and above the highest, where the scene has no workspace; above the lowest foot; metres.
const AROUND: f64 = 0.05;
const FOOT: f64 = 0.0005;
/// A point this much before what hides it counts as seen, metres.
const SURFACE: f64 = 0.001;

/// Where everything is at a look.
type Poses = Vec<Option<Pose>>;

pub(crate) fn check(
    plan: &PlanFile,
    case: &Case,
    tracks: &[Track],
    stages: &[Stage],
    budget: &Budget,
    report: &mut Report,
) -> Result<(), CannotJudge> {
    let Some(camera) = &plan.scene.camera else {
        if !plan.known.is_empty() {
            report.plan(ViolationKind::NotSeen, "`known` says what was seen, but the scene has no camera".to_owned());
        }
        return Ok(());
    };
    if plan.known.is_empty() {
        report.not_checked.push("what of the scene was seen: the plan has no `known`, as if all was".to_owned());
        return Ok(());
    }
    if plan.known.len() != plan.steps.len() || plan.known.iter().enumerate().any(|(i, k)| k.step != i) {
        report.plan(
            ViolationKind::NotSeen,
            format!(
                "`known` has {} entries for {} steps, or not one for each in order",
                plan.known.len(),
                plan.steps.len()
            ),
        );
        return Ok(());
    }
    let eye = Vector::from(camera.position);
    let view = View::new(eye, Vector::from(camera.look_at), camera.fov);
    let mut judge = Judge { case, view, looks: Vec::new(), region: region(plan, case) };
    let points = |pieces: &[Piece]| pieces.iter().flat_map(inside).collect::<Vec<Vector>>();
    let links: Vec<Vec<Vector>> = case.model.links.iter().map(|l| points(&l.pieces)).collect();
    let mut seen = vec![false; case.objects.len()];
    for (index, known) in plan.known.iter().enumerate() {
        let Some(first) = stages.iter().zip(tracks).find(|(_, t)| t.step == index) else { continue };
        judge.looks.push(first.0.standing.clone());
        for name in &known.seen {
            budget.check()?;
            let Some(object) = case.object(name) else {
                report.plan(ViolationKind::NotSeen, format!("`known` names {name:?}, which is no object"));
                continue;
            };
            if !seen[object] {
                let part = judge.part_seen(object);
                seen[object] = part >= ENOUGH - MEASURED;
                if !seen[object] {
                    report.plan(
                        ViolationKind::NotSeen,
                        format!(
                            "{name} is said to be known before step {index}, but only {:.0} % of it was in view",
                            100.0 * part
                        ),
                    );
                }
            }
        }
        if !known.seen.contains(&plan.steps[index].object) {
            report.plan(
                ViolationKind::NotSeen,
                format!("step {index} takes {}, which was not known", plan.steps[index].object),
            );
        }
        if camera.enter_unseen {
            continue;
        }
        let taken = case.object(&plan.steps[index].object);
        for (track, stage) in tracks.iter().zip(stages).filter(|(t, _)| t.step == index) {
            let held = stage.held.as_ref().map(|held| (held, points(&case.objects[held.object].pieces)));
            let pushed = stage.pushed.as_ref().map(|pushed| (pushed, points(&case.objects[pushed.object].pieces)));
            for row in (0..track.postures.len()).step_by(EVERY) {
                budget.check()?;
                let poses = case.link_poses(&track.postures[row]);
                let unseen = |body: &[Vector], at: &Pose| {
                    body.iter().map(|p| at.transform_point(*p)).find(|p| judge.unseen(*p, taken))
                };
                let link = links
                    .iter()
                    .zip(&poses)
                    .enumerate()
                    .find_map(|(l, (body, at))| Some((&case.model.links[l].name, unseen(body, at)?)));
                let hand = held.as_ref().and_then(|(held, body)| {
                    Some((&case.objects[held.object].id, unseen(body, &(poses[held.tool] * held.tool_from_object))?))
                });
                let ahead = pushed.as_ref().and_then(|(pushed, body)| {
                    let at = pushed.slide.at(When { row, fraction: 0.0 });
                    Some((&case.objects[pushed.object].id, unseen(body, &at)?))
                });
                if let Some((name, at)) = link.or(hand).or(ahead) {
                    report.at(
                        ViolationKind::NotSeen,
                        track.at(row),
                        format!("{name} reaches ({:.3}, {:.3}, {:.3}), which was not in view before", at.x, at.y, at.z),
                    );
                    break;
                }
            }
        }
    }
    Ok(())
}

struct View {
    eye: Vector,
    forward: Vector,
    right: Vector,
    up: Vector,
    tangent: f64,
}

impl View {
    fn new(eye: Vector, look_at: Vector, fov: f64) -> Self {
        let forward = (look_at - eye).normalize();
        let level = forward.cross(Vector::Z);
        let right = if level.length() > 1e-6 { level.normalize() } else { Vector::X };
        Self { eye, forward, right, up: right.cross(forward), tangent: (fov / 2.0).tan() }
    }

    fn holds(&self, d: Vector) -> bool {
        let depth = d.dot(self.forward) * self.tangent;
        depth > 0.0 && d.dot(self.right).abs() <= depth && d.dot(self.up).abs() <= depth
    }
}

struct Judge<'a> {
    case: &'a Case,
    view: View,
    /// What stood where at each look so far.
    looks: Vec<Poses>,
    region: (Vector, Vector),
}

impl Judge<'_> {
    /// Of an object, at the last look.
    fn part_seen(&self, object: usize) -> f64 {
        let Some(poses) = self.looks.last() else { return 0.0 };
        let Some(pose) = poses[object] else { return 0.0 };
        let thing = &self.case.objects[object];
        let (low, high) = extent(&thing.pieces, &pose);
        let centre = (low + high) * 0.5;
        let axis = (centre - self.view.eye).normalize();
        let side =
            if axis.z.abs() < 0.9 { axis.cross(Vector::Z).normalize() } else { axis.cross(Vector::X).normalize() };
        let other = axis.cross(side);
        let size = (high - low) * 0.5;
        let spread = |way: Vector| {
            let corner = |i: usize| centre + size * Vector::new(sign(i), sign(i >> 1), sign(i >> 2)) - self.view.eye;
            (0..8)
                .map(corner)
                .map(|c| (c.dot(way) / c.dot(axis).max(1e-3)).abs() * (centre - self.view.eye).length())
                .fold(0.0, f64::max)
        };
        let (wide, tall) = (spread(side), spread(other));
        let (mut would, mut does) = (0, 0);
        for i in 0..RAYS * RAYS {
            let at = |k: usize| 2.0 * (k as f64 + 0.5) / RAYS as f64 - 1.0;
            let direction =
                (centre + side * (at(i % RAYS) * wide) + other * (at(i / RAYS) * tall) - self.view.eye).normalize();
            let Some(reach) = met(thing, &pose, self.view.eye, direction, f64::MAX) else { continue };
            would += 1;
            let free = || {
                !self.bodies(poses).any(|(body, thing, pose)| {
                    body != Some(object) && met(thing, pose, self.view.eye, direction, reach).is_some()
                })
            };
            does += usize::from(self.view.holds(direction) && free());
        }
        does as f64 / would.max(1) as f64
    }

    fn bodies<'p>(&'p self, poses: &'p Poses) -> impl Iterator<Item = (Option<usize>, &'p Thing, &'p Pose)> {
        let objects = self
            .case
            .objects
            .iter()
            .zip(poses)
            .enumerate()
            .filter_map(|(i, (o, pose))| Some((Some(i), o, pose.as_ref()?)));
        objects.chain(self.case.fixtures.iter().map(|f| (None, f, &f.pose)))
    }

    /// Whether a point in the region was not in view at any look; `taken`: what is being taken.
    fn unseen(&self, p: Vector, taken: Option<usize>) -> bool {
        let (low, high) = self.region;
        if !(p.cmpge(low).all() && p.cmple(high).all()) {
            return false;
        }
        let line = p - self.view.eye;
        let direction = line.normalize();
        let free = |poses: &Poses| {
            self.view.holds(line)
                && !self.bodies(poses).any(|(body, thing, pose)| {
                    met(thing, pose, self.view.eye, direction, line.length() - SURFACE).is_some()
                        && !(body.is_some() && body == taken && !self.behind(thing, pose, p))
                })
        };
        !self.looks.iter().rev().any(free)
    }

    /// Whether a point is farther from the eye, seen from above, than all of a body.
    fn behind(&self, thing: &Thing, pose: &Pose, p: Vector) -> bool {
        let (low, high) = extent(&thing.pieces, pose);
        let middle = (low + high) * 0.5 - self.view.eye;
        let away = Vector::new(middle.x, middle.y, 0.0).normalize();
        let back = thing.pieces.iter().map(|piece| {
            let at = *pose * piece.pose;
            let inner = at.rotation.inverse() * away;
            piece.shape.as_support_map().map_or((*pose * piece.center).dot(away) + piece.radius, |s| {
                (at * s.local_support_point(inner)).dot(away)
            })
        });
        p.dot(away) > back.fold(f64::NEG_INFINITY, f64::max) + 2.0 * SURFACE
    }
}

fn sign(i: usize) -> f64 {
    if i & 1 == 1 { 1.0 } else { -1.0 }
}

/// How far along a ray a body begins, if not beyond `most`.
fn met(thing: &Thing, pose: &Pose, eye: Vector, direction: Vector, most: f64) -> Option<f64> {
    let near = |piece: &&Piece| {
        let centre = pose.transform_point(piece.center) - eye;
        let along = centre.dot(direction);
        (centre - direction * along).length() <= piece.radius && along - piece.radius < most
    };
    let cast = |piece: &Piece| piece.shape.cast_ray(&(*pose * piece.pose), &Ray::new(eye, direction), most, true);
    thing.pieces.iter().filter(near).filter_map(cast).reduce(f64::min)
}

/// Points inside a piece, in its owner's frame.
fn inside(piece: &Piece) -> Vec<Vector> {
    let bounds = piece.shape.compute_local_aabb();
    let size = bounds.maxs - bounds.mins;
    let steps = |length: f64| (length / GRID).ceil().max(1.0) as usize;
    let (nx, ny, nz) = (steps(size.x), steps(size.y), steps(size.z));
    let part = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let grid = (0..nx * ny * nz)
        .map(|i| bounds.mins + size * Vector::new(part(i % nx, nx), part(i / nx % ny, ny), part(i / (nx * ny), nz)));
    grid.filter(|p| piece.shape.contains_local_point(*p)).map(|p| piece.pose.transform_point(p)).collect()
}

/// Where space that is not seen counts.
fn region(plan: &PlanFile, case: &Case) -> (Vector, Vector) {
    let none = (Vector::INFINITY, Vector::NEG_INFINITY);
    let (low, high) =
        case.objects.iter().map(|o| extent(&o.pieces, &o.pose)).fold(none, |(a, b), (c, d)| (a.min(c), b.max(d)));
    let (min, max) = match plan.scene.workspace {
        Some(rect) => (rect.min, rect.max),
        None => ([low.x - AROUND, low.y - AROUND], [high.x + AROUND, high.y + AROUND]),
    };
    (Vector::new(min[0], min[1], low.z + FOOT), Vector::new(max[0], max[1], high.z + AROUND))
}
