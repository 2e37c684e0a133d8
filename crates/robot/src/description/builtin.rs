//! The robots that the program carries: files like a user's, embedded.

/// Their names.
pub const NAMES: [&str; 4] = ["ur10_ag95", "ur10_suction", "panda", "pr2_left"];

/// A built-in robot's files. They name no meshes.
pub struct BuiltIn {
    /// For messages.
    pub directory: &'static str,
    pub file: &'static str,
    pub urdf: &'static str,
    pub srdf: &'static str,
}

/// The files of `robots/NAME`: `robot.yaml`, `NAME.urdf`, `NAME.srdf`.
macro_rules! built_in {
    ($name:literal) => {
        BuiltIn {
            directory: concat!("robots/", $name),
            file: include_str!(concat!("../../../../robots/", $name, "/robot.yaml")),
            urdf: include_str!(concat!("../../../../robots/", $name, "/", $name, ".urdf")),
            srdf: include_str!(concat!("../../../../robots/", $name, "/", $name, ".srdf")),
        }
    };
}

pub fn find(name: &str) -> Option<BuiltIn> {
    match name {
        "ur10_ag95" => Some(built_in!("ur10_ag95")),
        "ur10_suction" => Some(built_in!("ur10_suction")),
        "panda" => Some(built_in!("panda")),
        "pr2_left" => Some(built_in!("pr2_left")),
        _ => None,
    }
}
