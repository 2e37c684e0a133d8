use std::time::Instant;
fn main() {
    for file in std::env::args().skip(1) {
        let path = std::path::Path::new(&file);
        let plan = clearway_verify::read_plan(path).expect("read");
        let mut best = f64::INFINITY;
        let mut text = String::new();
        for _ in 0..7 {
            let start = Instant::now();
            let report = clearway_verify::verify(&plan, path.parent().unwrap(), &clearway_plan::Budget::unlimited()).expect("judged");
            best = best.min(start.elapsed().as_secs_f64());
            text = format!("{report}");
        }
        println!("{file}: {:.1} ms {}", best * 1e3, text.lines().take(2).collect::<String>());
    }
}
