//! Is a straight motion of the joints free? Sixteen configurations of it at a time.
//!
//! **What is proved.** Configurations are sampled evenly along the motion, both ends included. A
//! sphere of radius *r* whose middle moves by at most *d* from one sample to the next sweeps
//! nothing outside of the spheres of radius √(r² + d²/4) + s about its sampled places, where *s*
//! is how far the middle's path may leave the straight line between them. So when the spheres,
//! that much larger, are clear at every sample, then everything between the samples is clear, too.
//! Where only the larger spheres touch, that stretch is sampled four times finer, at most
//! [`FINEST`] times in a row; what is still undecided then counts as touching. An answer of *free*
//! is therefore not about samples but about the motion, up to f32's rounding ([`ROUNDING`]).
//!
//! **What it costs.** Samples of a batch are spread over the whole motion, so that most motions
//! that touch are found out in their first batch. Obstacles that a part cannot reach during the
//! motion are dismissed once per motion. A link's spheres are placed only when its bound touches.

use super::body::{Body, Part, Settings as BodySettings};
use super::chain::Frame;
use super::neighbours::{self, Neighbours};
use super::never::Relative;
use super::obstacles::Obstacles;
use super::suspects::{Suspects, note};
use super::vector::{LANES, Lanes, Point, bits, counting, load, splat, store};
use clearway_robot::{Group, Sphere};
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x16};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

/// Added to every radius, metres: more than f32 loses over a chain of links.
pub const ROUNDING: f32 = 1e-5;
/// Work spent on proving that two links never meet, in boxes of joint values.
const MOST_BOXES: usize = 1000;
/// How often a stretch is sampled four times finer.
const FINEST: u32 = 3;

/// How far a direction of a frame may lean from where it should point; asked of the samples only.
#[derive(Clone, Copy, Debug)]
pub struct Upright {
    pub frame: usize,
    /// Unit, in that frame.
    pub axis: [f32; 3],
    /// Unit, in the root frame.
    pub upward: [f32; 3],
    /// Cosine of the largest angle between the two.
    pub least: f32,
}

/// What a motion is checked against.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    pub obstacles: &'a Obstacles,
    /// Which of them stand: a bit per slot, as [`Obstacles::mask`] makes them.
    pub standing: &'a [u16],
    /// Closer than this is touching, metres.
    pub margin: f32,
    /// The hand's joint value.
    pub hand: f32,
    pub upright: Option<Upright>,
    /// By part, where there are any: obstacles that it is known never to touch, as bits per slot.
    pub never: &'a [Vec<u16>],
}

/// The robot and the machine's best instructions.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub body: Body,
    pub level: Level,
    /// Pairs of links that tables answer for, not spheres: they are unchecked in the body.
    pub neighbours: Arc<[Neighbours]>,
    /// Where links that stand still are asked as obstacles: those of them, and those that move, which are
    /// checked against each other, `(a, b)` with `a < b`.
    pub still: Option<Arc<BTreeSet<(usize, usize)>>>,
    /// Room that was given back.
    idle: Arc<Mutex<Vec<Scratch>>>,
}

/// Room for one thread's questions; reuse it to allocate nothing. It also remembers what touched
/// last, to ask that first.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    frames: Vec<Frame>,
    /// By part: the middle of its bound.
    centres: Vec<[Lanes; 3]>,
    balls: Vec<[Lanes; 3]>,
    /// By ball: the batch it was placed for.
    placed: Vec<u32>,
    batch: u32,
    /// By group of parts and pairs: how far the whole motion moves them.
    swing: Vec<Lanes>,
    /// Likewise: by how much spheres are larger at the present step.
    larger: Vec<Lanes>,
    from: Vec<f32>,
    by: Vec<f32>,
    /// By part, then one more: where its candidates begin.
    reached: Vec<(u32, u32)>,
    candidates: Vec<u32>,
    near: Vec<u32>,
    joints: Vec<Lanes>,
    /// Times a part's swing: how far it may be from the box about four of its places on a stretch.
    strays: f32,
    /// Parts, those that touched last first.
    parts: Vec<u16>,
    /// How many configurations were looked at.
    pub configurations: u64,
    /// How many motions were asked about.
    pub motions: u64,
}

impl Kernel {
    pub fn new(body: Body) -> Self {
        Self::at_level(body, Level::new())
    }

    /// With other instructions than the best.
    pub fn at_level(body: Body, level: Level) -> Self {
        Self { body, level, neighbours: Arc::default(), still: None, idle: Arc::default() }
    }

    /// The same with another body, which has more on it.
    pub fn with_body(&self, body: Body) -> Self {
        Self {
            body,
            level: self.level,
            neighbours: self.neighbours.clone(),
            still: self.still.clone(),
            idle: Arc::default(),
        }
    }

    /// For links that `spheres` only cover. Pairs that their own shapes prove apart are left out, and
    /// near neighbours are asked by tables; `unchecked` are never checked.
    pub fn of_covers(
        group: &Group,
        spheres: &[Vec<Sphere>],
        mut unchecked: Vec<(usize, usize)>,
        settings: &BodySettings,
    ) -> Self {
        let links = group.links.len();
        for (a, b) in (0..links).flat_map(|a| (a + 1..links).map(move |b| (a, b))) {
            let (own, other) = (&group.links[a].collision, &group.links[b].collision);
            let apart = || Relative::new(group, a, b).always_apart(own, other, settings.self_margin, MOST_BOXES);
            if !unchecked.contains(&(a, b)) && apart() {
                unchecked.push((a, b));
            }
        }
        let neighbours = neighbours::find(group, spheres, &unchecked, settings.self_margin + f64::from(ROUNDING));
        unchecked.extend(neighbours.iter().map(|n| (n.a, n.b)));
        let kinematics = &group.kinematics;
        let still = |l: usize| kinematics.is_still(l);
        let shaped = |l: usize| !spheres[l].is_empty();
        let all = (0..links).flat_map(|a| (a + 1..links).map(move |b| (a, b)));
        let aside =
            all.filter(|&(a, b)| still(a) != still(b) && shaped(a) && shaped(b) && !unchecked.contains(&(a, b)));
        let aside = settings.still_aside.then(|| Arc::new(aside.collect()));
        let seen = |(link, spheres): (usize, &Vec<Sphere>)| {
            if aside.is_some() && still(link) { Vec::new() } else { spheres.clone() }
        };
        let spheres: Vec<Vec<Sphere>> = spheres.iter().enumerate().map(seen).collect();
        Self {
            neighbours: neighbours.into(),
            still: aside,
            ..Self::new(Body::new(group, &spheres, &unchecked, settings))
        }
    }

    /// Room for questions: some that was given back, or new.
    pub fn lend(&self) -> Scratch {
        let given_back = self.idle.lock().ok().and_then(|mut idle| idle.pop());
        match given_back {
            Some(mut scratch) => {
                (scratch.configurations, scratch.motions) = (0, 0);
                scratch.parts.sort_unstable_by(|a, b| b.cmp(a));
                scratch
            }
            None => self.scratch(),
        }
    }

    /// Takes room back, for whoever asks next; the still parts of a body need not be placed again.
    pub fn give_back(&self, scratch: Scratch) {
        if let Ok(mut idle) = self.idle.lock() {
            idle.push(scratch);
        }
    }

    pub fn scratch(&self) -> Scratch {
        let body = &self.body;
        let mut scratch = Scratch {
            frames: vec![Frame::identity(); body.chain.frames()],
            centres: vec![[Lanes::ZERO; 3]; body.parts.len()],
            balls: vec![[Lanes::ZERO; 3]; body.balls.len()],
            placed: vec![0; body.balls.len()],
            batch: 0,
            swing: vec![Lanes::ZERO; body.least.len()],
            larger: vec![Lanes::ZERO; body.least.len()],
            from: vec![0.0; body.chain.joints],
            by: vec![0.0; body.chain.joints],
            reached: vec![(0, 0); body.parts.len()],
            candidates: Vec::with_capacity(256),
            near: Vec::with_capacity(64),
            joints: vec![Lanes::ZERO; body.chain.joints],
            strays: 0.0,
            parts: (0..body.parts.len() as u16).filter(|p| body.parts[usize::from(*p)].frame != 0).rev().collect(),
            configurations: 0,
            motions: 0,
        };
        // The parts that stand still are placed once and for all.
        for (part, centre) in body.parts.iter().zip(&mut scratch.centres).filter(|(p, _)| p.frame == 0) {
            let still = |p: [f32; 3]| p.map(Lanes::splat);
            *centre = still(part.bound.centre);
            for ball in part.balls.clone() {
                scratch.balls[ball] = still(body.balls[ball].centre);
            }
        }
        scratch
    }

    /// Whether the straight motion from `a` to `b` is free, with at least `per_radian` samples per
    /// radian of joint distance. Both ends are looked at.
    pub fn motion_free(&self, a: &[f64], b: &[f64], per_radian: f64, around: &Around, scratch: &mut Scratch) -> bool {
        let count = self.begin(a, b, per_radian, scratch);
        dispatch!(self.level, simd => self.motion(simd, count, around, scratch))
            && self.neighbours.iter().all(|n| n.motion_clear(f64::from(around.hand), a, b))
    }

    /// What up to sixteen rows, and the straight lines between them, may touch.
    pub fn rows_suspects(&self, rows: &[Vec<f64>], around: &Around, scratch: &mut Scratch, suspects: &mut Suspects) {
        let steps = |j: usize| rows.windows(2).map(|w| (w[1][j] - w[0][j]).abs() as f32).fold(0.0, f32::max);
        for (j, by) in scratch.by.iter_mut().enumerate() {
            *by = steps(j);
        }
        self.suspects(rows, around, scratch, suspects);
        let hand = f64::from(around.hand);
        for n in self.neighbours.iter() {
            for (lane, _) in rows.windows(2).enumerate().filter(|(_, ends)| !n.motion_clear(hand, &ends[0], &ends[1])) {
                note(&mut suspects.pairs, (n.a, n.b), (0b11 << lane, 0));
            }
        }
    }

    /// What up to sixteen configurations may touch.
    pub fn configurations_suspects(
        &self,
        configurations: &[Vec<f64>],
        around: &Around,
        scratch: &mut Scratch,
        suspects: &mut Suspects,
    ) {
        scratch.by.fill(0.0);
        self.suspects(configurations, around, scratch, suspects);
        let hand = f64::from(around.hand);
        for n in self.neighbours.iter() {
            let touching = |lane: &usize| !n.clear(hand, |j| configurations[*lane][j]);
            let lanes = (0..configurations.len()).filter(touching).fold(0, |all, lane| all | 1 << lane);
            if lanes != 0 {
                note(&mut suspects.pairs, (n.a, n.b), (lanes, 0));
            }
        }
    }

    fn suspects(&self, rows: &[Vec<f64>], around: &Around, scratch: &mut Scratch, suspects: &mut Suspects) {
        suspects.clear();
        let Some(last) = rows.len().checked_sub(1) else { return };
        let mut joints = std::mem::take(&mut scratch.joints);
        for (j, lanes) in joints.iter_mut().enumerate() {
            for (lane, value) in lanes.0.iter_mut().enumerate() {
                *value = rows[lane.min(last)][j] as f32;
            }
        }
        dispatch!(self.level, simd => self.all_suspects(simd, &joints, around, scratch, suspects));
        scratch.joints = joints;
    }

    /// By lane, as bits: the configurations that touch nothing at all. `joints` has a row per joint.
    pub fn configurations_free(&self, joints: &[Lanes], around: &Around, scratch: &mut Scratch) -> u32 {
        scratch.configurations += LANES as u64;
        let free = dispatch!(self.level, simd => self.lanes_free(simd, joints, around, scratch));
        let hand = f64::from(around.hand);
        let clear = |lane: usize| self.neighbours.iter().all(|n| n.clear(hand, |j| f64::from(joints[j].0[lane])));
        if self.neighbours.is_empty() {
            return free;
        }
        (0..LANES).filter(|lane| free >> lane & 1 == 1 && clear(*lane)).fold(0, |mask, lane| mask | 1 << lane)
    }

    /// The room that obstacles keep, and links that are among them.
    fn margins(&self, around: &Around) -> [f32; 2] {
        [around.margin + ROUNDING, self.body.self_margin + ROUNDING]
    }

    /// Places all frames for sixteen configurations, and nothing more.
    pub fn place(&self, joints: &[Lanes], hand: f32, scratch: &mut Scratch) {
        dispatch!(self.level, simd => {
            let variable = |j: usize| if j < joints.len() { load(simd, &joints[j]) } else { splat(simd, hand) };
            self.body.chain.place(simd, variable, &mut scratch.frames);
        });
    }

    fn begin(&self, a: &[f64], b: &[f64], per_radian: f64, scratch: &mut Scratch) -> usize {
        let mut square = 0.0;
        for (((from, by), a), b) in scratch.from.iter_mut().zip(&mut scratch.by).zip(a).zip(b) {
            *from = *a as f32;
            *by = (b - a) as f32;
            square += (b - a) * (b - a);
        }
        scratch.motions += 1;
        let count = (square.sqrt() * per_radian).ceil().clamp(1.0, 1e6) as usize;
        count.next_multiple_of(LANES)
    }

    #[inline(always)]
    fn motion<S: Simd>(&self, simd: S, count: usize, around: &Around, scratch: &mut Scratch) -> bool {
        self.set_swing(simd, scratch);
        scratch.near.clear();
        self.stretch(simd, 0.0, 1.0, count, around, scratch) && self.finer(simd, count, around, scratch)
    }

    /// Samples one stretch, its near lanes pushed onto `scratch.near`; false when something touches.
    #[inline(always)]
    fn stretch<S: Simd>(
        &self,
        simd: S,
        lo: f32,
        hi: f32,
        count: usize,
        around: &Around,
        scratch: &mut Scratch,
    ) -> bool {
        let batches = count / LANES;
        let step = (hi - lo) / (count - 1) as f32;
        self.set_step(simd, step, scratch);
        let whole = hi - lo == 1.0;
        if whole {
            self.set_strays(step, batches, scratch);
        }
        for batch in 0..batches {
            let index = counting(simd).mul_add(splat(simd, batches as f32), splat(simd, batch as f32));
            let t = index.mul_add(splat(simd, step), splat(simd, lo));
            self.place_at(simd, t, around.hand, scratch);
            match self.batch::<S, false>(simd, whole && batch == 0, around, scratch, &mut Suspects::default()) {
                Some(near) => scratch.near.push(near),
                None => return false,
            }
        }
        true
    }

    /// Looks closer where only the larger spheres touched, down to the finest sampling.
    #[inline(always)]
    fn finer<S: Simd>(&self, simd: S, count: usize, around: &Around, scratch: &mut Scratch) -> bool {
        if scratch.near.iter().all(|m| *m == 0) {
            return true;
        }
        let mut waiting = Waiting::default();
        if !waiting.add(&scratch.near, 0.0, 1.0, 1) {
            return false;
        }
        let step = 1.0 / (count - 1) as f32;
        while let Some((lo, hi, level)) = waiting.pop() {
            let fine = step / (1 << (2 * level)) as f32;
            let samples = (((hi - lo) / fine).ceil() as usize + 1).next_multiple_of(LANES);
            scratch.near.clear();
            if !self.stretch(simd, lo, hi, samples, around, scratch) {
                return false;
            }
            let undecided = scratch.near.iter().any(|m| *m != 0);
            if undecided && (level == FINEST || !waiting.add(&scratch.near, lo, hi, level + 1)) {
                return false;
            }
        }
        true
    }

    #[inline(always)]
    fn all_suspects<S: Simd>(
        &self,
        simd: S,
        joints: &[Lanes],
        around: &Around,
        scratch: &mut Scratch,
        suspects: &mut Suspects,
    ) {
        scratch.configurations += LANES as u64;
        self.set_swing(simd, scratch);
        self.set_step(simd, 1.0, scratch);
        // Between rows, and so outside of the box about them all, by half a step at most.
        scratch.strays = 0.5;
        let hand = around.hand;
        let variable = |j: usize| if j < joints.len() { load(simd, &joints[j]) } else { splat(simd, hand) };
        self.body.chain.place(simd, variable, &mut scratch.frames);
        self.batch::<S, true>(simd, true, around, scratch, suspects);
    }

    /// How far the motion moves each part, and each pair against itself.
    #[inline(always)]
    fn set_swing<S: Simd>(&self, simd: S, scratch: &mut Scratch) {
        for (group, swing) in scratch.swing.iter_mut().enumerate() {
            let mut sum = splat(simd, 0.0);
            for (reach, by) in self.body.reach.iter().zip(&scratch.by) {
                sum = splat(simd, by.abs()).mul_add(load(simd, &reach[group]), sum);
            }
            store(sum, swing);
        }
    }

    /// By how much spheres are larger when the parameter steps by `step`.
    #[inline(always)]
    fn set_step<S: Simd>(&self, simd: S, step: f32, scratch: &mut Scratch) {
        let turned: f32 = scratch.by.iter().map(|b| b.abs()).sum::<f32>() * step;
        // |c″| ≤ (Σ|q̇|)·(Σ|q̇| reach), and a chord of parameter length h is left by at most |c″| h²/8.
        let sagitta = splat(simd, turned / 8.0);
        let half = splat(simd, step / 2.0);
        for ((swing, larger), least) in scratch.swing.iter().zip(&mut scratch.larger).zip(&self.body.least) {
            let (swing, least) = (load(simd, swing), load(simd, least));
            let moved = swing * half;
            let lens = moved.mul_add(moved, least * least).sqrt() - least;
            store((moved + moved).mul_add(sagitta, lens), larger);
        }
    }

    /// The first batch of a stretch has every so many-th sample, so that its last lane stops short
    /// of the end by less than a batch.
    #[inline(always)]
    fn set_strays(&self, step: f32, batches: usize, scratch: &mut Scratch) {
        let turned: f32 = scratch.by.iter().map(|b| b.abs()).sum();
        let third = 5.0 * batches as f32 * step;
        scratch.strays = turned * third * third / 8.0 + batches as f32 * step;
    }

    #[inline(always)]
    fn place_at<S: Simd>(&self, simd: S, t: f32x16<S>, hand: f32, scratch: &mut Scratch) {
        scratch.configurations += LANES as u64;
        let Scratch { frames, from, by, .. } = scratch;
        let (from, by) = (&from[..], &by[..]);
        let variable = |j: usize| {
            if j < from.len() { t.mul_add(splat(simd, by[j]), splat(simd, from[j])) } else { splat(simd, hand) }
        };
        self.body.chain.place(simd, variable, frames);
    }

    /// Checks the placed batch: `None` when something touches, else the lanes where only the larger
    /// spheres do. With `ALL`, everything touched is noted instead. `first`: of its motion.
    #[inline(always)]
    fn batch<S: Simd, const ALL: bool>(
        &self,
        simd: S,
        first: bool,
        around: &Around,
        scratch: &mut Scratch,
        suspects: &mut Suspects,
    ) -> Option<u32> {
        let body = &self.body;
        scratch.batch = scratch.batch.wrapping_add(1).max(1);
        if first {
            scratch.candidates.clear();
        }
        if !ALL
            && let Some(upright) = &around.upright
            && !scratch.frames[upright.frame].points_up(simd, upright)
        {
            return None;
        }
        let margins = self.margins(around);
        let mut near = 0;
        for place in 0..scratch.parts.len() {
            let index = usize::from(scratch.parts[place]);
            let part = &body.parts[index];
            let larger = scratch.larger[index / LANES].0[index % LANES];
            let centre = scratch.frames[part.frame].point(simd, part.bound.centre);
            centre.store(&mut scratch.centres[index]);
            if first {
                let swing = scratch.swing[index / LANES].0[index % LANES];
                self.reach::<S, ALL>(
                    simd,
                    index,
                    part,
                    swing * scratch.strays + larger + margins[0].max(margins[1]),
                    around,
                    scratch,
                );
            }
            let (from, to) = scratch.reached[index];
            for candidate in from..to {
                let slot = scratch.candidates[candidate as usize] as usize;
                let shape = &around.obstacles.shapes[slot];
                let link = around.obstacles.link(slot);
                let margin = margins[usize::from(link.is_some())];
                if shape.meets(simd, centre, part.bound.radius + larger + margin) == 0 {
                    continue;
                }
                let (mut met, mut sure) = (0, 0);
                for ball in part.balls.clone() {
                    let at = self.ball_at(simd, part.frame, ball, scratch);
                    let radius = body.balls[ball].radius + margin;
                    let close = shape.meets(simd, at, radius + larger);
                    if close == 0 {
                        continue;
                    }
                    if ALL {
                        met |= close;
                        let inner = body.inner[ball] - ROUNDING;
                        if inner > 0.0 {
                            sure |= shape.meets(simd, at, inner);
                        }
                        continue;
                    }
                    if shape.meets(simd, at, radius) != 0 {
                        // What touched will be asked first next time.
                        if place > 0 {
                            scratch.parts.swap(place, place - 1);
                        }
                        return None;
                    }
                    near |= close;
                }
                match (link, around.obstacles.owner(slot)) {
                    _ if met == 0 => {}
                    (Some(link), _) => {
                        note(&mut suspects.pairs, (link.min(part.link), link.max(part.link)), (met, sure))
                    }
                    (None, Some(owner)) => note(&mut suspects.obstacles, (part.link, owner as usize), (met, sure)),
                    (None, None) => {}
                }
            }
        }
        let parts = body.parts.len();
        let margin = body.self_margin + ROUNDING;
        let square = |r: f32| splat(simd, r * r);
        // All bounds first, without branches; few pairs are left.
        for (first, pairs) in body.pairs.chunks(64).enumerate() {
            let mut met = 0_u64;
            for (i, pair) in pairs.iter().enumerate() {
                let entity = parts + first * 64 + i;
                let bound = pair.bound + scratch.larger[entity / LANES].0[entity % LANES] + margin;
                let (a, b) = (Point::load(simd, &scratch.centres[pair.a]), Point::load(simd, &scratch.centres[pair.b]));
                met |= u64::from(bits(a.distance_squared(b).simd_lt(square(bound))) != 0) << i;
            }
            while met != 0 {
                let index = first * 64 + met.trailing_zeros() as usize;
                met &= met - 1;
                near |= self.pair_meets::<S, ALL>(simd, index, margin, scratch, suspects)?;
            }
        }
        Some(near)
    }

    /// Checks the balls of a pair of parts whose bounds meet.
    #[inline(always)]
    fn pair_meets<S: Simd, const ALL: bool>(
        &self,
        simd: S,
        index: usize,
        margin: f32,
        scratch: &mut Scratch,
        suspects: &mut Suspects,
    ) -> Option<u32> {
        let body = &self.body;
        let pair = &body.pairs[index];
        let entity = body.parts.len() + index;
        let larger = scratch.larger[entity / LANES].0[entity % LANES];
        let centre_b = Point::load(simd, &scratch.centres[pair.b]);
        let square = |r: f32| splat(simd, r * r);
        let (mut near, mut met, mut sure) = (0, 0, 0);
        let (frame_a, frame_b) = (body.parts[pair.a].frame, body.parts[pair.b].frame);
        for row in &body.rows[pair.rows.clone()] {
            let a = self.ball_at(simd, frame_a, row.ball, scratch);
            if bits(a.distance_squared(centre_b).simd_lt(square(row.guard + larger + margin))) == 0 {
                continue;
            }
            for partner in &body.partners[row.partners.clone()] {
                let b = self.ball_at(simd, frame_b, partner.ball, scratch);
                let apart = a.distance_squared(b);
                let close = bits(apart.simd_lt(square(partner.sum + larger + margin)));
                if close == 0 {
                    continue;
                }
                if ALL {
                    met |= close;
                    let (a, b) = (body.inner[row.ball], body.inner[partner.ball]);
                    if a > 0.0 && b > 0.0 {
                        sure |= bits(apart.simd_lt(square((a + b - ROUNDING).max(0.0))));
                    }
                } else if bits(apart.simd_lt(square(partner.sum + margin))) != 0 {
                    return None;
                }
                near |= close;
            }
        }
        if met != 0 {
            let (a, b) = (body.parts[pair.a].link, body.parts[pair.b].link);
            note(&mut suspects.pairs, (a.min(b), a.max(b)), (met, sure));
        }
        Some(near)
    }

    /// Finds the obstacles that a part may come near on a stretch, from where it is at four of its
    /// samples: between them the middle leaves the straight line by at most |c″| h²/8.
    #[inline(always)]
    fn reach<S: Simd, const ALL: bool>(
        &self,
        simd: S,
        index: usize,
        part: &Part,
        more: f32,
        around: &Around,
        scratch: &mut Scratch,
    ) {
        let at = &scratch.centres[index];
        let (mut lo, mut hi) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            if ALL {
                // Configurations that need not lie on one motion.
                lo[axis] = load(simd, &at[axis]).reduce_min();
                hi[axis] = load(simd, &at[axis]).reduce_max();
                continue;
            }
            let [a, b, c, d] = [0, 5, 10, 15].map(|lane| at[axis].0[lane]);
            lo[axis] = a.min(b).min(c.min(d));
            hi[axis] = a.max(b).max(c.max(d));
        }
        let from = scratch.candidates.len() as u32;
        let candidates = &mut scratch.candidates;
        let never = around.never.get(index).map_or(&[][..], |n| n);
        let standing = |group: usize| around.standing[group] & !never.get(group).copied().unwrap_or(0);
        around.obstacles.near(simd, lo, hi, part.bound.radius + more, standing, |slot| candidates.push(slot as u32));
        scratch.reached[index] = (from, candidates.len() as u32);
    }

    /// Where a ball is, placed once per batch.
    #[inline(always)]
    fn ball_at<S: Simd>(&self, simd: S, frame: usize, ball: usize, scratch: &mut Scratch) -> Point<S> {
        if frame == 0 || scratch.placed[ball] == scratch.batch {
            return Point::load(simd, &scratch.balls[ball]);
        }
        let at = scratch.frames[frame].point(simd, self.body.balls[ball].centre);
        at.store(&mut scratch.balls[ball]);
        scratch.placed[ball] = scratch.batch;
        at
    }

    #[inline(always)]
    fn lanes_free<S: Simd>(&self, simd: S, joints: &[Lanes], around: &Around, scratch: &mut Scratch) -> u32 {
        let body = &self.body;
        let hand = around.hand;
        let variable = |j: usize| if j < joints.len() { load(simd, &joints[j]) } else { splat(simd, hand) };
        body.chain.place(simd, variable, &mut scratch.frames);
        scratch.batch = scratch.batch.wrapping_add(1).max(1);
        let all = (1_u32 << LANES) - 1;
        let mut hit = 0;
        for (index, part) in body.parts.iter().enumerate().filter(|(_, p)| p.frame != 0) {
            scratch.frames[part.frame].point(simd, part.bound.centre).store(&mut scratch.centres[index]);
        }
        let margin = body.self_margin + ROUNDING;
        for pair in &body.pairs {
            let b = Point::load(simd, &scratch.centres[pair.b]);
            let apart = Point::load(simd, &scratch.centres[pair.a]).distance_squared(b);
            let bound = pair.bound + margin;
            if bits(apart.simd_lt(splat(simd, bound * bound))) & !hit == 0 {
                continue;
            }
            for row in &body.rows[pair.rows.clone()] {
                let a = self.ball_at(simd, body.parts[pair.a].frame, row.ball, scratch);
                for partner in &body.partners[row.partners.clone()] {
                    let b = self.ball_at(simd, body.parts[pair.b].frame, partner.ball, scratch);
                    let sum = partner.sum + margin;
                    hit |= bits(a.distance_squared(b).simd_lt(splat(simd, sum * sum)));
                }
            }
            if hit == all {
                return 0;
            }
        }
        let margins = self.margins(around);
        for (index, part) in body.parts.iter().enumerate().filter(|(_, p)| p.frame != 0) {
            let centre = Point::load(simd, &scratch.centres[index]);
            for (slot, shape) in around.obstacles.shapes.iter().enumerate() {
                let never = around.never.get(index).and_then(|n| n.get(slot / LANES)).copied().unwrap_or(0);
                if (around.standing[slot / LANES] & !never) >> (slot % LANES) & 1 == 0
                    || shape.meets(simd, centre, part.bound.radius + margins[0].max(margins[1])) & !hit == 0
                {
                    continue;
                }
                let margin = margins[usize::from(around.obstacles.link(slot).is_some())];
                for ball in part.balls.clone() {
                    let at = self.ball_at(simd, part.frame, ball, scratch);
                    hit |= shape.meets(simd, at, body.balls[ball].radius + margin);
                }
            }
            if hit == all {
                return 0;
            }
        }
        all & !hit
    }
}

/// Stretches of a motion that have yet to be looked at closer: from, to, and how much closer.
struct Waiting {
    stretches: [(f32, f32, u32); 64],
    count: usize,
}

impl Default for Waiting {
    fn default() -> Self {
        Self { stretches: [(0.0, 0.0, 0); 64], count: 0 }
    }
}

impl Waiting {
    /// Adds the stretches about the near samples of `lo..hi`; false when there are too many.
    fn add(&mut self, near: &[u32], lo: f32, hi: f32, level: u32) -> bool {
        let batches = near.len();
        let count = batches * LANES;
        let step = (hi - lo) / (count - 1) as f32;
        let is_near = |i: usize| i < count && near[i % batches] >> (i / batches) & 1 == 1;
        let mut i = 0;
        while i < count {
            if !is_near(i) {
                i += 1;
                continue;
            }
            let first = i.saturating_sub(1);
            while is_near(i + 1) || is_near(i + 2) {
                i += 1;
            }
            let last = (i + 1).min(count - 1);
            let Some(stretch) = self.stretches.get_mut(self.count) else { return false };
            *stretch = (lo + first as f32 * step, (lo + last as f32 * step).min(hi), level);
            self.count += 1;
            i = last + 1;
        }
        true
    }

    fn pop(&mut self) -> Option<(f32, f32, u32)> {
        self.count = self.count.checked_sub(1)?;
        Some(self.stretches[self.count])
    }
}
