//! The robots that the program carries: files like a user's, embedded.

/// Their names.
pub const NAMES: [&str; 1] = ["ur10_ag95"];

/// A built-in robot's files. They name no meshes.
pub struct BuiltIn {
    /// For messages.
    pub directory: &'static str,
    pub file: &'static str,
    pub urdf: &'static str,
    pub srdf: &'static str,
}

pub fn find(name: &str) -> Option<BuiltIn> {
    match name {
        "ur10_ag95" => Some(BuiltIn {
            directory: "robots/ur10_ag95",
            file: include_str!("../../../../robots/ur10_ag95/robot.yaml"),
            urdf: include_str!("../../../../robots/ur10_ag95/ur10_ag95.urdf"),
            srdf: include_str!("../../../../robots/ur10_ag95/ur10_ag95.srdf"),
        }),
        _ => None,
    }
}
