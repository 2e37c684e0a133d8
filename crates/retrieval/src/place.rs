//! Spots to put an object down: a grid over the places, tried in a fixed order.

use clearway_geometry::footprint::enclosing_circle;
use clearway_geometry::{Mat3, Pose, Solid, Vec2, Vec3};
use clearway_scene::Place;

/// Between neighbouring spots, metres.
const GRID: f64 = 0.04;
/// Kept from the place's edge, metres.
const EDGE: f64 = 0.002;

/// Where an object could stand: its pose with yaw 0 is turned and moved there.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// World, top face of the place.
    pub at: Vec3,
    pub place: usize,
}

/// All grid points of all places, those far from `robot` (world x, y) first: what is put down
/// later then never has to be carried over what stands already.
pub fn spots(places: &[Place], robot: Vec2) -> Vec<Spot> {
    let mut spots = Vec::new();
    for (index, place) in places.iter().enumerate() {
        let count = (place.size / GRID).floor().max(Vec2::ONE);
        for i in 0..=count.x as usize {
            for j in 0..=count.y as usize {
                let t = Vec2::new(i as f64, j as f64) / count - 0.5;
                let offset = place.size * t;
                spots.push(Spot { at: place.centre + Vec3::new(offset.x, offset.y, 0.0), place: index });
            }
        }
    }
    spots.sort_by(|a, b| b.at.truncate().distance(robot).total_cmp(&a.at.truncate().distance(robot)));
    spots
}

/// The object's pose when it stands on a spot, turned by `yaw` about the vertical from how it
/// stood at `world_from_object`; `None` when it would stick out over the place's edge.
pub fn standing_at(solid: &Solid, world_from_object: &Pose, yaw: f64, spot: &Spot, place: &Place) -> Option<Pose> {
    let turn = Mat3::from_rotation_z(yaw);
    let turned = Pose::new(turn * world_from_object.rotation, Vec3::ZERO);
    let circle = footprint_middle(solid, &turned);
    let (low, high) = solid.aabb(turned);
    let shift = Vec3::new(spot.at.x - circle.x, spot.at.y - circle.y, spot.at.z - low.z);
    let (min, max) = (low + shift, high + shift);
    let half = place.size / 2.0 - EDGE;
    let inside = min.x >= place.centre.x - half.x
        && max.x <= place.centre.x + half.x
        && min.y >= place.centre.y - half.y
        && max.y <= place.centre.y + half.y;
    inside.then(|| Pose::new(turned.rotation, shift))
}

/// The middle of the footprint.
fn footprint_middle(solid: &Solid, pose: &Pose) -> Vec2 {
    /// Parts are over each other within this, metres.
    const OVER: f64 = 1e-9;
    // Primitives over each other, a bottle's for one, stand round the line through their origins.
    let origins = solid.parts.iter().map(|(part, convex)| {
        let middle = pose.point(part.translation).truncate();
        (!matches!(convex, clearway_geometry::Convex::Hull(_))).then_some(middle)
    });
    let mut origins = origins.collect::<Option<Vec<Vec2>>>().unwrap_or_default().into_iter();
    match origins.next() {
        Some(first) if origins.all(|o| o.abs_diff_eq(first, OVER)) => first,
        _ => enclosing_circle(solid, pose).centre,
    }
}

/// Whether any place could hold the object at all, whatever stands there.
pub fn fits_somewhere(solid: &Solid, world_from_object: &Pose, places: &[Place]) -> bool {
    places.iter().enumerate().any(|(index, place)| {
        let centre = Spot { at: place.centre, place: index };
        (0..12).any(|i| {
            standing_at(solid, world_from_object, i as f64 * std::f64::consts::PI / 12.0, &centre, place).is_some()
        })
    })
}

/// How far the object is turned about the vertical when put down, so that the hand points away
/// from the robot there, or nearly.
pub fn yaws(forward: Vec2, outward: Vec2) -> impl Iterator<Item = f64> {
    let straight = if forward.length() > 0.1 { forward.angle_to(outward) } else { 0.0 };
    [0.0, 20.0, -20.0, 40.0, -40.0, 65.0, -65.0, 90.0, -90.0, 130.0, -130.0, 180.0f64]
        .into_iter()
        .map(move |d| straight + d.to_radians())
}
