//! Runs the program as a user would, in a directory of its own.
#![allow(dead_code)]

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// The repository's example scene; the tests spoil it line by line.
pub const SHELF: &str = include_str!("../../../../examples/shelf.yaml");

/// A working directory, with the example scene in it as `shelf.yaml`.
pub struct Program {
    pub directory: TempDir,
}

/// How a run ended.
pub struct Done {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Program {
    pub fn new() -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        fs::write(directory.path().join("shelf.yaml"), SHELF).expect("a scene");
        Self { directory }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("a file");
    }

    /// `arguments`, parted by spaces.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_clearway"));
        command.current_dir(self.directory.path()).args(arguments.split_whitespace()).stdin(Stdio::null());
        command
    }

    pub fn run(&self, arguments: &str) -> Done {
        Done::of(self.command(arguments).output().expect("the program runs"))
    }

    /// Runs to exit code 0.
    pub fn does(&self, arguments: &str) -> Done {
        let done = self.run(arguments);
        assert_eq!(done.code, Some(0), "{arguments}: {}{}", done.out, done.err);
        done
    }

    /// Exit code 2, these words on stderr, nothing on stdout, and no file that was not there before.
    #[track_caller]
    pub fn refuses(&self, arguments: &str, words: &[&str]) {
        let before = self.files();
        let done = self.run(arguments);
        assert_eq!(done.code, Some(2), "{arguments}: {}{}", done.out, done.err);
        for word in words {
            assert!(done.err.contains(word), "{arguments}: {word:?} is not in: {}", done.err);
        }
        assert_eq!(done.out, "", "{arguments}");
        assert_eq!(self.files(), before, "{arguments}");
    }

    /// Names and content.
    pub fn files(&self) -> Vec<(PathBuf, Option<Vec<u8>>)> {
        let entries = fs::read_dir(self.directory.path()).expect("a directory");
        let mut files: Vec<_> =
            entries.map(|e| e.expect("an entry").path()).map(|p| (p.clone(), fs::read(p).ok())).collect();
        files.sort();
        files
    }

    pub fn json(&self, name: &str) -> Value {
        json(&self.path(name))
    }
}

impl Done {
    pub fn of(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        let done = Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) };
        assert!(!done.err.contains("panicked"), "{}", done.err);
        done
    }
}

pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON")
}

/// The example scene with `from`, which must be in it, replaced.
pub fn shelf_with(from: &str, to: &str) -> String {
    assert!(SHELF.contains(from), "{from} is not in the scene");
    SHELF.replacen(from, to, 1)
}

/// The example scene with the robot three metres off: no grasp is within reach.
pub fn far_away() -> String {
    shelf_with("    position:\n    - 0.0\n", "    position:\n    - -3.0\n")
}

/// The example scene with its opening closed: a fixture in every grasp.
pub fn closed_shelf() -> String {
    shelf_with(
        "fixtures:\n",
        "fixtures:\n- {id: curtain, box: {size: [0.045, 1.09, 0.52]}, position: [0.5225, 0, 0.85]}\n",
    )
}

/// The example scene with a lid over the tray: nothing can be put down, and that is not proved.
pub fn covered_tray() -> String {
    shelf_with("fixtures:\n", "fixtures:\n- {id: lid, box: {size: [0.5, 0.8, 0.02]}, position: [0.1, -0.82, 0.58]}\n")
}

/// Two links of spheres, 0.5 m each, that turn about z and lie in the plane.
pub const ARM: &str = r#"<robot name="planar">
  <link name="base"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="upper">
    <collision><origin xyz="0.2 0 0"/><geometry><sphere radius="0.05"/></geometry></collision>
    <collision><origin xyz="0.4 0 0"/><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <link name="fore">
    <collision><origin xyz="0.15 0 0"/><geometry><sphere radius="0.05"/></geometry></collision>
    <collision><origin xyz="0.35 0 0"/><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="2" effort="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2.5" upper="2.5" velocity="2" effort="1"/>
  </joint>
</robot>
"#;

/// A ball between the start and the goal.
pub const AROUND_A_BALL: &str = "format: clearway-motion/1
robot: {urdf: arm.urdf}
obstacles:
- {id: ball, sphere: {radius: 0.1}, position: [0.8, 0.0, 0.0]}
start: {shoulder: 1.0, elbow: 0.0}
goals:
- [-1.0, 0.0]
limits: {acceleration: 4}
";

/// The same with a wall that the upper arm cannot pass on either side.
pub fn behind_a_wall() -> String {
    AROUND_A_BALL
        .replace("obstacles:\n", "obstacles:\n- {id: wall, box: {size: [0.6, 0.02, 0.2]}, position: [0.45, 0, 0]}\n")
}
