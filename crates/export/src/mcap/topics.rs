//! The topics of a bag, and what is said on each.

use super::START;
use super::bag::{Bag, Channel, Late};
use super::messages::{JointState, Log, Marker, MarkerKind, Markers, Text, Trajectory, Transform, Transforms};
use super::objects::At;
use super::postures::Postures;
use super::shapes::{Colour, Look, markers};
use super::words;
use crate::differences::differences;
use crate::rows::Nanoseconds;
use crate::sequence::Point;
use crate::urdf::Urdf;
use crate::{ExportError, Mesh};
use clearway_geometry::{Pose, Vec3};
use clearway_plan::PlanFile;
use clearway_plan::scene_file::PoseKeys;

const FIXTURE: Colour = [0.62, 0.64, 0.67, 0.6];
const PLACE: Colour = [0.25, 0.7, 0.45, 0.35];
const OBJECT: Colour = [0.8, 0.76, 0.64, 1.0];
const REMOVED: Colour = [0.95, 0.65, 0.2, 1.0];
const TARGET: Colour = [0.85, 0.2, 0.25, 1.0];

/// How thick a place is drawn, metres.
const PLACE_HEIGHT: f64 = 0.002;

/// Times are given on the plan's clock and written on the bag's.
pub(crate) struct Topics<'a> {
    plan: &'a PlanFile,
    urdf: &'a Urdf,
    postures: &'a Postures<'a>,
    /// The postures' times and values.
    rows: Vec<(Nanoseconds, &'a [f64])>,
    meshes: &'a [Mesh],
    bag: Bag,
    robot_description: Channel,
    tf_static: Channel,
    tf: Channel,
    joint_states: Channel,
    trajectory: Channel,
    fixtures: Channel,
    objects: Channel,
    events: Channel,
}

impl<'a> Topics<'a> {
    pub fn new(
        plan: &'a PlanFile,
        urdf: &'a Urdf,
        postures: &'a Postures<'a>,
        meshes: &'a [Mesh],
    ) -> Result<Self, ExportError> {
        let mut bag = Bag::new()?;
        Ok(Self {
            robot_description: bag.channel::<Text>("/robot_description", Late::GetsTheLast)?,
            tf_static: bag.channel::<Transforms>("/tf_static", Late::GetsTheLast)?,
            tf: bag.channel::<Transforms>("/tf", Late::GetsNone)?,
            joint_states: bag.channel::<JointState>("/joint_states", Late::GetsNone)?,
            trajectory: bag.channel::<Trajectory>("/trajectory", Late::GetsNone)?,
            fixtures: bag.channel::<Markers>("/scene/fixtures", Late::GetsTheLast)?,
            objects: bag.channel::<Markers>("/scene/objects", Late::GetsTheLast)?,
            events: bag.channel::<Log>("/events", Late::GetsNone)?,
            rows: postures.rows.iter().map(|row| (row.time, row.values.as_slice())).collect(),
            plan,
            urdf,
            postures,
            meshes,
            bag,
        })
    }

    /// What does not change.
    pub fn begin(&mut self) -> Result<(), ExportError> {
        self.bag.write(&mut self.robot_description, START, &Text(&self.plan.robot.urdf))?;

        let frame = &self.plan.scene.frame;
        let world = (*frame != self.urdf.root).then(|| Transform {
            parent: frame,
            child: &self.urdf.root,
            parent_from_child: self.plan.scene.robot.base.pose(),
        });
        let still = self.transforms(0, false);
        let transforms = Transforms { time: START, transforms: world.into_iter().chain(still).collect() };
        self.bag.write(&mut self.tf_static, START, &transforms)?;

        let mut bodies = Vec::new();
        for body in &self.plan.scene.fixtures {
            let look = Look { time: START, frame, namespace: &body.id, colour: FIXTURE };
            let pose = PoseKeys { position: body.position, rpy: body.rpy, quaternion: body.quaternion }.pose();
            bodies.extend(markers(body, &pose, look, self.meshes));
        }
        bodies.extend(self.plan.scene.place.iter().map(|place| {
            let [x, y, top] = place.position;
            Marker {
                time: START,
                frame,
                namespace: &place.id,
                number: 0,
                kind: MarkerKind::Cube,
                pose: Pose::from_translation(Vec3::new(x, y, top - 0.5 * PLACE_HEIGHT)),
                scale: [place.size[0], place.size[1], PLACE_HEIGHT],
                colour: PLACE,
                points: Vec::new(),
            }
        }));
        self.bag.write(&mut self.fixtures, START, &Markers(bodies))
    }

    /// Where the robot is in one of the plan's rows.
    pub fn posture(&mut self, row: usize) -> Result<(), ExportError> {
        let time = START + self.rows[row].0;
        let transforms = Transforms { time, transforms: self.transforms(row, true).collect() };
        self.bag.write(&mut self.tf, time, &transforms)?;
        let (velocities, _) = differences(&self.rows, row);
        let (names, positions) = (&self.postures.names, self.rows[row].1);
        self.bag.write(&mut self.joint_states, time, &JointState { time, names, positions, velocities: &velocities })
    }

    /// By link that hangs from another by a joint that the plan moves, or by one that it does not.
    fn transforms(&self, row: usize, driven: bool) -> impl Iterator<Item = Transform<'a>> + use<'a> {
        let (postures, posture) = (self.postures, &self.postures.rows[row]);
        let joints = self.urdf.joints.iter().filter(move |joint| postures.driven(joint) == driven);
        joints.map(move |joint| Transform {
            parent: &joint.parent,
            child: &joint.child,
            parent_from_child: postures.parent_from_child(joint, posture),
        })
    }

    pub fn objects(&mut self, time: Nanoseconds, at: &[At]) -> Result<(), ExportError> {
        let time = START + time;
        let mut all = Vec::new();
        for (body, at) in self.plan.scene.objects.iter().zip(at) {
            let (frame, pose) = match at {
                At::World(pose) => (self.plan.scene.frame.as_str(), pose),
                At::Link(link, pose) => (*link, pose),
            };
            let look = Look { time, frame, namespace: &body.id, colour: self.colour(&body.id) };
            all.extend(markers(body, pose, look, self.meshes));
        }
        self.bag.write(&mut self.objects, time, &Markers(all))
    }

    fn colour(&self, object: &str) -> Colour {
        if object == self.plan.scene.target {
            TARGET
        } else if self.plan.steps.iter().any(|step| step.object == object) {
            REMOVED
        } else {
            OBJECT
        }
    }

    pub fn trajectory(&mut self, time: Nanoseconds, points: &[Point]) -> Result<(), ExportError> {
        let message = Trajectory { frame: &self.plan.scene.frame, joints: &self.plan.robot.joints, points };
        self.bag.write(&mut self.trajectory, START + time, &message)
    }

    pub fn event(&mut self, time: Nanoseconds, text: String) -> Result<(), ExportError> {
        let time = START + time;
        self.bag.write(&mut self.events, time, &Log { time, text })
    }

    /// The plan itself and what it comes to; the file's content.
    pub fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        self.bag.attach_json("plan.json", START, serde_json::to_vec(self.plan)?)?;
        self.bag.write_metadata("clearway", words::summary(self.plan))?;
        self.bag.finish()
    }
}
