//! Turns a plan file into its page: `cargo run -p clearway-viewer --example page -- PLAN.json PAGE.html`

use clearway_plan::PlanFile;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(from), Some(to)) = (arguments.next(), arguments.next()) else {
        return Err("expected two arguments: PLAN.json PAGE.html".into());
    };
    let plan: PlanFile = serde_json::from_str(&std::fs::read_to_string(from)?)?;
    std::fs::write(to, clearway_viewer::page(&plan)?)?;
    Ok(())
}
