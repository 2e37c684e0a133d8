//! A lower bound on the number of removals that holds for every plan over the declared grasps.
//!
//! Whoever takes an object comes to one of its declared grasps straight over the standoff, with the
//! hand open and the arm in some branch of its inverse kinematics, and leaves with it the same way,
//! raised a little. What comes too near on that stretch has to be gone before. That holds for the target and
//! for each object in its way; the fewest removals that agree with it ([`crate::order`]) and open
//! every barrier ([`crate::barriers`]) are a lower bound. It needs an inverse kinematics that finds every branch, and links without meshes.
//!
//! Only what is near the answer is looked at: other objects are taken to be free to go.
//!
//! The same, without any margin, proves that there is no plan at all: [`Prover::stuck`].

use crate::barriers::Barriers;
use crate::grasps::{Grasp, declared};
use crate::order::{self, Fewest, WaysIn, most_in_way};
use crate::ways::{self, REACH};
use clearway_collision::lanes::{LANES, Suspects};
use clearway_collision::{Moment, Quick, Scratch, Touch, World};
use clearway_geometry::Pose;
use clearway_motion::Posture;
use clearway_plan::proof::{Branch, GraspCase, GraspsProof, ObjectCase};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::InverseKinematics;

/// Between the postures looked at on the stretch, metres.
const STEP: f64 = 0.02;
/// What is this much nearer than plans allow is too near beyond doubt, metres.
pub const DOUBT: f64 = 5e-5;

/// A bound, the target included, and what proves it.
pub struct Bound {
    pub removed: usize,
    pub proof: GraspsProof,
}

/// Finds the bound.
pub struct Prover<'a> {
    pub world: &'a World,
    pub inverse: &'a InverseKinematics,
    pub settings: &'a ways::Settings,
    pub names: &'a [String],
    pub barriers: &'a Barriers,
}

/// What is known of one object: the sets, and all that they come from.
#[derive(Default)]
struct Known {
    ways: Vec<ObjectSet>,
    cases: Vec<GraspCase>,
}

impl Prover<'_> {
    /// The bound, given that there is a plan with `most` removals: more would prove nothing. `None`
    /// where the inverse kinematics is no complete one, and for links given as meshes: here they are
    /// their hulls, and what meets a hull need not meet the mesh.
    pub fn bound(&self, target: ObjectId, most: usize, budget: &Budget) -> Result<Option<Bound>, Stop> {
        if !self.inverse.complete() || !self.world.model.robot.meshes.is_empty() {
            return Ok(None);
        }
        let mut known: Vec<Option<Known>> = self.names.iter().map(|_| None).collect();
        let mut scratch = Scratch::default();
        let free = vec![ObjectSet::EMPTY];
        loop {
            let ways: WaysIn = known.iter().map(|k| k.as_ref().map_or(free.clone(), |k| k.ways.clone())).collect();
            let Fewest::Found(set) = order::fewest(&ways, &self.barriers.sets, target, most, order::THOROUGH, budget)?
            else {
                return Ok(None);
            };
            // Objects not looked at yet count as free; an answer without them stands.
            let unknown = |o: &ObjectId| known[o.index()].is_none();
            let Some(object) = Some(target).filter(unknown).or_else(|| set.iter().find(unknown)) else {
                return Ok(Some(Bound { removed: set.len(), proof: self.proof(known) }));
            };
            known[object.index()] =
                Some(self.look(object, most_in_way(most, object == target), &mut scratch, budget)?);
        }
    }

    /// Objects that certainly are never taken, whatever goes first, `object` among them; none where that is not certain.
    /// Objects not looked at count as free to go, so that mostly few are.
    pub fn stuck(&self, object: ObjectId, budget: &Budget) -> Result<ObjectSet, Stop> {
        if !self.inverse.complete() || !self.world.model.robot.meshes.is_empty() {
            return Ok(ObjectSet::EMPTY);
        }
        let all = ObjectSet::first(self.names.len());
        let mut ways: WaysIn = vec![vec![ObjectSet::EMPTY]; self.names.len()];
        let mut scratch = Scratch::default();
        let (mut looked, mut next) = (ObjectSet::EMPTY, Some(object));
        while let Some(some) = next {
            ways[some.index()] = self.look(some, all.len(), &mut scratch, budget)?.ways;
            looked.insert(some);
            let takable = order::takable(&ways, &all);
            if !takable.contains(object) {
                return Ok(looked.difference(takable));
            }
            next = looked.iter().flat_map(|o| &ways[o.index()]).find_map(|set| set.difference(looked).iter().next());
        }
        Ok(ObjectSet::EMPTY)
    }

    fn proof(&self, known: Vec<Option<Known>>) -> GraspsProof {
        let case =
            |(known, name): (Option<Known>, &String)| Some(ObjectCase { object: name.clone(), grasps: known?.cases });
        GraspsProof {
            standoff: self.world.model.robot.grasps.standoff,
            lift: self.settings.lift,
            hand: self.world.model.robot.hand.open(),
            clearance: self.settings.margin,
            held_clearance: self.settings.held_margin,
            objects: known.into_iter().zip(self.names).filter_map(case).collect(),
            barriers: (!self.barriers.sets.is_empty()).then(|| self.barriers.proof.clone()),
        }
    }

    /// What blocks each declared grasp of an object. Branches that more than `most` objects block are
    /// not looked into farther: they are in no answer.
    fn look(&self, object: ObjectId, most: usize, scratch: &mut Scratch, budget: &Budget) -> Result<Known, Stop> {
        let world = self.world;
        let mut known = Known::default();
        let declared = declared(world, object);
        let mut postures: Vec<(usize, &Grasp, Posture)> = Vec::new();
        for (pose, grasp) in &declared {
            budget.check()?;
            if let Some(grasp) = grasp {
                let branches = self.inverse.solve(&(world.poses[object.index()] * *pose), &world.model.robot.home);
                postures.extend(branches.into_iter().map(|q| (known.cases.len(), grasp, q)));
            }
            known.cases.push(GraspCase {
                position: pose.translation.to_array().map(tidy),
                quaternion: pose.quaternion().map(tidy),
                holds: grasp.is_some(),
                branches: Vec::new(),
            });
        }
        let Some((_, first, _)) = postures.first() else { return Ok(known) };
        let mut quick = Quick::links(world, &self.moment(object, first, false));
        let mut suspects = Suspects::default();
        for some in postures.chunks(LANES) {
            budget.check()?;
            let rows: Vec<Posture> = some.iter().map(|(_, _, q)| q.clone()).collect();
            quick.suspects(&rows, &mut suspects);
            let at_grasps: Vec<Touch> = some
                .iter()
                .enumerate()
                .map(|(lane, (_, grasp, q))| {
                    world.touched_among(q, &self.moment(object, grasp, true), &suspects, lane, scratch)
                })
                .collect();
            for ((case, grasp, posture), at_grasp) in some.iter().zip(at_grasps) {
                let touched = match at_grasp {
                    Touch::Objects(set) if set.len() <= most => {
                        self.stretch(object, grasp, posture, set, &mut quick, scratch)
                    }
                    known => known,
                };
                let blocked_by = match touched {
                    Touch::Fixed => None,
                    Touch::Objects(set) => {
                        known.ways.push(set);
                        Some(set.names(self.names))
                    }
                };
                known.cases[*case]
                    .branches
                    .push(Branch { posture: posture.iter().map(|v| tidy(*v)).collect(), blocked_by });
            }
        }
        known.ways = ObjectSet::minimal(std::mem::take(&mut known.ways));
        Ok(known)
    }

    /// What is too near on the stretch, beside `blocked_by`; `Fixed` also where the arm does not reach
    /// that far.
    fn stretch(
        &self,
        object: ObjectId,
        grasp: &Grasp,
        posture: &Posture,
        mut blocked_by: ObjectSet,
        quick: &mut Quick,
        scratch: &mut Scratch,
    ) -> Touch {
        let world = self.world;
        let at = world.poses[object.index()] * grasp.object_from_tool;
        let lifted = at.translation + world.up() * self.settings.lift;
        let standoff = world.model.robot.grasps.standoff;
        let steps = ((standoff / STEP - 1e-9).ceil() as usize).min(LANES - 1);
        let mut trail = vec![posture.clone()];
        for step in 0..=steps {
            let out = (step as f64 * STEP).min(standoff);
            let target = Pose::new(at.rotation, lifted - at.rotation.z_axis * out);
            match self.inverse.follow(&target, &trail, REACH).or_else(|| self.nearest(&target, &trail[trail.len() - 1]))
            {
                Some(next) => trail.push(next),
                None => return Touch::Fixed,
            }
        }
        let moment = self.moment(object, grasp, false);
        let mut suspects = Suspects::default();
        quick.suspects(&trail[1..], &mut suspects);
        for (lane, posture) in trail[1..].iter().enumerate() {
            match world.touched_among(posture, &moment, &suspects, lane, scratch) {
                Touch::Fixed => return Touch::Fixed,
                Touch::Objects(set) => blocked_by = blocked_by.union(set),
            }
        }
        Touch::Objects(blocked_by)
    }

    /// The posture nearest to one, of all that there are: what a descent misses is no proof.
    fn nearest(&self, target: &Pose, from: &Posture) -> Option<Posture> {
        let far = |q: &Posture| q.iter().zip(from).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let found = self.inverse.solve(target, from).into_iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        found.filter(|q| far(q) <= REACH)
    }

    /// As ways are looked at, only a little nearer.
    fn moment(&self, object: ObjectId, grasp: &Grasp, resting: bool) -> Moment {
        let moment = ways::moment(self.world, self.settings, object, grasp);
        Moment { resting, margin: moment.margin - DOUBT, held_margin: moment.held_margin - DOUBT, ..moment }
    }
}

/// Numbers of a proof: a tenth of a micrometre is enough.
fn tidy(v: f64) -> f64 {
    (v * 1e7).round() / 1e7
}
