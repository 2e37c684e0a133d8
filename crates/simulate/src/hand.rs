//! What the hand does about an object: close on it and press, or hold it by suction.

use crate::error::CannotSimulate;
use crate::grip::{Grip, Gripper, Pads};
use crate::settings::Settings;
use crate::world::World;
use clearway_plan::PlanFile;
use clearway_verify::played::{Played, PlayedShape, distance};
use rapier3d_f64::dynamics::ImpulseJointHandle;

/// The hand and what it is about.
pub(crate) enum Hand {
    Parallel { gripper: Gripper, grip: Option<Grip> },
    Suction { tool: usize, weld: Option<ImpulseJointHandle> },
}

impl Hand {
    pub fn new(plan: &PlanFile, played: &Played) -> Result<Self, CannotSimulate> {
        let hand = &plan.robot.hand;
        if hand.kind == "suction" {
            let tool = played.link(&hand.frame);
            let tool = tool.ok_or_else(|| CannotSimulate::Hand(format!("{:?} is no link of the URDF", hand.frame)))?;
            return Ok(Self::Suction { tool, weld: None });
        }
        Ok(Self::Parallel { gripper: Gripper::new(hand, played)?, grip: None })
    }

    /// Links whose friction is the rubber's: fingers, or cups.
    pub fn rubber(&self, played: &Played) -> Vec<bool> {
        let suction = matches!(self, Self::Suction { .. });
        played.links.iter().map(|l| l.in_hand && (l.finger || suction)).collect()
    }

    /// Begins to grip an object of this mass; `friction` between it and the pads.
    pub fn begin(&mut self, settings: &Settings, mass: f64, friction: f64) {
        if let Self::Parallel { grip, .. } = self {
            *grip = Some(Grip::new(settings, mass, friction));
        }
    }

    /// A suction hand takes hold of what its links are near enough to.
    pub fn suck(&mut self, world: &mut World, played: &Played, object: usize, shapes: &[PlayedShape], reach: f64) {
        let Self::Suction { tool, weld } = self else { return };
        let at = world.object(object);
        let near =
            played.links.iter().enumerate().filter(|(_, link)| link.in_hand).any(|(i, link)| {
                distance(&link.shapes, &world.link(i), shapes, &at, reach).is_some_and(|d| d <= reach)
            });
        if near && weld.is_none() {
            *weld = Some(world.weld(*tool, object));
        }
    }

    pub fn let_go(&mut self, world: &mut World) {
        match self {
            Self::Parallel { grip, .. } => *grip = None,
            Self::Suction { weld, .. } => {
                if let Some(weld) = weld.take() {
                    world.part(weld);
                }
            }
        }
    }

    pub fn holds(&self) -> bool {
        match self {
            Self::Parallel { grip, .. } => grip.as_ref().is_some_and(|g| g.holds),
            Self::Suction { weld, .. } => weld.is_some(),
        }
    }

    /// Newtons on each pad, while a parallel hand grips.
    pub fn asked(&self) -> Option<f64> {
        match self {
            Self::Parallel { grip, .. } => grip.as_ref().map(|g| g.asked),
            Self::Suction { .. } => None,
        }
    }

    /// Where a joint goes that the force leads, if one does.
    pub fn step(&mut self, posture: &[f64], pads: Pads, planned_over: bool, dt: f64) -> Option<(usize, f64)> {
        let Self::Parallel { gripper, grip: Some(grip) } = self else { return None };
        let next = grip.step(gripper, posture[gripper.joint], pads, planned_over, dt)?;
        Some((gripper.joint, next))
    }
}
