//! `clearway plan`: the main job.

use super::output::{self, print, tell, write_page, write_plan};
use super::summary::{self, Progress};
use super::symbolic;
use super::{budget, directory_of};
use crate::cli::{First, LookKind, PlanArgs, SearchKind};
use crate::exit::{Exit, Failure};
use clearway::pddl::Handling;
use clearway::{
    CollisionModel, FileError, FirstLimit, LookRule, Outcome, Planner, Pushes, Request, Search, Settings, Stop, Unfit,
};
use clearway_files::{Limits, yaml};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// The paper's limit for one planning instance (section VI-A), seconds.
const TIME_LIMIT: f64 = 60.0;

pub fn run(args: &PlanArgs) -> Result<Exit, Failure> {
    output::check(args.output.as_deref().into_iter().chain(args.html.as_deref()), &[&args.scene])?;
    let (scene, robot) = clearway::open(&args.scene, &args.package)?;
    let mut budget = budget(args.threads);
    if let Some(iterations) = args.iterations {
        budget = budget.with_iterations(iterations);
    }
    // Iterations alone make runs repeatable; a clock only cuts in where one was asked for.
    if args.time_limit.is_some() || args.iterations.is_none() {
        budget = budget.with_time(Duration::from_secs_f64(args.time_limit.unwrap_or(TIME_LIMIT)));
    }
    let request = Request::new(args.seed, budget);
    let directory = args.output.as_deref().map_or(PathBuf::from("."), directory_of);
    let mut progress = Progress::new(!args.json);
    if scene.file.camera.is_some() {
        if args.symbolic.asked() {
            let why = "a goal in PDDL is for scenes without a camera: what is hidden has no name";
            return Err(Failure::bad_input(why.to_owned()));
        }
        if args.improve.is_some() {
            let why = "--improve is for scenes without a camera: what was done to look cannot be taken back";
            return Err(Failure::bad_input(why.to_owned()));
        }
        let model = Arc::new(CollisionModel::new(robot));
        let outcome =
            clearway::solve_observed(scene, model, settings(args), rule(args), &request, &directory, &mut progress);
        progress.clear();
        return finish(
            outcome.map_err(|u| unfit(&args.scene, &u))?,
            args.output.as_deref(),
            args.html.as_deref(),
            &directory,
            args.json,
        );
    }
    if let Some(option) = args.symbolic.unused() {
        return Err(Failure::bad_input(format!("{option} is for plans with --goal or --symbolic")));
    }
    if args.symbolic.asked() && args.prefer_push {
        let why = "--prefer-push is for plans by the retrieval graph: symbols and streams only pick";
        return Err(Failure::bad_input(why.to_owned()));
    }
    if args.symbolic.asked() && (args.paper || args.search.is_some() || args.first_limit != First::One) {
        let why =
            "--paper, --search and --first-limit are for plans by the retrieval graph, without --goal and --symbolic";
        return Err(Failure::bad_input(why.to_owned()));
    }
    if args.symbolic.asked() {
        if args.improve.is_some() {
            return Err(Failure::bad_input(
                "--improve is for plans that have the target, without --goal and --symbolic".to_owned(),
            ));
        }
        let model = Arc::new(CollisionModel::new(robot));
        let mut handling =
            Handling::new(scene, model, settings(args), args.seed).map_err(|u| unfit(&args.scene, &u))?;
        let outcome = symbolic::solve(&args.symbolic, &mut handling, &request, &directory)?;
        progress.clear();
        return finish(outcome, args.output.as_deref(), args.html.as_deref(), &directory, args.json);
    }
    let mut planner = Planner::new(scene, robot, settings(args)).map_err(|u| unfit(&args.scene, &u))?;
    let outcome = clearway::solve(&mut planner, &request, &directory, &mut progress);
    progress.clear();
    let outcome = match (outcome, args.improve) {
        (Outcome::Solved(first), Some(spend)) => Outcome::Solved(clearway::improve(
            &mut planner,
            first,
            &request,
            Duration::from_secs_f64(spend),
            &directory,
        )),
        (outcome, _) => outcome,
    };
    finish(outcome, args.output.as_deref(), args.html.as_deref(), &directory, args.json)
}

/// Writes what was asked for, tells, and says how the program ends.
pub fn finish(
    outcome: Outcome,
    output: Option<&Path>,
    html: Option<&Path>,
    directory: &Path,
    json: bool,
) -> Result<Exit, Failure> {
    let (plan, report, exit) = match outcome {
        Outcome::Solved(verified) => {
            let report = verified.report().clone();
            (verified.into_inner(), Some(report), Exit::Done)
        }
        Outcome::Impossible(plan) => (*plan, None, Exit::Impossible),
        Outcome::OutOfBudget(_, Stop::Cancelled) => {
            return Err(Failure { exit: Exit::Interrupted, message: "interrupted; nothing was written".to_owned() });
        }
        Outcome::OutOfBudget(plan, _) => (*plan, None, Exit::OutOfBudget),
        Outcome::Refused(rejected) => {
            return Err(Failure::internal(format!(
                "the planner's own plan does not pass the verifier and was not written; please report this with the scene and the seed\n{rejected}"
            )));
        }
    };
    if let Some(path) = output {
        write_plan(path, &plan)?;
    }
    if let Some(path) = html {
        write_page(path, &plan, directory)?;
    }
    if json {
        print(format!("{}\n", summary::json(&plan, report.as_ref(), output, html)))?;
    }
    match (exit, json) {
        (Exit::Done, true) => {}
        (Exit::Done, false) => print(summary::text(&plan, output, html))?,
        (_, true) => tell(&summary::verdict(&plan)),
        (_, false) => tell(&summary::text(&plan, output, html)),
    }
    Ok(exit)
}

fn settings(args: &PlanArgs) -> Settings {
    let mut settings = if args.paper { Settings::paper() } else { Settings::default() };
    settings.first_limit = match args.first_limit {
        First::One => FirstLimit::One,
        First::Grasp => FirstLimit::GraspCover,
        First::All => FirstLimit::All,
    };
    match args.search {
        Some(SearchKind::Exact) => settings.search = Search::Exact,
        Some(SearchKind::Greedy) => settings.search = Search::Greedy,
        None => {}
    }
    settings.mobile.drives = !args.fixed_base;
    if args.no_push {
        settings.push.when = Pushes::Never;
    } else if args.prefer_push {
        settings.push.when = Pushes::Prefer;
    }
    settings
}

fn rule(args: &PlanArgs) -> LookRule {
    match args.look {
        LookKind::Expected => LookRule::Expected,
        LookKind::Farthest => LookRule::Farthest,
        LookKind::Largest => LookRule::Largest,
    }
}

fn unfit(scene: &Path, unfit: &Unfit) -> Failure {
    // The file is read again, for the line; if it is gone by now there is none.
    let text = clearway_files::read_text(scene, &Limits::DOCUMENT).unwrap_or_default();
    let error = |keys: &[&str], found: &str| FileError::new(scene, found).at_position(yaml::position(&text, keys));
    match unfit {
        Unfit::StartInCollision(contacts) => {
            let list: Vec<String> = contacts.iter().map(ToString::to_string).collect();
            error(&["robot", "start"], &format!("the robot's start posture is in collision: {}", list.join("; ")))
                .help("give a free `robot.start`, or move the robot's `base` or what it touches")
        }
        Unfit::StartTooNear(contacts) => {
            let list: Vec<String> = contacts.iter().map(|c| c.to_string().replace(" touches ", " to ")).collect();
            error(&["clearance"], &format!("at the start there is less room than the clearance asked for: {}", list.join("; ")))
                .help("ask for less, or give another `robot.start`")
        }
        Unfit::BadStart(why) => error(&["robot", "start"], why).help("`clearway robot` lists the joints and their limits"),
        Unfit::Region(why) => error(&["robot", "region"], why).help("make the region larger, or move the robot's start"),
        Unfit::Drives(why) => error(&["robot"], why).help("hold the base still: a robot file without `mobile`, the base's pose in the scene"),
        Unfit::Camera(why) => error(&["camera"], why).help("move it, or turn it towards the objects with `look_at`"),
        Unfit::NoPlace(why) => error(&["place"], why).help(
            "add one: `place: [{id: tray, size: [0.5, 0.8], position: [x, y, z]}]`, position being the centre of its top face",
        ),
    }
    .into()
}
