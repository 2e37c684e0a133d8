//! Forward kinematics of sixteen configurations at once.
//!
//! The tree is reduced to the frames that joints move, each with its axis turned to z; links fixed
//! to a frame are folded into it. One sine and cosine per turning joint; constant rotations that
//! only swap axes (the common case) cost nothing.

use super::kernel::Upright;
use super::vector::{Lanes, Point, bits, load, sin_cos, splat};
use clearway_geometry::{Mat3, Pose, Vec3};
use clearway_robot::{Kinematics, Motion};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// A frame in lanes: its axes' directions and its origin, in the root frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub x: [Lanes; 3],
    pub y: [Lanes; 3],
    pub z: [Lanes; 3],
    pub origin: [Lanes; 3],
}

impl Frame {
    /// The root's own frame.
    pub fn identity() -> Self {
        let (one, zero) = (Lanes::splat(1.0), Lanes::ZERO);
        Self { x: [one, zero, zero], y: [zero, one, zero], z: [zero, zero, one], origin: [zero; 3] }
    }

    /// Whether a direction of this frame leans no farther than it may, in every lane.
    #[inline(always)]
    pub fn points_up<S: Simd>(&self, simd: S, upright: &Upright) -> bool {
        let [ux, uy, uz] = upright.upward.map(|x| splat(simd, x));
        let mut sum = splat(simd, 0.0);
        for (axis, along) in [(&self.x, upright.axis[0]), (&self.y, upright.axis[1]), (&self.z, upright.axis[2])] {
            let up = load(simd, &axis[0]).mul_add(ux, load(simd, &axis[1]).mul_add(uy, load(simd, &axis[2]) * uz));
            sum = up.mul_add(splat(simd, along), sum);
        }
        bits(sum.simd_lt(splat(simd, upright.least))) == 0
    }

    /// A point given in this frame, in the root frame.
    #[inline(always)]
    pub fn point<S: Simd>(&self, simd: S, p: [f32; 3]) -> Point<S> {
        let mut at = Point::load(simd, &self.origin);
        for (axis, along) in [(&self.x, p[0]), (&self.y, p[1]), (&self.z, p[2])] {
            if along != 0.0 {
                let along = splat(simd, along);
                at.x = along.mul_add(load(simd, &axis[0]), at.x);
                at.y = along.mul_add(load(simd, &axis[1]), at.y);
                at.z = along.mul_add(load(simd, &axis[2]), at.z);
            }
        }
        at
    }
}

/// The constant rotation before a joint.
#[derive(Clone, Copy, Debug)]
enum Turn {
    /// Column *i* of the product is the parent's column `source[i]`, times `sign[i]`.
    Swap { source: [usize; 3], sign: [f32; 3] },
    /// By columns.
    Full([[f32; 3]; 3]),
}

/// A frame that a joint moves.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Frame 0 is the root's.
    parent: usize,
    turn: Turn,
    /// In the parent's frame.
    offset: [f32; 3],
    /// `value = multiplier · variable + shift`.
    variable: usize,
    multiplier: f32,
    shift: f32,
    slides: bool,
}

/// Where a link is: a frame, and its fixed pose in it.
#[derive(Clone, Copy, Debug)]
pub struct Seat {
    pub frame: usize,
    pub frame_from_link: Pose,
}

/// The frames that joints move, parents first.
#[derive(Clone, Debug)]
pub struct Chain {
    steps: Vec<Step>,
    /// By link.
    pub seats: Vec<Seat>,
    /// By frame: which variables move it, as bits; the hand's is bit `joints`.
    pub moved_by: Vec<u64>,
    /// How many joints a posture has, the hand's not counted.
    pub joints: usize,
}

impl Chain {
    pub fn new(kinematics: &Kinematics) -> Self {
        let mut chain =
            Chain { steps: Vec::new(), seats: Vec::new(), moved_by: vec![0], joints: kinematics.arm_joints };
        for (index, step) in kinematics.steps().iter().enumerate() {
            if index == 0 {
                chain.seats.push(Seat { frame: 0, frame_from_link: Pose::IDENTITY });
                continue;
            }
            let parent = chain.seats[step.parent];
            let to_joint = parent.frame_from_link * step.parent_from_joint;
            let (axis, source, slides) = match step.motion {
                Motion::Still => {
                    chain.seats.push(Seat { frame: parent.frame, frame_from_link: to_joint });
                    continue;
                }
                Motion::Turn { axis, source } => (axis, source, false),
                Motion::Slide { axis, source } => (axis, source, true),
            };
            let joint_from_frame = axis_to_z(axis);
            let rotation = to_joint.rotation * joint_from_frame;
            chain.steps.push(Step {
                parent: parent.frame,
                turn: turn(&rotation),
                offset: snapped(to_joint.translation),
                variable: source.variable,
                multiplier: source.multiplier as f32,
                shift: source.offset as f32,
                slides,
            });
            chain.moved_by.push(chain.moved_by[parent.frame] | 1 << source.variable);
            chain.seats.push(Seat {
                frame: chain.steps.len(),
                frame_from_link: Pose::new(joint_from_frame.transpose(), Vec3::ZERO),
            });
        }
        chain
    }

    pub fn frames(&self) -> usize {
        self.steps.len() + 1
    }

    /// Whether frame `descendant` hangs from frame `ancestor`, or is it.
    pub fn hangs_from(&self, descendant: usize, ancestor: usize) -> bool {
        let mut at = descendant;
        while at > ancestor {
            at = self.steps[at - 1].parent;
        }
        at == ancestor
    }

    /// Places all frames. `variable(j)` gives the lanes of joint `j`, the hand's last.
    #[inline(always)]
    pub fn place<S: Simd>(&self, simd: S, variable: impl Fn(usize) -> f32x16<S>, frames: &mut [Frame]) {
        for (index, step) in self.steps.iter().enumerate() {
            let (before, after) = frames.split_at_mut(index + 1);
            let (parent, frame) = (&before[step.parent], &mut after[0]);
            let mut value = variable(step.variable);
            if step.multiplier != 1.0 || step.shift != 0.0 {
                value = value.mul_add(splat(simd, step.multiplier), splat(simd, step.shift));
            }
            let mut origin = parent.point(simd, step.offset);
            let (x, y, z) = turned(simd, parent, &step.turn);
            if step.slides {
                origin.x = value.mul_add(z.x, origin.x);
                origin.y = value.mul_add(z.y, origin.y);
                origin.z = value.mul_add(z.z, origin.z);
                x.store(&mut frame.x);
                y.store(&mut frame.y);
            } else {
                let (s, c) = sin_cos(simd, value);
                Point { x: x.x.mul_add(c, y.x * s), y: x.y.mul_add(c, y.y * s), z: x.z.mul_add(c, y.z * s) }
                    .store(&mut frame.x);
                Point { x: y.x.mul_add(c, -(x.x * s)), y: y.y.mul_add(c, -(x.y * s)), z: y.z.mul_add(c, -(x.z * s)) }
                    .store(&mut frame.y);
            }
            z.store(&mut frame.z);
            origin.store(&mut frame.origin);
        }
    }
}

/// The parent's axes after the constant rotation.
#[inline(always)]
fn turned<S: Simd>(simd: S, parent: &Frame, turn: &Turn) -> (Point<S>, Point<S>, Point<S>) {
    match turn {
        Turn::Swap { source, sign } => {
            let columns = [&parent.x, &parent.y, &parent.z];
            let column = |i: usize| {
                let p = Point::load(simd, columns[source[i]]);
                let s = splat(simd, sign[i]);
                Point { x: p.x * s, y: p.y * s, z: p.z * s }
            };
            (column(0), column(1), column(2))
        }
        Turn::Full(columns) => {
            let (px, py, pz) =
                (Point::load(simd, &parent.x), Point::load(simd, &parent.y), Point::load(simd, &parent.z));
            let column = |c: &[f32; 3]| {
                let (a, b, d) = (splat(simd, c[0]), splat(simd, c[1]), splat(simd, c[2]));
                Point {
                    x: a.mul_add(px.x, b.mul_add(py.x, d * pz.x)),
                    y: a.mul_add(px.y, b.mul_add(py.y, d * pz.y)),
                    z: a.mul_add(px.z, b.mul_add(py.z, d * pz.z)),
                }
            };
            (column(&columns[0]), column(&columns[1]), column(&columns[2]))
        }
    }
}

/// Lengths this small come from rounding in the URDF's angles.
fn snapped(v: Vec3) -> [f32; 3] {
    v.to_array().map(|x| if x.abs() < 1e-9 { 0.0 } else { x as f32 })
}

/// URDFs write quarter turns with few digits; nearer than this to an axis is on it.
const ON_AXIS: f64 = 1e-9;

fn turn(rotation: &Mat3) -> Turn {
    let columns = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
    let mut source = [0; 3];
    let mut sign = [0.0; 3];
    for (i, column) in columns.iter().enumerate() {
        let a = column.to_array();
        match (0..3).find(|&k| (a[k].abs() - 1.0).abs() < ON_AXIS) {
            Some(k) => (source[i], sign[i]) = (k, a[k].signum() as f32),
            None => return Turn::Full(columns.map(|c| c.to_array().map(|x| x as f32))),
        }
    }
    Turn::Swap { source, sign }
}

/// A rotation that takes z to `axis`; one that swaps axes where `axis` is one.
fn axis_to_z(axis: Vec3) -> Mat3 {
    let z = axis.normalize();
    let a = z.abs();
    let x = if a.z > 1.0 - ON_AXIS {
        Vec3::X
    } else if a.x > 1.0 - ON_AXIS {
        Vec3::Y
    } else if a.y > 1.0 - ON_AXIS {
        Vec3::Z
    } else {
        z.any_orthonormal_vector()
    };
    Mat3::from_cols(x, z.cross(x), z)
}
