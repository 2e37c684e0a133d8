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
//! diagonals. At both ends q' is zero, so nothing has to be said about rest there.

use crate::Limits;

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

/// `|left·x₋ + middle·x + right·x₊| ≤ 1`, times √x for a jerk.
#[derive(Clone, Copy)]
struct Linear {
    left: f64,
    middle: f64,
    right: f64,
}

impl Linear {
    fn of(self, x: &[f64], k: usize) -> f64 {
        self.left * x[k - 1] + self.middle * x[k] + self.right * x[k + 1]
    }
}

/// One joint at one node.
#[derive(Clone, Copy)]
struct Pair {
    acceleration: Linear,
    jerk: Linear,
}

/// Of a node: what the barrier adds to the gradient of x₋, x and x₊ and to the Hessian's entries
/// (−,−), (−,0), (−,+), (0,0), (0,+), (+,+).
#[derive(Clone, Copy, Default)]
struct Push {
    gradient: [f64; 3],
    hessian: [f64; 6],
}

impl Push {
    /// The barrier −ln(1 − z) − ln(1 + z), to second order; `g` is the gradient of z.
    #[inline]
    fn add(&mut self, z: f64, g: [f64; 3]) {
        let w = 1.0 / (1.0 - z * z);
        let (first, second) = (2.0 * z * w, 2.0 * (1.0 + z * z) * w * w);
        let [l, m, r] = g;
        let (sl, sm, sr) = (second * l, second * m, second * r);
        self.gradient[0] += first * l;
        self.gradient[1] += first * m;
        self.gradient[2] += first * r;
        self.hessian[0] += sl * l;
        self.hessian[1] += sl * m;
        self.hessian[2] += sl * r;
        self.hessian[3] += sm * m;
        self.hessian[4] += sm * r;
        self.hessian[5] += sr * r;
    }
}

/// By how much the barrier's weight falls with each step.
const LESS: f64 = 0.5;

/// What a change of a change of pace costs beside the time: keeps x from jumping where a motion is so
/// slow, near its ends, that no joint's limit would notice.
const EVEN: f64 = 0.3;

/// The fastest pace found: x at both ends of every step. The barrier's weight falls `from` … `to`.
pub fn fastest(motion: &Motion, limits: &Limits, bounds: &Bounds, (from, to): (f64, f64)) -> Vec<f64> {
    let n = motion.joints;
    let steps = motion.first.len() / n;
    let pairs = pairs(motion, limits, &bounds.slower);
    let caps = caps(motion, limits, bounds);
    // As slow as needed for nothing to be near its limit.
    let mut slow = caps.iter().copied().fold(f64::INFINITY, f64::min);
    for pair in &pairs {
        let a = pair.acceleration.left + pair.acceleration.middle + pair.acceleration.right;
        let j = pair.jerk.left + pair.jerk.middle + pair.jerk.right;
        slow = slow.min(a.abs().recip()).min(j.abs().recip().powf(2.0 / 3.0));
    }
    let mut x = vec![0.9 * slow; steps + 1];
    let mut next = x.clone();
    let mut gradient = vec![0.0; steps + 1];
    let mut diagonals = vec![[0.0; 3]; steps + 1];
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
        // Even paces are preferred.
        for k in 1..steps {
            let stiff = EVEN / (weight * slow * slow);
            let bend = x[k - 1] - 2.0 * x[k] + x[k + 1];
            gradient[k - 1] += stiff * bend;
            gradient[k] -= 2.0 * stiff * bend;
            gradient[k + 1] += stiff * bend;
            diagonals[k - 1][0] += stiff;
            diagonals[k - 1][1] -= 2.0 * stiff;
            diagonals[k - 1][2] += stiff;
            diagonals[k][0] += 4.0 * stiff;
            diagonals[k][1] -= 2.0 * stiff;
            diagonals[k + 1][0] += stiff;
        }
        for k in 1..steps {
            let mut push = Push::default();
            let root = x[k].sqrt();
            for pair in &pairs[(k - 1) * n..k * n] {
                let (a, j) = (pair.acceleration, pair.jerk);
                push.add(a.of(&x, k), [a.left, a.middle, a.right]);
                let g = j.of(&x, k);
                push.add(g * root, [j.left * root, j.middle * root + g / (2.0 * root), j.right * root]);
            }
            for i in 0..3 {
                gradient[k + i - 1] += push.gradient[i];
            }
            let h = &push.hessian;
            diagonals[k - 1][0] += h[0];
            diagonals[k - 1][1] += h[1];
            diagonals[k - 1][2] += h[2];
            diagonals[k][0] += h[3];
            diagonals[k][1] += h[4];
            diagonals[k + 1][0] += h[5];
        }
        solve(&mut diagonals, &mut gradient);
        // As far as that leads while everything stays within its limits.
        let mut far = 1.0;
        for _ in 0..40 {
            for k in 0..=steps {
                next[k] = x[k] - far * gradient[k];
            }
            if within(&next, &x, &caps, &pairs, n) {
                std::mem::swap(&mut x, &mut next);
                break;
            }
            far *= 0.6;
        }
        weight *= LESS;
    }
    x
}

/// Whether limits hold, and x is not much less than it was.
fn within(x: &[f64], before: &[f64], caps: &[f64], pairs: &[Pair], n: usize) -> bool {
    let last = x.len() - 1;
    x.iter().zip(before).zip(caps).all(|((x, b), cap)| *x > 0.2 * b && x < cap)
        && (1..last).all(|k| {
            let root = x[k].sqrt();
            pairs[(k - 1) * n..k * n]
                .iter()
                .all(|p| p.acceleration.of(x, k).abs() < 1.0 && (p.jerk.of(x, k) * root).abs() < 1.0)
        })
}

fn pairs(motion: &Motion, limits: &Limits, slower: &[f64]) -> Vec<Pair> {
    let (n, step) = (motion.joints, motion.step);
    let steps = motion.first.len() / n;
    let mut pairs = Vec::with_capacity(n * steps);
    for k in 1..steps {
        let c = slower[k];
        for j in 0..n {
            let (before, after) = ((k - 1) * n + j, k * n + j);
            let first = (motion.first[before] + motion.first[after]) / 2.0;
            let second = (motion.second[before] + motion.second[after]) / 2.0;
            let third = (motion.second[after] - motion.second[before]) / step;
            let (a, i) = (c * c / limits.acceleration[j], c * c * c / limits.jerk[j]);
            let slope = first / (4.0 * step);
            let (tilt, bend) = (0.75 * second / step, 0.5 * first / (step * step));
            pairs.push(Pair {
                acceleration: Linear { left: -slope * a, middle: second * a, right: slope * a },
                jerk: Linear { left: (bend - tilt) * i, middle: (third - 2.0 * bend) * i, right: (bend + tilt) * i },
            });
        }
    }
    pairs
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
fn solve(rows: &mut [[f64; 3]], values: &mut [f64]) {
    let n = rows.len();
    for k in 0..n {
        let [d, e, f] = rows[k];
        let (l1, l2) = (e / d, f / d);
        if k + 1 < n {
            rows[k + 1][0] -= l1 * e;
            rows[k + 1][1] -= l1 * f;
            values[k + 1] -= l1 * values[k];
        }
        if k + 2 < n {
            rows[k + 2][0] -= l2 * f;
            values[k + 2] -= l2 * values[k];
        }
        rows[k] = [d, l1, l2];
    }
    for k in (0..n).rev() {
        values[k] /= rows[k][0];
        if k + 1 < n {
            values[k] -= rows[k][1] * values[k + 1];
        }
        if k + 2 < n {
            values[k] -= rows[k][2] * values[k + 2];
        }
    }
}
