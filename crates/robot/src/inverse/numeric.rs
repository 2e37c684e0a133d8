//! Inverse kinematics of any chain by damped least squares (Levenberg–Marquardt on the pose error),
//! within the joints' limits.

use super::Posture;
use super::chain::{Chain, NO_JACOBIAN};
use crate::Robot;
use clearway_geometry::{Mat3, Pose, Vec3};
use std::f64::consts::PI;

/// Starts per pose; a seven-joint arm then shows most of its families of postures.
pub const STARTS: usize = 12;
/// As many more are tried while no posture is found.
const SPARE: usize = 36;
const STEPS: usize = 60;
/// A descent that has not halved its error after so many steps is given up.
const PATIENCE: usize = 8;
/// No joint moves farther in one step, radians or metres.
const LONGEST: f64 = 0.5;

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
    for i in 1..STARTS + SPARE {
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

/// What joints may be.
#[derive(Clone, Copy)]
pub struct Limits<'a> {
    pub lower: &'a [f64],
    pub upper: &'a [f64],
}

impl Limits<'_> {
    pub fn hold(&self, q: &[f64]) -> bool {
        q.iter().zip(self.lower).zip(self.upper).all(|((q, low), high)| q >= low && q <= high)
    }
}

/// The postures found from the seeds.
pub fn solve(chain: &Chain, target: &Pose, seeds: &[Posture], limits: Limits) -> Vec<Posture> {
    let mut found = Vec::new();
    for (i, seed) in seeds.iter().enumerate() {
        if i >= STARTS && !found.is_empty() {
            break;
        }
        let mut q = seed.clone();
        if descend(chain, target, &mut q, Some(limits), STEPS, super::TOLERANCE) {
            found.push(q);
        }
    }
    found
}

/// The pose error as a twist in the root frame: translation (metres), rotation (radians).
fn error(target: &Pose, at: &Pose) -> (Vec3, Vec3) {
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
    (target.translation - at.translation, w)
}

/// Moves `q` towards the target for at most `steps` steps, within the limits if there are any;
/// whether it came within `tolerance`. Joints at a limit that would leave it stand still, and the
/// others make up for them.
pub fn descend(
    chain: &Chain,
    target: &Pose,
    q: &mut [f64],
    limits: Option<Limits>,
    steps: usize,
    tolerance: f64,
) -> bool {
    let n = chain.joints;
    let mut jacobian = NO_JACOBIAN;
    let mut delta = [0.0; NO_JACOBIAN.len()];
    let mut checkpoint = f64::INFINITY;
    for step in 0..=steps {
        let tool = chain.tool(q, &mut jacobian);
        let (t, w) = error(target, &tool);
        let size = (t.length_squared() + w.length_squared()).sqrt();
        if size < tolerance {
            return true;
        }
        if step % PATIENCE == 0 {
            if size > checkpoint / 2.0 {
                return false;
            }
            checkpoint = size;
        }
        // (J Jᵀ + λ 1) y = e, then Δq = Jᵀ y. The damping dies with the error, so that the end is
        // as quick as Newton's method.
        let damping = 1e-3 * (size * size).min(0.1) + 1e-13;
        let mut still = 0u32;
        loop {
            let mut a = [[0.0; 6]; 6];
            for (i, (v, w)) in jacobian[..n].iter().enumerate() {
                if still >> i & 1 == 0 {
                    let c = [v.x, v.y, v.z, w.x, w.y, w.z];
                    for i in 0..6 {
                        for j in 0..=i {
                            a[i][j] += c[i] * c[j];
                        }
                    }
                }
            }
            for (i, row) in a.iter_mut().enumerate() {
                row[i] += damping;
            }
            let Some(y) = solve6(a, [t.x, t.y, t.z, w.x, w.y, w.z]) else { return false };
            let (force, torque) = (Vec3::new(y[0], y[1], y[2]), Vec3::new(y[3], y[4], y[5]));
            let before = still;
            for (i, (v, w)) in jacobian[..n].iter().enumerate() {
                delta[i] = if still >> i & 1 == 0 { v.dot(force) + w.dot(torque) } else { 0.0 };
                if let Some(limits) = limits
                    && (delta[i] > 0.0 && q[i] >= limits.upper[i] || delta[i] < 0.0 && q[i] <= limits.lower[i])
                {
                    still |= 1 << i;
                }
            }
            if still == before {
                break;
            }
        }
        let longest = delta[..n].iter().fold(0.0f64, |m, d| m.max(d.abs()));
        let scale = if longest > LONGEST { LONGEST / longest } else { 1.0 };
        for i in 0..n {
            q[i] += delta[i] * scale;
            if let Some(limits) = limits {
                q[i] = q[i].clamp(limits.lower[i], limits.upper[i]);
            }
        }
    }
    false
}

/// Solves a symmetric positive definite 6×6 system, of which the lower half is given, by Cholesky's
/// method.
fn solve6(mut a: [[f64; 6]; 6], b: [f64; 6]) -> Option<[f64; 6]> {
    for i in 0..6 {
        for j in 0..=i {
            let mut sum = a[i][j];
            sum -= a[i][..j].iter().zip(&a[j][..j]).map(|(x, y)| x * y).sum::<f64>();
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
