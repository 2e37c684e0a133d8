//! The joint space of a robot of spheres, asked of the collision kernel.

use crate::MotionValidator;
use clearway_collision::lanes::{Around, Kernel, LANES, Lanes, Scratch};

/// One robot among obstacles; one thread's.
pub struct SphereSpace<'a> {
    pub kernel: &'a Kernel,
    pub around: Around<'a>,
    /// Samples per radian of joint distance, at least; what lies between them is checked as well.
    pub per_radian: f64,
    pub scratch: Scratch,
    lower: Vec<f64>,
    upper: Vec<f64>,
    joints: Vec<Lanes>,
}

impl<'a> SphereSpace<'a> {
    pub fn new(kernel: &'a Kernel, around: Around<'a>, lower: &[f64], upper: &[f64], per_radian: f64) -> Self {
        let joints = vec![Lanes::ZERO; lower.len()];
        Self { kernel, around, per_radian, scratch: kernel.scratch(), lower: lower.to_vec(), upper: upper.to_vec(), joints }
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
    }

    #[inline]
    fn motion_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.kernel.motion_free(a, b, self.per_radian, &self.around, &mut self.scratch)
    }
}
