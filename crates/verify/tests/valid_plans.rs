//! Plans without a fault have no violations.

mod gantry;

use clearway_plan::Budget;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::time::Instant;

#[test]
fn gantry_plans_are_valid() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut slowest: f64 = 0.0;
    for _ in 0..50 {
        let plan = gantry::plan(&mut random);
        let start = Instant::now();
        let report = clearway_verify::verify(&plan, Path::new(""), &Budget::unlimited()).expect("judged");
        slowest = slowest.max(start.elapsed().as_secs_f64());
        assert!(report.is_valid(), "{report}");
    }
    println!("slowest of 50: {:.1} ms", slowest * 1e3);
}
