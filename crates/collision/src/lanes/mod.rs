//! The collision kernel: sixteen configurations of a robot covered by spheres, at once, in f32.
//!
//! The machine's instructions are chosen at run time (AVX-512, AVX2, SSE, NEON, plain). Answers of
//! *free* are proofs about the spheres ([`kernel`]); where spheres are too fat, the exact shapes of
//! [`crate::World`] decide.

pub mod body;
mod cells;
mod chain;
pub mod exact;
pub mod kernel;
mod neighbours;
mod never;
pub mod obstacles;
pub mod shape;
mod suspects;
mod vector;

pub use body::{Body, Settings};
pub use kernel::{Around, Kernel, Scratch, Upright};
pub use neighbours::Neighbours;
pub use never::Relative;
pub use obstacles::{Obstacles, Piece, link_owner, owner_link};
pub use suspects::{Suspect, Suspects};
pub use vector::{LANES, Lanes};

use fearless_simd::Level;

/// What this machine offers, best first; the last is what every machine of its kind has.
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut all = vec![best];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        if best.as_avx512().is_some() {
            all.extend(best.as_avx2().map(Level::Avx2));
        }
        if best.as_avx2().is_some() {
            all.extend(best.as_sse4_2().map(Level::Sse4_2));
        }
    }
    all.push(Level::baseline());
    all
}
