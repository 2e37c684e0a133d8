//! Is a ball nearer to a shape than so much? One function per shape, sixteen balls at once.
//!
//! Distances are exact for boxes, capsules, spheres, cylinders and points. A hull is first asked by
//! its face planes, which can only err towards *near*; lanes that pass are decided by GJK.

use super::vector::{LANES, Lanes, Point, bits, load, splat};
use clearway_geometry::distance::closer_than;
use clearway_geometry::{Convex, Pose, Vec3};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// A convex piece of an obstacle, in the root frame, metres.
#[derive(Clone, Debug)]
pub enum Shape {
    Sphere {
        centre: [f32; 3],
        radius: f32,
    },
    /// `axis` is the unit direction from the middle to the upper end.
    Capsule {
        centre: [f32; 3],
        axis: [f32; 3],
        half: f32,
        radius: f32,
    },
    Cylinder {
        centre: [f32; 3],
        axis: [f32; 3],
        half: f32,
        radius: f32,
    },
    /// `axes` are the box's own, by rows; none where they are the root's.
    Box {
        centre: [f32; 3],
        axes: Option<[[f32; 3]; 3]>,
        half: [f32; 3],
    },
    Hull {
        planes: Vec<[f32; 4]>,
        exact: Convex,
        pose: Pose,
    },
    /// At most sixteen balls of one size; unused lanes repeat the first.
    Points {
        at: [Lanes; 3],
        count: usize,
        radius: f32,
    },
}

impl Shape {
    pub fn new(convex: &Convex, root_from_part: &Pose) -> Shape {
        let centre = narrow(root_from_part.translation);
        let axis = narrow(root_from_part.rotation.z_axis);
        match convex {
            Convex::Sphere { radius } => Shape::Sphere { centre, radius: *radius as f32 },
            Convex::Capsule { radius, half } => {
                Shape::Capsule { centre, axis, half: *half as f32, radius: *radius as f32 }
            }
            Convex::Cylinder { radius, half } => {
                Shape::Cylinder { centre, axis, half: *half as f32, radius: *radius as f32 }
            }
            Convex::Box { half } => boxed(root_from_part, *half),
            Convex::Hull(hull) => {
                let planes = hull
                    .planes
                    .iter()
                    .map(|(normal, offset)| {
                        let n = root_from_part.rotation * *normal;
                        let d = offset + n.dot(root_from_part.translation);
                        [n.x as f32, n.y as f32, n.z as f32, d as f32]
                    })
                    .collect();
                Shape::Hull { planes, exact: convex.clone(), pose: *root_from_part }
            }
        }
    }

    /// At most sixteen points.
    pub fn points(points: &[Vec3], radius: f64) -> Shape {
        let mut at = [Lanes::ZERO; 3];
        for lane in 0..LANES {
            let p = points[if lane < points.len() { lane } else { 0 }].to_array();
            for (axis, lanes) in at.iter_mut().enumerate() {
                lanes.0[lane] = p[axis] as f32;
            }
        }
        Shape::Points { at, count: points.len().min(LANES), radius: radius as f32 }
    }

    /// The lanes, as bits, whose ball of radius `reach` about `p` meets the shape.
    #[inline(always)]
    pub fn meets<S: Simd>(&self, simd: S, p: Point<S>, reach: f32) -> u32 {
        let square = |r: f32| splat(simd, r * r);
        match self {
            Shape::Sphere { centre, radius } => {
                bits(p.distance_squared(Point::splat(simd, *centre)).simd_lt(square(radius + reach)))
            }
            Shape::Capsule { centre, axis, half, radius } => {
                let d = p.minus(Point::splat(simd, *centre));
                let along = d.dot(Point::splat(simd, *axis));
                let beyond = along - along.max(splat(simd, -*half)).min(splat(simd, *half));
                // |d − clamped·axis|² = |d|² − along² + beyond², cancelling for the worse the farther away:
                // the part across the axis is made out on its own.
                let across = across(simd, d, along, axis);
                bits(beyond.mul_add(beyond, across).simd_lt(square(radius + reach)))
            }
            Shape::Cylinder { centre, axis, half, radius } => {
                let d = p.minus(Point::splat(simd, *centre));
                let along = d.dot(Point::splat(simd, *axis));
                let zero = splat(simd, 0.0);
                let over = (along.abs() - splat(simd, *half)).max(zero);
                let beside = (across(simd, d, along, axis).sqrt() - splat(simd, *radius)).max(zero);
                bits(over.mul_add(over, beside * beside).simd_lt(square(reach)))
            }
            Shape::Box { centre, axes, half } => {
                let d = p.minus(Point::splat(simd, *centre));
                let d = match axes {
                    None => d,
                    Some(rows) => Point {
                        x: d.dot(Point::splat(simd, rows[0])),
                        y: d.dot(Point::splat(simd, rows[1])),
                        z: d.dot(Point::splat(simd, rows[2])),
                    },
                };
                bits(outside(simd, d, half).simd_lt(square(reach)))
            }
            Shape::Hull { planes, exact, pose } => {
                let limit = splat(simd, reach);
                let mut most = splat(simd, f32::NEG_INFINITY);
                for [x, y, z, d] in planes {
                    let over = p.dot(Point::splat(simd, [*x, *y, *z])) - splat(simd, *d);
                    most = most.max(over);
                }
                let near = bits(most.simd_lt(limit));
                if near == 0 { 0 } else { decided(p, near, exact, pose, reach) }
            }
            Shape::Points { at, count, radius } => {
                let limit = square(radius + reach);
                let mut near = 0;
                for ((x, y), z) in at[0].0.iter().zip(&at[1].0).zip(&at[2].0).take(*count) {
                    near |= bits(p.distance_squared(Point::splat(simd, [*x, *y, *z])).simd_lt(limit));
                }
                near
            }
        }
    }
}

/// The squared part of `d` across the unit `axis`, given the part along it.
#[inline(always)]
fn across<S: Simd>(simd: S, d: Point<S>, along: f32x16<S>, axis: &[f32; 3]) -> f32x16<S> {
    let a = Point::splat(simd, *axis);
    let c = Point { x: d.x - along * a.x, y: d.y - along * a.y, z: d.z - along * a.z };
    c.dot(c)
}

/// The squared distance of points from a box about the origin.
#[inline(always)]
fn outside<S: Simd>(simd: S, d: Point<S>, half: &[f32; 3]) -> f32x16<S> {
    let zero = splat(simd, 0.0);
    let beyond = Point {
        x: (d.x.abs() - splat(simd, half[0])).max(zero),
        y: (d.y.abs() - splat(simd, half[1])).max(zero),
        z: (d.z.abs() - splat(simd, half[2])).max(zero),
    };
    beyond.dot(beyond)
}

/// The lanes among `near` whose ball meets the hull, by GJK in f64.
#[inline(never)]
fn decided<S: Simd>(p: Point<S>, near: u32, exact: &Convex, pose: &Pose, reach: f32) -> u32 {
    let (mut x, mut y, mut z) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
    p.x.store_slice(&mut x.0);
    p.y.store_slice(&mut y.0);
    p.z.store_slice(&mut z.0);
    let mut met = 0;
    let point = Convex::Sphere { radius: 0.0 };
    for lane in (0..LANES).filter(|l| near >> l & 1 == 1) {
        let at = Vec3::new(x.0[lane].into(), y.0[lane].into(), z.0[lane].into());
        if closer_than(&point, &Pose::from_translation(at), exact, pose, f64::from(reach)) {
            met |= 1 << lane;
        }
    }
    met
}

fn boxed(pose: &Pose, half: Vec3) -> Shape {
    let centre = narrow(pose.translation);
    let rows = pose.rotation.transpose();
    // A box that lies along the root's axes, whichever of its own those are.
    let extent = |axis: Vec3| (0..3).find(|&k| (axis.to_array()[k].abs() - 1.0).abs() < 1e-12);
    if let (Some(x), Some(y), Some(z)) =
        (extent(pose.rotation.x_axis), extent(pose.rotation.y_axis), extent(pose.rotation.z_axis))
    {
        let mut along = [0.0; 3];
        along[x] = half.x as f32;
        along[y] = half.y as f32;
        along[z] = half.z as f32;
        return Shape::Box { centre, axes: None, half: along };
    }
    let row = |k: usize| [rows.x_axis[k] as f32, rows.y_axis[k] as f32, rows.z_axis[k] as f32];
    Shape::Box { centre, axes: Some([row(0), row(1), row(2)]), half: narrow(half) }
}

fn narrow(v: Vec3) -> [f32; 3] {
    v.to_array().map(|x| x as f32)
}

/// The squared distance of a box from sixteen others, all along the root's axes.
#[inline(always)]
pub fn from_boxes<S: Simd>(simd: S, min: &[Lanes; 3], max: &[Lanes; 3], lo: [f32; 3], hi: [f32; 3]) -> f32x16<S> {
    let zero = splat(simd, 0.0);
    let mut sum = zero;
    for axis in 0..3 {
        let beyond = load(simd, &min[axis]) - splat(simd, hi[axis]);
        let beyond = beyond.max(splat(simd, lo[axis]) - load(simd, &max[axis])).max(zero);
        sum = beyond.mul_add(beyond, sum);
    }
    sum
}
