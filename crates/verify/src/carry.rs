//! Where every object is, segment by segment, and whether it could have come there: taken where it
//! stands, held by the hand, let go where `placed` says. What is pushed is [`push`](crate::push)'s.

use crate::case::{Case, Track, pose_of};
use crate::error::CannotJudge;
use crate::names::Names;
use crate::placement::{self, Rest};
use crate::push::{Push, Pushed};
use crate::report::{Place, Report, ViolationKind};
use crate::rest::{self, Standing};
use crate::shapes::{body_gap, extent};
use crate::stability::Stability;
use clearway_plan::plan_file::{Action, Attached, SegmentKind, Step};
use clearway_plan::{Budget, PlanFile};
use parry3d_f64::math::Pose;

/// How far an object may be from where it stood, or from `placed`, when gripped or let go.
const SAME_PLACE: f64 = 1e-3;
const SAME_TURN: f64 = 0.01;
/// An object may settle by this when let go.
const SETTLE: f64 = 1e-3;
/// What is held is at most this far from a link of the hand.
const GRIP: f64 = 5e-3;
/// How exactly `pose_in_tool` stays the same.
const SAME_HOLD: f64 = 1e-6;
const ROUNDING: f64 = 1e-6;

/// What is where during one segment.
pub(crate) struct Stage {
    pub standing: Standing,
    pub held: Option<Held>,
    pub pushed: Option<Pushed>,
    /// The object that links of the hand may touch.
    pub gripping: Option<usize>,
}

/// An object that moves with a link.
#[derive(Clone)]
pub(crate) struct Held {
    pub object: usize,
    pub tool: usize,
    pub tool_from_object: Pose,
    /// Where it stood, and where it will stand, with what carries it there: overlap with those is
    /// forgiven near those poses.
    pub lifted_from: (Pose, Vec<String>),
    pub put_on: (Pose, Vec<String>),
}

/// A stage for every track, in order.
pub(crate) fn stages(
    plan: &PlanFile,
    case: &Case,
    names: &Names,
    tracks: &[Track],
    objects: &[usize],
    budget: &Budget,
    report: &mut Report,
) -> Result<Vec<Stage>, CannotJudge> {
    let mut standing: Standing = case.objects.iter().map(|o| Some(o.pose)).collect();
    let mut stability = Stability::new(case, &standing, budget)?;
    placement::check_start(case, &standing, &stability, budget, report)?;
    let mut stages = Vec::new();
    for (index, (step, &object)) in plan.steps.iter().zip(objects).enumerate() {
        budget.check()?;
        let of_step: Vec<&Track> = tracks.iter().filter(|t| t.step == index).collect();
        let time = of_step.first().map_or(0.0, |t| t.start);
        let from = standing[object].unwrap_or(case.objects[object].pose);
        let to = pose_of(&step.placed).unwrap_or_else(|| {
            report.at(ViolationKind::Rows, Place::step(index, time), "placed is no pose");
            from
        });
        let walk = Walk { plan, case, names, step, object, from, to, of_step: &of_step };
        walk.run(&mut standing, &mut stability, &mut stages, report);
        let is_last = !plan.steps[index + 1..].iter().any(|s| s.object == step.object);
        let rest = match (step.action, is_last) {
            _ if plan.goal.is_some() => Rest::Anywhere,
            (Action::PickPlace, true) => Rest::InPlace,
            _ => Rest::InPlaceOrOn(
                rest::carriers(case, &standing, object, &from).into_iter().map(str::to_owned).collect(),
            ),
        };
        let end = of_step.last().map_or(time, |t| t.start + t.segment.times.last().copied().unwrap_or(0.0));
        placement::check_placed(case, &standing, object, &to, &rest, Place::step(index, end), report);
        stability.put(object, &to, Place::step(index, end), report);
    }
    Ok(stages)
}

/// One step, from its first segment to its last.
struct Walk<'a> {
    plan: &'a PlanFile,
    case: &'a Case,
    names: &'a Names,
    step: &'a Step,
    object: usize,
    from: Pose,
    to: Pose,
    of_step: &'a [&'a Track<'a>],
}

impl Walk<'_> {
    fn run(&self, standing: &mut Standing, stability: &mut Stability, stages: &mut Vec<Stage>, report: &mut Report) {
        let kinds: Vec<SegmentKind> = self.of_step.iter().map(|t| t.segment.kind).collect();
        let release = kinds.iter().position(|k| *k == SegmentKind::Release).unwrap_or(kinds.len());
        let grasp = kinds[..release].iter().rposition(|k| *k == SegmentKind::Grasp);
        let carried_from = owned(rest::carriers(self.case, standing, self.object, &self.from));
        let mut without = standing.clone();
        without[self.object] = None;
        let carried_to = owned(rest::carriers(self.case, &without, self.object, &self.to));
        let Walk { plan, case, names, step, object, from, to, of_step: tracks } = *self;
        let push = Push { plan, case, names, step, object, from, to, tracks };
        let mut pushes = push.judge(standing, stability, report);
        let mut held: Option<Held> = None;
        let mut gone = false; // has been held and let go, or pushed
        for (i, track) in self.of_step.iter().enumerate() {
            let kind = track.segment.kind;
            let must = grasp.is_some_and(|g| g < i && i < release);
            let may = must || kind == SegmentKind::Push || grasp == Some(i) || i == release;
            let now = track.segment.attached.as_ref().and_then(|attached| {
                if !may {
                    report.at(
                        ViolationKind::Attachment,
                        track.place(),
                        format!("{} is attached in a {kind:?} segment, in which nothing is held", attached.object),
                    );
                }
                self.held(attached, track, (&carried_from, &carried_to), report)
            });
            if must && track.segment.attached.is_none() {
                let what = format!("{} is not attached, between grasp and release", self.step.object);
                report.at(ViolationKind::Attachment, track.place(), what);
            }
            match (&held, &now) {
                (None, Some(taken)) => {
                    self.taken(taken, if gone { &self.to } else { &self.from }, track, standing, report);
                    stability.take(self.object, track.at(0), report);
                }
                (Some(before), Some(after)) if !same_hold(before, after) => {
                    report.at(
                        ViolationKind::Attachment,
                        track.place(),
                        format!("{} changes its pose in the hand", self.step.object),
                    );
                }
                (Some(before), None) => {
                    self.let_go(before, self.of_step[i - 1], &without, report);
                    gone = true;
                }
                _ => {}
            }
            if let Some(now) = &now {
                self.gripped(now, track, report);
            }
            gone |= now.is_none() && i >= release;
            let still = if gone { self.to } else { self.from };
            standing[self.object] = (now.is_none() && kind != SegmentKind::Push).then_some(still);
            gone |= kind == SegmentKind::Push && now.is_none();
            let gripping = (kind != SegmentKind::Transit || now.is_some()).then_some(self.object);
            stages.push(Stage { standing: standing.clone(), held: now.clone(), pushed: pushes[i].take(), gripping });
            held = now;
        }
        if let (Some(held), Some(last)) = (&held, self.of_step.last()) {
            let what = format!("the step ends with {} in the hand", self.step.object);
            report.at(ViolationKind::Attachment, last.place(), what);
            self.let_go(held, last, &without, report);
        }
        standing[self.object] = Some(self.to);
    }

    fn held(
        &self,
        attached: &Attached,
        track: &Track,
        (from, to): (&[String], &[String]),
        report: &mut Report,
    ) -> Option<Held> {
        if attached.object != self.step.object {
            let what = format!("{} is attached in a step of {}", attached.object, self.step.object);
            report.at(ViolationKind::Attachment, track.place(), what);
            return None;
        }
        match (self.case.model.link(&attached.tool), pose_of(&attached.pose_in_tool)) {
            (Some(tool), Some(tool_from_object)) => Some(Held {
                object: self.object,
                tool,
                tool_from_object,
                lifted_from: (self.from, from.to_vec()),
                put_on: (self.to, to.to_vec()),
            }),
            _ => {
                let what = format!(
                    "{} is attached to {:?}; expected a link of the URDF and a valid pose",
                    attached.object, attached.tool
                );
                report.at(ViolationKind::Attachment, track.place(), what);
                None
            }
        }
    }

    fn pose_at(&self, held: &Held, posture: &[f64]) -> Pose {
        self.case.link_poses(posture)[held.tool] * held.tool_from_object
    }

    /// The object is taken where it stands, and carries nothing.
    fn taken(&self, held: &Held, stood: &Pose, track: &Track, standing: &Standing, report: &mut Report) {
        let object = &self.case.objects[self.object];
        let found = self.pose_at(held, &track.postures[0]);
        let (away, turned) = apart(&found, stood);
        if !(away <= SAME_PLACE + ROUNDING && turned <= SAME_TURN) {
            let what =
                format!("{} is gripped {:.1} mm and {turned:.3} rad from where it stands", object.id, away * 1e3);
            report.at(ViolationKind::Teleport, track.at(0), what);
        }
        let mut without = standing.clone();
        without[self.object] = None;
        for (i, above) in self.case.objects.iter().enumerate() {
            let Some(at) = standing[i].filter(|_| i != self.object) else { continue };
            if rest::rests_on(above, &at, object, stood) && rest::carriers(self.case, &without, i, &at).is_empty() {
                report.at(
                    ViolationKind::Unsupported,
                    track.at(0),
                    format!("{} stands on {}, which is taken from under it", above.id, object.id),
                );
            }
        }
    }

    /// Something of the hand is within 5 mm at the track's first, middle and last rows.
    fn gripped(&self, held: &Held, track: &Track, report: &mut Report) {
        let object = &self.case.objects[self.object];
        let last = track.postures.len() - 1;
        for row in [0, last / 2, last] {
            let poses = self.case.link_poses(&track.postures[row]);
            let at = poses[held.tool] * held.tool_from_object;
            let links = self.case.model.links.iter().zip(&poses).zip(&self.names.in_hand);
            let nearest = links
                .filter(|(_, in_hand)| **in_hand)
                .filter_map(|((link, pose), _)| body_gap(&link.pieces, pose, &object.pieces, &at, 1.0))
                .map(|g| g.distance)
                .fold(f64::INFINITY, f64::min);
            if nearest > GRIP + ROUNDING {
                let what = format!(
                    "{} is {:.1} mm from the hand that holds it; expected at most 5 mm",
                    object.id,
                    nearest * 1e3
                );
                report.at(ViolationKind::Grip, track.at(row), what);
                return;
            }
        }
    }

    /// The object ends where `placed` says; if it does not, whether something is under it.
    fn let_go(&self, held: &Held, track: &Track, without: &Standing, report: &mut Report) {
        let row = track.postures.len() - 1;
        let found = self.pose_at(held, &track.postures[row]);
        let (_, turned) = apart(&found, &self.to);
        let moved = found.translation - self.to.translation;
        let sunk = moved.z.abs() - moved.z.abs().min(SETTLE);
        let away = moved.truncate().length().hypot(sunk);
        if away <= SAME_PLACE + ROUNDING && turned <= SAME_TURN {
            return;
        }
        let object = &self.case.objects[self.object];
        let bottom = extent(&object.pieces, &found).0.z;
        let on_place = placement::place_under(self.case, &object.pieces, &found, 2.0 * rest::REST).is_some();
        if on_place || !rest::carriers(self.case, without, self.object, &found).is_empty() {
            let what = format!(
                "{} is let go {:.1} mm and {turned:.3} rad from where `placed` says",
                object.id,
                moved.length() * 1e3
            );
            report.at(ViolationKind::PutDown, track.at(row), what);
        } else {
            let what = format!(
                "{} is let go in mid-air, its bottom at z = {bottom:.4} m, {:.1} mm from where `placed` says",
                object.id,
                moved.length() * 1e3
            );
            report.at(ViolationKind::LetGo, track.at(row), what);
        }
    }
}

fn owned(names: Vec<&str>) -> Vec<String> {
    names.into_iter().map(str::to_owned).collect()
}

/// Metres and radians between two poses.
pub(crate) fn apart(a: &Pose, b: &Pose) -> (f64, f64) {
    let turn = a.rotation.inverse() * b.rotation;
    let angle = 2.0 * turn.xyz().length().atan2(turn.w.abs());
    ((a.translation - b.translation).length(), angle)
}

fn same_hold(a: &Held, b: &Held) -> bool {
    let (away, turned) = apart(&a.tool_from_object, &b.tool_from_object);
    a.tool == b.tool && away <= SAME_HOLD && turned <= SAME_HOLD
}
