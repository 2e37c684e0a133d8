//! Convex hulls of point clouds and of the connected parts of triangle meshes.
//!
//! The hull itself is parry's; this module hides its failure modes.

use crate::convex::Hull;
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// Why no hull could be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HullError {
    /// Fewer than four points, or all in one plane: the hull has no volume.
    Flat,
    /// A coordinate is NaN or infinite, or an index is out of range.
    Invalid,
}

/// The convex hull of `points`.
pub fn convex_hull(points: &[DVec3]) -> Result<Hull, HullError> {
    use parry3d_f64::math::Vector;
    if points.iter().any(|p| !p.is_finite()) {
        return Err(HullError::Invalid);
    }
    if points.len() < 4 {
        return Err(HullError::Flat);
    }
    let theirs: Vec<Vector> = points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
    let (vertices, triangles) = parry3d_f64::transformation::try_convex_hull(&theirs).map_err(|_| HullError::Flat)?;
    let points: Vec<DVec3> = vertices.iter().map(|v| DVec3::new(v.x, v.y, v.z)).collect();
    let centre = points.iter().sum::<DVec3>() / points.len() as f64;
    let size = points.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let mut planes: Vec<(DVec3, f64)> = Vec::new();
    let mut seen: HashSet<[i64; 4]> = HashSet::new();
    for t in &triangles {
        let [a, b, c] = t.map(|i| points[i as usize]);
        let normal = (b - a).cross(c - a);
        if normal.length() <= 1e-12 * size * size {
            continue;
        }
        let normal = normal.normalize();
        // A hair outside the corners, so that rounding leaves none of them out.
        let offset = [a, b, c].iter().map(|p| p.dot(normal)).fold(f64::NEG_INFINITY, f64::max) + 1e-9 * size;
        // Triangles of one flat face share their plane.
        let key = [normal.x, normal.y, normal.z, offset / size].map(|v| (v * 1e7).round() as i64);
        if seen.insert(key) {
            planes.push((normal, offset));
        }
    }
    if planes.len() < 4 || is_flat(&points) {
        return Err(HullError::Flat);
    }
    Ok(Hull { points, triangles, planes })
}

/// Whether points span less than a tenth of a micrometre in some direction: the direction across
/// their two widest ones is looked at.
fn is_flat(points: &[DVec3]) -> bool {
    let first = points[0];
    let far = |score: &dyn Fn(&DVec3) -> f64| {
        points.iter().copied().max_by(|a, b| score(a).total_cmp(&score(b))).unwrap_or(first)
    };
    let second = far(&|p| p.distance(first));
    let along = (second - first).normalize_or_zero();
    let third = far(&|p| (*p - first).cross(along).length());
    let normal = along.cross(third - first).normalize_or_zero();
    let heights = points.iter().map(|p| (*p - first).dot(normal));
    let (low, high) = heights.fold((0.0f64, 0.0f64), |(l, h), d| (l.min(d), h.max(d)));
    high - low < 1e-7
}

/// The hulls of a triangle mesh's connected parts (corners closer than 1 µm are one), largest
/// first. Flat parts are left out, unless all are.
pub fn connected_hulls(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Vec<Hull>, HullError> {
    if triangles.iter().flatten().any(|&i| i as usize >= vertices.len()) || vertices.iter().any(|v| !v.is_finite()) {
        return Err(HullError::Invalid);
    }
    let mut merged: HashMap<[i64; 3], usize> = HashMap::new();
    let mut points: Vec<DVec3> = Vec::new();
    let index: Vec<usize> = vertices
        .iter()
        .map(|v| {
            let key = (*v * 1e6).round();
            *merged.entry([key.x as i64, key.y as i64, key.z as i64]).or_insert_with(|| {
                points.push(*v);
                points.len() - 1
            })
        })
        .collect();
    let mut parent: Vec<usize> = (0..points.len()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    let mut used = vec![false; points.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| index[i as usize]);
        for i in [a, b, c] {
            used[i] = true;
        }
        for other in [b, c] {
            let (x, y) = (root(&mut parent, a), root(&mut parent, other));
            parent[x.max(y)] = x.min(y);
        }
    }
    let mut parts: Vec<Vec<DVec3>> = Vec::new();
    let mut part_of: HashMap<usize, usize> = HashMap::new();
    for i in 0..points.len() {
        if used[i] {
            let r = root(&mut parent, i);
            let part = *part_of.entry(r).or_insert_with(|| {
                parts.push(Vec::new());
                parts.len() - 1
            });
            parts[part].push(points[i]);
        }
    }
    let mut hulls: Vec<Hull> = parts.iter().filter_map(|p| convex_hull(p).ok()).collect();
    if hulls.is_empty() {
        // Flat sheets that enclose something only together.
        let all: Vec<DVec3> = (0..points.len()).filter(|&i| used[i]).map(|i| points[i]).collect();
        hulls.push(convex_hull(&all)?);
    }
    hulls.sort_by_key(|h| std::cmp::Reverse(h.points.len()));
    Ok(hulls)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(offset: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let v = (0..8).map(|i| offset + DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)).collect();
        let t = vec![
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        (v, t)
    }

    #[test]
    fn two_cubes_are_two_hulls() {
        let (mut v, mut t) = cube(DVec3::ZERO);
        let (v2, t2) = cube(DVec3::new(3.0, 0.0, 0.0));
        t.extend(t2.iter().map(|t| t.map(|i| i + 8)));
        v.extend(v2);
        let hulls = connected_hulls(&v, &t).unwrap();
        assert_eq!(hulls.len(), 2);
        assert!(hulls.iter().all(|h| h.points.len() == 8 && h.planes.len() == 6), "{hulls:?}");
    }

    #[test]
    fn flat_and_bad_input_is_told() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
        assert_eq!(convex_hull(&square).unwrap_err(), HullError::Flat);
        assert_eq!(convex_hull(&square[..2]).unwrap_err(), HullError::Flat);
        assert_eq!(convex_hull(&[DVec3::NAN; 5]).unwrap_err(), HullError::Invalid);
        assert_eq!(connected_hulls(&square, &[[0, 1, 9]]).unwrap_err(), HullError::Invalid);
    }
}
