//! Whether motions are free of the few things that the kernel's spheres touch.
//!
//! Between two postures near each other a point of a link leaves the straight line between its
//! places by at most (Σ|Δq|)(Σ|Δq| reach)/8, and along that line it is never farther from the nearer
//! place than half its length. So a link that keeps so much room in both postures keeps clear in
//! between; where it does not, the posture in the middle is looked at, and so on. What a link moves
//! is measured where it is, not bounded by the joints: a hand that is drawn straight out moves a
//! little, though every joint turns.

use crate::directions::Directions;
use crate::query::Scratch;
use clearway_geometry::Pose;
use clearway_robot::Sphere;

/// Who answers exactly: places a robot's bodies, and tells how near they come to things.
pub(crate) trait Exact {
    /// Two things that may touch.
    type Question;

    /// The links' frames.
    fn place(&self, q: &[f64], frames: &mut Vec<Pose>);

    /// Whether two things come closer than they should, by up to `more` metres.
    fn near(&self, question: &Self::Question, frames: &[Pose], more: f64, directions: &mut Directions) -> bool;

    /// The bodies that move, at most two.
    fn bodies(&self, question: &Self::Question) -> (usize, Option<usize>);

    fn frame(&self, body: usize, frames: &[Pose]) -> Pose;

    /// A ball that holds a body, in its frame.
    fn bound(&self, body: usize) -> Sphere;

    /// How far joints could move any point of a body from one posture to another, each on its own.
    fn swing(&self, body: usize, a: &[f64], b: &[f64]) -> f64;
}

/// What a question's bodies do between two postures.
#[derive(Clone, Copy, Default)]
struct Moved {
    /// How far any point of them is moved, metres.
    by: f64,
    /// How far its path may leave the straight line.
    off: f64,
}

/// A posture, and the links' frames there.
struct Place {
    q: Vec<f64>,
    frames: Vec<Pose>,
}

/// A stretch between two places, by their number, and what is not settled there, as bits.
struct Stretch {
    from: usize,
    to: usize,
    /// Of which questions, counted in masks.
    group: usize,
    open: u64,
}

/// Questions settled at a time: the bits of a mask.
const AT_ONCE: usize = 64;

/// Whether up to sixteen rows, and the straight lines between them, are free of what is asked: a
/// question, and the rows in which it is open, as bits. A stretch in which nothing moves farther than
/// `step` (metres) is taken to be free where its ends are.
pub(crate) fn rows_clear<E: Exact>(
    exact: &E,
    questions: &[(E::Question, u16)],
    rows: &[Vec<f64>],
    step: f64,
    scratch: &mut Scratch,
) -> bool {
    if questions.is_empty() {
        return true;
    }
    // Only rows beside one at which something is near are placed.
    let lanes = questions.iter().fold(0_u32, |all, (_, lanes)| all | u32::from(*lanes));
    let placed = lanes | lanes << 1 | lanes >> 1;
    let mut places: Vec<Place> = Vec::with_capacity(rows.len());
    for (i, row) in rows.iter().enumerate() {
        let mut frames = Vec::new();
        if placed >> i & 1 == 1 {
            scratch.checked += 1;
            exact.place(row, &mut frames);
        }
        places.push(Place { q: row.clone(), frames });
    }
    let mut settling =
        Settling { exact, step, questions, directions: &mut scratch.directions, places, stretches: Vec::new() };
    settling.rows() && settling.stretches()
}

struct Settling<'a, E: Exact> {
    exact: &'a E,
    step: f64,
    questions: &'a [(E::Question, u16)],
    directions: &'a mut Directions,
    /// The rows, then what was looked at in between.
    places: Vec<Place>,
    stretches: Vec<Stretch>,
}

impl<E: Exact> Settling<'_, E> {
    /// Looks at the rows themselves; stretches that they do not settle are kept. False when
    /// something is touched.
    fn rows(&mut self) -> bool {
        let last = self.places.len() - 1;
        for (group, questions) in self.questions.chunks(AT_ONCE).enumerate() {
            let mut open = vec![0_u64; self.places.len()];
            for (bit, (question, lanes)) in questions.iter().enumerate() {
                let asked = |i: usize| u32::from(*lanes) >> i & 1 == 1;
                // A neighbour that is not asked answers for nothing: then all of the way is this row's.
                let part = |i: usize| if asked(i) { 0.5 } else { 1.0 };
                let (mut before, mut before_part) = (Moved::default(), 0.0);
                for i in 0..=last {
                    let active = i < last && (asked(i) || asked(i + 1));
                    let after = if active {
                        self.moved(question, &self.places[i], &self.places[i + 1])
                    } else {
                        Moved::default()
                    };
                    if asked(i) {
                        let after_part = if i < last { part(i + 1) } else { 0.0 };
                        let room = (before.by * before_part + before.off).max(after.by * after_part + after.off);
                        let frames = &self.places[i].frames;
                        if self.exact.near(question, frames, room, self.directions) {
                            if self.exact.near(question, frames, 0.0, self.directions) {
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
                self.stretches.push(Stretch { from: i, to: i + 1, group, open });
            }
        }
        true
    }

    /// Halves what is left until all of it is settled; false when something is touched.
    fn stretches(&mut self) -> bool {
        while let Some(Stretch { from, to, group, open }) = self.stretches.pop() {
            let (a, b) = (&self.places[from], &self.places[to]);
            let mut middle =
                Place { q: a.q.iter().zip(&b.q).map(|(a, b)| (a + b) / 2.0).collect(), frames: Vec::new() };
            self.exact.place(&middle.q, &mut middle.frames);
            let mut left = 0_u64;
            for (bit, (question, _)) in self.questions.iter().skip(group * AT_ONCE).take(AT_ONCE).enumerate() {
                if open >> bit & 1 == 0 {
                    continue;
                }
                let (before, after) = (self.moved(question, a, &middle), self.moved(question, &middle, b));
                // Both ends were looked at.
                if before.by + before.off + after.by + after.off <= self.step {
                    continue;
                }
                let near = |room: f64, directions: &mut Directions| {
                    self.exact.near(question, &middle.frames, room, directions)
                };
                let (half, other) = (before.by + before.off, after.by + after.off);
                if near(half.max(other), self.directions) {
                    if near(0.0, self.directions) {
                        return false;
                    }
                    left |= 1 << bit;
                }
            }
            if left != 0 {
                let between = self.places.len();
                self.places.push(middle);
                self.stretches.push(Stretch { from, to: between, group, open: left });
                self.stretches.push(Stretch { from: between, to, group, open: left });
            }
        }
        true
    }

    fn moved(&self, question: &E::Question, a: &Place, b: &Place) -> Moved {
        let turned: f64 = a.q.iter().zip(&b.q).map(|(a, b)| (a - b).abs()).sum();
        let mut moved = Moved::default();
        let (first, second) = self.exact.bodies(question);
        for body in std::iter::once(first).chain(second) {
            let (frame_a, frame_b) = (self.exact.frame(body, &a.frames), self.exact.frame(body, &b.frames));
            let bound = self.exact.bound(body);
            let (ra, rb) = (&frame_a.rotation, &frame_b.rotation);
            // Twice the sine of half the angle between them.
            let same = ra.x_axis.dot(rb.x_axis) + ra.y_axis.dot(rb.y_axis) + ra.z_axis.dot(rb.z_axis);
            let turn = (3.0 - same).max(0.0).sqrt();
            moved.by += frame_a.point(bound.centre).distance(frame_b.point(bound.centre)) + turn * bound.radius;
            moved.off += turned * self.exact.swing(body, &a.q, &b.q) / 8.0;
        }
        moved
    }
}
