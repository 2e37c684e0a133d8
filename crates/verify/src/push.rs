//! Pushes: where an object is while the hand pushes it along, and whether it would go so.
//!
//! The model is quasi-static. The tool goes straight along a level direction without turning; after
//! its free way the hand meets the object, which from then on goes with it. Only upright round bodies
//! are pushed: those do not turn aside. At a row, the object's way is the tool's furthest so far, less
//! the free way; between rows it changes evenly. Judged are: `placed` and the line; [what carries the
//! object](ground); that the hand is [at it, not in it, and not too high](contact); and that it [stops
//! with the hand](braking). What the object meets on its way is judged with all that moves (see
//! [`collisions`](crate::collisions)).
//!
//! Not judged: how far the object slips within the hand, and how hard the hand meets it. Metres,
//! radians, world frame. Each fault is told once for a step. Costs a
//! microsecond or two for each row and link of the hand.

mod braking;
mod contact;
mod ground;
mod round;

use crate::carry::apart;
use crate::case::{Case, Track};
use crate::names::Names;
use crate::report::{Place, Report, ViolationKind};
use crate::rest::Standing;
use crate::stability::Stability;
use crate::sweep::When;
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{SegmentKind, Step};
use ground::Ground;
use parry3d_f64::math::{Pose, Vector};
use round::Round;

/// How far ways, lines and heights may be off, metres.
const SAME_PLACE: f64 = 1e-3;
/// How far anything may turn, radians.
const SAME_TURN: f64 = 0.01;
/// How far a direction may be off unit length, and off level.
const SAME_DIRECTION: f64 = 1e-3;
const ROUNDING: f64 = 1e-6;
/// No push is longer, metres.
const FAR: f64 = 1e3;
/// A smaller way between two rows is none, metres.
const MOVES: f64 = 1e-9;

/// An object that is pushed, during one segment.
pub(crate) struct Pushed {
    pub object: usize,
    pub slide: Slide,
    /// What it slides on.
    pub carriers: Vec<String>,
    /// Where it stood before the push, and where it will stand.
    pub ends: [Pose; 2],
}

/// Where an object is that goes along a line.
pub(crate) struct Slide {
    pub from: Pose,
    /// Unit.
    pub direction: Vector,
    /// At each row; they never fall.
    pub ways: Vec<f64>,
}

impl Slide {
    pub fn at(&self, When { row, fraction }: When) -> Pose {
        let way = self.ways[row];
        let next = self.ways.get(row + 1).copied().unwrap_or(way);
        shifted(&self.from, self.direction * (way + fraction * (next - way)))
    }
}

/// One step that pushes.
pub(crate) struct Push<'a> {
    pub plan: &'a PlanFile,
    pub case: &'a Case,
    pub names: &'a Names,
    pub step: &'a Step,
    pub object: usize,
    /// Where the object stood, and `placed`.
    pub from: Pose,
    pub to: Pose,
    /// All of the step.
    pub tracks: &'a [&'a Track<'a>],
}

/// The way of the tool and of the object.
struct Line {
    /// Unit and level.
    direction: Vector,
    distance: f64,
    free: f64,
}

/// The tool at a row of a push segment, against the first of all.
struct Row {
    /// Into the step's tracks.
    track: usize,
    place: Place,
    moved: Vector,
    turned: f64,
}

impl Push<'_> {
    /// Where the object is, for each track of the step in which it is pushed and not held.
    pub fn judge(&self, standing: &Standing, stability: &mut Stability, report: &mut Report) -> Vec<Option<Pushed>> {
        let none = || self.tracks.iter().map(|_| None).collect();
        let pushing = || self.tracks.iter().filter(|t| t.segment.kind == SegmentKind::Push);
        let held = pushing().filter(|t| t.segment.attached.is_some()).count();
        let Some(first) = pushing().next().filter(|_| held == 0) else {
            if let Some(one) = pushing().find(|t| t.segment.attached.is_none()) {
                let what = format!("{} is held in some push segments, and in others not", self.id());
                report.at(ViolationKind::Attachment, one.place(), what);
            }
            return none();
        };
        let Some(rows) = self.rows() else { return none() };
        let line = self.line(&rows, first.place(), report);
        self.placed(&line, first.place(), report);
        self.straight(&rows, &line, report);
        let ways = ways(&rows, &line);
        let ground = Ground::judge(self, standing, (&rows, &line, &ways), stability, report);
        let slides = self.slides(&rows, &line, &ways);
        contact::depth(self, &slides, report);
        if line.distance > ROUNDING {
            braking::check(self, &rows, &line, &ways, ground.friction, report);
            match Round::of(&self.case.objects[self.object].pieces, &self.from) {
                Ok(round) => {
                    let radius = round.foot.min(ground.reach);
                    contact::pushes(self, &slides, &round, radius / ground.friction, report);
                }
                Err(why) => {
                    let what = format!("{} may turn aside: {why}; only upright round bodies are pushed", self.id());
                    self.fault(first.place(), what, report);
                }
            }
        }
        slides
            .into_iter()
            .map(|slide| {
                let (carriers, ends) = (ground.carriers.clone(), [self.from, self.to]);
                Some(Pushed { object: self.object, slide: slide?, carriers, ends })
            })
            .collect()
    }

    fn id(&self) -> &str {
        &self.case.objects[self.object].id
    }

    fn fault(&self, place: Place, what: String, report: &mut Report) {
        report.at(ViolationKind::Push, place, what);
    }

    /// Every row of the push segments; where one follows another, its first row is the last one's last.
    fn rows(&self) -> Option<Vec<Row>> {
        let tool = self.case.model.link(&self.plan.robot.tool)?;
        let mut rows: Vec<Row> = Vec::new();
        let mut start: Option<Pose> = None;
        for (index, track) in self.tracks.iter().enumerate().filter(|(_, t)| t.segment.kind == SegmentKind::Push) {
            for (row, posture) in track.postures.iter().enumerate() {
                let at = self.case.link_poses(posture)[tool];
                let start = *start.get_or_insert(at);
                let (_, turned) = apart(&start, &at);
                rows.push(Row {
                    track: index,
                    place: track.at(row),
                    moved: at.translation - start.translation,
                    turned,
                });
            }
        }
        (!rows.is_empty()).then_some(rows)
    }

    /// As the step says; or as it must be, if it says nothing that makes sense.
    fn line(&self, rows: &[Row], place: Place, report: &mut Report) -> Line {
        if let Some(push) = &self.step.push {
            let direction = Vector::from(push.direction);
            let unit = (direction.length() - 1.0).abs() <= SAME_DIRECTION && direction.z.abs() <= SAME_DIRECTION;
            let lengths = [push.distance, push.free].iter().all(|v| (0.0..=FAR).contains(v));
            if unit && lengths {
                let direction = level(direction).normalize();
                return Line { direction, distance: push.distance, free: push.free };
            }
            let what = format!(
                "push.direction is {:?}, push.distance {} m, push.free {} m; expected a level unit vector, and lengths from 0 to 1000 m",
                push.direction, push.distance, push.free
            );
            self.fault(place, what, report);
        }
        // Whatever `placed` is, poses on the way stay within reason.
        let way = level(self.to.translation - self.from.translation);
        let travel = rows.last().map_or(Vector::ZERO, |r| level(r.moved));
        let direction = [way, travel]
            .into_iter()
            .find(|v| (ROUNDING..FAR).contains(&v.length()))
            .map_or(Vector::X, Vector::normalize);
        let distance = way.length().min(FAR);
        let furthest = rows.iter().map(|r| r.moved.dot(direction)).fold(0.0, f64::max);
        Line { direction, distance, free: (furthest - distance).max(0.0) }
    }

    /// `placed` is where the way ends, as high and as upright as before.
    fn placed(&self, line: &Line, place: Place, report: &mut Report) {
        let turn = self.to.rotation * self.from.rotation.inverse();
        let tilt = (turn * Vector::Z).angle_between(Vector::Z);
        if exceeds(tilt, SAME_TURN) {
            self.fault(place, format!("{} is tilted by {tilt:.3} rad where it is pushed to", self.id()), report);
        }
        let rise = self.to.translation.z - self.from.translation.z;
        if exceeds(rise.abs(), SAME_PLACE + ROUNDING) {
            self.fault(place, format!("{} is pushed to {:.1} mm above where it stood", self.id(), rise * 1e3), report);
        }
        let end = self.from.translation + line.direction * line.distance;
        let away = level(self.to.translation - end).length();
        if exceeds(away, SAME_PLACE + ROUNDING) {
            let what = format!("`placed` is {:.1} mm from where pushing {} leaves it", away * 1e3, self.id());
            self.fault(place, what, report);
        }
    }

    /// The tool keeps its orientation and to the line, and goes as far as is said.
    fn straight(&self, rows: &[Row], line: &Line, report: &mut Report) {
        let aside = |row: &Row| (row.moved - line.direction * row.moved.dot(line.direction)).length();
        let most = |value: &dyn Fn(&Row) -> f64, limit: f64| {
            let worst = rows.iter().max_by(|a, b| value(a).total_cmp(&value(b)));
            worst.filter(|r| exceeds(value(r), limit + ROUNDING))
        };
        if let Some(row) = most(&|r| r.turned, SAME_TURN) {
            self.fault(row.place, format!("the tool turns by {:.3} rad as it pushes", row.turned), report);
        }
        if let Some(row) = most(&aside, SAME_PLACE) {
            let what = format!("the tool is {:.1} mm beside the line along which it pushes", aside(row) * 1e3);
            self.fault(row.place, what, report);
        }
        let furthest = rows.iter().map(|r| r.moved.dot(line.direction)).fold(0.0, f64::max);
        let expected = line.free + line.distance;
        if exceeds((furthest - expected).abs(), SAME_PLACE + ROUNDING) {
            let what = format!(
                "the tool goes {:.1} mm; expected {:.1} mm, of which {:.1} mm with the object",
                furthest * 1e3,
                expected * 1e3,
                line.distance * 1e3
            );
            self.fault(rows[rows.len() - 1].place, what, report);
        }
    }

    /// Along each track that pushes.
    fn slides(&self, rows: &[Row], line: &Line, ways: &[f64]) -> Vec<Option<Slide>> {
        let mut slides: Vec<Option<Slide>> = self.tracks.iter().map(|_| None).collect();
        for (row, way) in rows.iter().zip(ways) {
            let slide = || Slide { from: self.from, direction: line.direction, ways: Vec::new() };
            slides[row.track].get_or_insert_with(slide).ways.push(*way);
        }
        slides
    }
}

/// The object's way at each row.
fn ways(rows: &[Row], line: &Line) -> Vec<f64> {
    let mut furthest: f64 = 0.0;
    let way = |row: &Row| {
        furthest = furthest.max(row.moved.dot(line.direction));
        (furthest - line.free).clamp(0.0, line.distance)
    };
    rows.iter().map(way).collect()
}

/// What is no number does, too.
fn exceeds(value: f64, limit: f64) -> bool {
    value > limit || value.is_nan() || limit.is_nan()
}

fn shifted(pose: &Pose, by: Vector) -> Pose {
    Pose::from_parts(pose.translation + by, pose.rotation)
}

fn level(v: Vector) -> Vector {
    Vector::new(v.x, v.y, 0.0)
}
