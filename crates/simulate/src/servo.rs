//! Joint controllers that lag: each joint follows its command through a first-order lag. A steady motion comes
//! later by the time constant, all joints alike, so that the path is kept but for τ²/2 of the acceleration:
//! 0.3 mm at 8 ms, 8 rad/s² and a metre of arm.

/// Where the joints are, one value per joint of the URDF.
pub(crate) struct Servo {
    /// What is left of an error after one step.
    keeps: f64,
    pub at: Vec<f64>,
}

impl Servo {
    pub fn new(lag: f64, dt: f64, at: Vec<f64>) -> Self {
        Self { keeps: if lag > 0.0 { (-dt / lag).exp() } else { 0.0 }, at }
    }

    /// One step of one joint.
    pub fn follow(&mut self, joint: usize, command: f64) {
        self.at[joint] = command + self.keeps * (self.at[joint] - command);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_followed_later_by_the_time_constant() {
        let dt = 1e-3;
        let mut servo = Servo::new(0.01, dt, vec![0.0]);
        for i in 1..=1000 {
            servo.follow(0, f64::from(i) * dt);
        }
        assert!((servo.at[0] - (1.0 - 0.01)).abs() < 6e-4, "{}", servo.at[0]);
    }
}
