//! What the simulation assumes about controllers, hands and contacts; what it calls elsewhere; noise.

use serde::Serialize;

/// How a plan is played, and judged. SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// Steps of the physics per second.
    pub rate: f64,
    /// Every joint follows its command through a first-order lag of this time constant, seconds.
    pub lag: f64,
    /// Coefficient of friction of fingers and cups; against an object the larger one counts.
    pub rubber: f64,
    /// Each pad of a closed hand presses with this force, newtons; with more where the weight asks for it.
    pub grip: f64,
    /// A suction cup holds what is this near, metres.
    pub suction_reach: f64,
    /// How long a hand may take beyond the plan's time to have its grip, seconds; the plan waits.
    pub patience: f64,
    /// Things come to rest for so long before the plan starts, and after it ends, seconds.
    pub settle: [f64; 2],
    /// What the plan moved ends elsewhere if it is farther away than this.
    pub moved: Tolerance,
    /// What the plan did not move.
    pub unmoved: Tolerance,
    /// Newtons: the robot, or what it holds, may touch with less.
    pub touch: f64,
}

/// How far from its place an object may end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tolerance {
    /// Metres.
    pub position: f64,
    /// Degrees from upright, or from however it should lie.
    pub tilt: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rate: 1000.0,
            lag: 0.008,
            rubber: 1.0,
            grip: 30.0,
            suction_reach: 2e-3,
            patience: 1.0,
            settle: [0.25, 1.0],
            moved: Tolerance { position: 0.010, tilt: 10.0 },
            unmoved: Tolerance { position: 0.005, tilt: 10.0 },
            touch: 1.0,
        }
    }
}

impl Settings {
    /// Names the first value that makes no sense.
    pub fn validate(&self) -> Result<(), String> {
        within("rate", self.rate, 200.0, 10_000.0, "steps per second")?;
        within("lag", self.lag, 0.0, 0.5, "seconds")?;
        within("rubber", self.rubber, 0.0, 5.0, "as a coefficient of friction")?;
        within("grip", self.grip, 0.1, 1000.0, "newtons")?;
        within("suction reach", self.suction_reach, 0.0, 0.05, "metres")?;
        within("patience", self.patience, 0.0, 60.0, "seconds")?;
        within("settle", self.settle[0], 0.0, 60.0, "seconds")?;
        within("settle", self.settle[1], 0.0, 60.0, "seconds")?;
        for tolerance in [self.moved, self.unmoved] {
            within("position tolerance", tolerance.position, 0.0, 10.0, "metres")?;
            within("tilt tolerance", tolerance.tilt, 0.0, 180.0, "degrees")?;
        }
        within("touch", self.touch, 0.0, 1e6, "newtons")
    }
}

/// How the world differs from the plan's scene, drawn anew in each trial.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Noise {
    /// Every object stands elsewhere: uniform in a horizontal disc of this radius, metres.
    pub position: f64,
    /// Every object's friction is another: uniform, up to this fraction more or less.
    pub friction: f64,
    /// Every object is thicker or thinner: uniform, its radius up to this much more or less, metres; a box by as
    /// much on each of its four sides. Meshes and compounds stay as they are.
    pub radius: f64,
}

impl Noise {
    /// Names the first value that makes no sense.
    pub fn validate(&self) -> Result<(), String> {
        within("noise", self.position, 0.0, 0.1, "metres")?;
        within("noise of friction", self.friction, 0.0, 0.95, "as a fraction")?;
        within("noise of radius", self.radius, 0.0, 0.02, "metres")
    }

    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

fn within(what: &str, value: f64, least: f64, most: f64, unit: &str) -> Result<(), String> {
    // Written so that NaN fails too.
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(format!("the {what} is {value}; expected {least} to {most}, {unit}"))
}
