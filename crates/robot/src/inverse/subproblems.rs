//! The geometric subproblems that closed forms are made of (Paden 1986; Elias and Wen 2022).

use clearway_geometry::Vec3;
use std::f64::consts::PI;

/// A turn about an axis of unit length.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    axis: Vec3,
    sine: f64,
    cosine: f64,
}

impl Turn {
    /// The one that turns `p` onto `q`, as well as can be.
    pub fn onto(axis: Vec3, p: Vec3, q: Vec3) -> Self {
        let (sine, cosine) = (axis.dot(p.cross(q)), p.dot(q) - axis.dot(p) * axis.dot(q));
        let size = (sine * sine + cosine * cosine).sqrt();
        // Anything is as good where both are along the axis.
        if size > 0.0 {
            Self { axis, sine: sine / size, cosine: cosine / size }
        } else {
            Self { axis, sine: 0.0, cosine: 1.0 }
        }
    }

    /// Radians in (−π, π].
    pub fn angle(&self) -> f64 {
        self.sine.atan2(self.cosine)
    }

    pub fn forth(&self, v: Vec3) -> Vec3 {
        self.turned(v, self.sine)
    }

    pub fn back(&self, v: Vec3) -> Vec3 {
        self.turned(v, -self.sine)
    }

    fn turned(&self, v: Vec3, sine: f64) -> Vec3 {
        v * self.cosine + self.axis.cross(v) * sine + self.axis * (self.axis.dot(v) * (1.0 - self.cosine))
    }
}

/// What a joint may be, whole turns aside; asked for turns, of which the angle is not known.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    sine_of_middle: f64,
    cosine_of_middle: f64,
    /// No turn is farther from the middle than the one of which this is the cosine.
    least: f64,
}

impl Range {
    pub fn new(lower: f64, upper: f64) -> Self {
        const ROUNDING: f64 = 1e-9;
        let half = (upper - lower) / 2.0 + ROUNDING;
        if half >= PI {
            return Self { sine_of_middle: 0.0, cosine_of_middle: 1.0, least: f64::NEG_INFINITY };
        }
        let (sine_of_middle, cosine_of_middle) = ((lower + upper) / 2.0).sin_cos();
        Self { sine_of_middle, cosine_of_middle, least: half.cos() }
    }

    pub fn holds(&self, turn: &Turn) -> bool {
        turn.cosine * self.cosine_of_middle + turn.sine * self.sine_of_middle >= self.least
    }
}

/// θ with `rot(k, θ) p = q`, as well as can be; radians in (−π, π].
pub fn turn_onto(k: Vec3, p: Vec3, q: Vec3) -> f64 {
    k.dot(p.cross(q)).atan2(p.dot(q) - k.dot(p) * k.dot(q))
}

/// The θ with `h · rot(k, θ) p = d`, for one `h`, `k` and `p` and many `d`: d = rest + size · cos(θ − middle).
#[derive(Clone, Copy, Debug)]
pub struct TurnToHeight {
    axis: Vec3,
    rest: f64,
    size: f64,
    sine_of_middle: f64,
    cosine_of_middle: f64,
}

impl TurnToHeight {
    pub fn new(h: Vec3, k: Vec3, p: Vec3) -> Self {
        let rest = h.dot(k) * k.dot(p);
        let (sine, cosine) = (h.dot(k.cross(p)), h.dot(p) - rest);
        let size = sine.hypot(cosine);
        Self { axis: k, rest, size, sine_of_middle: sine / size, cosine_of_middle: cosine / size }
    }

    /// None, one (twice, when they coincide) or two.
    pub fn to(&self, d: f64) -> Option<[Turn; 2]> {
        let wanted = d - self.rest;
        // Just out of reach counts as the end of reach: rounding must not lose a touching solution.
        if self.size < 1e-12 || wanted.abs() > self.size + 1e-9 {
            return None;
        }
        let cosine = (wanted / self.size).clamp(-1.0, 1.0);
        let sine = (1.0 - cosine * cosine).sqrt();
        let (s, c) = (self.sine_of_middle, self.cosine_of_middle);
        Some([sine, -sine].map(|sine| Turn {
            axis: self.axis,
            sine: s * cosine + c * sine,
            cosine: c * cosine - s * sine,
        }))
    }
}

/// The point of the first line that is on the second, within `tolerance` metres; lines as point and
/// unit direction. None if they are parallel.
pub fn meeting_point(a: Vec3, u: Vec3, b: Vec3, v: Vec3, tolerance: f64) -> Option<Vec3> {
    let normal = u.cross(v);
    let size = normal.length_squared();
    if size < 1e-8 || ((b - a).dot(normal) / size.sqrt()).abs() > tolerance {
        return None;
    }
    let t = (b - a).cross(v).dot(normal) / size;
    Some(a + u * t)
}
