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

impl Reachability {
    /// Of an arm whose joints have these ranges.
    pub fn of(kinematics: &Kinematics, lower: &[f64], upper: &[f64]) -> Self {
        let ranges = || {
            lower.iter().zip(upper).map(|(&l, &u)| (if l.is_finite() { l } else { -PI }, if u.is_finite() { u } else { PI }))
        };
        let mut frames = Vec::new();
        let tools: Vec<Pose> = (0..SAMPLES)
            .map(|i| {
                kinematics.frames(&spread(i, ranges()), 0.0, &mut frames);
                frames[kinematics.tool]
            })
            .collect();
        let (mut low, mut high) = (Vec3::splat(f64::INFINITY), Vec3::splat(f64::NEG_INFINITY));
        for tool in &tools {
            (low, high) = (low.min(tool.translation), high.max(tool.translation));
        }
        let count = ((high - low) / CELL).floor().to_array().map(|n| n as usize + 1);
        let mut map = Self { low, count, met: vec![0; count[0] * count[1] * count[2] * CLASSES] };
        for tool in &tools {
            if let Some(cell) = map.cell(tool) {
                map.met[cell] = map.met[cell].saturating_add(1);
            }
        }
        map
    }

    /// How often the tool was near this pose, pointing like this.
    pub fn met(&self, root_from_tool: &Pose) -> usize {
        self.cell(root_from_tool).map_or(0, |cell| usize::from(self.met[cell]))
    }

    /// No tool was met farther from the root's axis, metres.
    pub fn farthest(&self) -> f64 {
        let (low, high) = (self.low.truncate(), self.low.truncate() + CELL * Vec2::new(self.count[0] as f64, self.count[1] as f64));
        low.abs().max(high.abs()).length()
    }

    fn cell(&self, root_from_tool: &Pose) -> Option<usize> {
        let at = (root_from_tool.translation - self.low) / CELL;
        let inside = at.to_array().iter().zip(self.count).all(|(v, n)| *v >= 0.0 && *v < n as f64);
        let class = Pointing::of(root_from_tool).class();
        inside.then(|| self.index(at.x as usize, at.y as usize, at.z as usize, class))
    }

    fn index(&self, x: usize, y: usize, z: usize, class: usize) -> usize {
        ((x * self.count[1] + y) * self.count[2] + z) * CLASSES + class
    }
}

/// Which way a tool points.
enum Pointing {
    Level { yaw: f64 },
    Up,
    Down,
}

const CLASSES: usize = YAWS + 2;

impl Pointing {
    fn of(tool: &Pose) -> Self {
        let z = tool.rotation.z_axis;
        match z.z {
            up if up > STEEP => Self::Up,
            down if down < -STEEP => Self::Down,
            _ => Self::Level { yaw: z.y.atan2(z.x) },
        }
    }

    fn class(&self) -> usize {
        match self {
            Self::Level { yaw } => (((yaw + PI) / TAU * YAWS as f64) as usize).min(YAWS - 1),
            Self::Up => YAWS,
            Self::Down => YAWS + 1,
        }
    }
}
