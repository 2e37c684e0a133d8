//! A parallel hand's closing by force. The joint follows the plan until a pad presses; from then on the pads come
//! together, or apart, the faster the farther their force is from the one asked for (admittance): the joint goes
//! beyond the plan's value by what the contacts give way, and stays with the force however the object is shaken.
//!
//! Contacts give way in proportion to the object's mass, and are solved in steps: a pad that comes at speed v is met
//! with up to some m v / dt. The controller's damping goes with that, well above it, lest force and speed chase each
//! other; the force then settles within some 50 ms for any object.

use crate::error::CannotSimulate;
use crate::settings::Settings;
use clearway_plan::plan_file::PlannedHand;
use clearway_verify::played::Played;

/// Newtons: less is no contact yet.
const FEEBLE: f64 = 0.5;
/// Until both pads touch they come together so fast, m/s each.
const APPROACH: f64 = 0.02;
/// Where the plan leaves the hand open, the pads come no closer than this by themselves, metres each: what is
/// wider apart is not gripped.
const BEYOND: f64 = 0.003;
/// A pad never moves faster by force, m/s.
const FASTEST: f64 = 0.1;
/// The controller's damping over m / dt: at 8 and less grips were seen to shake.
const DAMPING: f64 = 32.0;
/// What is light is gripped with no more than this many times its weight: pads would sink into it.
const MOST_WEIGHTS: f64 = 40.0;
/// What is heavy, or slippery, is gripped with up to this many times the usual force.
const STRONGEST: f64 = 3.0;
const GRAVITY: f64 = 9.81;

/// How hard the pads press on the object, newtons, from either side.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pads {
    pub sides: [f64; 2],
}

impl Pads {
    pub fn mean(self) -> f64 {
        (self.sides[0] + self.sides[1]) / 2.0
    }

    pub fn least(self) -> f64 {
        self.sides[0].min(self.sides[1])
    }
}

/// The gripper's joint, and what is known about it.
pub(crate) struct Gripper {
    pub joint: usize,
    range: (f64, f64),
    /// Joint value and gap, by rising joint value.
    opening: Vec<(f64, f64)>,
}

impl Gripper {
    pub fn new(hand: &PlannedHand, played: &Played) -> Result<Self, CannotSimulate> {
        let wrong = |what: String| CannotSimulate::Hand(what);
        let name = hand.joint.as_ref().ok_or_else(|| wrong("a parallel hand without a joint".to_owned()))?;
        let joint = played.joint(name).ok_or_else(|| wrong(format!("{name} is no joint of the URDF")))?;
        let value = |key: &String| key.parse::<f64>().ok().filter(|v| v.is_finite());
        let mut opening: Vec<(f64, f64)> = hand.opening.iter().filter_map(|(k, gap)| Some((value(k)?, *gap))).collect();
        opening.sort_by(|a, b| a.0.total_cmp(&b.0));
        let apart =
            opening.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 != w[1].1 && w.iter().all(|e| e.1.is_finite()));
        if opening.len() < 2 || !apart {
            return Err(wrong("`opening` does not say how the gap follows the joint".to_owned()));
        }
        let range = played.range(joint).unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        Ok(Self { joint, range, opening })
    }

    /// d gap / d joint.
    fn slope(&self, at: f64) -> f64 {
        let next = self.opening.partition_point(|(q, _)| *q <= at).clamp(1, self.opening.len() - 1);
        let ((q0, g0), (q1, g1)) = (self.opening[next - 1], self.opening[next]);
        (g1 - g0) / (q1 - q0)
    }
}

/// A grip in the making, or held.
pub(crate) struct Grip {
    /// Newtons on each pad.
    pub asked: f64,
    /// N s/m.
    damping: f64,
    by_force: bool,
    /// How far each pad has come beyond the plan without touching, metres.
    beyond: f64,
    /// Both pads press as asked.
    pub holds: bool,
}

impl Grip {
    /// `mass` of the object, and the friction between it and the pads.
    pub fn new(settings: &Settings, mass: f64, friction: f64) -> Self {
        let weight = mass * GRAVITY;
        // Two pads carry 2 µ F; twice what is needed to hang still.
        let needed = (weight / friction).min(STRONGEST * settings.grip);
        let asked = settings.grip.min(MOST_WEIGHTS * weight).max(needed);
        Self { asked, damping: DAMPING * mass * settings.rate, by_force: false, beyond: 0.0, holds: false }
    }

    /// Where the joint goes next; `None`: where the plan says. `planned_over`: the plan's own closing has ended.
    pub fn step(&mut self, gripper: &Gripper, at: f64, pads: Pads, planned_over: bool, dt: f64) -> Option<f64> {
        self.by_force |= planned_over || pads.mean() > FEEBLE;
        self.holds |= pads.mean() > 0.9 * self.asked && pads.least() > 0.5 * self.asked;
        if !self.by_force {
            return None;
        }
        let touching = pads.least() > FEEBLE || pads.mean() > self.asked / 2.0;
        if !touching && self.beyond >= BEYOND {
            return Some(at);
        }
        let closing = if touching { (self.asked - pads.mean()) / self.damping } else { APPROACH };
        self.beyond += if touching { 0.0 } else { closing * dt };
        let closing = closing.clamp(-FASTEST, FASTEST);
        let moved = -2.0 * closing * dt / gripper.slope(at);
        Some((at + moved).clamp(gripper.range.0, gripper.range.1))
    }
}
