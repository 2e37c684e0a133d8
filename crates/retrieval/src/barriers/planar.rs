//! What stands upright, seen from above: convex outlines with round edges.

use clearway_geometry::footprint::nearest_on_segment;
use clearway_geometry::{Convex, Pose, Vec2};

/// How far from vertical an axis may point: rounding.
const UPRIGHT: f64 = 1e-6;

/// A convex polygon (perhaps a point) and all within `radius` of it.
#[derive(Clone, Debug)]
pub struct Rounded {
    /// Counter-clockwise.
    pub corners: Vec<Vec2>,
    pub radius: f64,
}

/// An outline from one height to another.
#[derive(Clone, Debug)]
pub struct Prism {
    pub outline: Rounded,
    pub bottom: f64,
    pub top: f64,
}

impl Prism {
    /// The shape, if it stands upright; of a capsule the cylindrical part.
    pub fn of(convex: &Convex, pose: &Pose) -> Option<Self> {
        let axis = |i: usize| pose.rotation.col(i).z.abs() > 1.0 - UPRIGHT;
        let (outline, half) = match convex {
            Convex::Cylinder { radius, half } | Convex::Capsule { radius, half } if axis(2) => {
                (Rounded { corners: vec![pose.translation.truncate()], radius: *radius }, *half)
            }
            Convex::Box { half } => {
                let up = (0..3).find(|&i| axis(i))?;
                let (a, b) = ((up + 1) % 3, (up + 2) % 3);
                let side = |i: usize| (pose.rotation.col(i) * half[i]).truncate();
                let mut outline = Rounded::rectangle(pose.translation.truncate(), side(a), side(b));
                if pose.rotation.col(up).z < 0.0 {
                    outline.corners.reverse();
                }
                (outline, half[up])
            }
            _ => return None,
        };
        let z = pose.translation.z;
        Some(Self { outline, bottom: z - half, top: z + half })
    }

    /// The largest disc round the centre that is inside.
    pub fn inscribed(&self) -> (Vec2, f64) {
        let centre = self.outline.centre();
        let sides = self.outline.sides().filter(|(p, q)| p != q);
        let least = sides.map(|(p, q)| nearest_on_segment(centre, p, q).distance(centre)).reduce(f64::min);
        (centre, self.outline.radius + least.unwrap_or(0.0))
    }
}

impl Rounded {
    /// A rectangle; `along` and `across` lead from its middle to that of a side, a quarter turn to the left of each other.
    pub fn rectangle(middle: Vec2, along: Vec2, across: Vec2) -> Self {
        let corners =
            vec![middle - along - across, middle + along - across, middle + along + across, middle - along + across];
        Self { corners, radius: 0.0 }
    }

    pub fn centre(&self) -> Vec2 {
        self.corners.iter().sum::<Vec2>() / self.corners.len() as f64
    }

    fn sides(&self) -> impl Iterator<Item = (Vec2, Vec2)> {
        self.corners.iter().copied().zip(self.corners.iter().copied().cycle().skip(1))
    }

    /// How far `p` is from the polygon, radius aside; 0 inside.
    pub fn distance(&self, p: Vec2) -> f64 {
        let (a, b) = self.nearest(&Rounded { corners: vec![p], radius: 0.0 });
        a.distance(b)
    }

    /// Of both polygons, radius aside, the points nearest to each other.
    pub fn nearest(&self, other: &Rounded) -> (Vec2, Vec2) {
        if let Some(common) = self.common(other) {
            return (common, common);
        }
        let of = |a: &Rounded, b: &Rounded| -> Option<(f64, Vec2, Vec2)> {
            let pairs = a.corners.iter().flat_map(|&p| b.sides().map(move |(q, r)| (p, nearest_on_segment(p, q, r))));
            pairs.map(|(p, q)| (p.distance_squared(q), p, q)).min_by(|x, y| x.0.total_cmp(&y.0))
        };
        match (of(self, other), of(other, self)) {
            (Some((near, p, q)), Some((nearer, r, s))) => {
                if near <= nearer {
                    (p, q)
                } else {
                    (s, r)
                }
            }
            _ => (self.centre(), other.centre()),
        }
    }

    /// Some point in both polygons.
    fn common(&self, other: &Rounded) -> Option<Vec2> {
        let corner =
            self.corners.iter().find(|p| other.holds(**p)).or_else(|| other.corners.iter().find(|p| self.holds(**p)));
        corner
            .copied()
            .or_else(|| self.sides().flat_map(|s| other.sides().map(move |t| (s, t))).find_map(|(s, t)| crossing(s, t)))
    }

    /// Whether `p` is inside the polygon, or on its edge.
    pub fn holds(&self, p: Vec2) -> bool {
        self.corners.len() > 2 && self.sides().all(|(a, b)| (b - a).perp_dot(p - a) >= 0.0)
    }

    /// What of the polygon is in `region`, or up to `slack` beyond each of its sides.
    pub fn clipped(&self, region: &Rounded, slack: f64) -> Option<Rounded> {
        let mut corners = self.corners.clone();
        for (a, b) in region.sides() {
            let inwards = (b - a).perp().normalize_or_zero();
            let inside = |p: Vec2| inwards.dot(p - a) + slack;
            let mut kept = Vec::new();
            for (i, &p) in corners.iter().enumerate() {
                let q = corners[(i + 1) % corners.len()];
                let (at_p, at_q) = (inside(p), inside(q));
                if at_p >= 0.0 {
                    kept.push(p);
                }
                if (at_p >= 0.0) != (at_q >= 0.0) {
                    kept.push(p + (q - p) * (at_p / (at_p - at_q)));
                }
            }
            corners = kept;
        }
        (!corners.is_empty()).then_some(Rounded { corners, radius: self.radius })
    }
}

fn crossing((a, b): (Vec2, Vec2), (p, q): (Vec2, Vec2)) -> Option<Vec2> {
    let (u, v) = (b - a, q - p);
    let det = u.perp_dot(v);
    let (s, t) = ((p - a).perp_dot(v) / det, (p - a).perp_dot(u) / det);
    (det != 0.0 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then(|| a + u * s)
}
