//! Do bodies that carry each other balance? Each thing that carries a body pushes it up with any
//! forces ≥ 0 at the corners of the patch where they meet, and is pushed down as hard; the ground
//! bears anything. Of every body the forces add up to its weight, and so do their moments.
//!
//! What rests on one thing alone pushes it where its weight and what it bears add up to, so towers
//! are settled from the top. What is left, and rests on several things, is one linear problem.

use super::polygon::{Point, outside};
use super::solver::{Answer, Problem, solve};

/// Among more, who is to blame is not looked into.
const MANY: usize = 30;

pub(super) struct Body {
    pub weight: f64,
    /// Of mass.
    pub centre: Point,
    /// All that carries it; each thing once.
    pub rests: Vec<Rest>,
}

pub(super) struct Rest {
    /// Another body; `None` is the ground.
    pub on: Option<usize>,
    pub patch: Vec<Point>,
}

#[derive(Debug, PartialEq, Eq)]
pub(super) enum Balance {
    Stands,
    /// This body tips, with what is on it.
    Tips(usize),
    /// One of these, or several.
    Falls(Vec<usize>),
    /// Not known of these.
    Unknown(Vec<usize>),
}

/// A force down and where, times the force.
#[derive(Clone, Copy)]
struct Load {
    force: f64,
    moment: Point,
}

pub(super) fn balance(bodies: &[Body]) -> Balance {
    let mut loads = weights(bodies);
    let mut bears = vec![0_usize; bodies.len()];
    bodies.iter().flat_map(|b| &b.rests).filter_map(|r| r.on).for_each(|on| bears[on] += 1);
    let mut open = vec![true; bodies.len()];
    let mut ready: Vec<usize> = (0..bodies.len()).filter(|b| bears[*b] == 0).collect();
    while let Some(body) = ready.pop() {
        let [rest] = &bodies[body].rests[..] else { continue };
        let load = loads[body];
        if outside(&rest.patch, load.moment / load.force) > 0.0 {
            return Balance::Tips(body);
        }
        open[body] = false;
        if let Some(on) = rest.on {
            loads[on].force += load.force;
            loads[on].moment += load.moment;
            bears[on] -= 1;
            if bears[on] == 0 {
                ready.push(on);
            }
        }
    }
    for group in groups(bodies, &open) {
        match solve(&problem(bodies, &loads, &group)) {
            Answer::Yes => {}
            Answer::No => return Balance::Falls(to_blame(bodies, &loads, group)),
            Answer::Unknown => return Balance::Unknown(group),
        }
    }
    Balance::Stands
}

/// Those of which the others would stand if that one were held.
fn to_blame(bodies: &[Body], loads: &[Load], group: Vec<usize>) -> Vec<usize> {
    if group.len() > MANY {
        return group;
    }
    let helps = |held: &usize| {
        let others: Vec<usize> = group.iter().copied().filter(|b| b != held).collect();
        solve(&problem(bodies, loads, &others)) == Answer::Yes
    };
    let found: Vec<usize> = group.iter().copied().filter(helps).collect();
    if found.is_empty() { group } else { found }
}

fn weights(bodies: &[Body]) -> Vec<Load> {
    bodies.iter().map(|b| Load { force: b.weight, moment: b.centre * b.weight }).collect()
}

/// The open bodies, together with those they rest on.
fn groups(bodies: &[Body], open: &[bool]) -> Vec<Vec<usize>> {
    let mut beside = vec![Vec::new(); bodies.len()];
    for (body, on) in bodies.iter().enumerate().flat_map(|(i, b)| b.rests.iter().filter_map(move |r| Some((i, r.on?))))
    {
        beside[body].push(on);
        beside[on].push(body);
    }
    let mut open = open.to_vec();
    let mut groups = Vec::new();
    for first in 0..bodies.len() {
        let mut group = Vec::new();
        let mut next = vec![first];
        while let Some(body) = next.pop() {
            if std::mem::take(&mut open[body]) {
                group.push(body);
                next.extend(&beside[body]);
            }
        }
        if !group.is_empty() {
            groups.push(group);
        }
    }
    groups
}

/// Three rows for each body of the group: force, and moments about its centre of mass, in units of
/// what it bears and of its size. An unknown for each corner, in units of what is above it. Bodies that
/// are not of the group bear anything.
fn problem(bodies: &[Body], loads: &[Load], group: &[usize]) -> Problem {
    let mut row = vec![None; bodies.len()];
    group.iter().enumerate().for_each(|(i, body)| row[*body] = Some(3 * i));
    let mut size = vec![1e-3_f64; bodies.len()];
    let corners = || {
        let rests = group.iter().flat_map(|body| bodies[*body].rests.iter().map(move |rest| (*body, rest)));
        rests.flat_map(|(body, rest)| rest.patch.iter().map(move |corner| (body, rest.on, *corner)))
    };
    for (body, on, corner) in corners() {
        for touched in [Some(body), on].into_iter().flatten() {
            size[touched] = size[touched].max((corner - bodies[touched].centre).length());
        }
    }
    let entries = |body: usize, at: Point, force: f64| {
        let away = (at - bodies[body].centre) / size[body] * force;
        row[body].map(|row| [(row, force), (row + 1, away.x), (row + 2, away.y)])
    };
    let column = |(body, on, corner): (usize, Option<usize>, Point)| {
        let up = entries(body, corner, 1.0);
        let down = on.and_then(|on| entries(on, corner, -loads[body].force / loads[on].force));
        up.into_iter().chain(down).flatten().collect()
    };
    let right = group.iter().flat_map(|body| {
        let load = loads[*body];
        let away = (load.moment / load.force - bodies[*body].centre) / size[*body];
        [1.0, away.x, away.y]
    });
    Problem { columns: corners().map(column).collect(), right: right.collect() }
}

#[cfg(test)]
mod tests;
