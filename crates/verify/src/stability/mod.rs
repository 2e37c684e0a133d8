//! Does what stands stay as it stands: at the start, once something is taken, once it is put down?
//!
//! Bodies are rigid and of one material, so weigh as much as they fill. What carries one (see
//! [`rest`](crate::rest)) pushes it straight up, without friction, where they meet. It stands if some
//! such forces balance it, all that it bears, and all that bears it. What is 0.35 mm beside the
//! patch where bodies meet still counts as on it, for rounding; 0.5 mm at its corners.
//!
//! What nothing carries is told elsewhere; here it holds what is on it.

mod balance;
mod blame;
mod mass;
mod patch;
mod polygon;
mod solver;
mod stack;

use crate::case::Case;
use crate::error::CannotJudge;
use crate::report::{Place, Report, ViolationKind};
use crate::rest::Standing;
use balance::{Balance, Body, Rest, balance};
use clearway_plan::Budget;
use parry3d_f64::math::{Pose, Vector};
use polygon::{outside, widened};
use stack::{Carrier, Stack};

/// Patches are wider by this, along x and along y, metres: more than what scenes are forgiven.
const LENIENT: f64 = 5.5e-4;

/// What stands, judged whenever it changes.
pub(crate) struct Stability<'a> {
    stack: Stack<'a>,
}

/// After what something may fall.
#[derive(Clone, Copy)]
enum Change {
    Start,
    Taken(usize),
    Put(usize),
    Pushed(usize),
}

impl<'a> Stability<'a> {
    pub fn new(case: &'a Case, standing: &Standing, budget: &Budget) -> Result<Self, CannotJudge> {
        Ok(Self { stack: Stack::new(case, standing, budget)? })
    }

    /// Whether anything carries the object, where it stands.
    pub fn is_carried(&self, object: usize) -> bool {
        self.stack.is_carried(object)
    }

    pub fn check_start(&self, report: &mut Report) {
        let tell = |report: &mut Report, what| report.plan(ViolationKind::Unstable, what);
        self.check(&self.stack.all(), Change::Start, tell, report);
    }

    /// The object stands no more.
    pub fn take(&mut self, object: usize, place: Place, report: &mut Report) {
        let left = self.stack.lift(object);
        let tell = |report: &mut Report, what| report.at(ViolationKind::Unstable, place, what);
        self.check(&left, Change::Taken(object), tell, report);
    }

    /// The object stands here now, and no more where it stood.
    pub fn put(&mut self, object: usize, at: &Pose, place: Place, report: &mut Report) {
        self.moved(object, at, Change::Put(object), place, report);
    }

    /// The object is pushed, and has come here.
    pub fn slide(&mut self, object: usize, at: &Pose, place: Place, report: &mut Report) {
        self.moved(object, at, Change::Pushed(object), place, report);
    }

    fn moved(&mut self, object: usize, at: &Pose, change: Change, place: Place, report: &mut Report) {
        let mut changed = self.stack.lift(object);
        self.stack.put(object, at);
        changed.push(object);
        let tell = |report: &mut Report, what| report.at(ViolationKind::Unstable, place, what);
        self.check(&changed, change, tell, report);
    }

    /// How far what carries the object reaches beyond its centre of mass in a level direction, metres; up to
    /// 0.1 mm too far, since a disc counts as a polygon within it.
    pub fn reach(&self, object: usize, direction: Vector) -> f64 {
        let (centre, direction) = (self.stack.centre(object), direction.truncate());
        let patch = self.stack.under(object);
        patch.iter().map(|p| (*p - centre).dot(direction)).fold(f64::NEG_INFINITY, f64::max) + patch::ROUND
    }

    /// Judges whatever hangs together with these.
    fn check(&self, changed: &[usize], change: Change, tell: impl Fn(&mut Report, String), report: &mut Report) {
        let stack = &self.stack;
        for group in stack.groups(changed) {
            if let [one] = group[..]
                && outside(&stack.ground(one), stack.centre(one)) == 0.0
            {
                continue;
            }
            let bodies: Vec<Body> = group.iter().map(|object| self.body(*object, &group)).collect();
            let objects = |members: Vec<usize>| members.into_iter().map(|i| group[i]).collect::<Vec<usize>>();
            match balance(&bodies) {
                Balance::Stands => {}
                Balance::Tips(body) => tell(report, blame::falls(stack, &[group[body]], change)),
                Balance::Falls(members) => tell(report, blame::falls(stack, &objects(members), change)),
                Balance::Unknown(members) => {
                    report.not_checked.push(blame::unknown(stack, &objects(members), change));
                }
            }
        }
    }

    /// An object of a group, as a problem of forces.
    fn body(&self, object: usize, group: &[usize]) -> Body {
        let others = self.stack.contacts[object].iter().filter_map(|contact| {
            let on = group.iter().position(|o| contact.on == Carrier::Object(*o))?;
            Some(Rest { on: Some(on), patch: widened(&contact.patch, LENIENT) })
        });
        let ground = Some(self.stack.ground(object)).filter(|patch| !patch.is_empty());
        let ground = ground.map(|patch| Rest { on: None, patch: widened(&patch, LENIENT) });
        let rests = others.chain(ground).collect();
        Body { weight: self.stack.masses[object].volume, centre: self.stack.centre(object), rests }
    }
}

#[cfg(test)]
mod tests;
