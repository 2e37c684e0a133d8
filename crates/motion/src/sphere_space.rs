//! The joint space of any robot, asked of the collision kernel; and, where spheres only cover its
//! links, of their own shapes when the spheres touch.

use crate::{MotionValidator, Posture, between, distance};
use clearway_collision::lanes::{Around, Kernel, LANES, Lanes, Scratch, Suspects};
use clearway_collision::shapes::Among;

/// One robot among obstacles; one thread's.
pub struct SphereSpace<'a> {
    pub kernel: &'a Kernel,
    pub around: Around<'a>,
    /// Samples per radian of joint distance, at least; what lies between them is checked as well.
    pub per_radian: f64,
    pub scratch: Scratch,
    exact: Option<Exactly<'a>>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    joints: Vec<Lanes>,
}

/// Exact answers, and room for them.
struct Exactly<'a> {
    among: Among<'a>,
    suspects: Suspects,
    scratch: clearway_collision::Scratch,
    rows: Vec<Posture>,
}

impl<'a> SphereSpace<'a> {
    /// `exact`: who decides where spheres touch, if not they.
    pub fn new(
        kernel: &'a Kernel,
        around: Around<'a>,
        exact: Option<Among<'a>>,
        lower: &[f64],
        upper: &[f64],
        per_radian: f64,
    ) -> Self {
        let joints = vec![Lanes::ZERO; lower.len()];
        let room =
            |among| Exactly { among, suspects: Suspects::default(), scratch: Default::default(), rows: Vec::new() };
        let exact = exact.map(room);
        Self {
            kernel,
            around,
            per_radian,
            scratch: kernel.scratch(),
            exact,
            lower: lower.to_vec(),
            upper: upper.to_vec(),
            joints,
        }
    }

    /// Whether the shapes themselves are clear along a straight motion, both ends included; never
    /// where there are none but the spheres.
    fn exactly_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        let Some(exact) = &mut self.exact else { return false };
        // Rows half as dense as the kernel's samples: enough for spheres to suspect little.
        let count = (distance(a, b) * self.per_radian / 2.0).ceil().clamp(1.0, 1e5) as usize;
        let Exactly { among, suspects, scratch, rows } = exact;
        // The end is what most motions fail at, so blocks come from there; each has the next one's last row.
        let mut to = count;
        loop {
            let from = to.saturating_sub(LANES - 1);
            rows.clear();
            rows.extend((from..=to).map(|i| between(a, b, i as f64 / count as f64)));
            self.kernel.rows_suspects(rows, &self.around, &mut self.scratch, suspects);
            if !among.rows_clear(rows, suspects, scratch) {
                return false;
            }
            if from == 0 {
                return true;
            }
            to = from;
        }
    }
}

impl MotionValidator for SphereSpace<'_> {
    fn lower(&self) -> &[f64] {
        &self.lower
    }

    fn upper(&self) -> &[f64] {
        &self.upper
    }

    fn state_free(&mut self, q: &[f64]) -> bool {
        for (lanes, q) in self.joints.iter_mut().zip(q) {
            lanes.0 = [*q as f32; LANES];
        }
        self.kernel.configurations_free(&self.joints, &self.around, &mut self.scratch) != 0
            || self.exact.as_mut().is_some_and(|Exactly { among, suspects, scratch, rows }| {
                rows.clear();
                rows.push(q.to_vec());
                self.kernel.configurations_suspects(rows, &self.around, &mut self.scratch, suspects);
                among.rows_clear(rows, suspects, scratch)
            })
    }

    #[inline]
    fn motion_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.kernel.motion_free(a, b, self.per_radian, &self.around, &mut self.scratch) || self.exactly_free(a, b)
    }
}
