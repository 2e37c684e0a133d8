//! `clearway schema`: the JSON Schema of a file, from the types that read it.

use super::output::print;
use crate::cli::{Document, SchemaArgs};
use crate::exit::{Exit, Failure};
use clearway::{MotionFile, PlanFile, RobotFile, SceneFile};
use schemars::schema_for;

pub fn run(args: &SchemaArgs) -> Result<Exit, Failure> {
    let schema = match args.file {
        Document::Scene => schema_for!(SceneFile),
        Document::Robot => schema_for!(RobotFile),
        Document::Plan => schema_for!(PlanFile),
        Document::Motion => schema_for!(MotionFile),
    };
    let text = serde_json::to_string_pretty(&schema).map_err(|e| Failure::internal(e.to_string()))?;
    print(format!("{text}\n"))?;
    Ok(Exit::Done)
}
