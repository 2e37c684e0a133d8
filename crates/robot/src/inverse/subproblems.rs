//! The geometric subproblems that closed forms are made of (Paden 1986; Elias and Wen 2022).

use clearway_geometry::Vec3;

/// θ with `rot(k, θ) p = q`, as well as can be; radians in (−π, π].
pub fn turn_onto(k: Vec3, p: Vec3, q: Vec3) -> f64 {
    k.dot(p.cross(q)).atan2(p.dot(q) - k.dot(p) * k.dot(q))
}

/// The θ with `h · rot(k, θ) p = d`: none, one (twice, when they coincide) or two.
pub fn turn_to_height(h: Vec3, k: Vec3, p: Vec3, d: f64) -> Option<[f64; 2]> {
    let sine = h.dot(k.cross(p));
    let cosine = h.dot(p) - h.dot(k) * k.dot(p);
    let size = sine.hypot(cosine);
    let wanted = d - h.dot(k) * k.dot(p);
    // Just out of reach counts as the end of reach: rounding must not lose a touching solution.
    if size < 1e-12 || wanted.abs() > size + 1e-9 {
        return None;
    }
    let middle = sine.atan2(cosine);
    let aside = (wanted / size).clamp(-1.0, 1.0).acos();
    Some([middle + aside, middle - aside])
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
