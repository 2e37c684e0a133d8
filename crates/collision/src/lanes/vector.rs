//! Sixteen numbers at once, and the few formulas that all of the kernel shares.

use fearless_simd::{
    Select, Simd, SimdBase, SimdCvtTruncate, SimdFloat, SimdFrom, SimdMask, f32x16, i32x16, mask32x16,
};

/// Configurations, or obstacles, that are looked at together.
pub const LANES: usize = 16;

/// A number per lane, in memory.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    pub const ZERO: Lanes = Lanes([0.0; LANES]);

    pub fn splat(value: f32) -> Self {
        Self([value; LANES])
    }
}

#[inline(always)]
pub fn load<S: Simd>(simd: S, lanes: &Lanes) -> f32x16<S> {
    f32x16::simd_from(simd, lanes.0)
}

#[inline(always)]
pub fn store<S: Simd>(value: f32x16<S>, lanes: &mut Lanes) {
    value.store_slice(&mut lanes.0);
}

#[inline(always)]
pub fn splat<S: Simd>(simd: S, value: f32) -> f32x16<S> {
    f32x16::splat(simd, value)
}

/// The mask's bits, lane 0 lowest.
#[inline(always)]
pub fn bits<S: Simd>(mask: mask32x16<S>) -> u32 {
    mask.to_bitmask() as u32
}

/// A point per lane.
#[derive(Clone, Copy)]
pub struct Point<S: Simd> {
    pub x: f32x16<S>,
    pub y: f32x16<S>,
    pub z: f32x16<S>,
}

impl<S: Simd> Point<S> {
    #[inline(always)]
    pub fn splat(simd: S, p: [f32; 3]) -> Self {
        Self { x: splat(simd, p[0]), y: splat(simd, p[1]), z: splat(simd, p[2]) }
    }

    #[inline(always)]
    pub fn load(simd: S, lanes: &[Lanes; 3]) -> Self {
        Self { x: load(simd, &lanes[0]), y: load(simd, &lanes[1]), z: load(simd, &lanes[2]) }
    }

    #[inline(always)]
    pub fn store(self, lanes: &mut [Lanes; 3]) {
        store(self.x, &mut lanes[0]);
        store(self.y, &mut lanes[1]);
        store(self.z, &mut lanes[2]);
    }

    #[inline(always)]
    pub fn minus(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> f32x16<S> {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    #[inline(always)]
    pub fn distance_squared(self, other: Self) -> f32x16<S> {
        let d = self.minus(other);
        d.dot(d)
    }
}

/// Sine and cosine, radians; within 2e-7 for angles up to some hundred turns.
///
/// The angle is brought to ±π/4 by quarter turns (π/2 in three parts), then minimax polynomials
/// as in Cephes' `sinf` and `cosf`.
#[inline(always)]
pub fn sin_cos<S: Simd>(simd: S, angle: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let c = |v: f32| splat(simd, v);
    let turns = (angle * c(std::f32::consts::FRAC_2_PI)).round_ties_even();
    let quarter: i32x16<S> = i32x16::truncate_from(turns);
    let r = turns.mul_add(c(-1.570_312_5), angle);
    let r = turns.mul_add(c(-4.837_512_969_970_703e-4), r);
    let r = turns.mul_add(c(-7.549_789_948_768_648e-8), r);
    let r2 = r * r;
    let s = r2.mul_add(c(-1.951_529_6e-4), c(8.332_161e-3));
    let s = r2.mul_add(s, c(-1.666_665_5e-1));
    let s = (s * r2).mul_add(r, r);
    let k = r2.mul_add(c(2.443_315_7e-5), c(-1.388_731_6e-3));
    let k = r2.mul_add(k, c(4.166_664_6e-2));
    let k = (k * r2).mul_add(r2, r2.mul_add(c(-0.5), c(1.0)));
    let one = i32x16::splat(simd, 1);
    let two = i32x16::splat(simd, 2);
    let odd = (quarter & one).simd_eq(one);
    let (sine, cosine) = (odd.select(k, s), odd.select(s, k));
    let minus_sine = (quarter & two).simd_eq(two);
    let minus_cosine = ((quarter + one) & two).simd_eq(two);
    (minus_sine.select(-sine, sine), minus_cosine.select(-cosine, cosine))
}

/// 0, 1, 2 … by lane.
#[inline(always)]
pub fn counting<S: Simd>(simd: S) -> f32x16<S> {
    f32x16::simd_from(simd, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn sines_and_cosines_are_right() {
        for level in crate::lanes::levels() {
            for i in 0..20_000 {
                let angle = (i as f32 - 10_000.0) * 0.0137;
                let (s, c) = dispatch!(level, simd => {
                    let (s, c) = sin_cos(simd, splat(simd, angle));
                    let (mut a, mut b) = (Lanes::ZERO, Lanes::ZERO);
                    store(s, &mut a);
                    store(c, &mut b);
                    (a.0[7], b.0[7])
                });
                let (es, ec) = (f64::from(angle).sin(), f64::from(angle).cos());
                assert!((f64::from(s) - es).abs() < 4e-7, "{angle}: {s} {es}");
                assert!((f64::from(c) - ec).abs() < 4e-7, "{angle}: {c} {ec}");
            }
        }
        let _ = Level::new();
    }
}
