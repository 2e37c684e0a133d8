//! The motions of a push: to the object with the hand open, straight along with it, and away.

use super::{Attempt, Carried, Carrier, Situation, attempt, obstructed, segments};
use crate::grasps::hand;
use crate::push::{GRAVITY, Settings};
use crate::ways::Way;
use clearway_collision::Moment;
use clearway_geometry::{Convex, Pose, Vec3};
use clearway_motion::{Curve, Path, Posture, Space, Timed, distance, rounded, time_curve};
use clearway_plan::plan_file::{Action, SegmentKind, Step};
use clearway_plan::push::Push;
use clearway_plan::{ObjectId, ObjectSet};
use rand::Rng;

/// Between postures of a push, metres.
const STEP: f64 = 0.01;
/// And of the way out.
const OUT: f64 = 0.02;
/// No joint turns farther from one to the next, radians, …
const REACH: f64 = 0.4;
/// … nor from the end of the push to where the way out begins.
const NEAR: f64 = 0.5;
/// The tool may leave the line by this, metres, and its axes turn by this, radians.
const OFF: f64 = 3e-4;
const TURNED: f64 = 3e-3;
/// So much more than asked is let pass: half of what friction holds was asked.
const GENTLE: f64 = 1.2;
/// The hand is looked at without the object until it is this near, metres.
const BEFORE: f64 = 5e-4;

/// A push, but for the motions.
pub struct Shove<'a> {
    pub object: ObjectId,
    /// Root from tool, round the object where it stands, not touching it.
    pub from: Pose,
    /// Unit, in the root frame.
    pub direction: Vec3,
    /// The hand's way to the object, and the object's.
    pub free: f64,
    pub distance: f64,
    /// Above the object's bottom: where it is pushed, and where it would tip.
    pub height: f64,
    pub tips_at: f64,
    pub friction: f64,
    /// In to `from`, and out from there along with the object.
    pub way_in: &'a Way,
    pub ways_out: &'a [Way],
}

impl<R: Rng> Carrier<'_, R> {
    pub fn push(&mut self, shove: &Shove, settings: &Settings, before: &Situation) -> Attempt<Carried> {
        let (world, object) = (self.world, shove.object);
        let Some(path) = self.along(shove) else {
            return obstructed("the push: the arm does not reach so far", ObjectSet::EMPTY);
        };
        let from = world.poses[object.index()];
        let world_from_object =
            world.world_from_root * Pose::new(from.rotation, from.translation + shove.direction * shove.distance);
        let mut after = before.clone();
        after.standing.remove(object);
        after.placed.push((object, world_from_object));
        let moments = self.moments(shove, before);
        // What is cheap to see comes first.
        let tool = self.tool_position();
        let with_it = |q: &&Posture| (tool(q) - shove.from.translation).dot(shove.direction) >= shove.free;
        let mut going = Space::quick(world, &moments.1, self.settings.step);
        if !path.iter().filter(with_it).all(|q| going.free(q)) {
            return obstructed("the push", ObjectSet::EMPTY);
        }
        let Some(back) = self.way_back(shove, &path, &after) else {
            return obstructed("the push: no way out for the hand", ObjectSet::EMPTY);
        };
        let pushed = attempt!(self.pushed(shove, settings, &path, &moments));
        let (there, _) = attempt!(self.approach(object, shove.way_in, before));
        let back = attempt!(self.withdraw(object, &mut after, back, false));
        after.pushed.push((object, settings.margin_of_error));

        let mut segments = self.coming_segments(there);
        segments.push(self.empty_handed(SegmentKind::Push, pushed));
        segments.extend(self.going_segments(back));
        let step = Step {
            object: self.scene.names[object.index()].clone(),
            action: Action::Push,
            segments,
            placed: segments::written(&world_from_object),
            push: Some(Push {
                direction: (world.world_from_root.rotation * shove.direction).to_array(),
                distance: shove.distance,
                free: shove.free,
                height: shove.height,
                tips_at: shove.tips_at,
                margin_of_error: settings.margin_of_error,
            }),
        };
        Ok(Ok(Carried { step, after, way_blocked_by: shove.way_in.blocked_by, loosely: false }))
    }

    /// Straight on from the way in, the tool not turning.
    fn along(&self, shove: &Shove) -> Option<Path> {
        let whole = shove.free + shove.distance;
        let count = (whole / STEP).ceil().max(1.0) as usize;
        let mut path = vec![shove.way_in.postures.first()?.clone()];
        for i in 1..=count {
            let at = shove.from.translation + shove.direction * (whole * i as f64 / count as f64);
            path.push(self.inverse.follow(&Pose::new(shove.from.rotation, at), &path, REACH)?);
        }
        Some(path)
    }

    /// With the hand on its way to the object, and with the object before it.
    fn moments(&self, shove: &Shove, before: &Situation) -> (Moment, Moment) {
        let (world, object) = (self.world, shove.object);
        let mut coming = Moment::new(before.standing, world.model.robot.hand.open(), self.settings.final_margin);
        coming.placed = before.placed(world);
        let mut going = coming.clone();
        coming.gripping = Some(object);
        going.standing.remove(object);
        let at_contact = Pose::new(shove.from.rotation, shove.from.translation + shove.direction * shove.free);
        let mut held = world.in_hand(object, &(world.poses[object.index()].inverse() * at_contact));
        held.kernel = Some(world.model.holding(&held.solid()));
        (held.fixtures_below, held.objects_below) = world.carriers[object.index()].clone();
        going.held = Some(held);
        going.resting = true;
        going.held_margin = self.settings.final_held_margin;
        (coming, going)
    }

    /// A way out for the hand once the object is where it goes: straight out, or else off the object and back to
    /// where the hand came in.
    fn way_back(&self, shove: &Shove, path: &Path, after: &Situation) -> Option<Path> {
        let leaving = self.leaving(shove.object, after);
        let mut leaving = Space::quick(self.world, &leaving, self.settings.step);
        let mut free = |path: &Path| path.iter().skip(1).all(|q| leaving.free(q));
        let end = &path[path.len() - 1];
        let off = |way: &&Way| way.postures.first().map_or(f64::INFINITY, |q| distance(q, end));
        let straight = shove.ways_out.iter().min_by(|a, b| off(a).total_cmp(&off(b))).filter(|way| off(way) < NEAR);
        let straight = straight.map(|way| [end].into_iter().chain(&way.postures).cloned().collect::<Path>());
        straight.filter(&mut free).or_else(|| self.back_to_way_in(shove, end).filter(&mut free))
    }

    /// Off the object, the finger that pushed first, then aside to the way in, and out along it.
    fn back_to_way_in(&self, shove: &Shove, end: &Posture) -> Option<Path> {
        const FINGER: f64 = 0.03;
        let Pose { rotation, translation: from } = shove.from;
        let back = -rotation.z_axis;
        let ahead = shove.direction.dot(back) < -0.9;
        let last = from + shove.direction * (shove.free + shove.distance);
        let mut path = vec![end.clone()];
        let to = |at: Vec3, path: &mut Path| {
            self.inverse.follow(&Pose::new(rotation, at), path, REACH).map(|q| path.push(q))
        };
        let off = if ahead { shove.free + shove.distance } else { self.past_fingers(shove) };
        let steps = (off / OUT).ceil().max(1.0) as usize;
        for i in 1..=steps {
            let out = off * i as f64 / steps as f64;
            let centred = if ahead { Vec3::ZERO } else { shove.direction * shove.free * (out / FINGER).min(1.0) };
            to(last + back * out - centred, &mut path)?;
        }
        if !ahead {
            let aside = (shove.distance / OUT).ceil().max(1.0) as usize;
            for i in 1..=aside {
                to(
                    from + back * off + shove.direction * (shove.distance * (1.0 - i as f64 / aside as f64)),
                    &mut path,
                )?;
            }
        }
        let tool = self.tool_position();
        let off = if ahead { 0.0 } else { off };
        let rest = shove.way_in.postures.iter().skip(1).skip_while(|q| (tool(q) - from).dot(back) < off - 1e-6);
        let before = path.len();
        path.extend(rest.cloned());
        let joins = path.get(before).is_some_and(|q| distance(q, &path[before - 1]) < NEAR);
        joins.then_some(path)
    }

    /// How far back the hand is off the object: its fingers end before it begins.
    fn past_fingers(&self, shove: &Shove) -> f64 {
        const ROOM: f64 = 0.01;
        let world = self.world;
        let tip = |(pose, convex): (Pose, &Convex)| pose.point(convex.support(pose.rotation.transpose() * Vec3::Z)).z;
        let tips = hand(world, world.model.robot.hand.open()).map(tip);
        let pose = world.poses[shove.object.index()];
        let back = pose.rotation.transpose() * -shove.from.rotation.z_axis;
        let front = world.solids[shove.object.index()].support(back).dot(back);
        tips.fold(0.0, f64::max) + front + ROOM
    }

    /// The push itself, timed so that the object stays with the hand when it brakes, and checked.
    fn pushed(
        &mut self,
        shove: &Shove,
        settings: &Settings,
        path: &Path,
        (coming, going): &(Moment, Moment),
    ) -> Attempt<Timed> {
        const WHAT: &str = "the push";
        let world = self.world;
        let tool = self.tool_position();
        let gone = |q: &Posture| (tool(q) - shove.from.translation).dot(shove.direction);
        let mut before_it = Space::quick(world, coming, self.settings.final_step);
        let mut with_it = Space::quick(world, going, self.settings.final_step);
        let mut timed = Timed::default();
        // As round as can be; where that leaves the line or touches something, less.
        for part in [1.0, 0.2] {
            let acceleration = settings.braking * shove.friction * GRAVITY;
            let Some(gentle) = self.gently(&rounded(path, part), settings.speed, acceleration, gone) else { continue };
            timed = gentle;
            let rows = &timed.positions;
            if rows.len() < 2 {
                return obstructed(WHAT, ObjectSet::EMPTY);
            }
            let met = rows.iter().position(|q| gone(q) >= shove.free - BEFORE).unwrap_or(rows.len() - 1);
            // Between two rows it is met.
            let last = met.max(1) - 1;
            if self.straight(shove, rows) && before_it.rows_free(&rows[..=last]) && with_it.rows_free(&rows[last..]) {
                return Ok(Ok(timed));
            }
        }
        let mut coarse = Space::quick(world, going, self.settings.step);
        let blamed = coarse.path_touched(&timed.positions).unwrap_or_default();
        obstructed(WHAT, blamed)
    }

    /// Whether the tool keeps to the line and does not turn.
    fn straight(&self, shove: &Shove, rows: &[Posture]) -> bool {
        let model = &self.world.model;
        rows.iter().all(|q| {
            let tool = model.kinematics.tool(q, model.robot.hand.open());
            let off = (tool.translation - shove.from.translation).reject_from(shove.direction);
            let turned = |a: Vec3, b: Vec3| a.distance(b) > TURNED;
            let (now, then) = (tool.rotation, shove.from.rotation);
            off.length() <= OFF && !turned(now.x_axis, then.x_axis) && !turned(now.z_axis, then.z_axis)
        })
    }

    /// A curve timed so that the tool keeps to a speed and an acceleration along it; `None` where slowing down does
    /// not do it.
    fn gently(&self, curve: &Curve, speed: f64, acceleration: f64, gone: impl Fn(&Posture) -> f64) -> Option<Timed> {
        let mut slower = 1.0;
        let mut timed = time_curve(curve, &self.limits(slower), self.settings.row);
        for _ in 0..6 {
            let excess = excess(&timed, speed, acceleration, &gone);
            if excess <= 1.0 {
                return Some(timed);
            }
            slower *= excess * 1.005;
            timed = time_curve(curve, &self.limits(slower), self.settings.row);
        }
        (excess(&timed, speed, acceleration, gone) <= GENTLE).then_some(timed)
    }
}

/// By what factor a motion has to be slower to keep to a speed and an acceleration.
fn excess(timed: &Timed, speed: f64, acceleration: f64, gone: impl Fn(&Posture) -> f64) -> f64 {
    let at: Vec<(f64, f64)> = timed.times.iter().copied().zip(timed.positions.iter().map(gone)).collect();
    let speeds: Vec<(f64, f64)> =
        at.windows(2).map(|w| ((w[0].0 + w[1].0) / 2.0, (w[1].1 - w[0].1) / (w[1].0 - w[0].0))).collect();
    let fastest = speeds.iter().map(|s| s.1.abs()).fold(0.0, f64::max);
    let changes = speeds.windows(2).map(|w| ((w[1].1 - w[0].1) / (w[1].0 - w[0].0)).abs());
    (fastest / speed).max((changes.fold(0.0, f64::max) / acceleration).sqrt())
}
