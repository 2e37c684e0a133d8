//! Motions of the arm: free ones, level ones, and their timing.

use super::{Attempt, Carrier, obstructed};
use clearway_collision::{Lean, Moment, Scratch, Touch};
use clearway_geometry::{Mat3, Pose, Vec3};
use clearway_motion::{
    NearEnds, Path, Posture, RrtSettings, Space, Surely, Timed, connect, distance, rounded, shorten, simplify, smooth,
    time_curve,
};
use clearway_plan::{ObjectSet, Stop};
use rand::{Rng, RngExt};

/// What takes so many times as long as with its corners as round as can be is given up: another way may do.
const DAWDLES: f64 = 1.3;
/// Corners rounded by so much of what goes: nearly the path itself.
const HARDLY_ROUND: f64 = 0.2;

/// What a motion may be nearer to at its ends than between.
#[derive(Clone, Copy, Debug)]
pub(crate) enum AtEnds {
    Nothing,
    /// What is held may rest on what carries it, by this much of the tool's way.
    Resting {
        within: f64,
    },
    /// The hand comes to what it grips, or leaves it: the last standoff, or the first.
    Coming,
    Going,
}

impl AtEnds {
    /// As a moment is near the ends, and between.
    fn moments(self, moment: &Moment) -> (Moment, Moment) {
        match self {
            Self::Nothing => (moment.clone(), moment.clone()),
            Self::Resting { .. } => (Moment { resting: true, ..moment.clone() }, moment.clone()),
            Self::Coming | Self::Going => (moment.clone(), Moment { gripping: None, ..moment.clone() }),
        }
    }
}

impl<R: Rng> Carrier<'_, R> {
    /// What the hand touches while it turns from where a moment has it to another value: fingers may
    /// swing outwards on their way.
    pub(crate) fn hand_turning(&self, posture: &Posture, moment: &Moment, to: f64) -> Touch {
        const STEPS: usize = 16;
        let mut scratch = Scratch::default();
        let mut touched = ObjectSet::EMPTY;
        for i in 1..=STEPS {
            let hand = moment.hand + (to - moment.hand) * i as f64 / STEPS as f64;
            match self.world.touched_by_hand(posture, &Moment { hand, ..moment.clone() }, &mut scratch) {
                Touch::Fixed => return Touch::Fixed,
                Touch::Objects(set) => touched = touched.union(set),
            }
        }
        Touch::Objects(touched)
    }

    /// A free motion, shortened. When none is found, a motion that may pass through objects tells
    /// which of them stand in the way.
    pub(crate) fn free_motion(
        &mut self,
        moment: &Moment,
        start: &Posture,
        goals: &[Posture],
        what: &'static str,
    ) -> Attempt<Path> {
        // Ends may be nearer to things than free motion likes to be; then it has to do with less.
        let mut near = moment.clone();
        let mut space = Space::quick(self.world, moment, self.settings.step).within(self.within);
        if !space.free(start) || !goals.iter().any(|g| space.free(g)) {
            near.margin = self.settings.final_margin;
            near.held_margin = self.settings.final_held_margin;
            space = Space::quick(self.world, &near, self.settings.step).within(self.within);
        }
        if let Some(path) = self.connect(&mut space, start, goals, &[], self.settings.rrt.iterations)? {
            return Ok(Ok(path));
        }
        let mut relaxed = near.clone();
        relaxed.standing = ObjectSet::EMPTY;
        let mut space = Space::quick(self.world, &relaxed, self.settings.step).within(self.within);
        let Some(path) = self.connect(&mut space, start, goals, &[], self.settings.rrt.iterations)? else {
            return obstructed(what, ObjectSet::EMPTY);
        };
        let blamed = Space::quick(self.world, &near, self.settings.step).path_touched(&path).unwrap_or_default();
        obstructed(what, blamed)
    }

    /// A shortened path: among motions that the kernel calls free if there is one, else among all
    /// that are.
    fn connect(
        &mut self,
        space: &mut Space,
        start: &Posture,
        goals: &[Posture],
        guides: &[Posture],
        iterations: usize,
    ) -> Result<Option<Path>, Stop> {
        let rrt = RrtSettings { iterations, ..self.settings.rrt.clone() };
        let mut surely = Surely(space);
        let mut sampler = NearEnds::new(&surely, start, goals, guides, self.settings.near, self.random);
        if let Some(path) = connect(&mut surely, start, goals, &mut sampler, &rrt, self.trees, self.budget)? {
            return Ok(Some(simplify(&mut surely, path, &self.settings.simplify, self.budget)?));
        }
        let mut sampler = NearEnds::new(space, start, goals, guides, self.settings.near, self.random);
        match connect(space, start, goals, &mut sampler, &rrt, self.trees, self.budget)? {
            Some(path) => Ok(Some(shorten(space, path, self.settings.shortcuts, self.random, self.budget)?)),
            None => Ok(None),
        }
    }

    /// Smooths and times a path, and checks every row.
    pub(crate) fn timed(&mut self, moment: &Moment, path: &Path, ends: AtEnds, what: &'static str) -> Attempt<Timed> {
        let limits = self.limits(1.0);
        let (lenient, strict) = ends.moments(moment);
        let mut at_ends = Space::quick(self.world, &lenient, self.settings.final_step);
        let mut between = Space::quick(self.world, &strict, self.settings.final_step);
        let (mut roundest, mut failed) = (f64::INFINITY, (false, Vec::new()));
        // As round as can be; where that touches something, only as round as is free; half as round, and free of what
        // the ends may touch, too; hardly round.
        for attempt in 0..4 {
            self.budget.check()?;
            let curve = match attempt {
                0 => rounded(path, 1.0),
                1 => smooth(&mut Space::quick(self.world, &lenient, self.settings.step), path, 1.0),
                2 => smooth(&mut Space::quick(self.world, &strict, self.settings.step), path, 0.5),
                _ => rounded(path, HARDLY_ROUND),
            };
            let timed = time_curve(&curve, &limits, self.settings.row);
            let rows = &timed.positions;
            if rows.len() < 2 {
                return obstructed(what, ObjectSet::EMPTY);
            }
            let (from, to) = self.rows_between(ends, moment, rows);
            let parts = [(true, 0..=from), (false, from..=to), (true, to..=rows.len() - 1)];
            let touches = parts.into_iter().filter(|(_, part)| part.start() < part.end()).find(|(end, part)| {
                let space = if *end { &mut at_ends } else { &mut between };
                !space.rows_free(&rows[part.clone()])
            });
            roundest = roundest.min(timed.duration());
            match touches {
                None if timed.duration() > DAWDLES * roundest => return obstructed(what, ObjectSet::EMPTY),
                None => return Ok(Ok(timed)),
                Some((end, part)) => failed = (end, rows[part].to_vec()),
            }
        }
        // What is grazed between shows only when looked at finely, which takes long.
        let (end, rows) = failed;
        let (touching, fine) = if end { (&lenient, &mut at_ends) } else { (&strict, &mut between) };
        let mut blamed = match Space::quick(self.world, touching, self.settings.step).path_touched(&rows) {
            Some(touched) if touched.is_empty() => fine.path_touched(&rows).unwrap_or_default(),
            touched => touched.unwrap_or_default(),
        };
        moment.gripping.into_iter().for_each(|object| blamed.remove(object));
        obstructed(what, blamed)
    }

    /// The first and the last row of a motion at which it is no longer near its ends.
    fn rows_between(&self, ends: AtEnds, moment: &Moment, rows: &[Posture]) -> (usize, usize) {
        let end = rows.len() - 1;
        let tool = |q: &Posture| self.world.model.kinematics.tool(q, moment.hand).translation;
        let (first, last) = (tool(&rows[0]), tool(&rows[end]));
        match ends {
            AtEnds::Nothing => (0, end),
            AtEnds::Resting { within } => {
                let low = |q: &Posture, end: Vec3| {
                    let off = tool(q) - end;
                    off.dot(self.world.up()).abs() < self.settings.resting && off.length() < within
                };
                let from = rows.iter().position(|q| !low(q, first)).unwrap_or(end);
                let to = rows.iter().rposition(|q| !low(q, last)).unwrap_or(from).max(from);
                (from, to)
            }
            AtEnds::Coming => (0, self.comes_near(rows).unwrap_or(0)),
            AtEnds::Going => (self.is_gone(rows).unwrap_or(end), end),
        }
    }

    /// A free motion with the object in hand: level if one is found soon, otherwise any.
    pub(crate) fn level_motion(
        &mut self,
        moment: &Moment,
        start: &Posture,
        goal: &Posture,
        what: &'static str,
    ) -> Attempt<Path> {
        let world = self.world;
        let up = world.up();
        let (from, to) =
            (world.model.kinematics.tool(start, moment.hand), world.model.kinematics.tool(goal, moment.hand));
        let level = Moment {
            lean: Some(Lean { axis: from.rotation.transpose() * up, upward: up, least: self.settings.lean.cos() }),
            ..moment.clone()
        };
        let mut space = Space::quick(world, &level, self.settings.step);
        let mut path = None;
        if space.free(start) && space.free(goal) {
            if space.line_free(start, goal) {
                path = Some(vec![start.clone(), goal.clone()]);
            } else {
                // Postures in between that hold the object upright, for the trees to grow towards.
                let (low, high) =
                    (from.translation.min(to.translation) - 0.25, from.translation.max(to.translation) + 0.25);
                let mut guides = Vec::new();
                for _ in 0..self.settings.guides {
                    self.budget.check()?;
                    let mut at = || self.random.random::<f64>();
                    let turn = Mat3::from_axis_angle(up, std::f64::consts::TAU * at());
                    let position = low + (high - low) * Vec3::new(at(), at(), at());
                    let pose = Pose::new(turn * from.rotation, position);
                    let near = [start, goal].into_iter().flat_map(|near| self.inverse.solve_near(&pose, near));
                    let off = |q: &Posture| distance(q, start) + distance(q, goal);
                    guides.extend(near.min_by(|a, b| off(a).total_cmp(&off(b))));
                }
                path = self.connect(
                    &mut space,
                    start,
                    std::slice::from_ref(goal),
                    &guides,
                    self.settings.level_iterations,
                )?;
            }
        }
        match path {
            Some(path) => Ok(Ok(path)),
            None => self.free_motion(moment, start, std::slice::from_ref(goal), what),
        }
    }
}
