//! The ROS 2 messages of a bag: their fields as plain data, their schemas, and how they are written.
//!
//! The schemas are ROS's own definitions without comments, each followed by those it refers to, as
//! bags carry them. They hold from ROS 2 Humble on.

use super::cdr::Cdr;
use crate::rows::{Nanoseconds, SECOND};
use clearway_geometry::Pose;

/// What a channel carries.
pub(crate) trait Message {
    /// As ROS 2 spells it: `package/msg/Name`.
    const TYPE: &'static str;
    /// Its definition, in ROS's own language.
    const SCHEMA: &'static str;

    fn write(&self, cdr: &mut Cdr);
}

pub(crate) struct Text<'a>(pub &'a str);

impl Message for Text<'_> {
    const TYPE: &'static str = "std_msgs/msg/String";
    const SCHEMA: &'static str = include_str!("schemas/String.msg");

    fn write(&self, cdr: &mut Cdr) {
        cdr.string(self.0);
    }
}

/// Radians or metres, and per second.
pub(crate) struct JointState<'a> {
    pub time: Nanoseconds,
    pub names: &'a [&'a str],
    pub positions: &'a [f64],
    pub velocities: &'a [f64],
}

impl Message for JointState<'_> {
    const TYPE: &'static str = "sensor_msgs/msg/JointState";
    const SCHEMA: &'static str = include_str!("schemas/JointState.msg");

    fn write(&self, cdr: &mut Cdr) {
        header(cdr, self.time, "");
        cdr.list(self.names, |cdr, name| cdr.string(name));
        cdr.numbers(self.positions);
        cdr.numbers(self.velocities);
        cdr.empty_list();
    }
}

pub(crate) struct Transforms<'a> {
    pub time: Nanoseconds,
    pub transforms: Vec<Transform<'a>>,
}

pub(crate) struct Transform<'a> {
    pub parent: &'a str,
    pub child: &'a str,
    pub parent_from_child: Pose,
}

impl Message for Transforms<'_> {
    const TYPE: &'static str = "tf2_msgs/msg/TFMessage";
    const SCHEMA: &'static str = include_str!("schemas/TFMessage.msg");

    fn write(&self, cdr: &mut Cdr) {
        cdr.list(&self.transforms, |cdr, transform| {
            header(cdr, self.time, transform.parent);
            cdr.string(transform.child);
            pose(cdr, &transform.parent_from_child);
        });
    }
}

/// The trajectory's clock starts when it is received: its stamp is 0.
pub(crate) struct Trajectory<'a> {
    pub frame: &'a str,
    pub joints: &'a [String],
    pub points: &'a [crate::sequence::Point<'a>],
}

impl Message for Trajectory<'_> {
    const TYPE: &'static str = "trajectory_msgs/msg/JointTrajectory";
    const SCHEMA: &'static str = include_str!("schemas/JointTrajectory.msg");

    fn write(&self, cdr: &mut Cdr) {
        header(cdr, 0, self.frame);
        cdr.list(self.joints, |cdr, joint| cdr.string(joint));
        cdr.list(self.points, |cdr, point| {
            cdr.numbers(point.positions);
            cdr.numbers(&point.velocities);
            cdr.numbers(&point.accelerations);
            cdr.empty_list();
            time(cdr, point.time);
        });
    }
}

/// Something to be told, at the level `INFO`.
pub(crate) struct Log {
    pub time: Nanoseconds,
    pub text: String,
}

impl Message for Log {
    const TYPE: &'static str = "rcl_interfaces/msg/Log";
    const SCHEMA: &'static str = include_str!("schemas/Log.msg");

    fn write(&self, cdr: &mut Cdr) {
        const INFO: u8 = 20;
        time(cdr, self.time);
        cdr.u8(INFO);
        cdr.string("clearway");
        cdr.string(&self.text);
        // File, function and line of a program: there is none to look at.
        cdr.string("");
        cdr.string("");
        cdr.u32(0);
    }
}

pub(crate) struct Markers<'a>(pub Vec<Marker<'a>>);

/// One shape to be drawn until a marker of the same name and number takes its place.
pub(crate) struct Marker<'a> {
    pub time: Nanoseconds,
    /// The frame that `pose` is seen from; the marker goes where the frame goes.
    pub frame: &'a str,
    pub namespace: &'a str,
    pub number: usize,
    pub kind: MarkerKind,
    pub pose: Pose,
    /// Full size along each axis of the pose; 1 for triangles.
    pub scale: [f64; 3],
    /// Red, green, blue, opacity, from 0 to 1.
    pub colour: [f32; 4],
    /// Of lists of spheres and triangles, in the marker's pose.
    pub points: Vec<[f64; 3]>,
}

/// As `visualization_msgs` numbers them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MarkerKind {
    Cube = 1,
    Sphere = 2,
    Cylinder = 3,
    SphereList = 7,
    TriangleList = 11,
}

impl Message for Markers<'_> {
    const TYPE: &'static str = "visualization_msgs/msg/MarkerArray";
    const SCHEMA: &'static str = include_str!("schemas/MarkerArray.msg");

    fn write(&self, cdr: &mut Cdr) {
        cdr.list(&self.0, |cdr, marker| marker.write(cdr));
    }
}

impl Marker<'_> {
    fn write(&self, cdr: &mut Cdr) {
        const ADD: i32 = 0;
        const FOR_EVER: Nanoseconds = 0;
        header(cdr, self.time, self.frame);
        cdr.string(self.namespace);
        cdr.i32(i32::try_from(self.number).unwrap_or(i32::MAX));
        cdr.i32(self.kind as i32);
        cdr.i32(ADD);
        pose(cdr, &self.pose);
        cdr.f64s(&self.scale);
        self.colour.iter().for_each(|&part| cdr.f32(part));
        time(cdr, FOR_EVER);
        cdr.bool(true); // locked to the frame
        cdr.list(&self.points, |cdr, point| cdr.f64s(point));
        cdr.empty_list(); // a colour per point
        cdr.string(""); // the texture's name, then the texture: header, format, bytes
        header(cdr, 0, "");
        cdr.string("");
        cdr.empty_list();
        cdr.empty_list(); // where the texture lies
        cdr.string(""); // text
        cdr.string(""); // the mesh's URI, then the mesh: name, bytes
        cdr.string("");
        cdr.empty_list();
        cdr.bool(false); // the mesh's own materials
    }
}

fn header(cdr: &mut Cdr, stamp: Nanoseconds, frame: &str) {
    time(cdr, stamp);
    cdr.string(frame);
}

/// `Time` and `Duration` alike. `rows` keeps plans within what 32 bits of seconds hold.
fn time(cdr: &mut Cdr, time: Nanoseconds) {
    cdr.i32(i32::try_from(time / SECOND).unwrap_or(i32::MAX));
    cdr.u32((time % SECOND) as u32);
}

/// `Pose` and `Transform` alike: position, quaternion `x, y, z, w`.
fn pose(cdr: &mut Cdr, pose: &Pose) {
    cdr.f64s(&pose.translation.to_array());
    cdr.f64s(&pose.quaternion());
}
