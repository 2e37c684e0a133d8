//! `clearway verify`: judges a plan file.

use super::budget;
use super::output::print;
use crate::cli::VerifyArgs;
use crate::exit::{Exit, Failure};
use clearway::Stop;
use clearway_verify::CannotJudge;

pub fn run(args: &VerifyArgs) -> Result<Exit, Failure> {
    let report = clearway::verify_file(&args.plan, &budget(None)).map_err(|error| match error {
        CannotJudge::Stopped(Stop::Cancelled) => Failure { exit: Exit::Interrupted, message: "interrupted".to_owned() },
        CannotJudge::File(error) => error.into(),
        other => Failure::bad_input(format!("{}: {other}", args.plan.display())),
    })?;
    if args.json {
        let json = serde_json::to_string(&report).map_err(|e| Failure::internal(e.to_string()))?;
        print(format!("{json}\n"))?;
    } else {
        print(report.to_string())?;
    }
    Ok(if report.is_valid() { Exit::Done } else { Exit::Violations })
}
