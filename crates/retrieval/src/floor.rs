//! The scene as the roadmap sees it: from above, the target with the gripper a disc.
//!
//! Objects are their smallest enclosing circles, walls are outlines; only what stands at the
//! target's height counts. World x and y, metres.

use clearway_geometry::footprint::{Outline, enclosing_circle};
use clearway_geometry::{Circle, Pose, Solid, Vec2};
use clearway_plan::scene_file::Rect;
use clearway_plan::{ObjectId, ObjectSet};
use clearway_robot::Robot;
use clearway_scene::Scene;
use std::collections::VecDeque;

/// Circles, walls, and the disc that is to be brought out.
#[derive(Clone, Debug)]
pub struct Floor {
    /// Of all objects but the target and what stands higher or lower.
    circles: Vec<(Circle, ObjectId)>,
    walls: Vec<Outline>,
    /// The height of the highest object's top, the target's included, metres.
    top: f64,
    /// r_b of Appendix B: the target with the gripper.
    pub radius: f64,
    /// Walls are kept away from by the target's own radius only: the hand need not be there.
    wall_radius: f64,
    /// x_g
    pub goal: Vec2,
    /// x_s
    pub exit: Vec2,
    /// Where samples are drawn.
    pub workspace: Rect,
    /// The rectangle round all objects at the target's height, wider by the disc.
    clutter: Rect,
}

impl Floor {
    pub fn new(scene: &Scene, robot: &Robot) -> Self {
        let target = &scene.objects[scene.target.index()];
        let own = enclosing_circle(&target.solid, &target.pose);
        let (low, high) = target.solid.aabb(target.pose);
        let level = |solid: &Solid, pose: &Pose| {
            let (a, b) = solid.aabb(*pose);
            a.z < high.z - 0.002 && b.z > low.z + 0.002
        };
        let circles: Vec<(Circle, ObjectId)> = scene
            .objects
            .iter()
            .enumerate()
            .filter(|(i, o)| *i != scene.target.index() && level(&o.solid, &o.pose))
            .map(|(i, o)| (enclosing_circle(&o.solid, &o.pose), ObjectId(i as u16)))
            .collect();
        let walls: Vec<Outline> = scene
            .fixtures
            .iter()
            .flat_map(|f| f.solid.parts.iter().map(|(pose, convex)| (Solid::new(convex.clone()), f.pose * *pose)))
            .filter(|(solid, pose)| level(solid, pose))
            .map(|(solid, pose)| Outline::of(&solid, &pose))
            .collect();
        let goal = own.centre;
        let beside = walls.iter().map(|w| w.segment_distance(goal, goal)).fold(f64::INFINITY, f64::min);
        let top = scene.objects.iter().map(|o| o.solid.aabb(o.pose).1.z).fold(f64::NEG_INFINITY, f64::max);
        let mut floor = Self {
            top,
            circles,
            walls,
            radius: robot.hand.base_radius.max(own.radius + robot.hand.finger_thickness),
            wall_radius: (own.radius + 0.002).min(beside - 1e-6).max(0.0),
            goal,
            exit: goal,
            workspace: Rect { min: goal.to_array(), max: goal.to_array() },
            clutter: Rect { min: goal.to_array(), max: goal.to_array() },
        };
        let clutter = floor.around_clutter();
        floor.exit = match scene.file.exit {
            Some(exit) => Vec2::from_array(exit),
            None => floor.find_exit(&clutter, scene.base.translation.truncate()),
        };
        floor.workspace = scene.file.workspace.unwrap_or(Rect {
            min: (Vec2::from_array(clutter.min).min(floor.exit)).to_array(),
            max: (Vec2::from_array(clutter.max).max(floor.exit)).to_array(),
        });
        floor.clutter = clutter;
        floor
    }

    /// For a base that drives: the roadmap spans the free space round the clutter as well (section V-B), so that
    /// the target may leave on any side.
    pub fn open_all_round(&mut self) {
        let wider = 2.0 * self.radius;
        for axis in 0..2 {
            self.workspace.min[axis] = self.workspace.min[axis].min(self.clutter.min[axis] - wider);
            self.workspace.max[axis] = self.workspace.max[axis].max(self.clutter.max[axis] + wider);
        }
    }

    /// Col(x).
    #[inline]
    pub fn collisions(&self, x: Vec2) -> ObjectSet {
        self.edge_collisions(x, x)
    }

    /// EdgeCol(a, b), in closed form.
    #[inline]
    pub fn edge_collisions(&self, a: Vec2, b: Vec2) -> ObjectSet {
        let mut set = ObjectSet::EMPTY;
        for (circle, object) in &self.circles {
            if circle.meets_sweep(a, b, self.radius) {
                set.insert(*object);
            }
        }
        set
    }

    /// Whether the target keeps off the walls from `a` to `b`.
    #[inline]
    pub fn walls_free(&self, a: Vec2, b: Vec2) -> bool {
        !self.walls.iter().any(|w| w.closer_than(a, b, self.wall_radius))
    }

    fn around_clutter(&self) -> Rect {
        let (mut min, mut max) = (self.goal, self.goal);
        for (c, _) in &self.circles {
            min = min.min(c.centre - c.radius);
            max = max.max(c.centre + c.radius);
        }
        Rect { min: (min - self.radius).to_array(), max: (max + self.radius).to_array() }
    }

    /// x_s: the free place nearest to the robot that the target reaches when nothing but the walls
    /// stands, on a grid of 2 cm a little beyond the clutter.
    fn find_exit(&self, clutter: &Rect, robot: Vec2) -> Vec2 {
        const CELL: f64 = 0.02;
        let min = Vec2::from_array(clutter.min) - 0.06 - self.radius;
        let max = Vec2::from_array(clutter.max) + 0.06 + self.radius;
        let count = ((max - min) / CELL).ceil().min(Vec2::splat(400.0));
        let (nx, ny) = (count.x as i64 + 1, count.y as i64 + 1);
        let at = |i: i64, j: i64| min + Vec2::new(i as f64, j as f64) * CELL;
        let index = |i: i64, j: i64| (j * nx + i) as usize;
        let mut seen = vec![false; (nx * ny) as usize];
        let from = ((self.goal - min) / CELL).round();
        let mut queue = VecDeque::from([(from.x as i64, from.y as i64)]);
        seen[index(from.x as i64, from.y as i64)] = true;
        let mut best: Option<(f64, Vec2)> = None;
        while let Some((i, j)) = queue.pop_front() {
            let here = at(i, j);
            if self.collisions(here).is_empty() {
                let away = here.distance(robot);
                if best.is_none_or(|(d, _)| away < d - 1e-9) {
                    best = Some((away, here));
                }
            }
            for (di, dj) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let (x, y) = (i + di, j + dj);
                if x < 0 || y < 0 || x >= nx || y >= ny || seen[index(x, y)] || !self.walls_free(here, at(x, y)) {
                    continue;
                }
                seen[index(x, y)] = true;
                queue.push_back((x, y));
            }
        }
        best.map_or(self.goal, |(_, p)| p)
    }

    /// Whether something at `p`, with the disc round it and nothing of it below `bottom`, is beside
    /// or above all clutter.
    pub fn beyond_clutter(&self, p: Vec2, bottom: f64) -> bool {
        let r = &self.clutter;
        bottom > self.top || p.x < r.min[0] || p.y < r.min[1] || p.x > r.max[0] || p.y > r.max[1]
    }
}
