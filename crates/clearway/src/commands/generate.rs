//! `clearway generate`: makes scenes.

use super::output::{self, tell};
use crate::cli::{GenerateArgs, Kind};
use crate::exit::{Exit, Failure};
use clearway::scenarios::{self, NoScene, Wanted};

pub fn run(args: &GenerateArgs) -> Result<Exit, Failure> {
    output::check(args.output.as_deref(), &[])?;
    let (usual, least) = match args.kind {
        Kind::Shelf => (12, 2),
        Kind::Large => (100, 10),
        Kind::Table => (20, 1),
        Kind::Occluded => (12, 1),
        Kind::Stacked => (8, 3),
    };
    if args.contrast && !matches!(args.kind, Kind::Table) {
        return Err(Failure::bad_input("--contrast is for `generate table`: other robots do not drive".to_owned()));
    }
    let objects = args.objects.unwrap_or(usual);
    let least = args.least_removals.unwrap_or(least.min(objects));
    let wanted = Wanted { objects, seed: args.seed, least_removals: Some(least) };
    let drawn = match args.kind {
        Kind::Shelf => scenarios::shelf(&wanted),
        Kind::Large => scenarios::large(&wanted),
        Kind::Table => scenarios::table(&wanted, args.contrast),
        Kind::Occluded => scenarios::occluded(&wanted),
        Kind::Stacked => scenarios::stacked(&Wanted { least_removals: args.least_removals, ..wanted }),
    };
    let drawn = drawn.map_err(|error| match error {
        NoScene::Unsound(_) => Failure::internal(error.to_string()),
        _ => Failure::bad_input(format!("{error} (--objects {objects})")),
    })?;
    let text =
        serde_saphyr::to_string(&drawn.file).map_err(|e| Failure::internal(format!("the scene is no YAML: {e}")))?;
    match &args.output {
        Some(path) => output::write(path, text.as_bytes())?,
        None => output::print(&text)?,
    }
    if matches!(args.kind, Kind::Occluded) {
        tell(&format!(
            "{} objects, target {}; {} rejected because no plan was found even with all of them known",
            drawn.file.objects.len(),
            drawn.file.target,
            drawn.rejected
        ));
        return Ok(Exit::Done);
    }
    if matches!(args.kind, Kind::Table) && (args.contrast || least <= 1) {
        let why = if args.contrast { "; draws in which driving does not help were rejected" } else { "" };
        tell(&format!(
            "{} objects, target {}; {} rejected{why}",
            drawn.file.objects.len(),
            drawn.file.target,
            drawn.rejected
        ));
        if !drawn.as_wanted {
            tell("warning: no draw was one in which driving helps; the last one is kept");
        }
        return Ok(Exit::Done);
    }
    if matches!(args.kind, Kind::Stacked) && args.least_removals.is_none() {
        tell(&format!(
            "{} objects, target {}; {} rejected because something else than the one on top, one below it and the target has to go",
            drawn.file.objects.len(),
            drawn.file.target,
            drawn.rejected
        ));
        if !drawn.as_wanted {
            tell("warning: no draw was like that; the last one is kept");
        }
        return Ok(Exit::Done);
    }
    let stuck = if matches!(args.kind, Kind::Large) { ", or more than twice as many are needed" } else { "" };
    tell(&format!(
        "{} objects, target {}; {} draw{} rejected because fewer than {least} removals suffice{stuck}",
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
