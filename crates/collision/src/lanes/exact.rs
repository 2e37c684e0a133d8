//! The same spheres, asked one configuration at a time in f64, with names: what touches what.
//! Slow beside the kernel; for ends of motions, for messages and as the tests' oracle.

use clearway_geometry::distance::closer_than;
use clearway_geometry::{Convex, Pose};
use clearway_robot::{Group, Sphere};

/// What a configuration touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// Two links, by index.
    Links(usize, usize),
    /// A link, and an obstacle by its number.
    Obstacle(usize, usize),
}

/// The first thing that the spheres of a configuration touch; `obstacles` are in the root frame.
/// `margin` is kept from them only. Links that no joint moves are mounted among them, and may touch.
pub fn contact(
    group: &Group,
    spheres: &[Vec<Sphere>],
    unchecked: &[(usize, usize)],
    obstacles: &[(Pose, Convex)],
    q: &[f64],
    margin: f64,
) -> Option<Contact> {
    let mut frames = Vec::new();
    group.kinematics.frames(q, group.hand[0], &mut frames);
    let placed: Vec<Vec<Sphere>> = spheres
        .iter()
        .zip(&frames)
        .map(|(own, frame)| own.iter().map(|s| Sphere { centre: frame.point(s.centre), ..*s }).collect())
        .collect();
    let moves = |link: usize| !group.kinematics.is_still(link);
    for (number, (pose, convex)) in obstacles.iter().enumerate() {
        for (link, own) in placed.iter().enumerate().filter(|(link, _)| moves(*link)) {
            let near = |s: &Sphere| {
                let point = Convex::Sphere { radius: 0.0 };
                closer_than(&point, &Pose::from_translation(s.centre), convex, pose, s.radius + margin)
            };
            if own.iter().any(near) {
                return Some(Contact::Obstacle(link, number));
            }
        }
    }
    for a in 0..placed.len() {
        for b in a + 1..placed.len() {
            if unchecked.contains(&(a, b)) {
                continue;
            }
            let near = |s: &Sphere| placed[b].iter().any(|t| s.centre.distance(t.centre) < s.radius + t.radius);
            if placed[a].iter().any(near) {
                return Some(Contact::Links(a, b));
            }
        }
    }
    None
}

/// Postures that say how often two links touch.
const SAMPLES: usize = 256;

/// Which pairs of links need no check: those that the SRDF names, those that do not move against
/// each other, and, by postures spread over the joints' ranges, those whose shapes touch in every one
/// of them. Without an SRDF, links joined by a joint as well. `spheres` cover the links.
pub fn unchecked_pairs(group: &Group, spheres: &[Vec<Sphere>]) -> Vec<(usize, usize)> {
    let still = |a: usize, b: usize| {
        group.kinematics.moved_by[a] == group.kinematics.moved_by[b]
            && group.kinematics.moved_by_hand[a] == group.kinematics.moved_by_hand[b]
    };
    let shaped: Vec<usize> = (0..spheres.len()).filter(|&l| !spheres[l].is_empty()).collect();
    let mut unchecked = Vec::new();
    let mut asked = Vec::new();
    for (n, &a) in shaped.iter().enumerate() {
        for &b in &shaped[n + 1..] {
            let named = group.disabled_pairs.contains(&(a, b));
            if named || still(a, b) || group.disabled_pairs.is_empty() && group.adjacent(a, b) {
                unchecked.push((a, b));
            } else {
                asked.push((a, b));
            }
        }
    }
    let mut frames = Vec::new();
    for sample in 0..SAMPLES {
        group.kinematics.frames(&group.spread(sample), group.hand[0], &mut frames);
        asked.retain(|&(a, b)| {
            spheres_touch(&spheres[a], &frames[a], &spheres[b], &frames[b]) && shapes_touch(group, a, b, &frames)
        });
    }
    unchecked.extend(asked);
    unchecked.sort_unstable();
    unchecked
}

/// Whether spheres of two links touch, each with its link's frame.
pub(super) fn spheres_touch(own: &[Sphere], root_from_own: &Pose, others: &[Sphere], root_from_others: &Pose) -> bool {
    let placed: Vec<Sphere> =
        others.iter().map(|t| Sphere { centre: root_from_others.point(t.centre), ..*t }).collect();
    own.iter().any(|s| {
        let at = root_from_own.point(s.centre);
        placed.iter().any(|t| at.distance(t.centre) < s.radius + t.radius)
    })
}

fn shapes_touch(group: &Group, a: usize, b: usize, frames: &[Pose]) -> bool {
    let parts = |link: usize| group.links[link].collision.parts.iter().map(move |(pose, c)| (frames[link] * *pose, c));
    parts(a).any(|(pa, ca)| parts(b).any(|(pb, cb)| closer_than(ca, &pa, cb, &pb, 0.0)))
}
