//! Outcomes in words: the verdict first, then what went wrong, then what was assumed. Steps are told by their
//! objects.

use crate::outcome::{End, Hold, Outcome, Thing, ThingKind, Touch};
use crate::settings::{Noise, Settings};
use crate::trials::Trials;
use clearway_plan::scene_file::{DENSITY, FRICTION};
use std::fmt;

/// Touches told at most; the JSON report has all.
const MOST_TOUCHES: usize = 12;

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved = self.ends.iter().filter(|e| e.moved).count();
        match (self.as_planned, self.touched) {
            (true, false) => {
                writeln!(f, "ends as planned: {}, nothing else", counted(moved, "object moved", "objects moved"))?
            }
            (true, true) => writeln!(f, "ends as planned, but the robot touches what it should not")?,
            (false, _) => {
                let elsewhere = self.elsewhere().count();
                writeln!(f, "ends elsewhere: {} of {}", elsewhere, counted(self.ends.len(), "object", "objects"))?;
            }
        }
        for hold in &self.holds {
            told_hold(f, hold)?;
        }
        for end in self.elsewhere() {
            writeln!(f, "  {end}")?;
        }
        if self.touches.is_empty() {
            writeln!(f, "  no touch that the plan did not intend")?;
        }
        for touch in self.touches.iter().take(MOST_TOUCHES) {
            writeln!(f, "  {touch}")?;
        }
        if self.touches.len() > MOST_TOUCHES {
            writeln!(f, "  and {} more touches: see --json", self.touches.len() - MOST_TOUCHES)?;
        }
        let ends = self.ends.iter().filter(|e| e.moved && !e.elsewhere);
        let farthest = ends.map(|e| e.distance).fold(0.0, f64::max);
        write!(f, "  {:.1} s of motion", self.motion)?;
        if self.waited > 0.0 {
            write!(f, ", and {:.2} s waiting for the hand to grip", self.waited)?;
        }
        writeln!(f, "; what was moved ends within {:.1} mm of its place", farthest * 1e3)?;
        assumed(f, &self.ends)?;
        writeln!(f, "  settings: {}", self.settings)
    }
}

fn told_hold(f: &mut fmt::Formatter<'_>, hold: &Hold) -> fmt::Result {
    let object = &hold.object;
    match (hold.held, hold.dropped) {
        (None, _) => writeln!(f, "  {object}: the hand did not have it"),
        (_, Some(time)) => writeln!(f, "  {object}: dropped from the hand at {time:.2} s"),
        _ if hold.slipped > 1e-3 => writeln!(f, "  {object}: slipped by {:.1} mm in the hand", hold.slipped * 1e3),
        _ => Ok(()),
    }
}

/// What falls farther has missed everything, metres.
const BOTTOMLESS: f64 = 5.0;

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let became = if self.fallen { "fell" } else { "is elsewhere" };
        let place = if self.moved { "where it was to be put" } else { "where it stood" };
        let Self { object, level, distance, tilt, .. } = self;
        if self.fallen && *distance > BOTTOMLESS {
            return write!(f, "{object} fell, and met nothing below");
        }
        write!(
            f,
            "{object} {became}: {:.1} mm from {place} ({:.1} mm level), tilted {tilt:.1}°",
            distance * 1e3,
            level * 1e3
        )
    }
}

impl fmt::Display for Touch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, second, time, object, .. } = self;
        let kind = format!("{:?}", self.segment).to_lowercase();
        write!(f, "{first} touches {second} at {time:.2} s ({object}, {kind})")?;
        match (self.force, self.impulse) {
            (Some(force), Some(impulse)) => write!(f, ": up to {force:.2} N, {impulse:.3} N s"),
            _ => write!(f, ": up to {:.2} mm deep", self.depth * 1e3),
        }
    }
}

impl fmt::Display for Thing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            ThingKind::Link => "link",
            ThingKind::Held => "held",
            ThingKind::Object => "object",
            ThingKind::Fixture => "fixture",
        };
        write!(f, "{kind} {}", self.id)
    }
}

impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} steps/s, controllers lag {} ms, pads press with {} N and rub with {}; elsewhere is more than {} mm or {}° for what is moved, {} mm or {}° for what is not",
            self.rate,
            self.lag * 1e3,
            self.grip,
            self.rubber,
            self.moved.position * 1e3,
            self.moved.tilt,
            self.unmoved.position * 1e3,
            self.unmoved.tilt
        )
    }
}

impl fmt::Display for Noise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { position, friction, radius } = self;
        let (position, friction, radius) = (position * 1e3, friction * 100.0, radius * 1e3);
        write!(f, "positions within {position} mm, friction ± {friction} %, radii ± {radius} mm")
    }
}

impl fmt::Display for Trials {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.trials.len();
        let percent = 100.0 * self.rate();
        writeln!(
            f,
            "{} of {} as planned ({percent:.1} %)",
            self.as_planned,
            counted(count, "trial ends", "trials end")
        )?;
        for failing in &self.failing {
            writeln!(
                f,
                "  {}: failed in {} (mostly: {})",
                failing.object,
                counted(failing.trials, "trial", "trials"),
                failing.why
            )?;
        }
        writeln!(f, "  the robot touches what it should not in {}", counted(self.touched, "trial", "trials"))?;
        writeln!(f, "  noise: {}; seed {}", self.noise, self.seed)?;
        if let Some(first) = self.trials.first() {
            assumed(f, &first.outcome.ends)?;
            writeln!(f, "  settings: {}", first.outcome.settings)?;
        }
        Ok(())
    }
}

/// What the scene did not say.
fn assumed(f: &mut fmt::Formatter<'_>, ends: &[End]) -> fmt::Result {
    let of = |which: &dyn Fn(&End) -> bool| {
        let names: Vec<&str> = ends.iter().filter(|e| which(e)).map(|e| e.object.as_str()).collect();
        if names.len() == ends.len() { "all objects".to_owned() } else { names.join(", ") }
    };
    let (masses, frictions) = (of(&|e| e.assumed.mass), of(&|e| e.assumed.friction));
    if !masses.is_empty() {
        writeln!(f, "  assumed: {DENSITY} kg/m³ for {masses}")?;
    }
    if !frictions.is_empty() {
        writeln!(f, "  assumed: friction {FRICTION} for {frictions}")?;
    }
    Ok(())
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
