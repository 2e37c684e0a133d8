//! How two placed solids meet: how deep, and how far one stands above the other.
//!
//! Both questions are asked of K, the set of translations of *a* at which it overlaps *b*, which
//! is convex when the two are. Its support function is cheap and exact, and so every depth and
//! every separation found here is one that really separates. Overlap itself is decided by GJK.
//! A pair that is far apart costs a comparison of boxes; one that meets, some ten microseconds.

use clearway_geometry::distance::distance;
use clearway_geometry::{Convex, Pose, Solid, Vec3};

/// Distances below this are contact.
const TOUCH: f64 = 1e-9;
/// A body resting on a flat face is recognised when this far (metres) into it.
const FLAT: f64 = 1e-6;

/// A solid where it stands.
pub(crate) struct Placed<'a> {
    parts: Vec<Part<'a>>,
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

pub(crate) struct Part<'a> {
    pub(crate) convex: &'a Convex,
    pub(crate) pose: Pose,
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl<'a> Part<'a> {
    pub(crate) fn new(convex: &'a Convex, pose: Pose) -> Self {
        let most = |axis: Vec3| support(convex, &pose, axis).dot(axis);
        let max = Vec3::new(most(Vec3::X), most(Vec3::Y), most(Vec3::Z));
        let min = -Vec3::new(most(-Vec3::X), most(-Vec3::Y), most(-Vec3::Z));
        Self { convex, pose, min, max }
    }
}

impl<'a> Placed<'a> {
    pub(crate) fn new(solid: &'a Solid, world_from_solid: Pose) -> Self {
        Self::of(&world_from_solid, solid.parts.iter())
    }

    /// Only the parts whose boxes come near this one, seen from above.
    pub(crate) fn near(solid: &'a Solid, world_from_solid: Pose, (min, max): (Vec3, Vec3)) -> Self {
        let meets = |low: Vec3, high: Vec3| horizontally_near(low - FLAT, high + FLAT, min, max);
        let is_near = |(pose, convex): &&(Pose, Convex)| match convex {
            // Points of a cloud are many.
            Convex::Sphere { radius } => {
                let centre = world_from_solid.point(pose.translation);
                meets(centre - *radius, centre + *radius)
            }
            _ => {
                let (low, high) = convex.aabb(&(world_from_solid * *pose));
                meets(low, high)
            }
        };
        Self::of(&world_from_solid, solid.parts.iter().filter(is_near))
    }

    fn of(world_from_solid: &Pose, parts: impl Iterator<Item = &'a (Pose, Convex)>) -> Self {
        let parts: Vec<Part> = parts.map(|(pose, convex)| Part::new(convex, *world_from_solid * *pose)).collect();
        let min = parts.iter().map(|p| p.min).fold(Vec3::INFINITY, Vec3::min);
        let max = parts.iter().map(|p| p.max).fold(Vec3::NEG_INFINITY, Vec3::max);
        Self { parts, min, max }
    }

    pub(crate) fn pairs<'s>(&'s self, other: &'s Placed<'a>) -> impl Iterator<Item = (&'s Part<'a>, &'s Part<'a>)> {
        // Boxes first: a point cloud has a hundred thousand parts.
        let near = other.parts.iter().filter(|b| horizontally_near(self.min, self.max, b.min, b.max));
        near.flat_map(move |b| self.parts.iter().map(move |a| (a, b)))
            .filter(|(a, b)| horizontally_near(a.min, a.max, b.min, b.max))
    }
}

/// How many pairs of parts stand close enough to each other, seen from above, to be looked at.
pub(crate) fn near_pairs(a: &Placed, b: &Placed) -> usize {
    if horizontally_near(a.min, a.max, b.min, b.max) { a.pairs(b).count() } else { 0 }
}

fn horizontally_near(a_min: Vec3, a_max: Vec3, b_min: Vec3, b_max: Vec3) -> bool {
    a_min.x < b_max.x && b_min.x < a_max.x && a_min.y < b_max.y && b_min.y < a_max.y
}

/// How deep two solids reach into each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overlap {
    /// The shortest way out that was found, metres.
    pub(crate) depth: f64,
    /// Which way *a* has to go, of unit length.
    pub(crate) direction: Vec3,
}

/// The first overlap of a part of *a* with a part of *b* that is deeper than `allowed`, if any.
pub(crate) fn overlap(a: &Placed, b: &Placed, allowed: f64) -> Option<Overlap> {
    a.pairs(b)
        .filter(|(a, b)| a.min.z < b.max.z && b.min.z < a.max.z)
        .filter(|(a, b)| distance(a.convex, &a.pose, b.convex, &b.pose) <= TOUCH)
        .map(|(a, b)| shortest_way_out(a, b))
        .find(|overlap| overlap.depth > allowed)
}

/// The clearances of *a*'s parts above *b*'s: how far each would fall onto the other, negative when
/// it has to be lifted. Below `lowest` (the part is beside or beneath) and above what `highest`
/// says, given the least so far, they may be left out.
pub(crate) fn clearances(a: &Placed, b: &Placed, lowest: f64, mut highest: impl FnMut(f64) -> f64) -> Vec<f64> {
    let mut found = Vec::new();
    let mut least = f64::INFINITY;
    for (a, b) in a.pairs(b) {
        // No part falls less far than its lowest point is above the other's highest.
        if a.min.z - b.max.z > highest(least) || a.max.z < b.min.z {
            continue;
        }
        if let Some(clearance) = clearance(a, b).filter(|c| *c >= lowest) {
            least = least.min(clearance);
            found.push(clearance);
        }
    }
    found
}

/// How far *a* would fall onto *b*; nothing when it would miss.
pub(crate) fn clearance(a: &Part, b: &Part) -> Option<f64> {
    if let Some(aside) = (b.pose.translation - a.pose.translation).with_z(0.0).try_normalize()
        && (reach(a, b, aside) <= 0.0 || reach(a, b, -aside) <= 0.0)
    {
        return None;
    }
    let lifted = |lift: f64| {
        let pose = Pose::new(a.pose.rotation, a.pose.translation + lift * Vec3::Z);
        distance(a.convex, &pose, b.convex, &b.pose)
    };
    // Lifted as far as `high`, only the bounding planes can touch.
    let high = b.max.z - a.min.z;
    let low = b.min.z - a.max.z;
    if lifted(high - FLAT) <= TOUCH {
        return Some(-high);
    }
    // The distance is a convex function of the lift: look for a zero by golden section ...
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut left, mut right) = (low, high);
    let (mut x, mut y) = (right - GOLDEN * (right - left), left + GOLDEN * (right - left));
    let (mut at_x, mut at_y) = (lifted(x), lifted(y));
    let mut inside = loop {
        if at_x <= TOUCH {
            break x;
        }
        if at_y <= TOUCH {
            break y;
        }
        if right - left < 1e-7 {
            return None;
        }
        if at_x < at_y {
            (right, y, at_y) = (y, x, at_x);
            x = right - GOLDEN * (right - left);
            at_x = lifted(x);
        } else {
            (left, x, at_x) = (x, y, at_y);
            y = left + GOLDEN * (right - left);
            at_y = lifted(y);
        }
    };
    // ... and then, upwards, for the end of the zeros.
    let mut outside = high;
    while outside - inside > 1e-9 {
        let middle = (inside + outside) / 2.0;
        if lifted(middle) <= TOUCH { inside = middle } else { outside = middle }
    }
    Some(-inside)
}

/// The point of a placed shape farthest along `direction`.
pub(crate) fn support(convex: &Convex, pose: &Pose, direction: Vec3) -> Vec3 {
    pose.point(convex.support(pose.rotation.transpose() * direction))
}

/// How far *a* has to go along `direction` (of unit length) to be clear of *b*: K's support.
fn reach(a: &Part, b: &Part, direction: Vec3) -> f64 {
    (support(b.convex, &b.pose, direction) - support(a.convex, &a.pose, -direction)).dot(direction)
}

/// The least reach over all directions, searched from those that are likely: the faces of either,
/// what runs across both their edges, and the line between them.
fn shortest_way_out(a: &Part, b: &Part) -> Overlap {
    let between = a.pose.translation - b.pose.translation;
    let mut directions = vec![Vec3::X, Vec3::Y, Vec3::Z];
    directions.extend(between.try_normalize());
    let (axes_a, axes_b) = (axes(a), axes(b));
    for (part, axes) in [(a, &axes_a), (b, &axes_b)] {
        directions.extend(axes);
        // Across the axis of what is round about it.
        directions.extend(axes.iter().filter_map(|axis| (between - between.dot(*axis) * axis).try_normalize()));
        if let Convex::Hull(hull) = part.convex {
            directions.extend(hull.planes.iter().take(256).map(|(normal, _)| part.pose.rotation * *normal));
        }
    }
    directions.extend(axes_a.iter().flat_map(|x| axes_b.iter().filter_map(|y| x.cross(*y).try_normalize())));
    let mut starts: Vec<Overlap> = directions
        .into_iter()
        .flat_map(|d| [d, -d])
        .map(|direction| Overlap { depth: reach(a, b, direction), direction })
        .collect();
    starts.sort_by(|x, y| x.depth.total_cmp(&y.depth));
    starts.truncate(3);
    let refined = starts.into_iter().map(|start| descend(a, b, start));
    refined.min_by(|x, y| x.depth.total_cmp(&y.depth)).unwrap_or(Overlap { depth: f64::INFINITY, direction: Vec3::Z })
}

/// The directions that a shape's edges run along.
fn axes(part: &Part) -> Vec<Vec3> {
    let r = &part.pose.rotation;
    match part.convex {
        Convex::Box { .. } => vec![r.x_axis, r.y_axis, r.z_axis],
        Convex::Cylinder { .. } | Convex::Capsule { .. } => vec![r.z_axis],
        Convex::Sphere { .. } | Convex::Hull(_) => Vec::new(),
    }
}

/// Turns the direction this way and that, by less and less, while the reach falls.
fn descend(a: &Part, b: &Part, mut best: Overlap) -> Overlap {
    let mut step = 0.3;
    while step > 1e-4 {
        let (u, v) = best.direction.any_orthonormal_pair();
        let turned = [u, -u, v, -v].into_iter().map(|t| {
            let direction = (best.direction + step * t).normalize();
            Overlap { depth: reach(a, b, direction), direction }
        });
        match turned.min_by(|x, y| x.depth.total_cmp(&y.depth)) {
            // By so much at least that the search ends.
            Some(next) if next.depth < best.depth - 1e-9 => best = next,
            _ => step /= 2.0,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cylinder(radius: f64, height: f64) -> Solid {
        Solid::new(Convex::Cylinder { radius, half: height / 2.0 })
    }

    fn cuboid(x: f64, y: f64, z: f64) -> Solid {
        Solid::new(Convex::Box { half: Vec3::new(x, y, z) / 2.0 })
    }

    fn at(x: f64, y: f64, z: f64) -> Pose {
        Pose::from_translation(Vec3::new(x, y, z))
    }

    fn least(a: &Solid, pa: Pose, b: &Solid, pb: Pose) -> Option<f64> {
        clearances(&Placed::new(a, pa), &Placed::new(b, pb), f64::NEG_INFINITY, |_| f64::INFINITY)
            .into_iter()
            .min_by(f64::total_cmp)
    }

    fn depth(a: &Solid, pa: Pose, b: &Solid, pb: Pose) -> f64 {
        overlap(&Placed::new(a, pa), &Placed::new(b, pb), 0.0).map_or(0.0, |o| o.depth)
    }

    #[test]
    fn flat_on_flat_is_exact() {
        let (can, floor) = (cylinder(0.037, 0.26), cuboid(0.6, 0.9, 0.02));
        for gap in [0.3, 0.001, 0.0, -0.0007, -0.005] {
            let found = least(&can, at(0.1, 0.2, 0.01 + 0.13 + gap), &floor, at(0.0, 0.0, 0.0)).unwrap_or(f64::NAN);
            assert!((found - gap).abs() < 1e-12, "{found} is not {gap}");
        }
        // Half over the edge, and just past it.
        assert!(least(&can, at(0.33, 0.0, 0.5), &floor, at(0.0, 0.0, 0.0)).is_some());
        assert_eq!(least(&can, at(0.3371, 0.0, 0.5), &floor, at(0.0, 0.0, 0.0)), None);
    }

    #[test]
    fn round_and_tilted_things_fall_as_far_as_geometry_says() {
        let ball = Solid::new(Convex::Sphere { radius: 0.1 });
        // Over a ball 0.12 aside: the centres end 0.2 apart.
        let found = least(&ball, at(0.12, 0.0, 1.0), &ball, at(0.0, 0.0, 0.0)).unwrap_or(f64::NAN);
        assert!((found - (1.0 - 0.16)).abs() < 1e-7, "{found}");
        assert_eq!(least(&ball, at(0.2001, 0.0, 1.0), &ball, at(0.0, 0.0, 0.0)), None);
        // A box on its edge, over a lying cylinder.
        let tilted = Pose::from_rpy([std::f64::consts::FRAC_PI_4, 0.0, 0.0], Vec3::new(0.0, 0.0, 1.0));
        let lying = Pose::from_rpy([0.0, std::f64::consts::FRAC_PI_2, 0.0], Vec3::ZERO);
        let found = least(&cuboid(0.2, 0.2, 0.2), tilted, &cylinder(0.05, 0.4), lying).unwrap_or(f64::NAN);
        assert!((found - (1.0 - 0.02_f64.sqrt() - 0.05)).abs() < 1e-7, "{found}");
    }

    #[test]
    fn a_ceiling_is_not_beneath() {
        let (can, board) = (cylinder(0.04, 0.2), cuboid(1.0, 1.0, 0.02));
        let under = clearances(
            &Placed::new(&can, at(0.0, 0.0, 0.0)),
            &Placed::new(&board, at(0.0, 0.0, 0.111)),
            -0.001,
            |_| 1.0,
        );
        assert!(under.is_empty(), "{under:?}");
    }

    #[test]
    fn depths_are_the_shortest_way_out() {
        let (can, wall) = (cylinder(0.04, 0.26), cuboid(0.02, 1.0, 1.0));
        assert!((depth(&can, at(0.045, 0.0, 0.0), &wall, at(0.0, 0.0, 0.0)) - 0.005).abs() < 1e-9);
        assert!((depth(&can, at(0.0, 0.0, 0.0), &can, at(0.03, 0.04, 0.1)) - 0.03).abs() < 1e-9);
        assert_eq!(depth(&can, at(0.0, 0.0, 0.0), &can, at(0.08, 0.0, 0.1)), 0.0);
        assert!((depth(&can, at(0.0, 0.0, 0.0), &can, at(0.0, 0.0, 0.0)) - 0.08).abs() < 1e-6);
        // A ball at a box's corner.
        let ball = Solid::new(Convex::Sphere { radius: 0.1 });
        let corner = Vec3::splat(0.5) + Vec3::ONE.normalize() * 0.0985;
        let found = depth(&ball, Pose::from_translation(corner), &cuboid(1.0, 1.0, 1.0), at(0.0, 0.0, 0.0));
        assert!((found - 0.0015).abs() < 1e-6, "{found}");
        // Two boxes, edge across edge.
        let upper =
            Pose::from_rpy([std::f64::consts::FRAC_PI_4, 0.0, 0.0], Vec3::new(0.0, 0.0, 0.2 * 2.0_f64.sqrt() - 0.002));
        let lower = Pose::from_rpy([0.0, std::f64::consts::FRAC_PI_4, 0.0], Vec3::ZERO);
        let found = depth(&cuboid(1.0, 0.2, 0.2), upper, &cuboid(0.2, 1.0, 0.2), lower);
        assert!((found - 0.002).abs() < 1e-9, "{found}");
    }
}
