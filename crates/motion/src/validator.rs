//! What a planner asks: is this state, is this straight motion free?

/// The joint space of one robot among its obstacles.
pub trait MotionValidator {
    /// By joint; minus infinity where a joint turns without end.
    fn lower(&self) -> &[f64];
    fn upper(&self) -> &[f64];

    fn state_free(&mut self, q: &[f64]) -> bool;

    /// Whether the straight line is free, both ends included; `a` is taken to be free already.
    fn motion_free(&mut self, a: &[f64], b: &[f64]) -> bool;

    /// The values that samples of a joint are drawn from: one turn where there is no end.
    fn sampled_range(&self, joint: usize) -> (f64, f64) {
        let pi = std::f64::consts::PI;
        let (l, u) = (self.lower()[joint], self.upper()[joint]);
        (if l.is_finite() { l } else { -pi }, if u.is_finite() { u } else { pi })
    }
}
