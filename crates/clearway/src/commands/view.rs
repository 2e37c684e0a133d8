//! `clearway view`: a plan as a page.

use super::{directory_of, print, write_page};
use crate::cli::ViewArgs;
use crate::exit::{Exit, Failure};

pub fn run(args: &ViewArgs) -> Result<Exit, Failure> {
    let plan = clearway::read_plan(&args.plan)?;
    let output = args.output.clone().unwrap_or_else(|| args.plan.with_extension("html"));
    write_page(&output, &plan, &directory_of(&args.plan))?;
    print(&format!("page: {}\n", output.display()));
    Ok(Exit::Done)
}
