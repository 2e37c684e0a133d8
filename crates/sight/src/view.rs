//! Where the camera is, which way it looks, and what part of the room counts.

use clearway_geometry::{Pose, Solid, Vec2, Vec3};
use clearway_plan::scene_file::{Camera, Rect};
use clearway_scene::Scene;

/// Beyond the objects on all sides, where a scene does not say its workspace; above the highest object; metres.
const AROUND: f64 = 0.05;
const ABOVE: f64 = 0.05;
/// Less than this above the lowest foot is not looked at, metres.
const FOOT: f64 = 0.0005;

/// A pinhole camera with a square picture.
#[derive(Clone, Debug)]
pub struct View {
    pub eye: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    /// Of half the field of view.
    tangent: f64,
}

impl View {
    pub fn new(camera: &Camera) -> Self {
        let eye = Vec3::from_array(camera.position);
        let forward = (Vec3::from_array(camera.look_at) - eye).normalize();
        // Level, unless it looks straight up or down.
        let level = forward.cross(Vec3::Z);
        let right = if level.length() > 1e-6 { level.normalize() } else { Vec3::X };
        Self { eye, forward, right, up: right.cross(forward), tangent: (camera.fov / 2.0).tan() }
    }

    /// Whether a direction from the eye, of any length, is within the picture.
    pub fn holds(&self, direction: Vec3) -> bool {
        let depth = direction.dot(self.forward) * self.tangent;
        depth > 0.0 && direction.dot(self.right).abs() <= depth && direction.dot(self.up).abs() <= depth
    }

    /// The picture's four sides: inward normals of planes through the eye.
    pub fn sides(&self) -> [Vec3; 4] {
        let side = |across: Vec3| (self.forward * self.tangent - across).normalize();
        [side(self.right), side(-self.right), side(self.up), side(-self.up)]
    }
}

/// The box along the world's axes in which unseen space counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    pub low: Vec3,
    pub high: Vec3,
}

impl Region {
    /// Seen from above the scene's workspace, or 5 cm round its objects; from the lowest object's foot to 5 cm
    /// above the highest.
    pub fn of(scene: &Scene) -> Self {
        let boxes = scene.objects.iter().map(|o| o.solid.aabb(o.pose));
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = boxes.fold(none, |(low, high), (a, b)| (low.min(a), high.max(b)));
        let around = Rect { min: (low.truncate() - AROUND).to_array(), max: (high.truncate() + AROUND).to_array() };
        let Rect { min, max } = scene.file.workspace.unwrap_or(around);
        Self { low: Vec2::from(min).extend(low.z + FOOT), high: Vec2::from(max).extend(high.z + ABOVE) }
    }

    pub fn holds(&self, p: Vec3) -> bool {
        p.cmpge(self.low).all() && p.cmple(self.high).all()
    }

    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, axis: usize| if i >> bit & 1 == 1 { self.high[axis] } else { self.low[axis] };
            Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        })
    }

    /// Its faces: outward normals and offsets; inside is `n · p ≤ d`.
    pub fn faces(&self) -> [(Vec3, f64); 6] {
        let Self { low, high } = self;
        [
            (Vec3::X, high.x),
            (-Vec3::X, -low.x),
            (Vec3::Y, high.y),
            (-Vec3::Y, -low.y),
            (Vec3::Z, high.z),
            (-Vec3::Z, -low.z),
        ]
    }
}

/// Why nothing can be seen from there.
pub fn blind(scene: &Scene, view: &View) -> Option<String> {
    let inside = |solid: &Solid, pose: &Pose| solid.depth(pose.inverse_point(view.eye)) > 0.0;
    let fixture = scene.fixtures.iter().find(|f| inside(&f.solid, &f.pose)).map(|f| &f.id);
    if let Some(id) = fixture.or_else(|| scene.objects.iter().find(|o| inside(&o.solid, &o.pose)).map(|o| &o.id)) {
        return Some(format!("the camera is inside `{id}`"));
    }
    let Region { low, high } = Region::of(scene);
    let part = |k: usize| k as f64 / 4.0;
    let grid = (0..125).map(|i| low + (high - low) * Vec3::new(part(i % 5), part(i / 5 % 5), part(i / 25)));
    let nothing = !grid.into_iter().any(|p| view.holds(p - view.eye));
    nothing.then(|| "the camera looks away: nothing of the objects' surroundings is in its picture".to_owned())
}

/// A solid where it stands.
#[derive(Clone, Copy)]
pub struct Standing<'a> {
    pub solid: &'a Solid,
    pub pose: &'a Pose,
}
