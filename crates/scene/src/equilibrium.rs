//! Do bodies that press on each other stay where they are?
//!
//! Seen from above: a body is a mass at a point, and what carries it pushes it up somewhere in a
//! polygon. They stay if there are pushes such that each body's forces and moments balance.
//!
//! What stands on one thing only pushes it under its own centre of mass, and counts as part of it from
//! then on. What is left, bodies on several others, is a system of linear equations for forces at the
//! corners. If those have no solution, the proof of that is a motion: the one in which things fall.

use crate::feasible::{Column, Infeasible, solve};
use clearway_geometry::{Vec2, polygon};

/// Less of a motion than this part of the largest is none.
const STILL: f64 = 1e-6;

/// A body from above: its mass, and where its centre is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weight {
    pub(crate) mass: f64,
    pub(crate) centre: Vec2,
}

/// `upper` may be pushed up anywhere in the polygon by `lower`, or by what stands fast.
#[derive(Clone, Debug)]
pub(crate) struct Push {
    pub(crate) upper: usize,
    pub(crate) lower: Option<usize>,
    pub(crate) patch: Vec<Vec2>,
}

/// A body that falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fall {
    pub(crate) body: usize,
    /// It would not fall by itself: what it carries makes it.
    pub(crate) loaded: bool,
    /// The centre of mass that is not carried, of the body or of all that is upon it, and the nearest
    /// point that is. Nothing where no single point tells, or nothing carries it.
    pub(crate) aside: Option<(Vec2, Vec2)>,
}

/// The first body found to fall, if any. A push may act up to `forgiven` (metres) outside of its polygon.
pub(crate) fn fall(bodies: &[Weight], pushes: &[Push], forgiven: f64) -> Option<Fall> {
    let mut whole = Whole { bodies, pushes, forgiven, merged: bodies.to_vec(), left: vec![true; bodies.len()] };
    whole.merge().or_else(|| (0..bodies.len()).find_map(|seed| whole.component(seed)))
}

struct Whole<'a> {
    bodies: &'a [Weight],
    pushes: &'a [Push],
    forgiven: f64,
    /// With what was merged into them.
    merged: Vec<Weight>,
    /// Neither merged nor judged yet.
    left: Vec<bool>,
}

impl Whole<'_> {
    fn under(&self, body: usize) -> impl Iterator<Item = &Push> {
        self.pushes.iter().filter(move |p| p.upper == body)
    }

    fn carries(&self, body: usize) -> bool {
        self.pushes.iter().any(|p| p.lower == Some(body) && self.left[p.upper])
    }

    /// Merges what stands on one thing into it, from above, as long as there is such a thing.
    fn merge(&mut self) -> Option<Fall> {
        let mut tops: Vec<usize> = (0..self.bodies.len()).rev().collect();
        while let Some(top) = tops.pop() {
            if !self.left[top] || self.carries(top) || self.under(top).count() > 1 {
                continue;
            }
            let Some(push) = self.pushes.iter().find(|p| p.upper == top) else { return Some(self.tell(top)) };
            let Weight { mass, centre } = self.merged[top];
            if polygon::nearest(&push.patch, centre).is_none_or(|p| p.distance(centre) > self.forgiven) {
                return Some(self.tell(top));
            }
            self.left[top] = false;
            if let Some(lower) = push.lower {
                let below = &mut self.merged[lower];
                let sum = below.mass + mass;
                below.centre = (below.centre * below.mass + centre * mass) / sum;
                below.mass = sum;
                tops.push(lower);
            }
        }
        None
    }

    /// What to say of a body that falls.
    fn tell(&self, body: usize) -> Fall {
        let corners: Vec<Vec2> = self.under(body).flat_map(|p| p.patch.iter().copied()).collect();
        let patch = polygon::hull(corners);
        let aside = |centre: Vec2| {
            polygon::nearest(&patch, centre).map(|p| (centre, p)).filter(|(c, p)| c.distance(*p) > self.forgiven)
        };
        let alone = aside(self.bodies[body].centre);
        let loaded = alone.is_none() && self.pushes.iter().any(|p| p.lower == Some(body));
        Fall { body, loaded, aside: alone.or_else(|| aside(self.merged[body].centre)) }
    }

    /// What falls among the bodies that hang together with this one.
    fn component(&mut self, seed: usize) -> Option<Fall> {
        let mut members: Vec<usize> = Vec::new();
        let mut next = vec![seed];
        while let Some(body) = next.pop() {
            if std::mem::replace(&mut self.left[body], false) {
                members.push(body);
                let touching = self.pushes.iter().filter_map(|p| match p.lower {
                    Some(lower) if lower == body => Some(p.upper),
                    lower if p.upper == body => lower,
                    _ => None,
                });
                next.extend(touching.filter(|b| self.left[*b]));
            }
        }
        if members.is_empty() {
            return None;
        }
        let Infeasible { multipliers } = self.balance(&members).err()?;
        let motion = |row: usize| multipliers[3 * row..3 * row + 3].iter().map(|y| y.abs()).fold(0.0, f64::max);
        let most = (0..members.len()).map(motion).fold(0.0, f64::max);
        let moves = |body: usize| members.iter().position(|m| *m == body).is_some_and(|row| motion(row) > STILL * most);
        // It begins with what moves upon things that do not.
        let first = |b: &&usize| moves(**b) && !self.under(**b).any(|p| p.lower.is_some_and(moves));
        let body = members.iter().find(first).or_else(|| members.iter().find(|b| moves(**b))).unwrap_or(&seed);
        Some(self.tell(*body))
    }

    /// Forces that balance the bodies. Each has three rows, its forces and its moments about its centre,
    /// divided by what all that is above it weighs, and by how far it is pushed.
    fn balance(&self, members: &[usize]) -> Result<Vec<f64>, Infeasible> {
        let mut row = vec![usize::MAX; self.bodies.len()];
        members.iter().enumerate().for_each(|(i, body)| row[*body] = i);
        let pushes: Vec<(&Push, Vec<Vec2>)> = self
            .pushes
            .iter()
            .filter(|p| row[p.upper] != usize::MAX)
            .map(|p| (p, polygon::grown(&p.patch, self.forgiven)))
            .collect();
        let mut reach = vec![1e-3_f64; members.len()];
        for (push, corners) in &pushes {
            for body in [Some(push.upper), push.lower].into_iter().flatten() {
                let far = corners.iter().map(|c| c.distance(self.merged[body].centre)).fold(0.0, f64::max);
                reach[row[body]] = reach[row[body]].max(far);
            }
        }
        let weight: Vec<f64> = members.iter().map(|body| self.above(*body)).collect();
        let mut columns: Vec<Column> = Vec::new();
        for (push, corners) in &pushes {
            let own = weight[row[push.upper]];
            for corner in corners {
                let mut column = Column::with_capacity(6);
                for (body, sign) in [(Some(push.upper), 1.0), (push.lower, -1.0)] {
                    let Some(body) = body else { continue };
                    let r = row[body];
                    let arm = (*corner - self.merged[body].centre) / reach[r];
                    let force = sign * own / weight[r];
                    column.extend([(3 * r, force), (3 * r + 1, force * arm.x), (3 * r + 2, force * arm.y)]);
                }
                columns.push(column);
            }
        }
        let right: Vec<f64> =
            members.iter().zip(&weight).flat_map(|(b, w)| [self.merged[*b].mass / w, 0.0, 0.0]).collect();
        solve(&columns, &right)
    }

    /// The mass of a body and of all that is upon it.
    fn above(&self, body: usize) -> f64 {
        let mut known = vec![false; self.bodies.len()];
        let mut next = vec![body];
        let mut sum = 0.0;
        while let Some(body) = next.pop() {
            if !std::mem::replace(&mut known[body], true) {
                sum += self.bodies[body].mass;
                next.extend(self.pushes.iter().filter(|p| p.lower == Some(body)).map(|p| p.upper));
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(mass: f64, x: f64) -> Weight {
        Weight { mass, centre: Vec2::new(x, 0.0) }
    }

    fn push(upper: usize, lower: Option<usize>, from: f64, to: f64) -> Push {
        let patch = [(from, -0.01), (to, -0.01), (to, 0.01), (from, 0.01)];
        Push { upper, lower, patch: patch.map(|(x, y)| Vec2::new(x, y)).to_vec() }
    }

    #[test]
    fn who_falls() {
        let ground = push(0, None, -0.1, 0.1);
        assert_eq!(fall(&[at(1.0, 0.05)], std::slice::from_ref(&ground), 0.0), None);
        let Some(alone) = fall(&[at(1.0, 0.15)], std::slice::from_ref(&ground), 0.01) else { panic!("it falls") };
        assert!(!alone.loaded && alone.aside.is_some_and(|(c, p)| (c.distance(p) - 0.05).abs() < 1e-12));
        assert_eq!(fall(&[at(1.0, 0.15)], std::slice::from_ref(&ground), 0.06), None);
        assert_eq!(fall(&[at(1.0, 0.0)], &[], 1.0), Some(Fall { body: 0, loaded: false, aside: None }));
        // A load on an overhang.
        let load = push(1, Some(0), 0.1, 0.3);
        assert_eq!(fall(&[at(1.0, 0.0), at(0.9, 0.2)], &[ground.clone(), load.clone()], 0.0), None);
        let Some(found) = fall(&[at(1.0, 0.0), at(1.1, 0.2)], &[ground.clone(), load.clone()], 0.0) else {
            panic!("it falls")
        };
        assert!(found.body == 0 && found.loaded);
        // The same held from below by a third, and that by nothing.
        let pushes = [ground, load, push(0, Some(2), 0.2, 0.3), push(2, None, 0.2, 0.3)];
        assert_eq!(fall(&[at(1.0, 0.0), at(1.1, 0.2), at(1.0, 0.25)], &pushes, 0.0), None);
        assert_eq!(fall(&[at(1.0, 0.0), at(1.1, 0.2), at(1.0, 0.25)], &pushes[..3], 0.0).map(|f| f.body), Some(2));
    }

    /// Merging what stands on one thing is a shortcut: all equations together say the same.
    #[test]
    fn merging_changes_nothing() {
        let mut state = 7_u64;
        let mut draw = |low: f64, high: f64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut falls = 0;
        for _ in 0..2000 {
            let count = 1 + draw(0.0, 7.0) as usize;
            let mut bodies = Vec::new();
            let mut pushes = Vec::new();
            for i in 0..count {
                bodies.push(Weight {
                    mass: 10_f64.powf(draw(-3.0, 3.0)),
                    centre: Vec2::new(draw(-0.1, 0.1), draw(-0.005, 0.005)),
                });
                for lower in (0..i).map(Some).chain([None]) {
                    if draw(0.0, 1.0) < if lower.is_some() { 0.3 } else { 0.6 } {
                        pushes.push(push(i, lower, draw(-0.2, 0.05), draw(-0.05, 0.2).max(0.06)));
                    }
                }
            }
            let whole = |forgiven: f64| {
                let whole =
                    Whole { bodies: &bodies, pushes: &pushes, forgiven, merged: bodies.clone(), left: Vec::new() };
                whole.balance(&(0..count).collect::<Vec<_>>()).is_ok()
            };
            let (strict, lax) = (whole(0.0), whole(1e-5));
            if strict == lax {
                assert_eq!(fall(&bodies, &pushes, 0.0).is_none(), strict, "{bodies:?} {pushes:?}");
                falls += usize::from(!strict);
            }
        }
        assert!((300..1700).contains(&falls), "{falls}");
    }
}
