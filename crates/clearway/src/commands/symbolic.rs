//! `clearway plan --goal`: what is planned with symbols and streams.

use crate::cli::{AlgorithmKind, SymbolicArgs};
use crate::exit::Failure;
use clearway::pddl::{self, Algorithm, Asked, Domain, Engine, FastDownward, Ferroplan, Goal, Handling, Stream};
use clearway::{FileError, Outcome, Request};
use clearway_files::{Limits, read_text};
use std::path::{Path, PathBuf};

/// What messages call a goal given on the command line.
const GIVEN: &str = "--goal";

pub fn solve(args: &SymbolicArgs, handling: &mut Handling, request: &Request, directory: &Path) -> Result<Outcome, Failure> {
    let domain = match &args.domain {
        Some(path) => Domain::load(path)?,
        None => pddl::domain(),
    };
    let streams = match &args.streams {
        Some(path) => Stream::load_all(path, &domain, &pddl::PROVIDED)?,
        None => pddl::streams(&domain)?,
    };
    let named = args.domain.as_deref().unwrap_or(Path::new("the built-in domain"));
    pddl::check(&domain).map_err(|why| FileError::new(named, why).help("`clearway pddl domain` prints one that has it"))?;
    let known = pddl::constants(&domain, handling).map_err(|why| FileError::new(named, why))?;
    let (path, text) = match &args.goal {
        Some(goal) if goal.trim_start().starts_with('(') => (PathBuf::from(GIVEN), goal.clone()),
        Some(file) => (PathBuf::from(file), read_text(Path::new(file), &Limits::DOCUMENT)?),
        None => (PathBuf::from(GIVEN), pddl::retrieval(handling.scene())),
    };
    let goal = Goal::read(&path, &text, &domain, &known)?;
    let algorithm = match args.algorithm {
        AlgorithmKind::Focused => Algorithm::Focused,
        AlgorithmKind::Incremental => Algorithm::Incremental,
    };
    let downward = args.fast_downward.clone().map(|driver| FastDownward { python: PathBuf::from("python3"), driver });
    let engine: &dyn Engine = match &downward {
        Some(downward) => downward,
        None => &Ferroplan::default(),
    };
    let asked = Asked { domain: &domain, streams: &streams, goal: &goal, retrieval: args.goal.is_none(), algorithm, engine, sequences: !args.all_movable };
    Ok(clearway::solve_goal(handling, &asked, request, directory))
}
