//! `clearway export`: a plan for other programs.

use super::output;
use crate::cli::{ExportArgs, Format};
use crate::exit::{Exit, Failure};
use clearway::export::{Csv, Exporter, JointTrajectory};

pub fn run(args: &ExportArgs) -> Result<Exit, Failure> {
    output::check(args.output.as_deref(), &[&args.plan])?;
    let plan = clearway::read_plan(&args.plan)?;
    let exporter: Box<dyn Exporter> = match args.to {
        Format::JointTrajectory => Box::new(JointTrajectory::default()),
        Format::Csv => Box::new(Csv),
    };
    let bytes = exporter.export(&plan).map_err(|e| Failure::bad_input(format!("{}: {e}", args.plan.display())))?;
    match &args.output {
        Some(path) => output::write(path, &bytes)?,
        None => output::print(&bytes)?,
    }
    Ok(Exit::Done)
}
