//! Playing a plan, in outline: things come to rest, the rows are followed in steps of the physics, things come to
//! rest again, and it is told where they are.

use crate::bodies::{self, Object};
use crate::ends::{self, Expected};
use crate::error::CannotSimulate;
use crate::grip::Pads;
use crate::hand::Hand;
use crate::outcome::{Hold, Outcome};
use crate::servo::Servo;
use crate::settings::Settings;
use crate::touches::{Stage, Touches};
use crate::world::{Owner, World};
use clearway_plan::plan_file::SegmentKind;
use clearway_plan::{Budget, PlanFile};
use clearway_verify::played::{Played, PlayedSegment};
use parry3d_f64::math::{Pose, Rotation, Vector};
use std::path::Path;

/// Steps between looks at the budget.
const LOOK: usize = 16;
/// Seconds without both pads, or the cup, after which an object is dropped.
const LOST: f64 = 0.05;

/// Plays a plan once, as its scene says, without noise. `directory` is where its meshes are relative to.
pub fn simulate(
    plan: &PlanFile,
    directory: &Path,
    settings: &Settings,
    budget: &Budget,
) -> Result<Outcome, CannotSimulate> {
    settings.validate().map_err(CannotSimulate::Settings)?;
    let played = Played::new(plan, directory)?;
    let objects = bodies::objects(plan, &played)?;
    let course = Course::new(plan, &played);
    Player::new(plan, &played, &course, &objects, settings, budget)?.play()
}

/// Where the plan puts things, and what carries them there.
pub(crate) struct Course {
    /// At the start, by object.
    pub carriers: Vec<Vec<String>>,
    /// By step: where its object is put, and what carries it there.
    put: Vec<(Pose, Vec<String>)>,
}

impl Course {
    pub fn new(plan: &PlanFile, played: &Played) -> Self {
        let mut standing: Vec<Option<Pose>> = played.objects.iter().map(|o| Some(o.world_from_body)).collect();
        let at = |i: usize| (i, &played.objects[i].world_from_body);
        let carriers = (0..played.objects.len()).map(at).map(|(i, pose)| played.carriers(&standing, i, pose)).collect();
        let put = plan
            .steps
            .iter()
            .zip(&played.step_objects)
            .map(|(step, object)| {
                let [x, y, z, w] = step.placed.quaternion;
                let turn = Rotation::from_xyzw(x, y, z, w).normalize();
                let pose = Pose::from_parts(Vector::from(step.placed.position), turn);
                standing[*object] = Some(pose);
                (pose, played.carriers(&standing, *object, &pose))
            })
            .collect();
        Self { carriers, put }
    }
}

/// A plan being played among these objects.
pub(crate) struct Player<'a> {
    plan: &'a PlanFile,
    played: &'a Played,
    course: &'a Course,
    objects: &'a [Object],
    settings: &'a Settings,
    budget: &'a Budget,
    world: World,
    servo: Servo,
    hand: Hand,
    /// The link whose x is the way the fingers close.
    frame: Option<usize>,
    touches: Touches<'a>,
    holds: Vec<Hold>,
    dt: f64,
    steps: usize,
    waited: f64,
    /// The object of the step, and where it stood.
    object: usize,
    stood: (Pose, Vec<String>),
    on: Vec<Vec<String>>,
    pads: Pads,
    links_at: Vec<Pose>,
    /// The object in the hand when it was had, and seconds since it was last felt.
    carried: Option<(Pose, f64)>,
}

impl<'a> Player<'a> {
    pub fn new(
        plan: &'a PlanFile,
        played: &'a Played,
        course: &'a Course,
        objects: &'a [Object],
        settings: &'a Settings,
        budget: &'a Budget,
    ) -> Result<Self, CannotSimulate> {
        let hand = Hand::new(plan, played)?;
        let start = played.segments[0].postures[0].clone();
        let mut links_at = Vec::new();
        played.link_poses(&start, &mut links_at);
        let dt = 1.0 / settings.rate;
        Ok(Self {
            world: World::new(played, objects, &links_at, &hand.rubber(played), settings),
            servo: Servo::new(settings.lag, dt, start),
            frame: played.link(&plan.robot.hand.frame),
            touches: Touches::new(played, course.carriers.clone(), dt),
            holds: Vec::new(),
            steps: 0,
            waited: 0.0,
            object: played.step_objects[0],
            stood: (Pose::IDENTITY, Vec::new()),
            on: course.carriers.clone(),
            pads: Pads::default(),
            carried: None,
            plan,
            played,
            course,
            objects,
            settings,
            budget,
            hand,
            dt,
            links_at,
        })
    }

    /// Plays the plan, from rest to rest.
    pub fn play(mut self) -> Result<Outcome, CannotSimulate> {
        let [before, after] = self.settings.settle;
        self.rest(before, -before)?;
        for (step, put) in self.course.put.iter().enumerate() {
            self.begin(step);
            for segment in self.played.segments.iter().filter(|s| s.step == step) {
                self.segment(segment, put)?;
            }
            self.touches.put_down(self.played.step_objects[step], &put.1);
        }
        self.rest(after, self.plan.duration())?;
        Ok(self.outcome())
    }

    /// Nothing is commanded.
    fn rest(&mut self, seconds: f64, from: f64) -> Result<(), CannotSimulate> {
        let nowhere = (Pose::IDENTITY, Vec::new());
        for step in 0..(seconds / self.dt).round() as usize {
            self.tick(from + step as f64 * self.dt, None, &nowhere)?;
        }
        Ok(())
    }

    fn begin(&mut self, step: usize) {
        self.object = self.played.step_objects[step];
        self.stood = (self.world.object(self.object), self.on[self.object].clone());
        self.course.put[step].1.clone_into(&mut self.on[self.object]);
    }

    fn segment(&mut self, segment: &PlayedSegment, put: &(Pose, Vec<String>)) -> Result<(), CannotSimulate> {
        let duration = segment.times.last().copied().unwrap_or(0.0);
        let object = &self.objects[self.object];
        match segment.kind {
            SegmentKind::Grasp => {
                self.hand.begin(self.settings, object.mass, object.friction.max(self.settings.rubber))
            }
            SegmentKind::Release => {
                self.hand.let_go(&mut self.world);
                self.carried = None;
            }
            _ => {}
        }
        let steps = (duration / self.dt).ceil() as usize;
        for step in 1..=steps {
            let time = (step as f64 * self.dt).min(duration);
            self.follow(&posture(segment, time), false);
            self.tick(segment.start + time, Some(segment), put)?;
        }
        if segment.kind == SegmentKind::Grasp {
            self.wait_for_the_grip(segment, put, segment.start + duration)?;
        }
        Ok(())
    }

    fn wait_for_the_grip(
        &mut self,
        segment: &PlayedSegment,
        put: &(Pose, Vec<String>),
        now: f64,
    ) -> Result<(), CannotSimulate> {
        let shapes = &self.objects[self.object].shapes;
        self.hand.suck(&mut self.world, self.played, self.object, shapes, self.settings.suction_reach);
        let last = posture(segment, f64::INFINITY);
        let mut waited = 0.0;
        while self.hand.asked().is_some() && !self.hand.holds() && waited < self.settings.patience {
            self.follow(&last, true);
            self.tick(now, Some(segment), put)?;
            waited += self.dt;
        }
        self.waited += waited;
        let held = self.hand.holds();
        self.holds.push(Hold {
            step: segment.step,
            object: self.played.objects[self.object].id.clone(),
            force: self.hand.asked(),
            held: held.then_some(now),
            dropped: None,
            slipped: 0.0,
        });
        self.carried = held.then(|| (self.object_in_hand(), 0.0));
        Ok(())
    }

    fn object_in_hand(&self) -> Pose {
        let object = self.world.object(self.object);
        self.frame.map_or(object, |frame| self.world.link(frame).inverse() * object)
    }

    /// The joints go where they are told, or where the grip's force leads them.
    fn follow(&mut self, command: &[f64], planned_over: bool) {
        let led = self.hand.step(&self.servo.at, self.pads, planned_over, self.dt);
        for joint in self.played.driven() {
            match led {
                Some((finger, to)) if finger == joint => self.servo.at[joint] = to,
                _ => self.servo.follow(joint, command[joint]),
            }
        }
        self.played.follow(&mut self.servo.at);
    }

    /// One step of the physics.
    fn tick(
        &mut self,
        time: f64,
        segment: Option<&PlayedSegment>,
        put: &(Pose, Vec<String>),
    ) -> Result<(), CannotSimulate> {
        if self.steps.is_multiple_of(LOOK) {
            self.budget.check()?;
        }
        self.steps += 1;
        self.played.link_poses(&self.servo.at, &mut self.links_at);
        self.world.drive(&self.links_at);
        self.world.keep_awake(self.object);
        self.world.step();
        let closes = self.frame.map_or(Vector::X, |frame| self.world.link(frame).rotation * Vector::X);
        let stage = Stage {
            time,
            moving: segment.map(|s| (s.step, s.index, s.kind)),
            object: self.object,
            held: self.carried.is_some(),
            ends: [&self.stood, put],
            object_at: self.world.object(self.object),
        };
        let mut pads = Pads::default();
        for contact in self.world.contacts() {
            if let (Owner::Link(link), Owner::Object(object)) = (contact.first, contact.second)
                && object == self.object
                && self.played.links[link].in_hand
            {
                let push = contact.push.dot(closes);
                pads.sides[usize::from(push < 0.0)] += push.abs();
            }
            self.touches.note(&contact, &stage);
        }
        self.pads = pads;
        self.watch_the_hold(time, segment.map(|s| s.kind));
        Ok(())
    }

    /// Whether what is carried is still there, and how far it slipped.
    fn watch_the_hold(&mut self, time: f64, kind: Option<SegmentKind>) {
        let now = self.object_in_hand();
        let (Some((then, since)), Some(hold)) = (&mut self.carried, self.holds.last_mut()) else { return };
        if !matches!(kind, Some(SegmentKind::Transfer | SegmentKind::Transit)) || hold.dropped.is_some() {
            return;
        }
        let felt = hold.force.is_none() || self.pads.least() > 0.0;
        *since = if felt { 0.0 } else { *since + self.dt };
        if *since > LOST {
            hold.dropped = Some(time - *since);
        } else {
            hold.slipped = hold.slipped.max((now.translation - then.translation).length());
        }
    }

    fn outcome(self) -> Outcome {
        let last_put = |object: usize| {
            let last = self.played.step_objects.iter().rposition(|o| *o == object);
            let pose = last.map_or(self.objects[object].world_from_object, |step| self.course.put[step].0);
            Expected { pose, moved: last.is_some() }
        };
        let ends: Vec<_> = (0..self.objects.len())
            .map(|i| {
                ends::end(
                    &self.played.objects[i].id,
                    &self.objects[i],
                    &last_put(i),
                    self.world.object(i),
                    self.settings,
                )
            })
            .collect();
        let touches = self.touches.found();
        Outcome {
            as_planned: !ends.iter().any(|e| e.elsewhere)
                && self.holds.iter().all(|h| h.held.is_some() && h.dropped.is_none()),
            touched: touches.iter().any(|t| t.by_robot() && t.with(self.settings.touch)),
            touches,
            holds: self.holds,
            ends,
            motion: self.plan.duration(),
            waited: self.waited,
            settings: self.settings.clone(),
        }
    }
}

/// Straight lines between rows.
fn posture(segment: &PlayedSegment, time: f64) -> Vec<f64> {
    let (times, postures) = (&segment.times, &segment.postures);
    let next = times.partition_point(|t| *t <= time);
    if next == 0 || next == times.len() {
        return postures[next.min(times.len() - 1).max(next.saturating_sub(1))].clone();
    }
    let part = (time - times[next - 1]) / (times[next] - times[next - 1]);
    postures[next - 1].iter().zip(&postures[next]).map(|(a, b)| a + part * (b - a)).collect()
}
