//! Lower bounds of the kind `geometric`: barriers, which hold for any hand and any arm.
//!
//! Seen from above the target is a disc that has to get out among bodies it cannot pass over
//! ([`enclosure`]). Bodies nearer to each other than its diameter are neighbours; a closed chain of
//! neighbours round the target is a barrier, and has to lose an object. The bound is a fractional
//! packing of barriers ([`packing`]), which is as large as the fewest objects, fractions allowed, that hit them all:
//! to the packing of the barriers known the lightest barrier at its prices is added, as long as that
//! costs less than 1.
//!
//! A chain goes round the target when it crosses a ray from the target an odd number of times; the
//! lightest is a shortest path in the graph that has each body twice, once for each parity.

mod enclosure;
mod packing;
mod planar;

use crate::order::{self, Barrier};
use crate::ordered::Ordered;
use clearway_geometry::Vec2;
use clearway_plan::proof::{self, BarriersProof, ChainLink};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_scene::Scene;
use enclosure::{Enclosure, prisms};
use planar::Rounded;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Of equally cheap barriers the one of fewest bodies.
const PER_BODY: f64 = 1e-7;
/// A barrier this much cheaper than 1 is not worth adding.
const CHEAPER: f64 = 1e-5;
const MOST_BARRIERS: usize = 400;

/// What shuts the target in.
#[derive(Clone, Debug, Default)]
pub struct Barriers {
    pub proof: BarriersProof,
    pub sets: Vec<Barrier>,
}

impl Barriers {
    /// Every plan removes at least so many, the target included.
    pub fn bound(&self) -> usize {
        1 + order::least(self.sets.iter().map(|b| b.weight).sum())
    }

    /// None where the target can be lifted out, and where fixtures alone shut it in: then there is no plan.
    pub fn find(scene: &Scene, budget: &Budget) -> Result<Self, Stop> {
        let Some(enclosure) = Enclosure::of(scene) else { return Ok(Self::default()) };
        let chains = Chains::new(scene, &enclosure);
        let (mut found, mut sets): (Vec<Vec<(usize, Vec2)>>, Vec<ObjectSet>) = (Vec::new(), Vec::new());
        let packing = loop {
            let packing = packing::pack(&sets, scene.objects.len());
            let Some(chain) = chains.lightest(&packing.prices, budget)? else { break packing };
            let set: ObjectSet = chain.iter().filter_map(|(body, _)| chains.bodies[*body].object).collect();
            if set.is_empty() {
                return Ok(Self::default());
            }
            let price: f64 = set.iter().map(|o| packing.prices[o.index()]).sum();
            if price > 1.0 - CHEAPER || sets.len() >= MOST_BARRIERS {
                break packing;
            }
            found.push(chain);
            sets.push(set);
        };
        let mut barriers = Self::default();
        for ((chain, set), weight) in found.into_iter().zip(sets).zip(packing.weights).filter(|(_, w)| *w > 0.0) {
            let link =
                |(body, to): (usize, Vec2)| ChainLink { body: chains.bodies[body].id.clone(), to: to.to_array() };
            barriers.proof.barriers.push(proof::Barrier {
                weight,
                objects: set.names(&scene.names),
                chain: chain.into_iter().map(link).collect(),
            });
            barriers.sets.push(Barrier { objects: set, weight });
        }
        if !barriers.sets.is_empty() {
            barriers.proof.enclosure = Some(enclosure.told(scene));
        }
        Ok(barriers)
    }
}

/// A convex part of a fixture or an object.
struct Body {
    id: String,
    object: Option<ObjectId>,
    outline: Rounded,
}

struct Neighbour {
    body: usize,
    /// Near both.
    via: Vec2,
    /// Whether the way from centre to centre crosses the ray an odd number of times.
    odd: bool,
}

struct Chains {
    bodies: Vec<Body>,
    /// By body.
    neighbours: Vec<Vec<Neighbour>>,
}

impl Chains {
    fn new(scene: &Scene, enclosure: &Enclosure) -> Self {
        let mut bodies: Vec<Body> = Vec::new();
        for fixture in &scene.fixtures {
            let outlines = prisms(&fixture.solid, &fixture.pose).filter_map(|p| enclosure.barred(&p));
            bodies.extend(outlines.map(|outline| Body { id: fixture.id.clone(), object: None, outline }));
        }
        for (index, object) in scene.objects.iter().enumerate() {
            let id = ObjectId(index as u16);
            if id != scene.target {
                let outlines = prisms(&object.solid, &object.pose).filter_map(|p| enclosure.barred(&p));
                bodies.extend(outlines.map(|outline| Body { id: object.id.clone(), object: Some(id), outline }));
            }
        }
        let mut neighbours: Vec<Vec<Neighbour>> = bodies.iter().map(|_| Vec::new()).collect();
        for a in 0..bodies.len() {
            for b in 0..a {
                let (one, other) = (&bodies[a].outline, &bodies[b].outline);
                let Some(via) = between(one, other, enclosure.reach()).filter(|via| enclosure.inside(*via)) else {
                    continue;
                };
                let crossed = |p: Vec2, q: Vec2| crosses_ray(enclosure.target, p, q);
                let odd = crossed(one.centre(), via) != crossed(via, other.centre());
                neighbours[a].push(Neighbour { body: b, via, odd });
                neighbours[b].push(Neighbour { body: a, via, odd });
            }
        }
        Self { bodies, neighbours }
    }

    /// The cheapest chain round the target, each body with where the chain goes from it to the next;
    /// `prices` by object.
    fn lightest(&self, prices: &[f64], budget: &Budget) -> Result<Option<Vec<(usize, Vec2)>>, Stop> {
        let price = |body: usize| self.bodies[body].object.map_or(0.0, |o| prices[o.index()]) + PER_BODY;
        let mut best: Option<(f64, Vec<(usize, Vec2)>)> = None;
        for first in (0..self.bodies.len()).filter(|&b| self.neighbours[b].iter().any(|n| n.odd)) {
            budget.check()?;
            // By body and parity: the cheapest way there, and its last step: from where, and over which neighbour.
            let mut known: Vec<(f64, usize, usize)> = vec![(f64::INFINITY, 0, 0); 2 * self.bodies.len()];
            known[2 * first].0 = 0.0;
            let mut queue = BinaryHeap::from([(Reverse(Ordered(0.0)), 2 * first)]);
            let most = best.as_ref().map_or(f64::INFINITY, |b| b.0);
            while let Some((Reverse(Ordered(cost)), state)) = queue.pop() {
                if state == 2 * first + 1 || cost >= most {
                    break;
                }
                if cost > known[state].0 {
                    continue;
                }
                for (index, next) in self.neighbours[state / 2].iter().enumerate() {
                    let to = 2 * next.body + (state % 2 ^ usize::from(next.odd));
                    let cost = cost + price(next.body);
                    if cost < known[to].0 {
                        known[to] = (cost, state, index);
                        queue.push((Reverse(Ordered(cost)), to));
                    }
                }
            }
            let end = 2 * first + 1;
            if known[end].0 < most {
                let mut chain = Vec::new();
                let mut state = end;
                while state != 2 * first {
                    let (_, from, index) = known[state];
                    chain.push((from / 2, self.neighbours[from / 2][index].via));
                    state = from;
                }
                chain.reverse();
                best = Some((known[end].0, chain));
            }
        }
        Ok(best.map(|b| b.1))
    }
}

/// A point nearer than `reach` to both.
fn between(a: &Rounded, b: &Rounded, reach: f64) -> Option<Vec2> {
    let (p, q) = a.nearest(b);
    let far = p.distance(q);
    let towards = (q - p).normalize_or_zero();
    let via = (p + towards * a.radius.min(far) + q - towards * b.radius.min(far)) / 2.0;
    (far - a.radius - b.radius < 2.0 * reach).then_some(via)
}

/// Whether the segment crosses the ray from `from` along x.
fn crosses_ray(from: Vec2, a: Vec2, b: Vec2) -> bool {
    (a.y > from.y) != (b.y > from.y) && a.x + (b.x - a.x) * (from.y - a.y) / (b.y - a.y) > from.x
}
