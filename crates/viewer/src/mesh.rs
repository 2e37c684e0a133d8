//! Meshes in the page: coordinates as small integers on a grid fine enough not to be seen.

use serde::Serialize;

/// Cells along a mesh's longest side. On a link of half a metre a cell is under 0.01 mm.
const CELLS: f64 = 65_535.0;

/// The triangles of one file that the robot or the scene names. For a point cloud, no triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EmbeddedMesh {
    /// As written in the URDF or the scene file.
    pub uri: String,
    /// As in the file, before any `scale`.
    pub vertices: Vec<[f32; 3]>,
    /// Indices into `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// coordinate = `origin` + `step` · integer.
#[derive(Serialize)]
pub(crate) struct PackedMesh<'a> {
    uri: &'a str,
    origin: [f64; 3],
    step: f64,
    vertices: Vec<u32>,
    triangles: Vec<u32>,
}

impl EmbeddedMesh {
    /// The mesh on its grid; `None` if a coordinate is not finite or an index has no vertex.
    pub(crate) fn packed(&self) -> Option<PackedMesh<'_>> {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for vertex in &self.vertices {
            for k in 0..3 {
                let value = f64::from(vertex[k]);
                if !value.is_finite() {
                    return None;
                }
                (low[k], high[k]) = (low[k].min(value), high[k].max(value));
            }
        }
        if self.triangles.iter().flatten().any(|&index| index as usize >= self.vertices.len()) {
            return None;
        }
        let longest = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let step = if longest > 0.0 { longest / CELLS } else { 1.0 };
        let cell = |value: f32, k: usize| ((f64::from(value) - low[k]) / step).round() as u32;
        Some(PackedMesh {
            uri: &self.uri,
            origin: if self.vertices.is_empty() { [0.0; 3] } else { low },
            step,
            vertices: self.vertices.iter().flat_map(|v| [cell(v[0], 0), cell(v[1], 1), cell(v[2], 2)]).collect(),
            triangles: self.triangles.iter().flatten().copied().collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_moves_no_vertex_by_more_than_half_a_cell() {
        let mesh = EmbeddedMesh {
            uri: "a.stl".into(),
            vertices: vec![[-0.2, 0.0, 0.1], [0.3, 0.123_456, 0.1], [0.0, -0.4, 0.15]],
            triangles: vec![[0, 1, 2]],
        };
        let packed = mesh.packed().expect("sound");
        for (i, vertex) in mesh.vertices.iter().enumerate() {
            for (k, &value) in vertex.iter().enumerate() {
                let back = packed.origin[k] + packed.step * f64::from(packed.vertices[3 * i + k]);
                assert!((back - f64::from(value)).abs() <= 0.5 * packed.step + 1e-9);
            }
        }
        assert_eq!(packed.triangles, [0, 1, 2]);
    }

    #[test]
    fn unsound_meshes_are_refused() {
        let mesh =
            |vertex, triangle| EmbeddedMesh { uri: String::new(), vertices: vec![vertex], triangles: vec![triangle] };
        assert!(mesh([f32::NAN, 0.0, 0.0], [0, 0, 0]).packed().is_none());
        assert!(mesh([0.0; 3], [0, 0, 1]).packed().is_none());
        assert!(EmbeddedMesh::default().packed().is_some());
    }
}
