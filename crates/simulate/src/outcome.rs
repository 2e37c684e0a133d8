//! What came of playing a plan, as data. Printed by `told`.

use crate::settings::Settings;
use clearway_plan::plan_file::SegmentKind;
use serde::Serialize;

/// What came of playing a plan once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Every object ends where the plan says, and was never dropped.
    pub as_planned: bool,
    /// The robot, or what it held, met what it should not, with [`Settings::touch`] or more.
    pub touched: bool,
    /// What the plan did not intend, in order of time.
    pub touches: Vec<Touch>,
    /// One for each time that the hand closed.
    pub holds: Vec<Hold>,
    /// Every object, in the scene's order.
    pub ends: Vec<End>,
    /// Seconds that the plan moves.
    pub motion: f64,
    /// Seconds that it waited for the hand beyond that.
    pub waited: f64,
    pub settings: Settings,
}

impl Outcome {
    pub fn elsewhere(&self) -> impl Iterator<Item = &End> {
        self.ends.iter().filter(|e| e.elsewhere)
    }

    pub fn end(&self, object: &str) -> Option<&End> {
        self.ends.iter().find(|e| e.object == object)
    }
}

/// Two things that should not have touched, during one segment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Touch {
    /// At first, seconds from the plan's start; less than 0 while things came to rest before it.
    pub time: f64,
    /// Index into the plan's `steps`, from 0, and the object of the step.
    pub step: usize,
    pub object: String,
    pub segment: SegmentKind,
    pub first: Thing,
    pub second: Thing,
    /// The largest force, newtons; missing where neither can give way: between links, and with fixtures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// N s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse: Option<f64>,
    /// How deep one went into the other, metres.
    pub depth: f64,
}

impl Touch {
    /// By the robot, or by what it holds.
    pub fn by_robot(&self) -> bool {
        [&self.first, &self.second].iter().any(|t| matches!(t.kind, ThingKind::Link | ThingKind::Held))
    }

    /// With so many newtons, or with what does not give way.
    pub fn with(&self, newtons: f64) -> bool {
        self.force.is_none_or(|f| f >= newtons)
    }
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Thing {
    pub kind: ThingKind,
    pub id: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ThingKind {
    Link,
    /// The object in the hand.
    Held,
    Object,
    Fixture,
}

/// How an object was held.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hold {
    /// Index into the plan's `steps`, from 0.
    pub step: usize,
    pub object: String,
    /// Newtons on each pad; missing for suction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// When the hand had it, seconds from the plan's start.
    pub held: Option<f64>,
    /// When it lost it.
    pub dropped: Option<f64>,
    /// How far it went in the hand while carried, metres.
    pub slipped: f64,
}

/// Where an object ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct End {
    pub object: String,
    /// Moved by the plan.
    pub moved: bool,
    /// Where it should be, and where it is, metres.
    pub expected: [f64; 3],
    pub found: [f64; 3],
    /// From there, level, metres.
    pub level: f64,
    /// From there, in all, metres.
    pub distance: f64,
    /// Degrees from how it should stand.
    pub tilt: f64,
    /// Lies, or fell off what should carry it.
    pub fallen: bool,
    /// Beyond the tolerances, or fallen.
    pub elsewhere: bool,
    /// What was taken for its mass, kilograms, and friction.
    pub mass: f64,
    pub friction: f64,
    pub assumed: Assumed,
}

/// What the scene did not say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Assumed {
    pub mass: bool,
    pub friction: bool,
}
