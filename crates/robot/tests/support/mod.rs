//! A small robot in a temporary directory, to be broken one line at a time.

use clearway_files::FileError;
use clearway_robot::Robot;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

pub const URDF: &str = r#"<robot name="small">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <joint name="turn" type="continuous">
    <parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.1"/><axis xyz="0 0 2"/><limit velocity="1.0" effort="10"/>
  </joint>
  <link name="arm"><collision><geometry><mesh filename="meshes/arm.stl" scale="0.5 1 1"/></geometry></collision></link>
  <joint name="lift" type="prismatic">
    <parent link="arm"/><child link="wrist"/>
    <origin xyz="0 0 0.2" rpy="0 0 0"/><axis xyz="0 0 1"/><limit lower="0.1" upper="0.5" velocity="0.2" effort="10"/>
  </joint>
  <link name="wrist"/>
  <joint name="mount" type="fixed"><parent link="wrist"/><child link="tool"/></joint>
  <link name="tool"/>
  <joint name="left" type="prismatic">
    <parent link="wrist"/><child link="left_finger"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.04" velocity="0.1" effort="10"/>
  </joint>
  <link name="left_finger"><collision><origin xyz="0 0 0.05"/><geometry><capsule radius="0.01" length="0.05"/></geometry></collision></link>
  <joint name="right" type="prismatic">
    <parent link="wrist"/><child link="right_finger"/>
    <axis xyz="-1 0 0"/><limit lower="0" upper="0.04" velocity="0.1" effort="10"/>
    <mimic joint="left" multiplier="1"/>
  </joint>
  <link name="right_finger"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <joint name="camera_tilt" type="revolute">
    <parent link="base"/><child link="camera"/>
    <axis xyz="0 1 0"/><limit lower="0.2" upper="1.0" velocity="1" effort="1"/>
  </joint>
  <link name="camera"/>
</robot>
"#;

pub const FILE: &str = r#"format: clearway-robot/1
urdf: small.urdf
srdf: small.srdf
packages: {}
arm: {base: base, tip: wrist}
fixed: {}
home: {turn: 0.5}
limits: {acceleration: {turn: 3.0}, jerk: 50.0}
hand:
  kind: parallel
  frame: tool
  joint: left
  opening: {"0.0": 0.0, "0.04": 0.08}
  links: [left_finger, right_finger, wrist]
  base_radius: 0.05
  finger_thickness: 0.01
grasps: {kind: side, yaws: 12, heights: [0.5], standoff: 0.1}
mobile: none
"#;

pub const SRDF: &str = r#"<robot name="small">
  <group name="arm"><joint name="turn"/></group>
  <group_state name="up" group="arm"><joint name="lift" value="0.4"/></group_state>
  <disable_collisions link1="left_finger" link2="base" reason="Never"/>
</robot>
"#;

/// One edge longer, so that a scale shows.
pub fn stl(size: [f32; 3]) -> Vec<u8> {
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { size[axis] } else { 0.0 });
    let faces: [[usize; 3]; 12] = [
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
    let mut bytes = vec![0; 80];
    bytes.extend(12_u32.to_le_bytes());
    for face in faces {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|&i| corner(i)).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

/// The small robot, written out with these texts.
pub fn written(file: &str, urdf: &str, srdf: &str) -> TempDir {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("meshes")).expect("a directory");
    fs::write(at("meshes/arm.stl"), stl([0.1, 0.1, 0.2])).expect("a mesh");
    fs::write(at("robot.yaml"), file).expect("a robot file");
    fs::write(at("small.urdf"), urdf).expect("a URDF");
    fs::write(at("small.srdf"), srdf).expect("an SRDF");
    directory
}

pub fn load_from(directory: &Path) -> Result<Robot, FileError> {
    Robot::load("robot.yaml", directory, &[])
}

/// `text` with `from`, which must be in it, replaced by `to`.
pub fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from} is not in the text");
    text.replacen(from, to, 1)
}
