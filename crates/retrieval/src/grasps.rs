//! Preset grasps round an object (section IV-D), as poses of the tool in the object's frame.
//!
//! `side`: the hand comes level from evenly spread directions and square to the level sides of boxes, at
//! fractions of the object's height. `list`: poses from the robot file. A parallel hand is closed until its
//! fingers touch; a suction cup is set on the surface. As long as there may be a plan that way, objects are held
//! so that they do not turn or slip in the hand: a box by its sides, not by its corners.

use clearway_collision::World;
use clearway_geometry::distance::closer_than;
use clearway_geometry::{Convex, Mat3, Pose, Solid, Vec3};
use clearway_plan::ObjectId;
use clearway_plan::robot_file::{GraspKind, HandKind};
use std::f64::consts::TAU;

/// One way to hold an object.
#[derive(Clone, Debug)]
pub struct Grasp {
    pub object_from_tool: Pose,
    /// The hand's joint value when it holds; 0 for a cup.
    pub closed: f64,
    /// The object does not turn or slip in the hand.
    pub firm: bool,
}

/// How far in front of the object's front the tool stays when the object is too deep to be held
/// round its middle, metres: the pads then cover this much of it.
const PAD: f64 = 0.02;
/// What is deep by rounding alone is not, metres.
const ROUNDING: f64 = 1e-6;
/// A cup is set this far off the surface, metres: it seals, and rounding does not make it overlap.
const CUP_GAP: f64 = 0.0003;
/// Fingers are as good as touching at this distance, metres …
const TOUCH: f64 = 0.0005;
/// … and close up to this.
const FIRM: f64 = 2e-5;
/// How far an object is turned, radians (a little, and far enough to be off the diagonal of a box), and moved ahead, metres, to see whether that loosens the hand's hold …
const TURNED: [f64; 2] = [0.03, 0.15];
const AHEAD: f64 = 0.003;
/// … by more than this: then it is not held firmly. Of the slip a friction of 0.3 holds back as much.
const LOOSE_TURNED: f64 = 2e-4;
const LOOSE_AHEAD: f64 = 0.3 * AHEAD;
/// Raised or lowered by this, metres, it is still between the fingers: not held at its very edge.
const RAISED: f64 = 0.012;
/// Pads are at what they hold within this, both together, metres.
const PADS_OFF: f64 = 1e-3;
/// Both together they can open by so much more at least, metres: with less they drag it along when they leave.
const TO_OPEN: f64 = 0.003;
/// A cup sits on a surface that so far to either side is as far off, within so much, and falls off by no more: a can's
/// does, a corner's not. Metres.
const RIM: f64 = 0.008;
const SQUARE: f64 = 5e-4;
const FALLS_OFF: f64 = 2.5e-3;
/// How far a side of a box may be from upright: the sine of the angle.
const LEVEL: f64 = 0.01;
/// Directions this close are one, radians.
const SAME_YAW: f64 = 1e-6;
/// The gap at which the fingers touch is found within this, metres.
const CLOSED: f64 = 6e-6;
/// A hand that nowhere reaches farther by this after half a turn about its z axis is the same upside down, metres.
const ALIKE: f64 = 0.01;

/// The poses of the tool that the robot file declares for an object, in its frame, and the grasp where
/// the hand can hold it: not where it is too wide, or out of the fingers' reach.
pub fn declared(world: &World, object: ObjectId) -> Vec<(Pose, Option<Grasp>)> {
    let robot = &world.model.robot;
    let solid = &world.solids[object.index()];
    let world_from_object = world.world_from_root * world.poses[object.index()];
    let mut poses: Vec<Pose> = Vec::new();
    if robot.grasps.kind == GraspKind::List || !robot.grasps.list.is_empty() {
        poses.extend(robot.grasps.list.iter().map(|keys| keys.pose()));
    } else {
        for &height in &robot.grasps.heights {
            let angles = angles(solid, &world_from_object, robot.grasps.yaws);
            poses.extend(
                angles.into_iter().flat_map(|angle| side(solid, &world_from_object, angle, height, &robot.hand.kind)),
            );
        }
    }
    if both_ways_up(world) {
        let flip = Pose::new(Mat3::from_rotation_z(std::f64::consts::PI), Vec3::ZERO);
        let flipped: Vec<Pose> = poses.iter().map(|p| *p * flip).collect();
        poses.extend(flipped);
    }
    let mut hold = Hold::new(world, solid);
    let mut grasp = |object_from_tool: Pose| {
        let closed = match robot.hand.kind {
            HandKind::Suction { .. } => 0.0,
            HandKind::Parallel => hold.fingers.close(&object_from_tool)?,
        };
        Some(Grasp { object_from_tool, closed, firm: hold.is_firm(&object_from_tool, closed) })
    };
    poses.into_iter().map(|pose| (pose, grasp(pose))).collect()
}

/// Of the declared grasps those that hold an object firmly, or, where none does or `loosely` is enough, all that hold
/// it; and what became of the others.
pub fn preset_grasps(world: &World, object: ObjectId, loosely: bool) -> Presets {
    let declared = declared(world, object);
    let count = declared.len();
    let mut grasps: Vec<Grasp> = declared.into_iter().filter_map(|(_, grasp)| grasp).collect();
    let holding = grasps.len();
    if !loosely && grasps.iter().any(|grasp| grasp.firm) {
        grasps.retain(|grasp| grasp.firm);
    }
    Presets { too_wide: count - holding, askew: holding - grasps.len(), grasps }
}

/// The grasps to take an object by.
pub struct Presets {
    pub grasps: Vec<Grasp>,
    /// How many declared grasps do not hold it, and how many not firmly.
    pub too_wide: usize,
    pub askew: usize,
}

/// World yaws from which the hand comes: evenly spread, then square to the level sides of boxes.
fn angles(solid: &Solid, world_from_object: &Pose, count: usize) -> Vec<f64> {
    let step = TAU / count as f64;
    let mut angles: Vec<f64> = (0..count).map(|yaw| step * yaw as f64).collect();
    let boxes = solid.parts.iter().filter(|(_, convex)| matches!(convex, Convex::Box { .. }));
    for (pose, _) in boxes {
        let rotation = world_from_object.rotation * pose.rotation;
        for side in [rotation.x_axis, rotation.y_axis, rotation.z_axis]
            .into_iter()
            .flat_map(|n| [n, -n])
            .filter(|n| n.z.abs() < LEVEL)
        {
            let angle = (-side.y).atan2(-side.x);
            let near = |a: f64, b: f64| ((a - b) / TAU - ((a - b) / TAU).round()).abs() * TAU < SAME_YAW;
            if !angles.iter().any(|known| near(*known, angle)) {
                angles.push(angle);
            }
        }
    }
    angles
}

/// Whether grasps are declared for the hand as it is and upside down, where a parallel hand is the same; a last joint
/// that makes a whole turn finds that itself.
fn both_ways_up(world: &World) -> bool {
    let robot = &world.model.robot;
    let turns_round = robot.lower.last().zip(robot.upper.last()).is_some_and(|(low, high)| high - low >= TAU);
    robot.hand.kind == HandKind::Parallel && robot.grasps.list.is_empty() && !turns_round
}

/// Whether grasps come in twos that differ by half a turn about the tool's z axis, and all that moves with the arm's
/// last joint is about the same after it: a camera at the hand's side is not.
pub fn in_twos(world: &World) -> bool {
    if !both_ways_up(world) {
        return false;
    }
    let model = &world.model;
    let mut frames = Vec::new();
    model.kinematics.frames(&model.robot.home, model.robot.hand.open(), &mut frames);
    let back = frames[model.kinematics.tool].inverse();
    let last = 1 << (model.kinematics.arm_joints - 1);
    let moving = (0..frames.len()).filter(|&link| model.kinematics.moved_by[link] & last != 0);
    let parts = moving.flat_map(|link| {
        model.robot.links[link].collision.parts.iter().map(move |(part, convex)| (link, part, convex))
    });
    let parts: Vec<(Pose, &Convex)> = parts.map(|(link, part, convex)| (back * frames[link] * *part, convex)).collect();
    let reach = |d: Vec3| {
        let along = |(pose, convex): &(Pose, &Convex)| pose.point(convex.support(pose.rotation.transpose() * d)).dot(d);
        parts.iter().map(along).fold(f64::NEG_INFINITY, f64::max)
    };
    // To the corners, edges and sides of a cube.
    let directions = (0..27).map(|i| Vec3::new(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1)));
    let alike = |d: Vec3| (reach(d) - reach(Vec3::new(-d.x, -d.y, d.z))).abs() < ALIKE;
    directions.filter(|d| *d != Vec3::ZERO).map(Vec3::normalize).all(alike)
}

/// A level grasp from direction `angle` (the hand points that way, world yaw) at a fraction of the
/// height: round the middle, and for deep objects also with the finger tips only.
fn side(solid: &Solid, world_from_object: &Pose, angle: f64, height: f64, kind: &HandKind) -> Vec<Pose> {
    let forward = Vec3::new(angle.cos(), angle.sin(), 0.0);
    let across = Vec3::new(-angle.sin(), angle.cos(), 0.0);
    // x closes, z points at the object, y = z × x is up.
    let rotation = Mat3::from_cols(across, Vec3::Z, forward);
    let extent = |d: Vec3| world_from_object.point(solid.support(world_from_object.rotation.transpose() * d)).dot(d);
    let (left, right) = (extent(across), -extent(-across));
    let (back, front) = (extent(forward), -extent(-forward));
    let (top, bottom) = (extent(Vec3::Z), -extent(-Vec3::Z));
    let z = bottom + height * (top - bottom);
    let at = |depth: f64| across * ((left + right) / 2.0) + forward * depth + Vec3::Z * z;
    let object_from_world = world_from_object.inverse();
    let grasp = |depth: f64| object_from_world * Pose::new(rotation, at(depth));
    match kind {
        HandKind::Suction { .. } => {
            let start = at(front - 0.01);
            surface_along(solid, &object_from_world, start, forward, back - front + 0.02)
                .map(|p| object_from_world * Pose::new(rotation, p - forward * CUP_GAP))
                .into_iter()
                .collect()
        }
        HandKind::Parallel if back - front > deep(solid) + ROUNDING => {
            vec![grasp((back + front) / 2.0), grasp(front + PAD)]
        }
        HandKind::Parallel => vec![grasp((back + front) / 2.0)],
    }
}

/// Objects deeper than this are held by what is near their front, too, metres: of a box the corners may meet the hand
/// before its pads do.
fn deep(solid: &Solid) -> f64 {
    let has_corners = solid.parts.iter().any(|(_, convex)| matches!(convex, Convex::Box { .. }));
    2.0 * PAD + if has_corners { 0.02 } else { 0.05 }
}

/// Where a ray from outside first meets the solid, world coordinates.
fn surface_along(solid: &Solid, object_from_world: &Pose, start: Vec3, direction: Vec3, reach: f64) -> Option<Vec3> {
    let mut along = 0.0;
    while along < reach {
        let p = object_from_world.point(start + direction * along);
        let gap = solid
            .parts
            .iter()
            .map(|(pose, convex)| convex.point_distance(pose.inverse_point(p)))
            .fold(f64::INFINITY, f64::min);
        if gap < 1e-6 {
            return Some(start + direction * along);
        }
        along += gap;
    }
    None
}

/// Closes a parallel hand round one solid.
struct Fingers<'a> {
    world: &'a World,
    solid: &'a Solid,
    /// Whether the solid is the same however it is turned about its z axis.
    round: bool,
    /// What was asked, turned about that axis to come along x, and the answers.
    known: Vec<(Pose, Option<f64>)>,
}

impl<'a> Fingers<'a> {
    fn new(world: &'a World, solid: &'a Solid) -> Self {
        let about_z = |(pose, convex): &(Pose, Convex)| {
            let along =
                pose.translation.truncate().length() < 1e-12 && pose.rotation.z_axis.truncate().length() < 1e-12;
            along && matches!(convex, Convex::Cylinder { .. } | Convex::Sphere { .. } | Convex::Capsule { .. })
        };
        Self { world, solid, round: solid.parts.iter().all(about_z), known: Vec::new() }
    }

    /// The joint value at which the fingers touch; `None` when the open hand does not go round the
    /// solid or the closed one does not reach it.
    fn close(&mut self, object_from_tool: &Pose) -> Option<f64> {
        let asked = if self.round { turned_to_x(object_from_tool) } else { *object_from_tool };
        if let Some((_, answer)) = self.known.iter().find(|(pose, _)| same(pose, &asked)) {
            return *answer;
        }
        let answer = self.touching(&asked.inverse());
        self.known.push((asked, answer));
        answer
    }

    fn touching(&self, tool_from_object: &Pose) -> Option<f64> {
        let hand = &self.world.model.robot.hand;
        let (open, closed) = (hand.joint_at(hand.widest()), hand.joint_at(0.0));
        if self.near(open, tool_from_object, 0.0) || !self.near(closed, tool_from_object, TOUCH) {
            return None;
        }
        // Nearness only grows as the hand closes. Mostly the pads touch, at a gap as wide as the object.
        let (mut apart, mut touching) = (hand.widest(), 0.0);
        let touches = self.width(tool_from_object) + 2.0 * FIRM;
        let about = [0.5, 8.0, 64.0].into_iter().flat_map(|far| [touches + far * CLOSED, touches - far * CLOSED]);
        let mut guesses = about.collect::<Vec<f64>>().into_iter();
        while apart - touching > CLOSED * (1.0 + 1e-6) {
            let inside = |gap: &f64| touching < *gap && *gap < apart;
            let gap = guesses.find(inside).unwrap_or((apart + touching) / 2.0);
            let near = self.near(hand.joint_at(gap), tool_from_object, FIRM);
            *if near { &mut touching } else { &mut apart } = gap;
        }
        Some(hand.joint_at(apart))
    }

    /// The point of the solid farthest in a direction, seen from the tool.
    fn farthest(&self, tool_from_object: &Pose, direction: Vec3) -> Vec3 {
        tool_from_object.point(self.solid.support(tool_from_object.rotation.transpose() * direction))
    }

    /// Along the way that the fingers close.
    fn width(&self, tool_from_object: &Pose) -> f64 {
        self.farthest(tool_from_object, Vec3::X).x - self.farthest(tool_from_object, -Vec3::X).x
    }

    fn near(&self, value: f64, tool_from_object: &Pose, margin: f64) -> bool {
        hand(self.world, value).any(|(pose, convex)| {
            self.solid.parts.iter().any(|(p, c)| closer_than(convex, &pose, c, &(*tool_from_object * *p), margin))
        })
    }
}

/// Whether grasps hold one solid firmly.
struct Hold<'a> {
    world: &'a World,
    fingers: Fingers<'a>,
    known: Vec<(Pose, bool)>,
}

impl<'a> Hold<'a> {
    fn new(world: &'a World, solid: &'a Solid) -> Self {
        Self { world, fingers: Fingers::new(world, solid), known: Vec::new() }
    }

    fn is_firm(&mut self, object_from_tool: &Pose, closed: f64) -> bool {
        // Whoever lists grasps has thought about them.
        if self.world.model.robot.grasps.kind == GraspKind::List || !self.world.model.robot.grasps.list.is_empty() {
            return true;
        }
        match self.world.model.robot.hand.kind {
            HandKind::Suction { .. } => self.is_square(object_from_tool),
            HandKind::Parallel => {
                let asked = if self.fingers.round { turned_to_x(object_from_tool) } else { *object_from_tool };
                if let Some((_, firm)) = self.known.iter().find(|(pose, _)| same(pose, &asked)) {
                    return *firm;
                }
                let firm = self.stays(&asked.inverse(), closed);
                self.known.push((asked, firm));
                firm
            }
        }
    }

    /// Turned a little either way, raised, lowered or moved away from the palm, it does not come loose: fingers that
    /// close on the corners of a box turn it until they are on its sides.
    fn stays(&self, tool_from_object: &Pose, closed: f64) -> bool {
        let hand = &self.world.model.robot.hand;
        let (gap, width) = (hand.gap_at(closed), self.fingers.width(tool_from_object));
        // Wider apart than it is wide, the pads do not touch it: something else does. And they have to get off it again.
        if gap > width + PADS_OFF || hand.widest() - gap < TO_OPEN {
            return false;
        }
        // Turned, what is held across its corners is narrower one way.
        let narrower = |angle: f64| {
            let turned = Pose::new(Mat3::from_rotation_y(angle), Vec3::ZERO) * *tool_from_object;
            self.fingers.width(&turned) < width - LOOSE_TURNED
        };
        if gap > width - PADS_OFF && TURNED.into_iter().any(|angle| narrower(angle) || narrower(-angle)) {
            return false;
        }
        let ahead = |d: Vec3| self.fingers.farthest(tool_from_object, d).z;
        let moved = |by: Pose, loose: f64| self.fingers.near(closed, &(by * *tool_from_object), FIRM + loose);
        let shifted = |by: Vec3| moved(Pose::from_translation(by), LOOSE_AHEAD);
        // About the middle between the pads, and about its own.
        let own = Vec3::Z * ((ahead(Vec3::Z) + ahead(-Vec3::Z)) / 2.0);
        let turned = |about: Vec3, angle: f64| {
            let turn = Mat3::from_rotation_y(angle);
            moved(Pose::new(turn, about - turn * about), LOOSE_TURNED)
        };
        // A can that is turned about its own axis is as it was.
        let axis = tool_from_object.translation;
        let upright = self.fingers.round && tool_from_object.rotation.z_axis.y.abs() > 1.0 - 1e-12;
        let as_it_was = |about: Vec3| upright && (axis - about).length_squared() - axis.y * axis.y < 1e-18;
        let stays = |about: Vec3| {
            as_it_was(about) || TURNED.into_iter().all(|angle| turned(about, angle) && turned(about, -angle))
        };
        stays(Vec3::ZERO)
            && stays(own)
            && [Vec3::Y * RAISED, Vec3::Y * -RAISED, Vec3::Z * AHEAD].into_iter().all(shifted)
    }

    /// Whether the surface under a cup is square to it.
    fn is_square(&self, object_from_tool: &Pose) -> bool {
        const BACK: f64 = 0.02;
        let rotation = object_from_tool.rotation;
        let depth = |aside: Vec3| {
            let start = object_from_tool.translation + rotation * aside - rotation.z_axis * BACK;
            surface_along(self.fingers.solid, &Pose::IDENTITY, start, rotation.z_axis, 2.0 * BACK)
                .map(|p| (p - start).dot(rotation.z_axis))
        };
        let Some(middle) = depth(Vec3::ZERO) else { return false };
        [Vec3::X, Vec3::Y].into_iter().all(|axis| match (depth(axis * RIM), depth(axis * -RIM)) {
            (Some(a), Some(b)) => (a - b).abs() < SQUARE && a.max(b) - middle < FALLS_OFF,
            _ => false,
        })
    }
}

/// The parts of the hand's links at a value of its joint, each with `tool_from_part`.
pub(crate) fn hand(world: &World, value: f64) -> impl Iterator<Item = (Pose, &Convex)> {
    let model = &world.model;
    let mut frames = Vec::new();
    model.kinematics.frames(&model.robot.home, value, &mut frames);
    let back = frames[model.kinematics.tool].inverse();
    model.robot.hand.links.iter().flat_map(move |&link| {
        let tool_from_link = back * frames[link];
        model.robot.links[link].collision.parts.iter().map(move |(part, convex)| (tool_from_link * *part, convex))
    })
}

/// A pose turned about z so that its z axis (its x axis, where that is upright) has no y.
fn turned_to_x(pose: &Pose) -> Pose {
    let axis = [pose.rotation.z_axis, pose.rotation.x_axis].map(Vec3::truncate);
    let axis = if axis[0].length() > 1e-6 { axis[0] } else { axis[1] };
    Pose::new(Mat3::from_rotation_z(-axis.to_angle()), Vec3::ZERO) * *pose
}

fn same(a: &Pose, b: &Pose) -> bool {
    let near = |a: Vec3, b: Vec3| a.abs_diff_eq(b, 1e-9);
    near(a.translation, b.translation)
        && near(a.rotation.x_axis, b.rotation.x_axis)
        && near(a.rotation.z_axis, b.rotation.z_axis)
}
