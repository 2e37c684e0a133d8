//! `clearway generate`: makes scenes.

use super::output::{self, tell};
use crate::cli::{GenerateArgs, Kind};
use crate::exit::{Exit, Failure};
use clearway::scenarios::{self, NoScene, Wanted};

pub fn run(args: &GenerateArgs) -> Result<Exit, Failure> {
    output::check(args.output.as_deref(), &[])?;
    let wanted = Wanted { objects: args.objects, seed: args.seed, least_removals: args.least_removals };
    let drawn = match args.kind {
        Kind::Shelf => scenarios::shelf(&wanted),
    };
    let drawn = drawn.map_err(|error| match error {
        NoScene::Unsound(_) => Failure::internal(error.to_string()),
        _ => Failure::bad_input(format!("{error} (--objects {})", args.objects)),
    })?;
    let text = serde_saphyr::to_string(&drawn.file).map_err(|e| Failure::internal(format!("the scene is no YAML: {e}")))?;
    match &args.output {
        Some(path) => output::write(path, text.as_bytes())?,
        None => output::print(&text)?,
    }
    let least = args.least_removals.unwrap_or(2);
    tell(&format!(
        "{} objects, target {}; {} draw{} rejected because fewer than {least} removals suffice",
        drawn.file.objects.len(),
        drawn.file.target,
        drawn.rejected,
        if drawn.rejected == 1 { "" } else { "s" },
    ));
    if !drawn.as_wanted {
        tell("warning: no draw needed that many; the last one is kept");
    }
    Ok(Exit::Done)
}
