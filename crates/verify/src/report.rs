//! What the verifier found: violations, what was checked, and what was not.

use clearway_plan::clearance::{Clearance, Least};
use serde::Serialize;
use std::fmt;

/// What is wrong, in the terms of the plan file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ViolationKind {
    /// There is no plan to judge: `status` is not `solved`, or there are no steps.
    NotSolved,
    /// `format` is not a plan's.
    Format,
    /// Joints, links or the tool named by the plan do not fit its URDF.
    Joints,
    /// A row has the wrong width, a number is not finite, or `positions` and `times` differ in length.
    Rows,
    /// `times` do not start at 0, do not rise, or are more than 0.02 s apart.
    Times,
    /// The first row is not where the robot starts.
    Start,
    /// A segment does not start where the last one ended.
    Continuity,
    /// A step names no object of the scene, its segments are out of order, or steps are missing.
    Steps,
    /// The gripper changes outside `grasp` and `release`, jumps, or leaves its limits.
    Gripper,
    /// `removed` does not match the steps.
    Removed,
    /// A joint beyond its position limits.
    PositionLimit,
    VelocityLimit,
    AccelerationLimit,
    JerkLimit,
    /// The plan claims limits that the URDF does not grant, or none.
    DeclaredLimit,
    /// The mobile base outside `scene.robot.region`.
    Region,
    /// A pair of links may not go unchecked.
    UncheckedPair,
    /// `attached` missing, unexpected, changing, or of another object.
    Attachment,
    /// An object is attached, or let go, elsewhere than it stands.
    Teleport,
    /// The held object is too far from the hand.
    Grip,
    /// An object let go with nothing under it.
    LetGo,
    /// An object put down elsewhere than `placed` says.
    PutDown,
    /// `placed` is not upright.
    Tilted,
    /// An object that nothing carries.
    Unsupported,
    /// An object that tips over: by itself, or with what is on it.
    Unstable,
    /// `placed` outside every place.
    OffPlace,
    /// Things that stand still overlap.
    Overlap,
    /// A link of the robot touches a fixture or an object.
    Collision,
    /// What is held touches something.
    HeldCollision,
    /// Two links of the robot touch.
    SelfCollision,
    /// A push that cannot go as it says: off its line, too high, too sudden, of what is not round.
    Push,
    /// What is pushed touches something.
    PushedCollision,
    /// Less room than the scene asks for, or than the plan claims.
    Clearance,
    /// An object, or space, that the camera had not seen.
    NotSeen,
    /// `lower_bound` cannot be true.
    LowerBound,
}

impl fmt::Display for ViolationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = format!("{self:?}");
        for (i, c) in name.chars().enumerate() {
            if c.is_uppercase() && i > 0 {
                f.write_str(" ")?;
            }
            write!(f, "{}", c.to_ascii_lowercase())?;
        }
        Ok(())
    }
}

/// One thing wrong.
#[derive(Clone, Debug, Serialize)]
pub struct Violation {
    pub kind: ViolationKind,
    /// Index into the plan's `steps`, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<usize>,
    /// Index into the step's `segments`, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segment: Option<usize>,
    /// Index into the segment's rows, from 0: the row at which, or after which, it happens.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub row: Option<usize>,
    /// Seconds from the plan's start.
    pub time: f64,
    /// Names links, joints and objects; depths in millimetres; points in the world.
    pub what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.kind)?;
        if let Some(step) = self.step {
            write!(f, ", step {step}")?;
        }
        if let Some(segment) = self.segment {
            write!(f, ", segment {segment}")?;
        }
        if let Some(row) = self.row {
            write!(f, ", row {row}")?;
        }
        if self.step.is_some() {
            write!(f, " ({:.3} s)", self.time)?;
        }
        write!(f, ": {}", self.what)
    }
}

/// How much was looked at.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    pub steps: usize,
    pub segments: usize,
    pub rows: usize,
    /// Seconds that the robot moves.
    pub duration: f64,
    /// Pairs of shapes watched, summed over segments.
    pub pairs: usize,
    /// Exact distances computed.
    pub distances: usize,
    /// Link pairs that the plan leaves unchecked.
    pub unchecked_pairs: usize,
}

/// The verdict on a plan.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    pub violations: Vec<Violation>,
    pub checked: Summary,
    /// What the verifier did not judge, and why.
    pub not_checked: Vec<String>,
    /// The room that the motions keep; missing if they could not be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<Clearance>,
}

impl Report {
    pub fn is_valid(&self) -> bool {
        self.violations.is_empty()
    }

    /// True when there was no plan to judge, as opposed to a bad one.
    pub fn is_unsolved(&self) -> bool {
        self.violations.iter().any(|v| v.kind == ViolationKind::NotSolved)
    }

    pub fn has(&self, kind: ViolationKind) -> bool {
        self.violations.iter().any(|v| v.kind == kind)
    }

    /// About the plan as a whole.
    pub(crate) fn plan(&mut self, kind: ViolationKind, what: impl Into<String>) {
        self.violations.push(Violation { kind, step: None, segment: None, row: None, time: 0.0, what: what.into() });
    }

    pub(crate) fn at(&mut self, kind: ViolationKind, place: Place, what: impl Into<String>) {
        self.violations.push(Violation {
            kind,
            step: Some(place.step),
            segment: place.segment,
            row: place.row,
            time: place.time,
            what: what.into(),
        });
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let c = &self.checked;
        writeln!(
            f,
            "{}: {} steps, {} segments, {} rows, {:.2} s of motion; {} pairs of shapes, {} exact distances",
            match self.violations.len() {
                0 => "valid".to_owned(),
                1 => "1 violation".to_owned(),
                n => format!("{n} violations"),
            },
            c.steps,
            c.segments,
            c.rows,
            c.duration,
            c.pairs,
            c.distances,
        )?;
        if let Some(clearance) = &self.clearance {
            writeln!(f, "  {}", in_words(clearance))?;
        }
        for violation in &self.violations {
            writeln!(f, "  {violation}")?;
        }
        for note in &self.not_checked {
            writeln!(f, "  not checked: {note}")?;
        }
        Ok(())
    }
}

fn in_words(clearance: &Clearance) -> String {
    let asked = match clearance.asked {
        0.0 => String::new(),
        asked => format!(" (asked: {:.1} mm)", asked * 1e3),
    };
    match &clearance.least {
        Some(Least { distance, between: [a, b], time, .. }) => {
            format!("clearance {:.1} mm{asked}, least between {a} and {b} at {time:.2} s", distance * 1e3)
        }
        None => format!("clearance above {:.0} mm{asked}", clearance.up_to * 1e3),
    }
}

/// Where in a plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub step: usize,
    pub segment: Option<usize>,
    pub row: Option<usize>,
    /// Seconds from the plan's start.
    pub time: f64,
}

impl Place {
    pub fn step(step: usize, time: f64) -> Self {
        Self { step, segment: None, row: None, time }
    }

    pub fn segment(step: usize, segment: usize, time: f64) -> Self {
        Self { step, segment: Some(segment), row: None, time }
    }

    pub fn row(self, row: usize, time: f64) -> Self {
        Self { row: Some(row), time, ..self }
    }
}
