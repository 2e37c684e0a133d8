//! `clearway view`: a plan as a page.

use super::directory_of;
use super::output::{check, print, write_page};
use crate::cli::ViewArgs;
use crate::exit::{Exit, Failure};

pub fn run(args: &ViewArgs) -> Result<Exit, Failure> {
    let output = args.output.clone().unwrap_or_else(|| args.plan.with_extension("html"));
    check([output.as_path()], &[&args.plan])?;
    let plan = clearway::read_plan(&args.plan)?;
    write_page(&output, &plan, &directory_of(&args.plan))?;
    print(format!("page: {}\n", output.display()))?;
    Ok(Exit::Done)
}
