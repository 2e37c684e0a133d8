//! The arm's postures at one moment: which are free, which motions are.

use crate::{MotionValidator, Posture, between, distance};
use clearway_collision::lanes::{LANES, Suspects};
use clearway_collision::{Moment, Probe, Quick, Scratch, Slack, Touch, World};
use clearway_plan::ObjectSet;
use std::collections::VecDeque;

/// Postures of one robot at one moment.
pub struct Space<'a> {
    pub world: &'a World,
    pub moment: &'a Moment,
    /// Between two checked postures no point of the robot moves farther, metres.
    pub step: f64,
    scratch: Scratch,
    slack: Slack,
    queue: VecDeque<(f64, f64)>,
    /// Asked first where there is one: what it calls free is free.
    quick: Option<Quick>,
    suspects: Suspects,
    row: Posture,
    within: (&'a [f64], &'a [f64]),
}

/// Samples per radian that quick answers are asked with.
const PER_RADIAN: f64 = 32.0;

impl<'a> Space<'a> {
    pub fn new(world: &'a World, moment: &'a Moment, step: f64) -> Self {
        Self {
            world,
            moment,
            step,
            scratch: Scratch::default(),
            slack: Slack::default(),
            queue: VecDeque::new(),
            quick: None,
            suspects: Suspects::default(),
            row: Posture::new(),
            within: (&world.model.robot.lower, &world.model.robot.upper),
        }
    }

    /// The same, with the kernel asked first, if it knows what is held; worth its making for more
    /// than a few motions.
    pub fn quick(world: &'a World, moment: &'a Moment, step: f64) -> Self {
        let known = moment.held.as_ref().is_none_or(|held| held.kernel.is_some());
        Self { quick: known.then(|| Quick::new(world, moment)), ..Self::new(world, moment, step) }
    }

    /// Samples are drawn from between these, rather than from the joints' whole ranges.
    #[must_use]
    pub fn within(mut self, bounds: Option<(&'a [f64], &'a [f64])>) -> Self {
        self.within = bounds.unwrap_or(self.within);
        self
    }

    /// How many postures were checked so far.
    pub fn checked(&self) -> u64 {
        self.scratch.checked
    }

    pub fn free(&mut self, q: &[f64]) -> bool {
        let Some(quick) = &mut self.quick else { return self.world.free(q, self.moment, &mut self.scratch) };
        self.row.clear();
        self.row.extend_from_slice(q);
        let row = std::slice::from_ref(&self.row);
        if self.world.any_leans(row, self.moment, &mut self.scratch) {
            return false;
        }
        quick.suspects(row, &mut self.suspects);
        self.world.free_among(q, self.moment, &self.suspects, &mut self.scratch)
    }

    pub fn touched(&mut self, q: &[f64]) -> Touch {
        self.world.touched(q, self.moment, &mut self.scratch)
    }

    /// An upper bound of how far any point of the robot, or of what it holds, moves between two
    /// postures, metres.
    pub fn sweep(&mut self, a: &[f64], b: &[f64]) -> f64 {
        let joints: Posture = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
        self.slack.set(self.world, self.moment, &joints);
        self.slack.most()
    }

    /// Whether the straight line is free, both ends included; `a` is taken to be free already.
    pub fn line_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        if self.quick.is_none() {
            return self.line_free_exactly(a, b);
        }
        // The end is what most lines fail at; then only what the kernel suspects is looked at.
        self.surely_free(a, b) || self.free(b) && self.rows_free(&line(a, b))
    }

    /// Whether the kernel calls the straight line free; never without a kernel.
    fn surely_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.quick.as_mut().is_some_and(|q| q.motion_free(a, b, PER_RADIAN))
    }

    fn line_free_exactly(&mut self, a: &[f64], b: &[f64]) -> bool {
        if !self.free(b) {
            return false;
        }
        let along = |t: f64, q: &mut Posture| {
            q.clear();
            q.extend(a.iter().zip(b).map(|(a, b)| a + (b - a) * t));
        };
        let moved = |from: f64, to: f64, d: &mut Posture| {
            d.clear();
            d.extend(a.iter().zip(b).map(|(a, b)| (b - a).abs() * (to - from)));
        };
        self.between_free(0.0, 1.0, along, moved)
    }

    /// Whether rows with straight lines between them are free, the first included, and within the joints' limits:
    /// curves about a waypoint at a limit may swing beyond it.
    pub fn rows_free(&mut self, rows: &[Posture]) -> bool {
        if !rows.iter().all(|row| self.within_limits(row)) {
            return false;
        }
        if self.quick.is_none() || rows.len() < 2 {
            return self.rows_free_exactly(rows);
        }
        if self.world.any_leans(rows, self.moment, &mut self.scratch) {
            return false;
        }
        // Sixteen rows at a time, the last of them the next sixteen's first.
        let mut from = 0;
        while from + 1 < rows.len() {
            let to = (from + LANES - 1).min(rows.len() - 1);
            if let Some(quick) = &mut self.quick {
                quick.rows_suspects(&rows[from..=to], &mut self.suspects);
            }
            if !self.world.rows_clear(&rows[from..=to], self.moment, &self.suspects, self.step, &mut self.scratch) {
                return false;
            }
            from = to;
        }
        true
    }

    fn within_limits(&self, q: &[f64]) -> bool {
        const ROUNDING: f64 = 1e-9;
        let robot = &self.world.model.robot;
        q.iter()
            .zip(&robot.lower)
            .zip(&robot.upper)
            .all(|((q, low), high)| *q >= low - ROUNDING && *q <= high + ROUNDING)
    }

    fn rows_free_exactly(&mut self, rows: &[Posture]) -> bool {
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return true };
        if !self.free(first) || !self.free(last) {
            return false;
        }
        // By row and joint: how much the joint has moved since the first row, back and forth.
        let mut travel: Vec<Posture> = vec![vec![0.0; first.len()]];
        for w in rows.windows(2) {
            let so_far = &travel[travel.len() - 1];
            travel.push(so_far.iter().zip(w[0].iter().zip(&w[1])).map(|(s, (a, b))| s + (b - a).abs()).collect());
        }
        let at = |values: &[Posture], t: f64, out: &mut Posture| {
            let i = (t as usize).min(values.len() - 2);
            let part = t - i as f64;
            out.clear();
            out.extend(values[i].iter().zip(&values[i + 1]).map(|(a, b)| a + (b - a) * part));
        };
        if rows.len() < 2 {
            return true;
        }
        let mut start = Posture::new();
        let moved = |from: f64, to: f64, d: &mut Posture| {
            at(&travel, to, d);
            at(&travel, from, &mut start);
            d.iter_mut().zip(&start).for_each(|(d, s)| *d -= s);
        };
        self.between_free(0.0, (rows.len() - 1) as f64, |t, q| at(rows, t, q), moved)
    }

    /// Whether the open interval of a motion is free: halves it, coarse first, until every part is
    /// certified from its middle or shorter than [`Self::step`]. `along` gives the posture at a
    /// parameter, `moved` how much each joint moves between two.
    fn between_free(
        &mut self,
        from: f64,
        to: f64,
        along: impl Fn(f64, &mut Posture),
        mut moved: impl FnMut(f64, f64, &mut Posture),
    ) -> bool {
        let (mut q, mut half) = (Posture::new(), Posture::new());
        self.queue.clear();
        self.queue.push_back((from, to));
        while let Some((a, b)) = self.queue.pop_front() {
            let middle = (a + b) / 2.0;
            moved(a, middle, &mut half);
            let mut other = std::mem::take(&mut q);
            moved(middle, b, &mut other);
            half.iter_mut().zip(&other).for_each(|(h, o)| *h = h.max(*o));
            q = other;
            self.slack.set(self.world, self.moment, &half);
            if self.slack.most() * 2.0 <= self.step {
                continue;
            }
            along(middle, &mut q);
            match self.world.probe(&q, self.moment, Some(&self.slack), &mut self.scratch) {
                Probe::Hit => return false,
                Probe::Around => {}
                Probe::Here => self.queue.extend([(a, middle), (middle, b)]),
            }
        }
        true
    }

    /// Everything movable that a path touches; `None` when it touches something fixed.
    pub fn path_touched(&mut self, path: &[Posture]) -> Option<ObjectSet> {
        // One posture is a path, too.
        let mut postures: Vec<Posture> = path.first().cloned().into_iter().collect();
        for w in path.windows(2) {
            let count = (self.sweep(&w[0], &w[1]) / self.step).ceil().max(1.0) as usize;
            postures.extend((0..=count).map(|i| between(&w[0], &w[1], i as f64 / count as f64)));
        }
        let mut all = ObjectSet::EMPTY;
        for some in postures.chunks(LANES) {
            if let Some(quick) = &mut self.quick {
                quick.suspects(some, &mut self.suspects);
            }
            for (lane, q) in some.iter().enumerate() {
                // Where spheres touch nothing there is nothing to be told.
                if self.quick.is_some() && !self.suspects.any_in(lane) {
                    continue;
                }
                match self.touched(q) {
                    Touch::Fixed => return None,
                    Touch::Objects(set) => all = all.union(set),
                }
            }
        }
        Some(all)
    }
}

impl MotionValidator for Space<'_> {
    fn lower(&self) -> &[f64] {
        self.within.0
    }

    fn upper(&self) -> &[f64] {
        self.within.1
    }

    fn state_free(&mut self, q: &[f64]) -> bool {
        self.free(q)
    }

    fn motion_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.line_free(a, b)
    }
}

/// A straight line as rows, sparse enough for few blocks, dense enough for few suspects.
fn line(a: &[f64], b: &[f64]) -> Vec<Posture> {
    let count = (distance(a, b) * PER_RADIAN / 2.0).ceil().clamp(1.0, 1e4) as usize;
    (0..=count).map(|i| between(a, b, i as f64 / count as f64)).collect()
}

/// A [`Space`] in which links are free only where the kernel says so: quick, and a little tight.
pub struct Surely<'s, 'a>(pub &'s mut Space<'a>);

impl MotionValidator for Surely<'_, '_> {
    fn lower(&self) -> &[f64] {
        self.0.within.0
    }

    fn upper(&self) -> &[f64] {
        self.0.within.1
    }

    fn state_free(&mut self, q: &[f64]) -> bool {
        self.0.quick.as_mut().is_some_and(|k| k.free(q))
    }

    fn motion_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.0.surely_free(a, b)
    }
}
