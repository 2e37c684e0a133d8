//! The fastest pace along a motion whose joints' velocity, acceleration and jerk are limited, by an
//! interior-point method.
//!
//! Given a motion q(τ) from rest to rest, smooth but not fast, another clock is looked for: x(τ) is
//! the square of dτ/dt. With dots over t and primes over τ
//!
//! ```text
//! q̇ = q' √x      q̈ = q'' x + q' x'/2      q⃛ = (q''' x + 3/2 q'' x' + 1/2 q' x'') √x
//! ```
//!
//! so velocity and acceleration limits are linear in x and its differences, and the jerk limit
//! nearly so. The time, ∫ dτ/√x, is made least by Newton's method with a logarithmic barrier whose
//! weight falls with every step. A constraint knows three neighbouring x: the Hessian has five
//! diagonals. Rows are in columns over the nodes, so that the machine's lanes take many at once. At both ends q' is zero, so nothing has to be said about rest there.

use crate::Limits;
use fearless_simd::{Level, dispatch};

/// A motion at even times τ: derivatives in the middle of every step, one row of joints each.
pub struct Motion {
    pub joints: usize,
    /// Length of a step, seconds.
    pub step: f64,
    /// First and second derivatives over τ.
    pub first: Vec<f64>,
    pub second: Vec<f64>,
}

/// What is known of the nodes besides their constraints.
pub struct Bounds {
    /// Limits have to be kept to as if times were to be stretched by this factor afterwards.
    pub slower: Vec<f64>,
    /// The largest x.
    pub most: Vec<f64>,
}

/// Rows `|left·x₋ + middle·x + right·x₊| ≤ 1`, for each joint in turn one per inner node.
#[derive(Default)]
struct Linear {
    left: Vec<f64>,
    middle: Vec<f64>,
    right: Vec<f64>,
}

impl Linear {
    fn push(&mut self, left: f64, middle: f64, right: f64) {
        self.left.push(left);
        self.middle.push(middle);
        self.right.push(right);
    }

    /// One joint's rows.
    #[inline(always)]
    fn joint(&self, joint: usize, inner: usize) -> [&[f64]; 3] {
        [&self.left, &self.middle, &self.right].map(|c| &c[joint * inner..][..inner])
    }
}

/// Acceleration's rows, and jerk's, to be multiplied by √x.
#[derive(Default)]
struct Rows {
    acceleration: Linear,
    jerk: Linear,
}

/// By inner node: what the barrier adds to the gradient of x₋, x and x₊ and to the Hessian's entries
/// (−,−), (−,0), (−,+), (0,0), (0,+), (+,+).
struct Push {
    gradient: [Vec<f64>; 3],
    hessian: [Vec<f64>; 6],
}

/// The barrier −ln(1 − z) − ln(1 + z): its first two derivatives.
#[inline(always)]
fn barrier(z: f64) -> (f64, f64) {
    let w = 1.0 / (1.0 - z * z);
    (2.0 * z * w, 2.0 * (1.0 + z * z) * w * w)
}

impl Push {
    fn new(inner: usize) -> Self {
        let zeros = || vec![0.0; inner];
        Self { gradient: std::array::from_fn(|_| zeros()), hessian: std::array::from_fn(|_| zeros()) }
    }

    /// Adds up all rows' barriers to second order. `roots` are √x at inner nodes.
    #[inline(always)]
    fn set(&mut self, rows: &Rows, joints: usize, x: &[f64], roots: &[f64]) {
        let inner = roots.len();
        for sums in self.gradient.iter_mut().chain(&mut self.hessian) {
            sums.fill(0.0);
        }
        let (before, here, after) = (&x[..inner], &x[1..][..inner], &x[2..][..inner]);
        let [g0, g1, g2] = self.gradient.each_mut().map(|g| &mut g[..inner]);
        let [h0, h1, h2, h3, h4, h5] = self.hessian.each_mut().map(|h| &mut h[..inner]);
        for joint in 0..joints {
            let [al, am, ar] = rows.acceleration.joint(joint, inner);
            let [jl, jm, jr] = rows.jerk.joint(joint, inner);
            for k in 0..inner {
                let (l, m, r) = (al[k], am[k], ar[k]);
                let (first, second) = barrier(l * before[k] + m * here[k] + r * after[k]);
                let g = jl[k] * before[k] + jm[k] * here[k] + jr[k] * after[k];
                let (jerk_first, jerk_second) = barrier(g * roots[k]);
                let (a, b, c) = (jl[k] * roots[k], jm[k] * roots[k] + g / (2.0 * roots[k]), jr[k] * roots[k]);
                g0[k] += first * l + jerk_first * a;
                g1[k] += first * m + jerk_first * b;
                g2[k] += first * r + jerk_first * c;
                h0[k] += second * l * l + jerk_second * a * a;
                h1[k] += second * l * m + jerk_second * a * b;
                h2[k] += second * l * r + jerk_second * a * c;
                h3[k] += second * m * m + jerk_second * b * b;
                h4[k] += second * m * r + jerk_second * b * c;
                h5[k] += second * r * r + jerk_second * c * c;
            }
        }
    }
}

/// By how much the barrier's weight falls with each step.
const LESS: f64 = 0.4;

/// What a change of a change of pace costs beside the time: keeps x from jumping where a motion is so
/// slow, near its ends, that no joint's limit would notice.
const EVEN: f64 = 0.3;

/// The fastest pace found: x at both ends of every step. The barrier's weight falls `from` … `to`.
pub fn fastest(motion: &Motion, limits: &Limits, bounds: &Bounds, weights: (f64, f64)) -> Vec<f64> {
    // Plain loops, compiled for what the machine has.
    dispatch!(Level::new(), simd => {
        let _ = simd;
        search(motion, limits, bounds, weights)
    })
}

#[inline(always)]
fn search(motion: &Motion, limits: &Limits, bounds: &Bounds, (from, to): (f64, f64)) -> Vec<f64> {
    let n = motion.joints;
    let steps = motion.first.len() / n;
    let inner = steps - 1;
    let rows = rows(motion, limits, &bounds.slower);
    let caps = caps(motion, limits, bounds);
    // As slow as needed for nothing to be near its limit.
    let mut slow = caps.iter().copied().fold(f64::INFINITY, f64::min);
    for i in 0..n * inner {
        let (a, j) = (&rows.acceleration, &rows.jerk);
        slow = slow.min((a.left[i] + a.middle[i] + a.right[i]).abs().recip());
        let jerk = (j.left[i] + j.middle[i] + j.right[i]).abs();
        // x^{3/2} jerk ≤ 1, asked without a root where it holds anyway.
        if slow * slow * slow * jerk * jerk > 1.0 {
            slow = jerk.recip().powf(2.0 / 3.0);
        }
    }
    let mut x = vec![0.9 * slow; steps + 1];
    let mut next = x.clone();
    let mut roots = vec![0.0; inner];
    let mut gradient = vec![0.0; steps + 1];
    let mut diagonals = vec![[0.0; 3]; steps + 1];
    let mut push = Push::new(inner);
    let unit = slow.sqrt();
    let mut weight = from;
    while weight > to {
        // The time's share, and the caps'.
        for k in 0..=steps {
            let y = 1.0 / x[k];
            let time = unit * y.sqrt() / weight;
            let room = 1.0 / (caps[k] - x[k]);
            gradient[k] = room - 0.5 * time * y;
            diagonals[k] = [room * room + 0.75 * time * y * y, 0.0, 0.0];
        }
        for (root, x) in roots.iter_mut().zip(&x[1..]) {
            *root = x.sqrt();
        }
        push.set(&rows, n, &x, &roots);
        // Even paces are preferred.
        let stiff = EVEN / (weight * slow * slow);
        for k in 1..steps {
            let bend = stiff * (x[k - 1] - 2.0 * x[k] + x[k + 1]);
            let [g0, g1, g2] = push.gradient.each_ref().map(|g| g[k - 1]);
            let [h0, h1, h2, h3, h4, h5] = push.hessian.each_ref().map(|h| h[k - 1]);
            gradient[k - 1] += bend + g0;
            gradient[k] += g1 - 2.0 * bend;
            gradient[k + 1] += bend + g2;
            diagonals[k - 1][0] += stiff + h0;
            diagonals[k - 1][1] += h1 - 2.0 * stiff;
            diagonals[k - 1][2] += stiff + h2;
            diagonals[k][0] += 4.0 * stiff + h3;
            diagonals[k][1] += h4 - 2.0 * stiff;
            diagonals[k + 1][0] += stiff + h5;
        }
        solve(&mut diagonals, &mut gradient);
        // As far as that leads while everything stays within its limits.
        let mut far = 1.0;
        for _ in 0..40 {
            for k in 0..=steps {
                next[k] = x[k] - far * gradient[k];
            }
            if within(&next, &x, &caps, &rows, n, &mut roots) {
                std::mem::swap(&mut x, &mut next);
                break;
            }
            far *= 0.6;
        }
        weight *= LESS;
    }
    x
}

/// Whether limits hold, and x is not much less than it was. `roots` is room for √x.
#[inline(always)]
fn within(x: &[f64], before: &[f64], caps: &[f64], rows: &Rows, joints: usize, roots: &mut [f64]) -> bool {
    if !x.iter().zip(before).zip(caps).all(|((x, b), cap)| *x > 0.2 * b && x < cap) {
        return false;
    }
    let inner = roots.len();
    for (root, x) in roots.iter_mut().zip(&x[1..]) {
        *root = x.sqrt();
    }
    let (before, here, after) = (&x[..inner], &x[1..][..inner], &x[2..][..inner]);
    // Loops, not closures: those would not be compiled for what the machine has.
    for joint in 0..joints {
        let [al, am, ar] = rows.acceleration.joint(joint, inner);
        let [jl, jm, jr] = rows.jerk.joint(joint, inner);
        let mut beyond = 0_u64;
        for k in 0..inner {
            let a = al[k] * before[k] + am[k] * here[k] + ar[k] * after[k];
            let j = (jl[k] * before[k] + jm[k] * here[k] + jr[k] * after[k]) * roots[k];
            beyond += u64::from(!(a.abs() < 1.0 && j.abs() < 1.0));
        }
        if beyond > 0 {
            return false;
        }
    }
    true
}

#[inline(always)]
fn rows(motion: &Motion, limits: &Limits, slower: &[f64]) -> Rows {
    let (n, step) = (motion.joints, motion.step);
    let steps = motion.first.len() / n;
    let mut rows = Rows::default();
    for j in 0..n {
        let (acceleration, jerk) = (1.0 / limits.acceleration[j], 1.0 / limits.jerk[j]);
        for k in 1..steps {
            let c = slower[k];
            let (before, after) = ((k - 1) * n + j, k * n + j);
            let first = (motion.first[before] + motion.first[after]) / 2.0;
            let second = (motion.second[before] + motion.second[after]) / 2.0;
            let third = (motion.second[after] - motion.second[before]) / step;
            let (a, i) = (c * c * acceleration, c * c * c * jerk);
            let slope = first / (4.0 * step);
            let (tilt, bend) = (0.75 * second / step, 0.5 * first / (step * step));
            rows.acceleration.push(-slope * a, second * a, slope * a);
            rows.jerk.push((bend - tilt) * i, (third - 2.0 * bend) * i, (bend + tilt) * i);
        }
    }
    rows
}

/// The largest x at each node: by velocity, and at both ends by jerk.
fn caps(motion: &Motion, limits: &Limits, bounds: &Bounds) -> Vec<f64> {
    let n = motion.joints;
    let steps = motion.first.len() / n;
    let mut caps: Vec<f64> = vec![1e4; steps + 1];
    for k in 0..steps {
        for j in 0..n {
            let cap = (limits.velocity[j] / motion.first[k * n + j]).powi(2);
            caps[k] = caps[k].min(cap);
            caps[k + 1] = caps[k + 1].min(cap);
        }
    }
    for (end, k) in [(0, 0), (steps, steps - 1)] {
        for j in 0..n {
            let third = motion.second[k * n + j] / (motion.step / 2.0);
            caps[end] = caps[end].min((limits.jerk[j] / third.abs()).powf(2.0 / 3.0));
        }
    }
    let slower = caps.iter().zip(&bounds.slower).map(|(x, c)| x / (c * c));
    slower.zip(&bounds.most).map(|(x, most)| x.min(*most)).collect()
}

/// Solves a symmetric positive definite system of five diagonals; `rows[k]` holds the entries
/// (k,k), (k,k+1), (k,k+2). Leaves the solution in `values`.
#[inline(always)]
fn solve(rows: &mut [[f64; 3]], values: &mut [f64]) {
    let n = rows.len();
    for k in 0..n {
        let [d, e, f] = rows[k];
        let part = 1.0 / d;
        let (l1, l2) = (e * part, f * part);
        if k + 1 < n {
            rows[k + 1][0] -= l1 * e;
            rows[k + 1][1] -= l1 * f;
            values[k + 1] -= l1 * values[k];
        }
        if k + 2 < n {
            rows[k + 2][0] -= l2 * f;
            values[k + 2] -= l2 * values[k];
        }
        rows[k] = [part, l1, l2];
    }
    for k in (0..n).rev() {
        values[k] *= rows[k][0];
        if k + 1 < n {
            values[k] -= rows[k][1] * values[k + 1];
        }
        if k + 2 < n {
            values[k] -= rows[k][2] * values[k + 2];
        }
    }
}
