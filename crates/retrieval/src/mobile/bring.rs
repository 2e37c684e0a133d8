//! Bringing what was taken to another stand, where nothing could be put down at this one.

use super::Base;
use crate::carry::motions::AtEnds;
use crate::carry::put_down::Placement;
use crate::carry::{Attempt, Carrier, Obstruction, Situation, attempt};
use crate::grasps::Grasp;
use crate::stand::Stand;
use crate::ways::Way;
use clearway_collision::{Held, Moment};
use clearway_geometry::{Mat3, Pose, Vec3};
use clearway_motion::{Posture, Space, Timed, distance};
use clearway_plan::plan_file::Segment;
use clearway_plan::{ObjectId, ObjectSet};
use rand::Rng;

/// Other stands that something can be brought to, and what drives there.
pub struct Elsewhere<'a> {
    pub(crate) base: &'a Base,
    pub(crate) stands: &'a [Stand],
    /// Those with places in reach, the best first.
    pub(crate) order: Vec<usize>,
}

/// An object brought to above its spot.
pub(crate) struct Brought {
    /// Rows with the base's values.
    pub across: Vec<Timed>,
    pub placement: Placement,
    /// Where the robot is then.
    pub stand: usize,
    pub base: Vec<f64>,
}

impl<R: Rng> Carrier<'_, R> {
    /// The same at another stand.
    pub(crate) fn at<'b>(&'b mut self, stand: &'b Stand, base: Vec<f64>) -> Carrier<'b, R> {
        Carrier { world: &stand.world, base, ..self.same() }
    }

    /// Brings an object that hangs on to a way's end to another stand, and to above a spot there.
    pub(crate) fn bring(
        &mut self,
        elsewhere: &Elsewhere,
        object: ObjectId,
        grasp: &Grasp,
        way: &Way,
        before: &Situation,
        carrying: &Moment,
    ) -> Attempt<Brought> {
        /// Postures to drive in that are tried, and stands for each.
        const POSTURES: usize = 3;
        const STANDS: usize = 4;
        let world = self.world;
        let mut held = world.in_hand(object, &grasp.object_from_tool);
        held.kernel = Some(world.model.holding(&held.solid()));
        let mut hanging = carrying.clone();
        hanging.held = Some(held.clone());
        let mut failed = Obstruction {
            slower: false,
            what: "no spot is left on the places that the hand can reach with the object",
            blamed: ObjectSet::EMPTY,
        };
        let entry = way.postures.last().cloned().unwrap_or_default();
        for tucked in self.driving_postures(grasp, &hanging, &entry).into_iter().take(POSTURES) {
            self.budget.check()?;
            let mut out = match self.level_motion(&hanging, &entry, &tucked, "drawing in what is carried")? {
                Ok(out) => out,
                Err(obstruction) => {
                    failed = obstruction;
                    continue;
                }
            };
            for &stand in elsewhere.order.iter().take(STANDS) {
                let there = &elsewhere.stands[stand];
                let mut carrying = Moment::new(carrying.standing, grasp.closed, self.settings.margin);
                carrying.placed = before.placed(&there.world);
                let placement = match self.at(there, Vec::new()).place(
                    object,
                    grasp,
                    std::slice::from_ref(&tucked),
                    &carrying,
                    f64::INFINITY,
                )? {
                    Ok(placement) => placement,
                    Err(obstruction) => {
                        failed = obstruction;
                        continue;
                    }
                };
                let drive =
                    match elsewhere.base.drive(self, before, &there.placement, &tucked, Some((object, grasp)))? {
                        Ok(drive) => drive,
                        Err(obstruction) => {
                            failed = obstruction;
                            continue;
                        }
                    };
                let resting = AtEnds::Resting { within: self.settings.lower_from };
                let lifting = self.ready_to_carry(object, &hanging, &held);
                let mut path = way.postures.clone();
                path.extend(out.drain(1..));
                let out = attempt!(self.timed(&lifting, &path, resting, "the transfer"));
                let out = self.widened(out);
                let mut lowering = carrying.clone();
                lowering.held = Some(placement.held.clone());
                lowering.margin = self.settings.final_margin;
                lowering.held_margin = self.settings.final_held_margin;
                let mut path = placement.transfer.clone();
                path.extend(placement.lower.iter().skip(1).cloned());
                let base: Vec<f64> = drive.positions.last().map_or(Vec::new(), |row| row[..self.base.len()].to_vec());
                let mut other = self.at(there, base.clone());
                let down = attempt!(other.timed(&lowering, &path, resting, "the transfer"));
                let down = other.widened(down);
                return Ok(Ok(Brought { across: vec![out, drive, down], placement, stand, base }));
            }
        }
        Ok(Err(failed))
    }

    /// Postures that hold what hangs in the hand upright and near, those that reach out least first.
    fn driving_postures(&self, grasp: &Grasp, hanging: &Moment, entry: &Posture) -> Vec<Posture> {
        const OUT: [f64; 5] = [0.3, 0.4, 0.5, 0.6, 0.75];
        const BEARINGS: usize = 12;
        const RAISED: [f64; 2] = [0.05, 0.2];
        let world = self.world;
        let kinematics = &world.model.kinematics;
        let up = world.up();
        let tool = kinematics.tool(entry, hanging.hand);
        let pointing = tool.rotation.z_axis;
        let height = up * tool.translation.dot(up);
        let mut space = Space::quick(world, hanging, self.settings.step);
        let mut frames = Vec::new();
        let mut found: Vec<(f64, Posture)> = Vec::new();
        for out in OUT {
            for bearing in 0..BEARINGS {
                let bearing = std::f64::consts::TAU * bearing as f64 / BEARINGS as f64;
                let away = world.root_from_world.rotation * Vec3::new(bearing.cos(), bearing.sin(), 0.0);
                for aside in [0.0, 0.8, -0.8] {
                    let pointing_at = pointing.truncate().to_angle();
                    let turn = Mat3::from_axis_angle(up, away.truncate().to_angle() + aside - pointing_at);
                    for raised in RAISED {
                        let at = Pose::new(turn * tool.rotation, height + up * raised + away * out);
                        let near = self.inverse.solve(&at, entry);
                        let off = |q: &Posture| distance(q, entry);
                        let Some(q) = near.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
                        if !space.free(&q) {
                            continue;
                        }
                        kinematics.frames(&q, hanging.hand, &mut frames);
                        let flat = |p: Vec3| (p - up * p.dot(up)).length();
                        let links = world.model.links.iter().zip(&frames);
                        let arm = links
                            .filter_map(|(l, f)| l.as_ref().map(|l| flat(f.point(l.bound.centre)) + l.bound.radius));
                        let carried = flat((frames[kinematics.tool] * grasp.object_from_tool.inverse()).translation);
                        let held = hanging.held.as_ref().map_or(0.0, Held::radius);
                        found.push((arm.fold(carried + held, f64::max) + 0.02 * distance(&q, entry), q));
                    }
                }
            }
            if found.len() >= 8 {
                break;
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, q)| q).collect()
    }

    /// To the resting posture, for a drive.
    pub fn tuck(&mut self, before: &Situation) -> Attempt<Vec<Segment>> {
        let world = self.world;
        let home = &world.model.robot.home;
        if before.posture == *home {
            return Ok(Ok(Vec::new()));
        }
        let mut free = Moment::new(before.standing, world.model.robot.hand.open(), self.settings.margin);
        free.placed = before.placed(world);
        let path = attempt!(self.free_motion(
            &free,
            &before.posture,
            std::slice::from_ref(home),
            "the motion home, for driving"
        ));
        free.margin = self.settings.final_margin;
        let timed = attempt!(self.timed(&free, &path, AtEnds::Nothing, "the motion home, for driving"));
        Ok(Ok(vec![self.transit(timed)]))
    }
}
