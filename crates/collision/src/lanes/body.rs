//! The robot as the kernel sees it: a chain of frames, spheres seated on them in parts, and the
//! pairs of parts that could ever meet.

use super::chain::Chain;
use super::never::Relative;
use super::vector::{LANES, Lanes};
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_robot::{Group, Motion, Sphere, bounding_sphere};
use std::collections::BTreeMap;
use std::ops::Range;

/// A ball in a frame of the chain, metres.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub centre: [f32; 3],
    pub radius: f32,
}

/// Some neighbouring spheres of one link.
#[derive(Clone, Debug)]
pub struct Part {
    /// The link's index; what is attached has one more than the last.
    pub link: usize,
    /// The link that it is on: itself, or what it is attached to.
    pub carrier: usize,
    pub frame: usize,
    /// Holds them all.
    pub bound: Ball,
    /// Into [`Body::balls`].
    pub balls: Range<usize>,
}

/// Two parts that could meet.
#[derive(Clone, Debug)]
pub struct Pair {
    pub a: usize,
    pub b: usize,
    /// The sum of the bounds' radii.
    pub bound: f32,
    /// Into [`Body::rows`].
    pub rows: Range<usize>,
}

/// One ball of a pair's part `a`, and the balls of `b` that it could meet.
#[derive(Clone, Debug)]
pub struct Row {
    pub ball: usize,
    /// Its radius and that of `b`'s bound, added up.
    pub guard: f32,
    /// Into [`Body::partners`].
    pub partners: Range<usize>,
}

/// A ball of a pair's part `b`, and the sum of both radii.
#[derive(Clone, Copy, Debug)]
pub struct Partner {
    pub ball: usize,
    pub sum: f32,
}

/// How parts and pairs are made.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Links closer than this touch, metres.
    pub self_margin: f64,
    /// Links are cut into parts until their bounding spheres are smaller than this, metres …
    pub part_radius: f64,
    /// … or they have no more spheres than this.
    pub part_balls: usize,
    /// Links that stand still are no matter of the body's: they are among the obstacles, by their shapes.
    pub still_aside: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { self_margin: 0.0, part_radius: 0.13, part_balls: 6, still_aside: false }
    }
}

/// A robot ready for the kernel.
#[derive(Clone, Debug)]
pub struct Body {
    pub chain: Chain,
    pub parts: Vec<Part>,
    pub balls: Vec<Ball>,
    /// By ball: a smaller ball about its middle that is all inside the shape; negative where there is
    /// none.
    pub inner: Vec<f32>,
    pub pairs: Vec<Pair>,
    pub rows: Vec<Row>,
    pub partners: Vec<Partner>,
    /// By part, then by variable: how far a unit of the variable moves the middles of the part's balls, at most.
    reaches: Vec<Vec<f64>>,
    /// By variable, then by group of sixteen: how far a unit of the variable moves the middles of
    /// a part's balls, at most; parts first, then pairs, whose parts are seen from each other.
    pub reach: Vec<Vec<Lanes>>,
    /// By group of sixteen: the least radius of a part's balls, of a pair's sums.
    pub least: Vec<Lanes>,
    pub self_margin: f32,
}

impl Body {
    /// `spheres` by link, in the links' frames. Links without spheres are not seen; pairs of links
    /// in `unchecked` are never checked.
    pub fn new(group: &Group, spheres: &[Vec<Sphere>], unchecked: &[(usize, usize)], settings: &Settings) -> Body {
        let chain = Chain::new(&group.kinematics);
        let mut body = Body {
            chain,
            parts: Vec::new(),
            balls: Vec::new(),
            inner: Vec::new(),
            pairs: Vec::new(),
            rows: Vec::new(),
            partners: Vec::new(),
            reaches: Vec::new(),
            reach: Vec::new(),
            least: Vec::new(),
            self_margin: settings.self_margin as f32,
        };
        // By part: which of its link's spheres it has, in order.
        let mut members: Vec<Vec<usize>> = Vec::new();
        for (link, spheres) in spheres.iter().enumerate() {
            let seat = body.chain.seats[link];
            let mut seated: Vec<(usize, Sphere)> = spheres
                .iter()
                .map(|s| Sphere { centre: seat.frame_from_link.point(s.centre), radius: s.radius })
                .enumerate()
                .collect();
            divide(&mut seated, settings, &mut |part| {
                members.push(part.iter().map(|(i, _)| *i).collect());
                body.add_part((link, link), seat.frame, part);
                let depth = |(i, _): &(usize, Sphere)| group.links[link].collision.depth(spheres[*i].centre) as f32;
                body.inner.extend(part.iter().map(depth));
            });
        }
        body.add_pairs(group, spheres, &members, unchecked, settings);
        body.measure(group);
        body
    }

    fn add_part(&mut self, (link, carrier): (usize, usize), frame: usize, spheres: &[(usize, Sphere)]) {
        let from = self.balls.len();
        let spheres: Vec<Sphere> = spheres.iter().map(|(_, s)| *s).collect();
        self.balls.extend(spheres.iter().map(ball));
        self.parts.push(Part {
            link,
            carrier,
            frame,
            bound: ball(&bounding_sphere(&spheres)),
            balls: from..self.balls.len(),
        });
    }

    /// `members`: by part, which of its link's spheres it has.
    fn add_pairs(
        &mut self,
        group: &Group,
        spheres: &[Vec<Sphere>],
        members: &[Vec<usize>],
        unchecked: &[(usize, usize)],
        settings: &Settings,
    ) {
        let frame = |link: usize| self.chain.seats[link].frame;
        let mut meet: BTreeMap<(usize, usize), Vec<Vec<bool>>> = BTreeMap::new();
        for a in 0..spheres.len() {
            for b in a + 1..spheres.len() {
                let shaped = !spheres[a].is_empty() && !spheres[b].is_empty();
                let aside = settings.still_aside && (frame(a) == 0 || frame(b) == 0);
                if shaped && !aside && frame(a) != frame(b) && !unchecked.contains(&(a, b)) {
                    let relative = Relative::new(group, a, b);
                    meet.insert((a, b), relative.could_meet(&spheres[a], &spheres[b], settings.self_margin));
                }
            }
        }
        for a in 0..self.parts.len() {
            for b in a + 1..self.parts.len() {
                if let Some(meet) = meet.get(&(self.parts[a].link, self.parts[b].link)) {
                    self.add_pair(a, b, |i, j| meet[members[a][i]][members[b][j]]);
                }
            }
        }
    }

    /// `meet`: whether the parts' `i`-th and `j`-th balls could.
    fn add_pair(&mut self, a: usize, b: usize, meet: impl Fn(usize, usize) -> bool) {
        let from = self.rows.len();
        for (i, ball) in self.parts[a].balls.clone().enumerate() {
            let first = self.partners.len();
            let radius = self.balls[ball].radius;
            for (j, other) in self.parts[b].balls.clone().enumerate() {
                if meet(i, j) {
                    self.partners.push(Partner { ball: other, sum: radius + self.balls[other].radius });
                }
            }
            if self.partners.len() > first {
                let guard = radius + self.parts[b].bound.radius;
                self.rows.push(Row { ball, guard, partners: first..self.partners.len() });
            }
        }
        if self.rows.len() > from {
            let bound = self.parts[a].bound.radius + self.parts[b].bound.radius;
            self.pairs.push(Pair { a, b, bound, rows: from..self.rows.len() });
        }
    }

    /// Parts, then pairs.
    pub fn entities(&self) -> usize {
        self.parts.len() + self.pairs.len()
    }

    /// The same robot with a solid added to a link (in its frame), covered by `spheres`: what a hand
    /// holds. It is checked against all links but `beside`, and told by the index after the last link's.
    pub fn with_attached(
        &self,
        group: &Group,
        link: usize,
        (solid, spheres): (&Solid, &[Sphere]),
        beside: &[usize],
        settings: &Settings,
    ) -> Body {
        let mut body = self.clone();
        let seat = self.chain.seats[link];
        let attached = self.chain.seats.len();
        let seated = spheres.iter().map(|s| Sphere { centre: seat.frame_from_link.point(s.centre), radius: s.radius });
        let mut seated: Vec<(usize, Sphere)> = seated.enumerate().collect();
        let first = body.parts.len();
        divide(&mut seated, settings, &mut |part| {
            body.add_part((attached, link), seat.frame, part);
            body.inner.extend(part.iter().map(|(i, _)| solid.depth(spheres[*i].centre) as f32));
        });
        let aside = |a: usize| settings.still_aside && self.parts[a].frame == 0;
        for a in (0..first)
            .filter(|&a| self.parts[a].frame != seat.frame && !aside(a) && !beside.contains(&self.parts[a].link))
        {
            for b in first..body.parts.len() {
                body.add_pair(a, b, |_, _| true);
            }
        }
        body.measure(group);
        body
    }

    fn measure(&mut self, group: &Group) {
        let variables = self.chain.joints + 1;
        let groups = self.entities().div_ceil(LANES);
        self.reach = vec![vec![Lanes::ZERO; groups]; variables];
        self.least = vec![Lanes::splat(1.0); groups];
        let middle = |ball: &Ball| Vec3::from_array(ball.centre.map(f64::from));
        for part in &self.parts[self.reaches.len()..] {
            let points: Vec<Vec3> = self.balls[part.balls.clone()].iter().chain([&part.bound]).map(middle).collect();
            self.reaches.push(reach_of(group, part.carrier, &self.chain.seats[part.carrier].frame_from_link, &points));
        }
        let reaches = &self.reaches;
        for (entity, part) in self.parts.iter().enumerate() {
            let least = self.balls[part.balls.clone()].iter().map(|b| b.radius).fold(f32::MAX, f32::min);
            self.least[entity / LANES].0[entity % LANES] = least;
            for (variable, reach) in reaches[entity].iter().enumerate() {
                self.reach[variable][entity / LANES].0[entity % LANES] = *reach as f32;
            }
        }
        for (i, pair) in self.pairs.iter().enumerate() {
            let entity = self.parts.len() + i;
            let apart = self.chain.moved_by[self.parts[pair.a].frame] ^ self.chain.moved_by[self.parts[pair.b].frame];
            let partners = self.rows[pair.rows.clone()].iter().flat_map(|r| &self.partners[r.partners.clone()]);
            self.least[entity / LANES].0[entity % LANES] = partners.map(|p| p.sum).fold(f32::MAX, f32::min);
            for variable in (0..variables).filter(|v| apart >> v & 1 == 1) {
                let reach = reaches[pair.a][variable].max(reaches[pair.b][variable]);
                self.reach[variable][entity / LANES].0[entity % LANES] = reach as f32;
            }
        }
    }
}

fn ball(s: &Sphere) -> Ball {
    Ball { centre: s.centre.to_array().map(|x| x as f32), radius: s.radius as f32 }
}

/// Cuts across the longest side until the parts are small.
fn divide(spheres: &mut [(usize, Sphere)], settings: &Settings, found: &mut impl FnMut(&[(usize, Sphere)])) {
    if spheres.is_empty() {
        return;
    }
    let all: Vec<Sphere> = spheres.iter().map(|(_, s)| *s).collect();
    if spheres.len() <= settings.part_balls || bounding_sphere(&all).radius <= settings.part_radius {
        found(spheres);
        return;
    }
    let (min, max) =
        all.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), s| (a.min(s.centre), b.max(s.centre)));
    let size = max - min;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    spheres.sort_by(|(_, a), (_, b)| a.centre[axis].total_cmp(&b.centre[axis]));
    let (left, right) = spheres.split_at_mut(spheres.len() / 2);
    divide(left, settings, found);
    divide(right, settings, found);
}

/// By variable: how far a unit of it moves any of `points` (in the frame that carries `link`), at
/// most; 0 where it does not. From the point inwards a ball is known that holds it, whatever the joints
/// passed so far do: one that turns leaves a ball about its axis.
fn reach_of(group: &Group, link: usize, frame_from_link: &Pose, points: &[Vec3]) -> Vec<f64> {
    let mut most: Vec<f64> = vec![0.0; group.kinematics.arm_joints + 1];
    let steps = group.kinematics.steps();
    for point in points {
        // Joints that mimic one another add up.
        let mut reach = vec![0.0; most.len()];
        let mut at = link;
        let (mut centre, mut radius) = (frame_from_link.inverse_point(*point), 0.0);
        while at != 0 {
            let step = &steps[at];
            match step.motion {
                Motion::Still => {}
                Motion::Turn { axis, source } => {
                    let axis = axis.normalize();
                    radius += centre.reject_from_normalized(axis).length();
                    centre = axis * centre.dot(axis);
                    reach[source.variable] += radius * source.multiplier.abs();
                }
                Motion::Slide { axis, source } => {
                    let (low, high) = group.range(source.variable);
                    let [a, b] = [low, high].map(|v| source.multiplier * v + source.offset);
                    centre += axis * f64::midpoint(a, b);
                    radius += axis.length() * (b - a).abs() / 2.0;
                    reach[source.variable] += axis.length() * source.multiplier.abs();
                }
            }
            centre = step.parent_from_joint.point(centre);
            at = step.parent;
        }
        most.iter_mut().zip(reach).for_each(|(m, r)| *m = m.max(r));
    }
    most
}

/// The same for all points of a link's own shapes.
pub(crate) fn reach_of_link(group: &Group, link: usize) -> Vec<f64> {
    reach_of(group, link, &Pose::IDENTITY, &corners(&group.links[link].collision))
}

/// The same for one part of them.
pub(crate) fn reach_of_part(group: &Group, link: usize, part: usize) -> Vec<f64> {
    let solid = Solid { parts: group.links[link].collision.parts[part..=part].to_vec() };
    reach_of(group, link, &Pose::IDENTITY, &corners(&solid))
}

/// Points whose hull holds a solid: distances from an axis are greatest at one of them.
fn corners(solid: &Solid) -> Vec<Vec3> {
    let boxed = |half: Vec3| -> Vec<Vec3> {
        let sign = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        (0..8).map(|i| half * Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2))).collect()
    };
    let part = |(pose, convex): &(Pose, Convex)| -> Vec<Vec3> {
        let own = match convex {
            Convex::Sphere { radius } => boxed(Vec3::splat(*radius)),
            Convex::Capsule { radius, half } => boxed(Vec3::new(*radius, *radius, half + radius)),
            Convex::Cylinder { radius, half } => boxed(Vec3::new(*radius, *radius, *half)),
            Convex::Box { half } => boxed(*half),
            Convex::Hull(hull) => hull.points.clone(),
        };
        own.into_iter().map(|p| pose.point(p)).collect()
    };
    solid.parts.iter().flat_map(part).collect()
}
