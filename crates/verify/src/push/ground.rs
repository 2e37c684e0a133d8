//! What the pushed object slides on: the same all along, without the object's tipping over an edge.

use super::{Line, Push, Row, shifted};
use crate::report::Report;
use crate::rest::{self, Standing};
use crate::stability::Stability;
use clearway_plan::scene_file::FRICTION;
use parry3d_f64::math::Pose;

/// Places on the way that are looked at are so far apart, metres; there are at most so many.
const APART: f64 = 0.01;
const PLACES: f64 = 100.0;

pub(super) struct Ground {
    pub carriers: Vec<String>,
    /// From the object's centre of mass to the edge in the direction of the push, at the least, metres.
    pub reach: f64,
    /// Coefficient.
    pub friction: f64,
}

impl Ground {
    pub fn judge(
        push: &Push,
        standing: &Standing,
        (rows, line, ways): (&[Row], &Line, &[f64]),
        stability: &mut Stability,
        report: &mut Report,
    ) -> Self {
        let carriers = |at: &Pose| -> Vec<String> {
            rest::carriers(push.case, standing, push.object, at).into_iter().map(str::to_owned).collect()
        };
        let first = carriers(&push.from);
        above(push, standing, line, &rows[0], report);
        let places = (line.distance / APART).ceil().clamp(1.0, PLACES);
        let mut reach = f64::INFINITY;
        for i in 0..=places as usize {
            let way = line.distance * i as f64 / places;
            let at = shifted(&push.from, line.direction * way);
            let row = rows.iter().zip(ways).find(|(_, w)| **w >= way).map_or(&rows[rows.len() - 1], |(row, _)| row);
            let now = carriers(&at);
            let faults = report.violations.len();
            if now != first {
                let (id, before, now) = (push.id(), list(&first), list(&now));
                let what = format!("{id} stands on {before}; pushed {:.0} mm, on {now}", way * 1e3);
                push.fault(row.place, what, report);
            }
            stability.slide(push.object, &at, row.place, report);
            // Where nothing carries it, it is told so.
            let here = stability.reach(push.object, line.direction);
            reach = if here.is_finite() { reach.min(here) } else { reach };
            if report.violations.len() > faults {
                break;
            }
        }
        let friction = friction(push, &first);
        Self { carriers: first, reach, friction }
    }
}

/// Nothing stands on what is pushed.
fn above(push: &Push, standing: &Standing, line: &Line, row: &Row, report: &mut Report) {
    let object = &push.case.objects[push.object];
    let others = push.case.objects.iter().zip(standing).enumerate().filter(|(i, _)| *i != push.object);
    for (_, (other, at)) in others.filter(|_| line.distance > 0.0) {
        if at.is_some_and(|at| rest::rests_on(other, &at, object, &push.from)) {
            push.fault(row.place, format!("{} stands on {}, which is pushed", other.id, object.id), report);
        }
    }
}

/// Of the object on what carries it: of two objects the larger one counts.
fn friction(push: &Push, carriers: &[String]) -> f64 {
    let scene = &push.plan.scene;
    let of = |id: &str| {
        let body = scene.objects.iter().find(|o| o.id == id)?;
        Some(body.friction.or(scene.friction).unwrap_or(FRICTION))
    };
    let own = of(push.id()).unwrap_or(FRICTION);
    carriers.iter().filter_map(|id| of(id)).fold(own, f64::max)
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}
