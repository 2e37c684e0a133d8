//! What is the case at one time of a plan.

use crate::lanes::Kernel;
use crate::obstacle::{MovingPart, Obstacle};
use clearway_geometry::{Pose, Solid, Vec3};
use clearway_plan::{ObjectId, ObjectSet};
use std::sync::Arc;

/// What is nearer than the room asked for, metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Close {
    pub fixtures: Vec<(usize, f64)>,
    pub objects: Vec<(ObjectId, f64)>,
}

/// What the hand holds.
#[derive(Clone, Debug)]
pub struct Held {
    pub object: ObjectId,
    /// In the object's frame.
    pub parts: Arc<Vec<MovingPart>>,
    pub tool_from_object: Pose,
    /// Fixtures that carry the object where it is lifted off or put down: not checked against it
    /// while [`Moment::resting`].
    pub fixtures_below: Vec<usize>,
    /// Likewise, objects, standing where the scene has them or put down elsewhere.
    pub objects_below: ObjectSet,
    /// What stands nearer to it than the room asked for, and how near, metres: with those it keeps as much.
    pub close: Arc<Close>,
    /// The robot with the object in its hand, for quick answers; without it what is held is looked
    /// at exactly everywhere.
    pub kernel: Option<Arc<Kernel>>,
}

impl Held {
    /// No point of it is farther from its frame's origin, metres.
    pub fn radius(&self) -> f64 {
        self.parts.iter().map(|p| p.pose.translation.length() + p.radius).fold(0.0, f64::max)
    }

    /// What is held, as it is for the tool.
    pub fn solid(&self) -> Solid {
        Solid { parts: self.parts.iter().map(|p| (self.tool_from_object * p.pose, p.convex.clone())).collect() }
    }
}

/// How far a direction of the tool may lean from where it should point.
#[derive(Clone, Copy, Debug)]
pub struct Lean {
    /// Unit, in the tool's frame.
    pub axis: Vec3,
    /// Unit, in the root frame.
    pub upward: Vec3,
    /// Cosine of the largest angle between the two.
    pub least: f64,
}

/// Which objects stand, which were put down where, and what the hand does.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Objects where the scene has them.
    pub standing: ObjectSet,
    /// Objects put down elsewhere, in the root frame.
    pub placed: Vec<(ObjectId, Arc<Obstacle>)>,
    pub held: Option<Held>,
    /// The hand's links may touch this object: it is being approached, gripped or let go of. They
    /// still may not go through it.
    pub gripping: Option<ObjectId>,
    /// The held object is being lifted off or put down.
    pub resting: bool,
    /// Postures in which what is held leans farther count as touching something. Asked of the
    /// postures looked at only, not of all in between.
    pub lean: Option<Lean>,
    /// The hand's joint value.
    pub hand: f64,
    /// Closer than this is touching, metres: for the robot's links, and for what the hand holds.
    pub margin: f64,
    pub held_margin: f64,
}

impl Moment {
    /// Closer than this is touching, for what is held and a fixture.
    pub(crate) fn held_margin_to_fixture(&self, index: usize) -> f64 {
        let close = self.held.iter().flat_map(|held| &held.close.fixtures);
        close.filter(|(f, _)| *f == index).fold(self.held_margin, |margin, (_, close)| margin.min(*close))
    }

    /// The same with an object where the scene has it; what was put down elsewhere is kept off like anything.
    pub(crate) fn held_margin_to_object(&self, id: ObjectId) -> f64 {
        let close = self.held.iter().flat_map(|held| &held.close.objects);
        close.filter(|(o, _)| *o == id).fold(self.held_margin, |margin, (_, close)| margin.min(*close))
    }

    pub fn new(standing: ObjectSet, hand: f64, margin: f64) -> Self {
        Self {
            standing,
            placed: Vec::new(),
            held: None,
            gripping: None,
            resting: false,
            lean: None,
            hand,
            margin,
            held_margin: margin,
        }
    }
}
