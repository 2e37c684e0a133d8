//! Where the hand gets to, sampled once for each robot: for choosing where a mobile base should stand
//! (Vahrenkamp, Asfour and Dillmann 2013).
//!
//! Postures are drawn evenly over the joints' ranges, and counted by where the tool is in the root
//! frame and which way it points: cells of 10 cm and, where it points level, of 30°. What is counted
//! often is reached easily. A count of 0 proves nothing.

use crate::group::spread;
use crate::kinematics::Kinematics;
use clearway_geometry::{Pose, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// Metres.
const CELL: f64 = 0.1;
/// Directions of a tool that points level; besides there are upwards and downwards.
const YAWS: usize = 12;
/// From here on a tool points up or down: the sine of 35°.
const STEEP: f64 = 0.574;
const SAMPLES: usize = 60_000;

/// How often each cell was met.
#[derive(Clone, Debug)]
pub struct Reachability {
    low: Vec3,
    /// Cells along x, y and z.
    count: [usize; 3],
    /// By x, y, z, direction.
    met: Vec<u16>,
}

/// Where a base stands on the floor: x, y (metres), yaw (radians).
pub type Placement = [f64; 3];

/// Where a tool is wanted, and which way it is to point.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    pub at: Vec3,
    pointing: Pointing,
}

/// Where an upright root stands.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    at: Vec3,
    yaw: f64,
    /// Of its x.
    ahead: Vec2,
}

/// Which way a tool points.
#[derive(Clone, Copy, Debug)]
enum Pointing {
    Level { yaw: f64 },
    Up,
    Down,
}

const CLASSES: usize = YAWS + 2;

impl Aim {
    pub fn of(tool: &Pose) -> Self {
        let z = tool.rotation.z_axis;
        let pointing = match z.z {
            up if up > STEEP => Pointing::Up,
            down if down < -STEEP => Pointing::Down,
            _ => Pointing::Level { yaw: z.y.atan2(z.x) },
        };
        Self { at: tool.translation, pointing }
    }
}

impl Root {
    /// Whatever it leans is left out.
    pub fn of(root: &Pose) -> Self {
        let ahead = root.rotation.x_axis.truncate().normalize_or(Vec2::X);
        Self { at: root.translation, yaw: ahead.to_angle(), ahead }
    }
}

impl Reachability {
    /// Of an arm whose joints have these ranges.
    pub fn of(kinematics: &Kinematics, lower: &[f64], upper: &[f64]) -> Self {
        let ranges = || {
            lower
                .iter()
                .zip(upper)
                .map(|(&l, &u)| (if l.is_finite() { l } else { -PI }, if u.is_finite() { u } else { PI }))
        };
        let mut frames = Vec::new();
        let tools: Vec<Aim> = (0..SAMPLES)
            .map(|i| {
                kinematics.frames(&spread(i, ranges()), 0.0, &mut frames);
                Aim::of(&frames[kinematics.tool])
            })
            .collect();
        let (mut low, mut high) = (Vec3::splat(f64::INFINITY), Vec3::splat(f64::NEG_INFINITY));
        for tool in &tools {
            (low, high) = (low.min(tool.at), high.max(tool.at));
        }
        let count = ((high - low) / CELL).floor().to_array().map(|n| n as usize + 1);
        let mut map = Self { low, count, met: vec![0; count[0] * count[1] * count[2] * CLASSES] };
        let zero = Root::of(&Pose::IDENTITY);
        for tool in &tools {
            if let Some(cell) = map.cell(&zero, tool) {
                map.met[cell] = map.met[cell].saturating_add(1);
            }
        }
        map
    }

    /// How often the tool was near what is aimed at, for a root that stands there.
    #[inline]
    pub fn met(&self, root: &Root, aim: &Aim) -> usize {
        self.cell(root, aim).map_or(0, |cell| usize::from(self.met[cell]))
    }

    /// No tool was met farther from the root's axis, metres.
    pub fn farthest(&self) -> f64 {
        let (low, high) =
            (self.low.truncate(), self.low.truncate() + CELL * Vec2::new(self.count[0] as f64, self.count[1] as f64));
        low.abs().max(high.abs()).length()
    }

    #[inline]
    fn cell(&self, root: &Root, aim: &Aim) -> Option<usize> {
        let off = aim.at - root.at;
        let level = Vec2::new(root.ahead.x, -root.ahead.y).rotate(off.truncate());
        let at = (level.extend(off.z) - self.low) / CELL;
        let inside = at.to_array().iter().zip(self.count).all(|(v, n)| *v >= 0.0 && *v < n as f64);
        let class = match aim.pointing {
            Pointing::Level { yaw } => {
                (((yaw - root.yaw + PI).rem_euclid(TAU) / TAU * YAWS as f64) as usize).min(YAWS - 1)
            }
            Pointing::Up => YAWS,
            Pointing::Down => YAWS + 1,
        };
        let [x, y, z] = at.to_array().map(|v| v as usize);
        inside.then(|| ((x * self.count[1] + y) * self.count[2] + z) * CLASSES + class)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Robot;
    use std::path::Path;

    /// What was sampled is met again, wherever the root stands; what is far off never.
    #[test]
    fn the_map_knows_its_samples_from_everywhere() {
        let robot = Robot::load("panda", Path::new("."), &[]).unwrap();
        let kinematics = Kinematics::new(&robot);
        let map = Reachability::of(&kinematics, &robot.lower, &robot.upper);
        let ranges = || robot.lower.iter().zip(&robot.upper).map(|(l, u)| (*l, *u));
        for (sample, turn) in (0..500).zip(0..) {
            let tool = kinematics.tool(&spread(sample, ranges()), 0.0);
            let root = Pose::from_rpy([0.0, 0.0, f64::from(turn) * 0.7], Vec3::new(f64::from(turn) * 0.1, -0.3, 0.2));
            assert!(map.met(&Root::of(&Pose::IDENTITY), &Aim::of(&tool)) > 0);
            let moved = map.met(&Root::of(&root), &Aim::of(&(root * tool)));
            assert!(moved > 0 || near_an_edge(&tool), "{sample}");
            let far = Pose::new(tool.rotation, tool.translation + Vec3::new(3.0, 0.0, 0.0));
            assert_eq!(map.met(&Root::of(&root), &Aim::of(&(root * far))), 0);
        }
    }

    /// Rounding may put it into the next cell.
    fn near_an_edge(tool: &Pose) -> bool {
        let z = tool.rotation.z_axis;
        let yaw = (z.y.atan2(z.x) + PI) / TAU * YAWS as f64;
        z.z.abs() > STEEP - 1e-6 || (yaw - yaw.round()).abs() < 1e-6
    }
}
