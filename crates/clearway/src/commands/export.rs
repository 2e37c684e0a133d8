//! `clearway export`: a plan for other programs.

use super::{directory_of, output};
use crate::cli::{ExportArgs, Format};
use crate::exit::{Exit, Failure};
use clearway::export::{Csv, ExportError, Exporter, JointTrajectory, Mcap, rename_joints};
use std::io::IsTerminal;

pub fn run(args: &ExportArgs) -> Result<Exit, Failure> {
    output::check(args.output.as_deref(), &[&args.plan])?;
    let mut plan = clearway::read_plan(&args.plan)?;
    let wrong = |error: ExportError| Failure::bad_input(format!("{}: {error}", args.plan.display()));
    for (old, new) in &args.rename {
        rename_joints(&mut plan, old, new).map_err(wrong)?;
    }
    let exporter: Box<dyn Exporter> = match args.to {
        Format::JointTrajectory => Box::new(JointTrajectory::default()),
        Format::Mcap => {
            if !args.rename.is_empty() {
                return Err(Failure::bad_input(
                    "`--rename` is not for MCAP, where joints are called as in the URDF: leave it out",
                ));
            }
            if args.output.is_none() && std::io::stdout().is_terminal() {
                return Err(Failure::bad_input(
                    "MCAP is nothing to read on a terminal: name a file with `-o FILE.mcap`",
                ));
            }
            let (meshes, missing) = clearway::scene_meshes(&plan, &directory_of(&args.plan));
            for error in missing {
                output::tell(&format!("warning: not drawn: {error}"));
            }
            Box::new(Mcap { meshes })
        }
        Format::Csv => Box::new(Csv),
    };
    let bytes = exporter.export(&plan).map_err(wrong)?;
    match &args.output {
        Some(path) => output::write(path, &bytes)?,
        None => output::print(&bytes)?,
    }
    Ok(Exit::Done)
}
