//! Where a plan's robot is, by the kinematics of the crate `k`: neither the planner's nor the
//! verifier's. For planting faults at exact places.

use clearway_plan::PlanFile;
use clearway_plan::plan_file::{GripperValue, PlacedPose, Segment};
use clearway_plan::scene_file::{Body, PoseKeys};
use k::link::Geometry;
use k::{Isometry3, Translation3, UnitQuaternion, Vector3, nalgebra as na};

pub struct Robot {
    pub chain: k::Chain<f64>,
    world_from_root: Isometry3<f64>,
}

/// A link's collision shape, for planting.
pub struct LinkShape {
    pub link: String,
    pub world_from_shape: Isometry3<f64>,
    pub world_from_link: Isometry3<f64>,
    pub geometry: Geometry<f64>,
}

impl Robot {
    pub fn new(plan: &PlanFile) -> Self {
        let file = tempfile::Builder::new().suffix(".urdf").tempfile().expect("a temporary file");
        std::fs::write(file.path(), &plan.robot.urdf).expect("written");
        let chain = k::Chain::from_urdf_file(file.path()).expect("a URDF");
        chain.update_transforms();
        Self { chain, world_from_root: pose_of_keys(&plan.scene.robot.base) }
    }

    /// Moves the robot to a row, or so far from it towards the next.
    pub fn move_to(&self, plan: &PlanFile, segment: &Segment, row: usize, fraction: f64) {
        let next = (row + 1).min(segment.times.len() - 1);
        let set = |name: &str, a: f64, b: f64| {
            if let Some(node) = self.chain.find(name) {
                node.set_joint_position_unchecked(a + fraction * (b - a));
            }
        };
        for (name, value) in &plan.robot.fixed {
            set(name, *value, *value);
        }
        for (column, name) in plan.robot.joints.iter().enumerate() {
            set(name, segment.positions[row][column], segment.positions[next][column]);
        }
        for (name, value) in &segment.gripper {
            match value {
                GripperValue::Held(v) => set(name, *v, *v),
                GripperValue::Rows(v) => set(name, v[row], v[next]),
            }
        }
        for node in self.chain.iter() {
            // Named apart: `joint()` locks the node while its guard lives.
            let name = node.joint().name.clone();
            if let (Some(parent), Some((multiplier, offset))) = (node.mimic_parent(), mimic_of(plan, &name)) {
                let leader = parent.joint_position().unwrap_or_default();
                node.set_joint_position_unchecked(multiplier * leader + offset);
            }
        }
        self.chain.update_transforms();
    }

    pub fn link_pose(&self, link: &str) -> Option<Isometry3<f64>> {
        Some(self.world_from_root * self.chain.find_link(link)?.world_transform()?)
    }

    /// Shapes of primitive links, where the robot is now.
    pub fn shapes(&self) -> Vec<LinkShape> {
        let mut shapes = Vec::new();
        for node in self.chain.iter() {
            let Some(pose) = node.world_transform() else { continue };
            let link = node.link();
            let Some(link) = link.as_ref() else { continue };
            for collision in &link.collisions {
                if !matches!(collision.geometry, Geometry::Mesh { .. }) {
                    shapes.push(LinkShape {
                        link: link.name.clone(),
                        world_from_shape: self.world_from_root * pose * collision.origin(),
                        world_from_link: self.world_from_root * pose,
                        geometry: collision.geometry.clone(),
                    });
                }
            }
        }
        shapes
    }

    /// Movable joints between a link and the root.
    pub fn moving_above(&self, link: &str) -> Vec<String> {
        let Some(node) = self.chain.find_link(link) else { return Vec::new() };
        node.iter_ancestors().filter(|n| n.joint().is_movable()).map(|n| n.joint().name.clone()).collect()
    }
}

/// `k` keeps a mimic's factor to itself, and forgets it where limits are not checked.
fn mimic_of(plan: &PlanFile, joint: &str) -> Option<(f64, f64)> {
    let document = roxmltree::Document::parse(&plan.robot.urdf).ok()?;
    let wanted =
        |n: &roxmltree::Node| n.has_tag_name("joint") && n.attribute("name") == Some(joint) && n.has_attribute("type");
    let mimic = document.descendants().find(wanted)?.children().find(|n| n.has_tag_name("mimic"))?;
    let number =
        |key: &str, default: f64| mimic.attribute(key).map_or(default, |v| v.trim().parse().unwrap_or(default));
    Some((number("multiplier", 1.0), number("offset", 0.0)))
}

/// The point of a shape farthest along a world direction.
pub fn support(geometry: &Geometry<f64>, pose: &Isometry3<f64>, direction: &Vector3<f64>) -> Vector3<f64> {
    let d = pose.rotation.inverse() * direction;
    let side = |half: f64, along: f64| half * along.signum();
    let ring = |radius: f64| {
        let flat = na::Vector2::new(d.x, d.y);
        flat.try_normalize(1e-12).map_or(na::Vector2::zeros(), |n| n * radius)
    };
    let local = match geometry {
        Geometry::Box { depth, width, height } => {
            Vector3::new(side(depth / 2.0, d.x), side(width / 2.0, d.y), side(height / 2.0, d.z))
        }
        Geometry::Cylinder { radius, length } => {
            let r = ring(*radius);
            Vector3::new(r.x, r.y, side(length / 2.0, d.z))
        }
        Geometry::Capsule { radius, length } => Vector3::z() * side(length / 2.0, d.z) + d.normalize() * *radius,
        Geometry::Sphere { radius } => d.normalize() * *radius,
        Geometry::Mesh { .. } => Vector3::zeros(),
    };
    pose.rotation * local + pose.translation.vector
}

/// An object's shape, where it is one primitive.
pub fn primitive(body: &Body) -> Option<Geometry<f64>> {
    if let Some(b) = &body.r#box {
        return Some(Geometry::Box { depth: b.size[0], width: b.size[1], height: b.size[2] });
    }
    if let Some(s) = &body.sphere {
        return Some(Geometry::Sphere { radius: s.radius });
    }
    let capsule = body.capsule.as_ref().map(|c| Geometry::Capsule { radius: c.radius, length: c.height });
    body.cylinder.as_ref().map(|c| Geometry::Cylinder { radius: c.radius, length: c.height }).or(capsule)
}

pub fn isometry(pose: &PlacedPose) -> Isometry3<f64> {
    let [x, y, z, w] = pose.quaternion;
    Isometry3::from_parts(
        Translation3::from(Vector3::from(pose.position)),
        UnitQuaternion::from_quaternion(na::Quaternion::new(w, x, y, z)),
    )
}

pub fn placed(pose: &Isometry3<f64>) -> PlacedPose {
    let q = pose.rotation.quaternion();
    PlacedPose { position: pose.translation.vector.into(), quaternion: [q.i, q.j, q.k, q.w] }
}

fn pose_of_keys(keys: &PoseKeys) -> Isometry3<f64> {
    if let Some(quaternion) = keys.quaternion {
        return isometry(&PlacedPose { position: keys.position, quaternion });
    }
    let [r, p, y] = keys.rpy.unwrap_or_default();
    Isometry3::from_parts(Translation3::from(Vector3::from(keys.position)), UnitQuaternion::from_euler_angles(r, p, y))
}
