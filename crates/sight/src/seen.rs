//! How much of an object is in view.

use crate::view::{Standing, View};
use clearway_geometry::{Vec3, ray};

/// An object is seen when at least this part of it is: of the rays that would meet it if it stood alone, those
/// that are in the picture and meet nothing before it.
pub const ENOUGH: f64 = 0.25;
/// Rays across an object, each way.
const RAYS: usize = 20;

/// What became of the rays at an object.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Of those that would meet it, the part that does.
    pub part: f64,
    /// The body that stops most of the others, of those given.
    pub mostly_behind: Option<usize>,
}

/// Looks at `object`; `others`: everything else that stands, fixtures included.
pub fn look_at(view: &View, object: Standing, others: &[Standing]) -> Seen {
    let (low, high) = object.solid.aabb(*object.pose);
    let (centre, radius) = ((low + high) / 2.0, low.distance(high) / 2.0);
    let towards = centre - view.eye;
    let far = towards.length();
    let axis = towards / far.max(1e-9);
    let level = axis.cross(Vec3::Z);
    let across = if level.length() > 1e-3 { level.normalize() } else { Vec3::X };
    let other_way = axis.cross(across);
    // As wide and as high as the box round it looks, at its distance.
    let spread = |way: Vec3| {
        let corner = |i: usize| {
            (low + (high - low) * Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)) - view.eye
        };
        (0..8).map(corner).map(|c| (c.dot(way) / c.dot(axis).max(1e-3)).abs() * far).fold(0.0, f64::max)
    };
    let (wide, tall) = (spread(across), spread(other_way));
    // What reaches into the cone of rays before the object's far side.
    let cone = (radius / far.max(radius)).min(1.0);
    let near: Vec<(usize, Standing)> = others
        .iter()
        .enumerate()
        .filter(|(_, o)| {
            let (low, high) = o.solid.aabb(*o.pose);
            let (middle, around) = ((low + high) / 2.0 - view.eye, low.distance(high) / 2.0);
            let along = middle.dot(axis);
            let off = (middle - axis * along).length();
            along - around < far + radius
                && off < around + (along.max(0.0) + around) * cone / (1.0 - cone * cone).max(1e-6).sqrt()
        })
        .map(|(i, o)| (i, *o))
        .collect();
    let (mut would, mut does) = (0, 0);
    let mut stopped = vec![0; others.len()];
    for i in 0..RAYS * RAYS {
        let at = |k: usize| 2.0 * (k as f64 + 0.5) / RAYS as f64 - 1.0;
        let direction = (towards + across * (at(i % RAYS) * wide) + other_way * (at(i / RAYS) * tall)).normalize();
        let Some(reach) = ray::meets_solid(object.solid, object.pose, view.eye, direction) else { continue };
        would += 1;
        if !view.holds(direction) {
            continue;
        }
        let before =
            |(index, o): &(usize, Standing)| Some((ray::meets_solid(o.solid, o.pose, view.eye, direction)?, *index));
        match near.iter().filter_map(before).filter(|(t, _)| *t < reach).min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((_, index)) => stopped[index] += 1,
            None => does += 1,
        }
    }
    let most = stopped.iter().enumerate().max_by_key(|(i, n)| (**n, std::cmp::Reverse(*i))).filter(|(_, n)| **n > 0);
    Seen { part: f64::from(does) / f64::from(would.max(1)), mostly_behind: most.map(|(i, _)| i) }
}
