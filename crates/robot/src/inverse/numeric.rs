//! Inverse kinematics of any chain by damped least squares (Levenberg–Marquardt on the pose error).

use super::Posture;
use crate::Robot;
use crate::kinematics::{JointAxis, Kinematics};
use clearway_geometry::{Mat3, Pose, Vec3};
use std::f64::consts::PI;

/// Starts per pose; a seven-joint arm then shows most of its families of postures.
const SEEDS: usize = 12;
const STEPS: usize = 60;

/// Postures spread evenly over the joint ranges (Halton), the resting posture first.
pub fn seeds(robot: &Robot) -> Vec<Posture> {
    const PRIMES: [usize; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];
    let halton = |mut i: usize, base: usize| {
        let (mut f, mut r) = (1.0, 0.0);
        while i > 0 {
            f /= base as f64;
            r += f * (i % base) as f64;
            i /= base;
        }
        r
    };
    let mut seeds = vec![robot.home.clone()];
    for i in 1..SEEDS {
        seeds.push(
            (0..robot.arm.len())
                .map(|j| {
                    let (low, high) = (robot.lower[j].max(-PI), robot.upper[j].min(PI));
                    low + (high - low) * halton(i + 20, PRIMES[j % PRIMES.len()])
                })
                .collect(),
        );
    }
    seeds
}

/// The pose error as a twist in the root frame: translation (metres), rotation (radians).
fn error(target: &Pose, at: &Pose) -> [f64; 6] {
    let t = target.translation - at.translation;
    let r = target.rotation * at.rotation.transpose();
    let axis = Vec3::new(r.y_axis.z - r.z_axis.y, r.z_axis.x - r.x_axis.z, r.x_axis.y - r.y_axis.x);
    let trace = r.x_axis.x + r.y_axis.y + r.z_axis.z;
    let sin = axis.length();
    let angle = sin.atan2(trace - 1.0);
    let w = if sin > 1e-12 {
        axis * (angle / sin)
    } else if trace > 0.0 {
        axis / 2.0
    } else {
        // Half a turn: the axis is the column of r + 1 that is longest.
        let m = r + Mat3::IDENTITY;
        let c = [m.x_axis, m.y_axis, m.z_axis].into_iter().max_by(|a, b| a.length().total_cmp(&b.length()));
        c.unwrap_or(Vec3::X).normalize_or_zero() * PI
    };
    [t.x, t.y, t.z, w.x, w.y, w.z]
}

/// Moves `q` towards the target for at most `steps` steps; whether it came within `tolerance`.
/// Limits are not considered.
pub fn descend(kinematics: &Kinematics, target: &Pose, q: &mut [f64], steps: usize, tolerance: f64) -> bool {
    iterate(kinematics, target, q, None, steps, tolerance)
}

/// The same within limits, from far away.
pub fn descend_within(kinematics: &Kinematics, target: &Pose, q: &mut [f64], lower: &[f64], upper: &[f64]) -> bool {
    iterate(kinematics, target, q, Some((lower, upper)), STEPS, super::TOLERANCE)
}

fn iterate(
    kinematics: &Kinematics,
    target: &Pose,
    q: &mut [f64],
    limits: Option<(&[f64], &[f64])>,
    steps: usize,
    tolerance: f64,
) -> bool {
    let n = kinematics.arm_joints;
    let mut frames = Vec::new();
    let mut axes: Vec<JointAxis> = Vec::new();
    let mut jacobian = vec![[0.0; 6]; n];
    for step in 0..=steps {
        kinematics.frames(q, 0.0, &mut frames);
        let tool = frames[kinematics.tool];
        let e = error(target, &tool);
        let size = e.iter().map(|x| x * x).sum::<f64>().sqrt();
        if size < tolerance {
            return true;
        }
        if step == steps {
            return false;
        }
        kinematics.axes(&frames, &mut axes);
        for (column, axis) in jacobian.iter_mut().zip(&axes) {
            let (v, w) = if axis.slides {
                (axis.direction, Vec3::ZERO)
            } else {
                (axis.direction.cross(tool.translation - axis.origin), axis.direction)
            };
            *column = [v.x, v.y, v.z, w.x, w.y, w.z];
        }
        // (J Jᵀ + λ 1) y = e, then Δq = Jᵀ y. The damping dies with the error, so that the end is
        // as quick as Newton's method.
        let damping = 1e-3 * (size * size).min(0.1);
        let mut a = [[0.0; 6]; 6];
        for column in &jacobian {
            for i in 0..6 {
                for j in 0..6 {
                    a[i][j] += column[i] * column[j];
                }
            }
        }
        for (i, row) in a.iter_mut().enumerate() {
            row[i] += damping + 1e-14;
        }
        let Some(y) = solve6(a, e) else { return false };
        let mut longest = 0.0f64;
        let delta: Vec<f64> = jacobian
            .iter()
            .map(|c| {
                let d: f64 = c.iter().zip(&y).map(|(c, y)| c * y).sum();
                longest = longest.max(d.abs());
                d
            })
            .collect();
        let scale = if longest > 0.5 { 0.5 / longest } else { 1.0 };
        for (i, d) in delta.iter().enumerate() {
            q[i] += d * scale;
            if let Some((lower, upper)) = limits {
                q[i] = q[i].clamp(lower[i], upper[i]);
            }
        }
    }
    false
}

/// Solves a symmetric positive definite 6×6 system by Cholesky's method.
fn solve6(mut a: [[f64; 6]; 6], b: [f64; 6]) -> Option<[f64; 6]> {
    for i in 0..6 {
        for j in 0..=i {
            let mut sum = a[i][j];
            for k in 0..j {
                sum -= a[i][k] * a[j][k];
            }
            if i == j {
                if sum <= 0.0 {
                    return None;
                }
                a[i][i] = sum.sqrt();
            } else {
                a[i][j] = sum / a[j][j];
            }
        }
    }
    let mut x = b;
    for i in 0..6 {
        for k in 0..i {
            x[i] -= a[i][k] * x[k];
        }
        x[i] /= a[i][i];
    }
    for i in (0..6).rev() {
        for k in i + 1..6 {
            x[i] -= a[k][i] * x[k];
        }
        x[i] /= a[i][i];
    }
    Some(x)
}
