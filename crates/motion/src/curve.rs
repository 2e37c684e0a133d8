//! Paths without corners: straight pieces joined by parabolas, once continuously differentiable.
//!
//! At each inner waypoint the corner is cut by a parabola that begins and ends at most half-way
//! to the neighbours. For the dense waypoints of a straight hand motion that is the quadratic
//! B-spline through their middles, a hair's breadth away; a wide corner is checked again.

use crate::{Path, Posture, Space, distance};

/// A quadratic in the path parameter: `q(t) = start + slope·t + bend·t²`, `0 ≤ t ≤ length`.
#[derive(Clone, Debug)]
pub struct Piece {
    pub start: Posture,
    pub slope: Posture,
    pub bend: Posture,
    pub length: f64,
}

impl Piece {
    pub fn at(&self, t: f64) -> Posture {
        self.start.iter().zip(&self.slope).zip(&self.bend).map(|((a, b), c)| a + b * t + c * t * t).collect()
    }

    pub fn slope_at(&self, t: f64) -> Posture {
        self.slope.iter().zip(&self.bend).map(|(b, c)| b + 2.0 * c * t).collect()
    }
}

/// Pieces in a row. Where two pieces meet at an angle (a corner that could not be cut) the motion
/// has to stop; `stops` holds the index of the piece after each such corner.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    pub pieces: Vec<Piece>,
    pub stops: Vec<usize>,
}

impl Curve {
    /// Cuts the corner at inner waypoint *i* by the part `cut[i − 1]` (0 to 1) of what is possible.
    pub fn through(path: &[Posture], cut: &[f64]) -> Curve {
        let mut curve = Curve::default();
        if path.len() < 2 {
            return curve;
        }
        let lengths: Vec<f64> = path.windows(2).map(|w| distance(&w[0], &w[1])).collect();
        let along = |i: usize| -> Posture {
            path[i].iter().zip(&path[i + 1]).map(|(a, b)| (b - a) / lengths[i]).collect()
        };
        let mut from = 0.0;
        for i in 0..lengths.len() {
            let u = along(i);
            let last = i + 1 == lengths.len();
            let half = if last { 0.0 } else { cut[i] * 0.5 * lengths[i].min(lengths[i + 1]) };
            let straight = lengths[i] - from - half;
            if straight > 1e-12 {
                let start = path[i].iter().zip(&u).map(|(p, u)| p + u * from).collect();
                curve.pieces.push(Piece { start, slope: u.clone(), bend: vec![0.0; u.len()], length: straight });
            }
            if !last && half > 1e-12 {
                let next = along(i + 1);
                curve.pieces.push(Piece {
                    start: path[i + 1].iter().zip(&u).map(|(p, u)| p - u * half).collect(),
                    bend: u.iter().zip(&next).map(|(u, n)| (n - u) / (4.0 * half)).collect(),
                    slope: u,
                    length: 2.0 * half,
                });
            } else if !last {
                curve.stops.push(curve.pieces.len());
            }
            from = half;
        }
        curve
    }

    pub fn end(&self) -> Option<Posture> {
        self.pieces.last().map(|p| p.at(p.length))
    }
}

/// The smoothest curve along a free path that is free as well: every corner is cut as much as
/// possible, and less where the cut would touch something.
pub fn smooth(space: &mut Space, path: &Path) -> Curve {
    let mut path = path.clone();
    path.dedup_by(|a, b| distance(a, b) < 1e-9);
    if path.len() < 3 {
        return Curve::through(&path, &[]);
    }
    let mut cut = vec![1.0; path.len() - 2];
    for i in 0..cut.len() {
        loop {
            let (before, corner, after) = (&path[i], &path[i + 1], &path[i + 2]);
            let half = cut[i] * 0.5 * distance(before, corner).min(distance(corner, after));
            let alone = Curve::through(
                &[toward(corner, before, 2.0 * half), corner.clone(), toward(corner, after, 2.0 * half)],
                &[1.0],
            );
            // How far the parabola's top is from the corner, as the robot's points see it.
            let off: f64 = alone.pieces.iter().find(|p| p.bend.iter().any(|b| *b != 0.0)).map_or(0.0, |p| {
                space.sweep(corner, &p.at(p.length / 2.0))
            });
            if off < 2e-4 || alone.pieces.iter().all(|p| piece_free(space, p)) {
                break;
            }
            cut[i] *= 0.5;
            if cut[i] < 0.02 {
                cut[i] = 0.0;
                break;
            }
        }
    }
    Curve::through(&path, &cut)
}

fn toward(from: &[f64], to: &[f64], by: f64) -> Posture {
    let d = distance(from, to);
    from.iter().zip(to).map(|(a, b)| a + (b - a) * (by / d).min(1.0)).collect()
}

fn piece_free(space: &mut Space, piece: &Piece) -> bool {
    const PARTS: usize = 12;
    let rows: Path = (0..=PARTS).map(|i| piece.at(piece.length * i as f64 / PARTS as f64)).collect();
    space.rows_free(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joins_are_smooth_and_ends_stay() {
        let path = vec![vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 2.0], vec![0.5, 2.5]];
        let curve = Curve::through(&path, &[1.0, 0.5]);
        assert!(curve.stops.is_empty());
        assert!(distance(&curve.pieces[0].start, &path[0]) < 1e-12);
        assert!(distance(&curve.end().unwrap(), &path[3]) < 1e-12);
        for w in curve.pieces.windows(2) {
            assert!(distance(&w[0].at(w[0].length), &w[1].at(0.0)) < 1e-12);
            assert!(distance(&w[0].slope_at(w[0].length), &w[1].slope_at(0.0)) < 1e-12);
        }
    }

    #[test]
    fn uncut_corners_are_stops() {
        let path = vec![vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 2.0]];
        let curve = Curve::through(&path, &[0.0]);
        assert_eq!((curve.pieces.len(), curve.stops), (2, vec![1]));
    }
}
