//! A tree of configurations in joint space, with the nearest found by a flat scan.
//!
//! Trees stay small (tens of nodes on most problems), and sixteen nodes are looked at at once.

use crate::{Path, Posture};
use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdFrom, dispatch, f32x16, i32x16};

const BLOCK: usize = 16;

#[derive(Clone, Debug)]
pub struct Tree {
    level: Level,
    joints: usize,
    /// Node after node.
    values: Vec<f64>,
    /// In blocks of sixteen nodes: joint after joint, sixteen values each.
    blocks: Vec<[f32; BLOCK]>,
    parents: Vec<u32>,
    /// How far from a node samples may lie to be of use: infinite until a motion from it failed
    /// (dynamic domain, Yershova et al. 2005).
    pub domains: Vec<f64>,
}

impl Default for Tree {
    fn default() -> Self {
        let (values, blocks, parents, domains) = Default::default();
        Self { level: Level::new(), joints: 0, values, blocks, parents, domains }
    }
}

impl Tree {
    /// Empties the tree, keeping its room.
    pub fn clear(&mut self, joints: usize) {
        self.joints = joints;
        self.values.clear();
        self.blocks.clear();
        self.parents.clear();
        self.domains.clear();
    }

    pub fn len(&self) -> usize {
        self.parents.len()
    }

    pub fn node(&self, index: usize) -> &[f64] {
        &self.values[index * self.joints..(index + 1) * self.joints]
    }

    /// Adds a node; one without parent is a root.
    pub fn add(&mut self, q: &[f64], parent: Option<usize>) -> usize {
        let index = self.len();
        if index.is_multiple_of(BLOCK) {
            // Lanes without a node are far from everything.
            self.blocks.extend(std::iter::repeat_n([1e18; BLOCK], self.joints));
        }
        let from = index / BLOCK * self.joints;
        for (block, value) in self.blocks[from..].iter_mut().zip(q) {
            block[index % BLOCK] = *value as f32;
        }
        self.values.extend_from_slice(q);
        self.parents.push(parent.unwrap_or(index) as u32);
        self.domains.push(f64::INFINITY);
        index
    }

    /// The node nearest to `q`, and the distance.
    pub fn nearest(&self, q: &[f64]) -> (usize, f64) {
        let index = if self.len() < 8 {
            // Too few to be worth the wider instructions.
            let squares = |i: usize| self.node(i).iter().zip(q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            (0..self.len()).map(|i| (i, squares(i))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |found| found.0)
        } else {
            dispatch!(self.level, simd => self.scan(simd, q))
        };
        (index, crate::distance(self.node(index), q))
    }

    #[inline(always)]
    fn scan<S: Simd>(&self, simd: S, q: &[f64]) -> usize {
        let mut least = f32x16::splat(simd, f32::INFINITY);
        let mut found = i32x16::splat(simd, 0);
        for (number, block) in self.blocks.chunks_exact(self.joints).enumerate() {
            let mut sum = f32x16::splat(simd, 0.0);
            for (values, q) in block.iter().zip(q) {
                let apart = f32x16::simd_from(simd, *values) - f32x16::splat(simd, *q as f32);
                sum = apart.mul_add(apart, sum);
            }
            let nearer = sum.simd_lt(least);
            least = nearer.select(sum, least);
            found = nearer.select(i32x16::splat(simd, number as i32), found);
        }
        let (mut squares, mut numbers) = ([0.0_f32; BLOCK], [0_i32; BLOCK]);
        least.store_slice(&mut squares);
        found.store_slice(&mut numbers);
        let lane = (0..BLOCK).fold(0, |best, lane| if squares[lane] < squares[best] { lane } else { best });
        numbers[lane] as usize * BLOCK + lane
    }

    /// From the root to `node`.
    pub fn branch(&self, mut node: usize) -> Path {
        let mut path: Vec<Posture> = vec![self.node(node).to_vec()];
        while self.parents[node] as usize != node {
            node = self.parents[node] as usize;
            path.push(self.node(node).to_vec());
        }
        path.reverse();
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_is_that_of_brute_force() {
        let mut tree = Tree::default();
        tree.clear(3);
        let point = |i: usize| -> Vec<f64> { (0..3).map(|j| ((i * 7 + j * 3) as f64 * 1.37).sin() * 2.0).collect() };
        for i in 0..200 {
            tree.add(&point(i), (i > 0).then_some(i / 2));
            let q = point(i + 1000);
            let least = (0..=i).map(|n| crate::distance(tree.node(n), &q)).fold(f64::INFINITY, f64::min);
            let (found, distance) = tree.nearest(&q);
            assert!((distance - least).abs() < 1e-6 && found <= i);
        }
        assert_eq!(tree.branch(9).len(), 5);
    }
}
