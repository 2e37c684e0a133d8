//! RRT-Connect (Kuffner and LaValle 2000): two trees that grow towards each other.
//!
//! Trees stay small (tens of nodes on most problems), so the nearest node is found by a flat scan.

use crate::{Path, Posture, Space, distance};
use clearway_plan::{Budget, Stop};
use rand::{Rng, RngExt};

/// How the trees grow.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Longest new line, radians in joint space.
    pub range: f64,
    /// Samples drawn before giving up.
    pub iterations: usize,
    /// Part of the samples drawn near start and goals rather than from all postures.
    pub near: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { range: 0.8, iterations: 600, near: 0.75 }
    }
}

impl Settings {
    pub fn validate(&self) -> Result<(), String> {
        if !(self.range > 0.0) {
            return Err(format!("range is {}, must be positive", self.range));
        }
        if !(0.0..=1.0).contains(&self.near) {
            return Err(format!("near is {}, must lie in 0..=1", self.near));
        }
        Ok(())
    }
}

/// Part of the samples taken from guides, where there are any.
const GUIDED: f64 = 0.8;

struct Tree {
    nodes: Vec<Posture>,
    parents: Vec<usize>,
}

impl Tree {
    fn rooted(roots: &[Posture]) -> Self {
        Self { nodes: roots.to_vec(), parents: (0..roots.len()).collect() }
    }

    fn nearest(&self, q: &[f64]) -> usize {
        let mut best = (0, f64::INFINITY);
        for (i, node) in self.nodes.iter().enumerate() {
            let d = node.iter().zip(q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            if d < best.1 {
                best = (i, d);
            }
        }
        best.0
    }

    fn add(&mut self, q: Posture, parent: usize) -> usize {
        self.nodes.push(q);
        self.parents.push(parent);
        self.nodes.len() - 1
    }

    /// From the root to `node`.
    fn branch(&self, mut node: usize) -> Path {
        let mut path = vec![self.nodes[node].clone()];
        while self.parents[node] != node {
            node = self.parents[node];
            path.push(self.nodes[node].clone());
        }
        path.reverse();
        path
    }
}

/// A path from `start` to one of `goals`, or `None` when the iterations run out. Postures that
/// are not free are left out; a straight line is tried first. `guides`: postures that are likely
/// to be of use; most samples are then taken from them.
#[allow(clippy::too_many_arguments)]
pub fn connect(
    space: &mut Space,
    start: &Posture,
    goals: &[Posture],
    guides: &[Posture],
    settings: &Settings,
    random: &mut impl Rng,
    budget: &Budget,
) -> Result<Option<Path>, Stop> {
    let goals: Vec<Posture> = goals.iter().filter(|g| space.free(g)).cloned().collect();
    if goals.is_empty() || !space.free(start) {
        return Ok(None);
    }
    for goal in &goals {
        if space.line_free(start, goal) {
            return Ok(Some(vec![start.clone(), goal.clone()]));
        }
    }
    let (low, high) = neighbourhood(space, start, &goals);
    let mut from_start = Tree::rooted(std::slice::from_ref(start));
    let mut from_goal = Tree::rooted(&goals);
    let mut forward = true;
    for _ in 0..settings.iterations {
        budget.check()?;
        let guided = !guides.is_empty() && random.random::<f64>() < GUIDED;
        let near = random.random::<f64>() < settings.near;
        let sample: Posture = if guided {
            guides[random.random_range(0..guides.len())].clone()
        } else {
            (0..start.len())
            .map(|j| {
                let (l, u) = if near { (low[j], high[j]) } else { range(space, j) };
                l + (u - l) * random.random::<f64>()
            })
            .collect()
        };
        let (tree, other) = if forward { (&mut from_start, &mut from_goal) } else { (&mut from_goal, &mut from_start) };
        if let Some(new) = extend(space, tree, &sample, settings.range) {
            let target = tree.nodes[new].clone();
            if let Some(met) = reach(space, other, &target, settings.range) {
                let (mut path, mut rest) = (tree.branch(new), other.branch(met));
                rest.pop();
                rest.reverse();
                path.extend(rest);
                if !forward {
                    path.reverse();
                }
                return Ok(Some(path));
            }
        }
        // The smaller tree grows next.
        forward = from_start.nodes.len() <= from_goal.nodes.len();
    }
    Ok(None)
}

/// A box round start and goals, wider by a radian and a half, within the limits.
fn neighbourhood(space: &Space, start: &Posture, goals: &[Posture]) -> (Posture, Posture) {
    const WIDER: f64 = 1.5;
    let ends = || goals.iter().chain(std::iter::once(start));
    (0..start.len())
        .map(|j| {
            let low = ends().map(|q| q[j]).fold(f64::INFINITY, f64::min) - WIDER;
            let high = ends().map(|q| q[j]).fold(f64::NEG_INFINITY, f64::max) + WIDER;
            (low.max(space.lower()[j]), high.min(space.upper()[j]))
        })
        .unzip()
}

fn range(space: &Space, joint: usize) -> (f64, f64) {
    let pi = std::f64::consts::PI;
    let (l, u) = (space.lower()[joint], space.upper()[joint]);
    (if l.is_finite() { l } else { -pi }, if u.is_finite() { u } else { pi })
}

/// One step from the tree towards `sample`.
fn extend(space: &mut Space, tree: &mut Tree, sample: &[f64], range: f64) -> Option<usize> {
    let nearest = tree.nearest(sample);
    let from = tree.nodes[nearest].clone();
    let to = step(&from, sample, range);
    space.line_free(&from, &to).then(|| tree.add(to, nearest))
}

/// Steps from the tree towards `target` until it is reached.
fn reach(space: &mut Space, tree: &mut Tree, target: &[f64], range: f64) -> Option<usize> {
    let mut at = tree.nearest(target);
    loop {
        let from = tree.nodes[at].clone();
        if distance(&from, target) < 1e-12 {
            return Some(at);
        }
        let to = step(&from, target, range);
        if !space.line_free(&from, &to) {
            return None;
        }
        at = tree.add(to, at);
    }
}

fn step(from: &[f64], to: &[f64], range: f64) -> Posture {
    let d = distance(from, to);
    if d <= range {
        return to.to_vec();
    }
    from.iter().zip(to).map(|(a, b)| a + (b - a) * range / d).collect()
}
