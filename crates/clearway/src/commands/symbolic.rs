//! `clearway plan --goal`: what is planned with symbols and streams.

use crate::cli::{AlgorithmKind, SymbolicArgs};
use crate::exit::Failure;
use clearway::pddl::{
    self, Algorithm, Asked, Constant, Domain, Engine, FastDownward, Ferroplan, Goal, Handling, Stream,
};
use clearway::{FileError, Outcome, Request};
use clearway_files::{Limits, read_text};
use std::path::{Path, PathBuf};

/// What messages call a goal given on the command line.
const GIVEN: &str = "--goal";

pub fn solve(
    args: &SymbolicArgs,
    handling: &mut Handling,
    request: &Request,
    directory: &Path,
) -> Result<Outcome, Failure> {
    let domain = match &args.domain {
        Some(path) => Domain::load(path)?,
        None => pddl::domain(),
    };
    let streams = match &args.streams {
        Some(path) => Stream::load_all(path, &domain, &pddl::PROVIDED)?,
        None => pddl::streams(&domain)?,
    };
    let named = args.domain.as_deref().unwrap_or(Path::new("the built-in domain"));
    pddl::check(&domain, &streams).map_err(|why| {
        FileError::new(named, why).help("`clearway pddl domain` and `streams` print what is built in")
    })?;
    let known = pddl::constants(&domain, handling).map_err(|why| FileError::new(named, why))?;
    // A slip in a name would quietly mean nothing.
    let unknown = |c: &&Constant| {
        ["item", "place", "shelf"].iter().any(|of| domain.types.named(of) == Some(c.of))
            && known.iter().all(|k| k.name != c.name)
    };
    if let Some(constant) = domain.constants.iter().find(unknown) {
        let text = args.domain.as_deref().and_then(|path| read_text(path, &Limits::DOCUMENT).ok()).unwrap_or_default();
        let found = format!(
            "the scene has nothing that is called `{}`, a {} of the domain",
            constant.name, domain.types.names[constant.of.0]
        );
        return Err(FileError::new(named, found)
            .at_position(position(&text, &constant.name))
            .help("names are those of the scene's objects, places and shelves")
            .into());
    }
    let goal = match &args.goal {
        Some(goal) if goal.trim_start().starts_with('(') => Goal::read(Path::new(GIVEN), goal, &domain, &known)?,
        Some(file) => {
            let formula = "a goal is a file, or a formula, which begins with `(`";
            let text = read_text(Path::new(file), &Limits::DOCUMENT)
                .map_err(|e| if Path::new(file).exists() { e } else { e.help(formula) })?;
            Goal::read(Path::new(file), &text, &domain, &known)?
        }
        None => pddl::retrieval(&domain, handling.scene())
            .ok_or_else(|| FileError::new(named, "the domain has no predicate `On`"))?,
    };
    let algorithm = match args.algorithm {
        None | Some(AlgorithmKind::Focused) => Algorithm::Focused,
        Some(AlgorithmKind::Incremental) => Algorithm::Incremental,
    };
    let asked_in = Path::new(args.goal.as_deref().filter(|g| !g.trim_start().starts_with('(')).unwrap_or(GIVEN));
    pddl::check_goal(&domain, &streams, &goal)
        .map_err(|why| FileError::new(asked_in, why).expected("what actions change, or is derived from that"))?;
    if let Some(driver) = args.fast_downward.as_deref().filter(|driver| !driver.is_file()) {
        return Err(FileError::new(driver, "no such file")
            .expected("Fast Downward's driver script, `fast-downward.py`")
            .into());
    }
    let downward = args.fast_downward.clone().map(|driver| FastDownward { python: PathBuf::from("python3"), driver });
    let engine: &dyn Engine = match &downward {
        Some(downward) => downward,
        None => &Ferroplan::default(),
    };
    let asked = Asked {
        domain: &domain,
        streams: &streams,
        goal: &goal,
        retrieval: args.goal.is_none(),
        algorithm,
        engine,
        sequences: !args.all_movable,
        // Whoever asks for symbols gets them.
        removals: args.goal.is_some()
            && !(args.symbolic || args.all_movable)
            && args.algorithm.is_none()
            && args.fast_downward.is_none()
            && args.domain.is_none()
            && args.streams.is_none(),
    };
    Ok(clearway::solve_goal(handling, &asked, request, directory))
}

/// Line and column at which a name first stands in a text.
fn position(text: &str, name: &str) -> Option<(usize, usize)> {
    let before = |c: Option<char>| c.is_none_or(|c| c.is_whitespace() || c == '(' || c == ')');
    let whole = |at: &usize| before(text[..*at].chars().next_back()) && before(text[at + name.len()..].chars().next());
    let at = text.match_indices(name).map(|(at, _)| at).find(whole)?;
    let line = text[..at].matches('\n').count() + 1;
    let column = text[..at].rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
    Some((line, column))
}
