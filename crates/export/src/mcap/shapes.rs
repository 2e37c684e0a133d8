//! What the scene's bodies look like: each a few markers, in the frame of whatever carries it.
//!
//! `visualization_msgs` has no capsules: theirs are a cylinder and two spheres. Meshes are their
//! triangles and point clouds their spheres, so that nobody has to find the files.

use super::messages::{Marker, MarkerKind};
use crate::Mesh;
use crate::rows::Nanoseconds;
use clearway_geometry::{Pose, Vec3};
use clearway_plan::scene_file::{Body, Part, PoseKeys, Scale};

/// How markers stand out: red, green, blue, opacity.
pub(crate) type Colour = [f32; 4];

/// What all markers of a body have in common.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub time: Nanoseconds,
    pub frame: &'a str,
    pub namespace: &'a str,
    pub colour: Colour,
}

/// The markers of a body that is at `pose` in the look's frame. Files not among `meshes` are left out.
pub(crate) fn markers<'a>(body: &Body, pose: &Pose, look: Look<'a>, meshes: &[Mesh]) -> Vec<Marker<'a>> {
    let own = Part {
        r#box: body.r#box.clone(),
        cylinder: body.cylinder.clone(),
        sphere: body.sphere.clone(),
        capsule: body.capsule.clone(),
        mesh: body.mesh.clone(),
        ..Part::default()
    };
    let parts = std::iter::once(&own).chain(body.compound.iter().flatten());
    let mut shapes: Vec<Shape> = parts.flat_map(|part| of_part(part, meshes)).collect();
    if let Some(points) = &body.points
        && let Some(cloud) = meshes.iter().find(|m| m.uri == points.file)
    {
        let size = [2.0 * points.radius; 3];
        shapes
            .push(Shape { points: cloud.vertices.clone(), ..Shape::new(MarkerKind::SphereList, Pose::IDENTITY, size) });
    }
    shapes.into_iter().enumerate().map(|(number, shape)| shape.marker(pose, number, look)).collect()
}

struct Shape {
    kind: MarkerKind,
    body_from_shape: Pose,
    scale: [f64; 3],
    points: Vec<[f64; 3]>,
}

impl Shape {
    fn new(kind: MarkerKind, body_from_shape: Pose, scale: [f64; 3]) -> Self {
        Self { kind, body_from_shape, scale, points: Vec::new() }
    }

    fn marker<'a>(self, frame_from_body: &Pose, number: usize, look: Look<'a>) -> Marker<'a> {
        Marker {
            time: look.time,
            frame: look.frame,
            namespace: look.namespace,
            number,
            kind: self.kind,
            pose: *frame_from_body * self.body_from_shape,
            scale: self.scale,
            colour: look.colour,
            points: self.points,
        }
    }
}

fn of_part(part: &Part, meshes: &[Mesh]) -> Vec<Shape> {
    let pose = PoseKeys { position: part.position, rpy: part.rpy, quaternion: part.quaternion }.pose();
    let across = |radius: f64| 2.0 * radius;
    let mut shapes = Vec::new();
    if let Some(keys) = &part.r#box {
        shapes.push(Shape::new(MarkerKind::Cube, pose, keys.size));
    }
    if let Some(keys) = part.cylinder.as_ref().or(part.capsule.as_ref()) {
        shapes.push(Shape::new(MarkerKind::Cylinder, pose, [across(keys.radius), across(keys.radius), keys.height]));
    }
    if let Some(keys) = &part.capsule {
        for end in [0.5, -0.5] {
            let cap = pose * Pose::from_translation(Vec3::Z * (end * keys.height));
            shapes.push(Shape::new(MarkerKind::Sphere, cap, [across(keys.radius); 3]));
        }
    }
    if let Some(keys) = &part.sphere {
        shapes.push(Shape::new(MarkerKind::Sphere, pose, [across(keys.radius); 3]));
    }
    if let Some(keys) = &part.mesh
        && let Some(mesh) = meshes.iter().find(|m| m.uri == keys.file)
    {
        let scale = match keys.scale {
            None => [1.0; 3],
            Some(Scale::Uniform(factor)) => [factor; 3],
            Some(Scale::PerAxis(factors)) => factors,
        };
        let corner = |&index: &u32| mesh.vertices.get(index as usize).map(|v| [0, 1, 2].map(|k| v[k] * scale[k]));
        let triangles = mesh.triangles.iter().filter_map(|t| Some([corner(&t[0])?, corner(&t[1])?, corner(&t[2])?]));
        let points = triangles.flatten().collect();
        shapes.push(Shape { points, ..Shape::new(MarkerKind::TriangleList, pose, [1.0; 3]) });
    }
    shapes
}
