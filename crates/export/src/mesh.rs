//! What is in a file that a scene names.

/// A mesh's triangles; of a point cloud, points alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// As written in the scene file.
    pub uri: String,
    /// Metres, as in the file, before any `scale`.
    pub vertices: Vec<[f64; 3]>,
    /// Indices into `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}
