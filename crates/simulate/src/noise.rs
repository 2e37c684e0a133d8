//! Another world than the plan's scene: objects a little elsewhere, thicker, rougher.
//!
//! Objects are drawn one after the other; a draw that would have an object overlap anything (what carries it
//! aside) is drawn again, up to [`TRIES`] times, and then the object stays as the scene has it, which always fits,
//! since what was drawn before it left it its room.

use crate::bodies::Object;
use crate::settings::Noise;
use clearway_verify::played::{Played, PlayedShape, distance};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::shape::{Ball, Capsule, Cuboid, Cylinder, SharedShape};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

const TRIES: usize = 200;
/// Overlap that is none, metres.
const ROUNDING: f64 = 1e-5;

pub(crate) fn draw(
    played: &Played,
    carriers: &[Vec<String>],
    objects: &[Object],
    noise: &Noise,
    random: &mut Xoshiro256PlusPlus,
) -> Vec<Object> {
    let mut drawn = objects.to_vec();
    for (i, object) in objects.iter().enumerate() {
        drawn[i].friction *= 1.0 + noise.friction * random.random_range(-1.0..=1.0);
        if noise.position == 0.0 && noise.radius == 0.0 {
            continue;
        }
        for _ in 0..TRIES {
            let (shapes, at) = redrawn(object, noise, random);
            if fits(played, &carriers[i], &drawn, i, &shapes, &at) {
                (drawn[i].shapes, drawn[i].world_from_object) = (shapes, at);
                break;
            }
        }
    }
    drawn
}

fn redrawn(object: &Object, noise: &Noise, random: &mut Xoshiro256PlusPlus) -> (Vec<PlayedShape>, Pose) {
    let (turn, out) = (random.random_range(0.0..TAU), noise.position * random.random_range(0.0..=1.0_f64).sqrt());
    let thicker = noise.radius * random.random_range(-1.0..=1.0);
    let mut at = object.world_from_object;
    at.translation += Vector::new(out * turn.cos(), out * turn.sin(), 0.0);
    let [shape] = &object.shapes[..] else { return (object.shapes.clone(), at) };
    let Some(other) = thickened(&shape.shape, thicker) else { return (object.shapes.clone(), at) };
    let shapes = vec![PlayedShape { shape: other, owner_from_shape: shape.owner_from_shape }];
    // What lies is so much higher or lower.
    let lowest = |shapes: &[PlayedShape]| {
        shapes.iter().map(|s| s.shape.compute_aabb(&(at * s.owner_from_shape)).mins.z).fold(f64::INFINITY, f64::min)
    };
    at.translation.z += lowest(&object.shapes) - lowest(&shapes);
    (shapes, at)
}

/// Of shapes that have a radius; boxes along their x and y.
fn thickened(shape: &SharedShape, by: f64) -> Option<SharedShape> {
    let length = |before: f64| (before + by).max(before / 4.0);
    if let Some(c) = shape.as_cylinder() {
        return Some(SharedShape::new(Cylinder::new(c.half_height, length(c.radius))));
    }
    if let Some(b) = shape.as_ball() {
        return Some(SharedShape::new(Ball::new(length(b.radius))));
    }
    if let Some(c) = shape.as_capsule() {
        return Some(SharedShape::new(Capsule::new(c.segment.a, c.segment.b, length(c.radius))));
    }
    let half = shape.as_cuboid()?.half_extents;
    Some(SharedShape::new(Cuboid::new(Vector::new(length(half.x), length(half.y), half.z))))
}

/// Whether an object overlaps nothing there but what carries it.
fn fits(
    played: &Played,
    carriers: &[String],
    drawn: &[Object],
    index: usize,
    shapes: &[PlayedShape],
    at: &Pose,
) -> bool {
    let free = |id: &String, others: &[PlayedShape], other_at: &Pose| {
        carriers.contains(id) || distance(shapes, at, others, other_at, 0.0).is_none_or(|d| d >= -ROUNDING)
    };
    played.fixtures.iter().all(|f| free(&f.id, &f.shapes, &f.world_from_body))
        && drawn.iter().zip(&played.objects).enumerate().all(|(other, (object, thing))| {
            // What stands on it stays on it.
            other == index
                || free(&thing.id, &object.shapes, &object.world_from_object)
                || stands_on(played, other, index, drawn)
        })
}

fn stands_on(played: &Played, above: usize, below: usize, drawn: &[Object]) -> bool {
    let standing: Vec<Option<Pose>> = drawn.iter().map(|o| Some(o.world_from_object)).collect();
    played.carriers(&standing, above, &played.objects[above].world_from_body).contains(&played.objects[below].id)
}
