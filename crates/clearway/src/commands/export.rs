//! `clearway export`: a plan for other programs.

use super::write;
use crate::cli::{ExportArgs, Format};
use crate::exit::{Exit, Failure};
use clearway::export::{Csv, Exporter, JointTrajectory};
use std::io::Write;

pub fn run(args: &ExportArgs) -> Result<Exit, Failure> {
    let plan = clearway::read_plan(&args.plan)?;
    let exporter: Box<dyn Exporter> = match args.to {
        Format::JointTrajectory => Box::new(JointTrajectory::default()),
        Format::Csv => Box::new(Csv),
    };
    let bytes = exporter.export(&plan).map_err(|e| Failure::bad_input(format!("{}: {e}", args.plan.display())))?;
    match &args.output {
        Some(path) => write(path, &bytes)?,
        None => {
            let _ = std::io::stdout().write_all(&bytes);
        }
    }
    Ok(Exit::Done)
}
