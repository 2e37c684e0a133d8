use super::*;
use crate::stability::polygon::hull;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A bar along x, of some width, and what carries it between which ends.
fn bar(weight: f64, centre: f64, rests: &[(Option<usize>, f64, f64)]) -> Body {
    let patch =
        |low: f64, high: f64| [(low, -0.1), (high, -0.1), (high, 0.1), (low, 0.1)].map(|(x, y)| Point::new(x, y));
    let rest = |(on, low, high): &(Option<usize>, f64, f64)| Rest { on: *on, patch: hull(patch(*low, *high).to_vec()) };
    Body { weight, centre: Point::new(centre, 0.0), rests: rests.iter().map(rest).collect() }
}

/// Without what is known of towers.
fn together(bodies: &[Body]) -> bool {
    let all: Vec<usize> = (0..bodies.len()).collect();
    match solve(&problem(bodies, &weights(bodies), &all)) {
        Answer::Yes => true,
        Answer::No => false,
        Answer::Unknown => panic!("gave up"),
    }
}

fn stands(bodies: &[Body]) -> bool {
    let found = balance(bodies) == Balance::Stands;
    assert_eq!(found, together(bodies));
    // Looked at from elsewhere.
    let turned = |p: &Point| Point::from_angle(0.7).rotate(*p) + Point::new(3.0, -2.0);
    let rest = |r: &Rest| Rest { on: r.on, patch: r.patch.iter().map(turned).collect() };
    let body = |b: &Body| Body {
        weight: b.weight * 1e-3,
        centre: turned(&b.centre),
        rests: b.rests.iter().map(rest).collect(),
    };
    let elsewhere: Vec<Body> = bodies.iter().map(body).collect();
    assert_eq!(found, balance(&elsewhere) == Balance::Stands);
    assert_eq!(found, together(&elsewhere));
    found
}

#[test]
fn an_edge_is_where_it_tips() {
    for (centre, expected) in [(0.0, true), (0.0999, true), (0.1001, false), (-0.2999, true), (-0.3001, false)] {
        assert_eq!(stands(&[bar(2.0, centre, &[(None, -0.3, 0.1)])]), expected, "{centre}");
    }
}

#[test]
fn two_supports_carry_what_is_between() {
    for (centre, expected) in [(0.0, true), (0.49, true), (0.51, false), (-0.51, false)] {
        let pillars = [bar(1.0, -0.45, &[(None, -0.5, -0.4)]), bar(1.0, 0.45, &[(None, 0.4, 0.5)])];
        let [left, right] = pillars;
        let board = bar(3.0, centre, &[(Some(0), -0.5, -0.4), (Some(1), 0.4, 0.5)]);
        assert_eq!(stands(&[left, right, board]), expected, "{centre}");
    }
    // One is the ground.
    let pillar = bar(1.0, 0.45, &[(None, 0.4, 0.5)]);
    let board = bar(3.0, 0.0, &[(None, -0.5, -0.4), (Some(0), 0.4, 0.5)]);
    assert!(stands(&[pillar, board]));
    // A pillar that leans tips as soon as the board bears on it.
    let leans = || bar(1.0, 0.45, &[(None, 0.3, 0.46)]);
    assert!(stands(&[leans()]));
    let board = |centre: f64| bar(3.0, centre, &[(None, -0.5, -0.4), (Some(0), 0.47, 0.5)]);
    // It bears 1 of 0.01 m; the board may bear 1 at 0.01 m, a third of its weight.
    let third = -0.4 + 0.87 / 3.0;
    assert!(stands(&[leans(), board(third - 1e-3)]));
    assert!(!stands(&[leans(), board(third + 1e-3)]));
    assert_eq!(balance(&[leans(), board(0.0)]), Balance::Falls(vec![0, 1]));
}

#[test]
fn a_counterweight_holds_a_board() {
    // The board's centre is 0.1 m over the edge at 0; the counterweight is 0.3 m on the inside.
    let board = || bar(3.0, 0.1, &[(None, -0.4, 0.0)]);
    assert_eq!(balance(&[board()]), Balance::Tips(0));
    for (weight, expected) in [(1.001, true), (0.999, false)] {
        let load = bar(weight, -0.3, &[(Some(0), -0.31, -0.29)]);
        assert_eq!(stands(&[board(), load]), expected, "{weight}");
    }
    // A load beyond the edge does not help, and is told to be on what tips.
    let load = bar(9.0, 0.2, &[(Some(0), 0.1, 0.3)]);
    assert_eq!(balance(&[board(), load]), Balance::Tips(0));
}

/// Harmonic: the k-th block from the top may hang over by half of its length divided by k.
#[test]
fn overhanging_blocks() {
    for count in 2..12_usize {
        for (share, expected) in [(0.999, true), (1.001, false)] {
            let mut centre = 0.0;
            let mut centres = vec![centre];
            for k in 1..count {
                centre -= share * 0.5 / k as f64;
                centres.push(centre);
            }
            // From the top down; the last is on the ground.
            let block = |i: usize| {
                let on = (i + 1 < count).then_some(i + 1);
                let (low, high) = match on {
                    Some(below) => (centres[i] - 0.5, centres[below] + 0.5),
                    None => (-9.0, 9.0),
                };
                bar(1.0, centres[i], &[(on, low, high)])
            };
            let blocks: Vec<Body> = (0..count).map(block).collect();
            assert_eq!(stands(&blocks), expected, "{count} blocks, {share}");
        }
    }
}

#[test]
fn three_legs() {
    let foot = |x: f64, y: f64| Rest { on: None, patch: vec![Point::new(x, y)] };
    let feet = || hull([(0.0, 0.0), (0.3, 0.0), (0.0, 0.3)].map(|(x, y)| Point::new(x, y)).to_vec());
    for (x, y, expected) in [(0.1, 0.1, true), (0.149, 0.149, true), (0.151, 0.151, false), (-0.001, 0.1, false)] {
        let stool = |rests: Vec<Rest>| Body { weight: 1.0, centre: Point::new(x, y), rests };
        let apart = stool(vec![foot(0.0, 0.0), foot(0.3, 0.0), foot(0.0, 0.3)]);
        assert_eq!(stands(&[apart]), expected);
        assert_eq!(stands(&[stool(vec![Rest { on: None, patch: feet() }])]), expected);
    }
}

/// As many as a scene may have: 16 courses of 16, odd ones 0.3 of a brick farther.
#[test]
fn a_wall_of_bricks_stands_until_its_foot_goes() {
    let wall = |foot: f64| {
        let (mut bodies, mut rows): (Vec<Body>, Vec<Vec<(usize, f64)>>) = (Vec::new(), Vec::new());
        for course in 0..16 {
            let mut row = Vec::new();
            for i in 0..16 {
                let centre = f64::from(i) + f64::from(course % 2) * 0.3;
                let below = rows.last().into_iter().flatten();
                let meets = below.map(|(b, c)| (Some(*b), f64::max(*c, centre) - 0.499, f64::min(*c, centre) + 0.499));
                let mut rests: Vec<_> = meets.filter(|(_, low, high)| low < high).collect();
                if course == 0 {
                    rests = vec![(None, centre - 0.5, centre + if i == 15 { foot } else { 0.5 })];
                }
                row.push((bodies.len(), centre));
                bodies.push(bar(1.0, centre, &rests));
            }
            rows.push(row);
        }
        bodies
    };
    // All the bricks together cannot hold the last foot down by its end.
    for (foot, expected) in [(0.5, true), (-0.4, true), (-0.499, false)] {
        let start = std::time::Instant::now();
        assert_eq!(balance(&wall(foot)) == Balance::Stands, expected, "{foot}");
        println!("256 bricks, {expected}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    }
}

/// Random towers: each stands if, at every level, all that is above has its centre within the patch.
#[test]
fn towers_as_in_the_closed_form() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut all, mut standing) = (0, 0);
    while all < 2_000 {
        let count = random.random_range(2..8);
        let mut centre: f64 = 0.0;
        let blocks: Vec<(f64, f64)> = (0..count)
            .map(|_| {
                centre += random.random_range(-0.5..0.5);
                (random.random_range(0.1..5.0), centre)
            })
            .collect();
        // The first is the lowest; blocks are 1 long.
        let over = |i: usize| {
            let above = &blocks[i..];
            let weight: f64 = above.iter().map(|b| b.0).sum();
            let at = above.iter().map(|b| b.0 * b.1).sum::<f64>() / weight;
            (at - f64::midpoint(blocks[i - 1].1, blocks[i].1)).abs()
                - (0.5 - (blocks[i].1 - blocks[i - 1].1).abs() / 2.0)
        };
        let worst = (1..count).map(over).fold(f64::NEG_INFINITY, f64::max);
        if worst.abs() < 1e-6 {
            continue;
        }
        let body = |i: usize| match i {
            0 => bar(blocks[0].0, blocks[0].1, &[(None, -9.0, 9.0)]),
            _ => {
                let (a, b) = (blocks[i - 1].1, blocks[i].1);
                bar(blocks[i].0, b, &[(Some(i - 1), a.max(b) - 0.5, a.min(b) + 0.5)])
            }
        };
        let bodies: Vec<Body> = (0..count).map(body).collect();
        assert_eq!(stands(&bodies), worst < 0.0, "{blocks:?}");
        all += 1;
        standing += usize::from(worst < 0.0);
    }
    assert!((200..1_800).contains(&standing), "{standing} of {all}");
}

/// Weight, centre, and what carries it between which ends.
type Bar = (f64, f64, Vec<(Option<usize>, f64, f64)>);

/// Random bars on bars, seen from the side, beside all vertices of the forces there can be.
#[test]
fn agrees_with_all_vertices() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
    let (mut all, mut standing, mut shared) = (0, 0, 0);
    while all < 2_000 {
        let count = random.random_range(2..5);
        let mut sides: Vec<(f64, f64)> = Vec::new();
        let mut bodies: Vec<Body> = Vec::new();
        let mut flat: Vec<Bar> = Vec::new();
        for i in 0..count {
            let (centre, half) = (random.random_range(-0.6..0.6), random.random_range(0.3..1.0));
            let weight = random.random_range(0.1..3.0);
            // Mostly on some of those before; else on a piece of ground.
            let mut rests: Vec<(Option<usize>, f64, f64)> = Vec::new();
            for (j, (low, high)) in sides.iter().enumerate() {
                let (low, high) = (f64::max(*low, centre - half), f64::min(*high, centre + half));
                if low < high && random.random_bool(0.7) {
                    rests.push((Some(j), low, high));
                }
            }
            if rests.is_empty() || random.random_bool(0.2) {
                let at = centre - half * random.random_range(-0.2..1.0);
                rests.push((None, at, at + half * random.random_range(0.0..1.5)));
            }
            rests.truncate(3);
            shared += usize::from(rests.len() > 1 && i > 0);
            sides.push((centre - half, centre + half));
            bodies.push(bar(weight, centre, &rests));
            flat.push((weight, centre, rests));
        }
        let Some(expected) = by_vertices(&flat) else { continue };
        assert_eq!(stands(&bodies), expected, "{flat:?}");
        all += 1;
        standing += usize::from(expected);
    }
    println!("{standing} of {all} stand; {shared} bars rest on several things");
    assert!((200..1_800).contains(&standing), "{standing} of {all}");
    assert!(shared > 1_000);
}

/// Whether some basis of the forces has none below 0. `None`: too close to say.
fn by_vertices(bars: &[Bar]) -> Option<bool> {
    let rows = 2 * bars.len();
    let right: Vec<f64> = bars.iter().flat_map(|(weight, centre, _)| [*weight, weight * centre]).collect();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (i, (_, _, rests)) in bars.iter().enumerate() {
        for (on, low, high) in rests {
            for x in [*low, *high] {
                let mut column = vec![0.0; rows];
                (column[2 * i], column[2 * i + 1]) = (1.0, x);
                if let Some(j) = on {
                    (column[2 * j], column[2 * j + 1]) = (-1.0, -x);
                }
                columns.push(column);
            }
        }
    }
    let mut best = f64::NEG_INFINITY;
    let mut chosen: Vec<usize> = (0..rows).collect();
    if columns.len() < rows {
        return None;
    }
    loop {
        if let Some(forces) = eliminated(&chosen.iter().map(|c| &columns[*c]).collect::<Vec<_>>(), &right) {
            best = best.max(forces.into_iter().fold(f64::INFINITY, f64::min));
        }
        // The next choice of as many.
        let Some(at) = (0..rows).rev().find(|i| chosen[*i] < columns.len() - rows + i) else { break };
        chosen[at] += 1;
        (at + 1..rows).for_each(|i| chosen[i] = chosen[at] + i - at);
    }
    // No basis at all: forces that cannot be told apart.
    (best.is_finite() && best.abs() > 1e-6).then_some(best > 0.0)
}

fn eliminated(columns: &[&Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    let n = right.len();
    let mut rows: Vec<Vec<f64>> = (0..n).map(|r| columns.iter().map(|c| c[r]).chain([right[r]]).collect()).collect();
    for c in 0..n {
        let pivot = (c..n).max_by(|a, b| rows[*a][c].abs().total_cmp(&rows[*b][c].abs()))?;
        rows.swap(c, pivot);
        if rows[c][c].abs() < 1e-9 {
            return None;
        }
        let lead = rows[c].clone();
        for (r, row) in rows.iter_mut().enumerate().filter(|(r, _)| *r != c) {
            debug_assert!(r < n);
            let factor = row[c] / lead[c];
            row.iter_mut().zip(&lead).for_each(|(a, b)| *a -= factor * b);
        }
    }
    Some((0..n).map(|r| rows[r][n] / rows[r][r]).collect())
}
