//! Whether motions are free of the few things that the kernel's spheres touch; see [`crate::Quick`].
//!
//! Between two postures near each other a point of a link leaves the straight line between its
//! places by at most (Σ|Δq|)(Σ|Δq| reach)/8, and along that line it is never farther from the nearer
//! place than half its length. So a link that keeps so much room in both postures keeps clear in
//! between; where it does not, the posture in the middle is looked at, and so on. What a link moves
//! is measured where it is, not bounded by the joints: a hand that is drawn straight out moves a
//! little, though every joint turns.

use crate::directions::Directions;
use crate::lanes::Suspects;
use crate::moment::Moment;
use crate::query::Scratch;
use crate::suspects::Question;
use crate::world::World;
use clearway_geometry::Pose;

/// What a question's bodies do between two postures.
#[derive(Clone, Copy, Default)]
struct Moved {
    /// How far any point of them is moved, metres.
    by: f64,
    /// How far its path may leave the straight line.
    off: f64,
}

/// A stretch between two postures, and what is not settled there, as bits.
struct Stretch {
    from: Vec<f64>,
    to: Vec<f64>,
    open: u64,
}

/// Questions settled at a time: the bits of a mask.
const AT_ONCE: usize = 64;

impl World {
    /// Whether up to sixteen rows, and the straight lines between them, are free of `suspects`, which
    /// were found for these rows. A stretch in which nothing moves farther than `step` (metres) is
    /// taken to be free where its ends are.
    pub fn rows_clear(&self, rows: &[Vec<f64>], moment: &Moment, suspects: &Suspects, step: f64, scratch: &mut Scratch) -> bool {
        if suspects.any_sure() {
            return false;
        }
        let questions: Vec<(Question, u16)> = self.questions(moment, suspects).collect();
        if questions.is_empty() {
            return true;
        }
        // Only rows beside one at which something is near are placed.
        let lanes = questions.iter().fold(0_u32, |all, (_, lanes)| all | u32::from(*lanes));
        let placed = lanes | lanes << 1 | lanes >> 1;
        let mut frames: Vec<Vec<Pose>> = Vec::with_capacity(rows.len());
        for (i, row) in rows.iter().enumerate() {
            let mut own = Vec::new();
            if placed >> i & 1 == 1 {
                scratch.checked += 1;
                self.model.kinematics.frames(row, moment.hand, &mut own);
            }
            frames.push(own);
        }
        let Scratch { directions, .. } = scratch;
        let mut settled = Settling { world: self, moment, step, questions: &questions, directions, stretches: Vec::new() };
        settled.rows(rows, &frames) && settled.stretches(&mut scratch.frames)
    }
}

struct Settling<'a> {
    world: &'a World,
    moment: &'a Moment,
    step: f64,
    questions: &'a [(Question<'a>, u16)],
    directions: &'a mut Directions,
    stretches: Vec<(usize, Stretch)>,
}

impl Settling<'_> {
    /// Looks at the rows themselves; stretches that they do not settle are kept. False when
    /// something is touched.
    fn rows(&mut self, rows: &[Vec<f64>], frames: &[Vec<Pose>]) -> bool {
        let last = rows.len() - 1;
        for (group, questions) in self.questions.chunks(AT_ONCE).enumerate() {
            let mut open = vec![0_u64; rows.len()];
            for (bit, (question, lanes)) in questions.iter().enumerate() {
                let asked = |i: usize| u32::from(*lanes) >> i & 1 == 1;
                // A neighbour that is not asked answers for nothing: then all of the way is this row's.
                let part = |i: usize| if asked(i) { 0.5 } else { 1.0 };
                let (mut before, mut before_part) = (Moved::default(), 0.0);
                for i in 0..rows.len() {
                    let active = i < last && (asked(i) || asked(i + 1));
                    let after = if active { self.moved(question, (&rows[i], &frames[i]), (&rows[i + 1], &frames[i + 1])) } else { Moved::default() };
                    if asked(i) {
                        let after_part = if i < last { part(i + 1) } else { 0.0 };
                        let room = (before.by * before_part + before.off).max(after.by * after_part + after.off);
                        if question.near(self.world, self.moment, &frames[i], room, self.directions) {
                            if question.near(self.world, self.moment, &frames[i], 0.0, self.directions) {
                                return false;
                            }
                            open[i.saturating_sub(1)] |= u64::from(i > 0) << bit;
                            open[i] |= u64::from(i < last) << bit;
                        }
                    }
                    (before, before_part) = (after, part(i));
                }
            }
            for (i, open) in open.into_iter().enumerate().filter(|(_, open)| *open != 0) {
                self.stretches.push((group, Stretch { from: rows[i].clone(), to: rows[i + 1].clone(), open }));
            }
        }
        true
    }

    /// Halves what is left until all of it is settled; false when something is touched.
    fn stretches(&mut self, frames: &mut Vec<Pose>) -> bool {
        let (mut from, mut to) = (Vec::new(), Vec::new());
        while let Some((group, Stretch { from: a, to: b, open })) = self.stretches.pop() {
            let middle: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a + b) / 2.0).collect();
            let kinematics = &self.world.model.kinematics;
            kinematics.frames(&a, self.moment.hand, &mut from);
            kinematics.frames(&b, self.moment.hand, &mut to);
            kinematics.frames(&middle, self.moment.hand, frames);
            let (mut left, mut right) = (0_u64, 0_u64);
            for (bit, (question, _)) in self.questions.iter().skip(group * AT_ONCE).take(AT_ONCE).enumerate() {
                if open >> bit & 1 == 0 {
                    continue;
                }
                let before = self.moved(question, (&a, &from), (&middle, frames));
                let after = self.moved(question, (&middle, frames), (&b, &to));
                // Both ends were looked at.
                if before.by + before.off + after.by + after.off <= self.step {
                    continue;
                }
                let near = |room: f64, directions: &mut Directions| question.near(self.world, self.moment, frames, room, directions);
                let (half, other) = (before.by + before.off, after.by + after.off);
                if near(half.max(other), self.directions) {
                    if near(0.0, self.directions) {
                        return false;
                    }
                    left |= 1 << bit;
                    right |= 1 << bit;
                }
            }
            if left != 0 {
                self.stretches.push((group, Stretch { from: a, to: middle.clone(), open: left }));
                self.stretches.push((group, Stretch { from: middle, to: b, open: right }));
            }
        }
        true
    }

    fn moved(&self, question: &Question, (a, root_from_a): (&[f64], &[Pose]), (b, root_from_b): (&[f64], &[Pose])) -> Moved {
        let turned: f64 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
        let mut moved = Moved::default();
        for body in question.bodies() {
            let swing = self.world.swing(self.moment, body, a, b);
            let (frame_a, frame_b) = (self.world.frame(self.moment, body, root_from_a), self.world.frame(self.moment, body, root_from_b));
            let bound = self.world.bound(self.moment, body);
            let (ra, rb) = (&frame_a.rotation, &frame_b.rotation);
            // Twice the sine of half the angle between them.
            let same = ra.x_axis.dot(rb.x_axis) + ra.y_axis.dot(rb.y_axis) + ra.z_axis.dot(rb.z_axis);
            let turn = (3.0 - same).max(0.0).sqrt();
            moved.by += frame_a.point(bound.centre).distance(frame_b.point(bound.centre)) + turn * bound.radius;
            moved.off += turned * swing / 8.0;
        }
        moved
    }
}
