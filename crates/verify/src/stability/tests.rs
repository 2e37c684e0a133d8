use super::*;
use crate::case::Thing;
use crate::meshes::Meshes;
use crate::shapes::{Piece, cuboid, cylinder_along_z};
use crate::urdf;
use parry3d_f64::shape::SharedShape;
use std::path::Path;
use std::time::Instant;

fn thing(id: String, (turn, shape): (Pose, SharedShape), at: [f64; 3]) -> Thing {
    Thing { id, pieces: vec![Piece::new(turn, shape)], pose: Pose::from_translation(at.into()) }
}

/// Cylinders in rows and layers, on a board between walls.
fn shelf(rows: [u32; 3]) -> Case {
    let urdf = r#"<robot name="r"><link name="l"/></robot>"#;
    let model = urdf::read(urdf, &mut Meshes::new(&[], Path::new(""))).expect("a robot");
    let boxed = |id: &str, size, at| thing(id.to_owned(), (Pose::IDENTITY, cuboid(size)), at);
    let [columns, depth, layers] = rows;
    let [width, deep] = [columns, depth].map(|n| 0.07 * f64::from(n));
    let objects = (0..columns * depth * layers).map(|i| {
        let (x, y, z) = (i % columns, i / columns % depth, i / columns / depth);
        let at = [0.07 * f64::from(x) - 0.03, 0.07 * f64::from(y) - 0.03, 0.15 * f64::from(z) + 0.075];
        thing(format!("o{i}"), cylinder_along_z(0.03, 0.15), at)
    });
    let middle = [width, deep].map(|w| w / 2.0 - 0.065);
    Case {
        model,
        world_from_root: Pose::IDENTITY,
        fixtures: vec![
            boxed("board", [width, deep, 0.02], [middle[0], middle[1], -0.01]),
            boxed("left", [0.02, deep, 1.0], [-0.09, middle[1], 0.5]),
            boxed("back", [width, 0.02, 1.0], [middle[0], deep + 0.02, 0.5]),
        ],
        objects: objects.collect(),
        places: Vec::new(),
    }
}

#[test]
fn shelves_are_judged_in_no_time() {
    for rows in [[5, 4, 1], [10, 5, 2], [16, 16, 1], [8, 8, 4]] {
        let case = shelf(rows);
        let standing: Standing = case.objects.iter().map(|o| Some(o.pose)).collect();
        let mut report = Report::default();
        let start = Instant::now();
        let mut stability = Stability::new(&case, &standing, &Budget::unlimited()).expect("time");
        let found = start.elapsed();
        stability.check_start(&mut report);
        let judged = start.elapsed();
        let count = case.objects.len();
        assert!((0..count).all(|o| stability.is_carried(o)));
        // The last is at the top: taken, and put back 20 mm aside.
        let aside = Pose::translation(0.02, 0.0, 0.0) * case.objects[count - 1].pose;
        stability.take(count - 1, Place::step(0, 0.0), &mut report);
        stability.put(count - 1, &aside, Place::step(0, 1.0), &mut report);
        assert!(report.is_valid(), "{report}");
        let ms = |time: std::time::Duration| time.as_secs_f64() * 1e3;
        println!(
            "{count} cylinders: {:.3} ms to find what carries them, {:.3} ms to judge, {:.3} ms for one moved",
            ms(found),
            ms(judged - found),
            ms(start.elapsed() - judged)
        );
    }
}
