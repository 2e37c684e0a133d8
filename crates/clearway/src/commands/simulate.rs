//! `clearway simulate`: plays a plan file in a physics engine, once, or many times with noise.

use super::output::print;
use super::{budget, directory_of};
use crate::cli::SimulateArgs;
use crate::exit::{Exit, Failure};
use clearway::Stop;
use clearway::simulate::{CannotSimulate, Noise, Settings, simulate, trials};
use serde::Serialize;
use std::fmt::Display;

pub fn run(args: &SimulateArgs) -> Result<Exit, Failure> {
    let noise = Noise { position: args.noise, friction: args.noise_friction, radius: args.noise_radius };
    let mut settings = Settings::default();
    settings.grip = args.grip.unwrap_or(settings.grip);
    settings.rubber = args.rubber.unwrap_or(settings.rubber);
    settings.rate = args.rate.unwrap_or(settings.rate);
    settings.lag = args.lag.unwrap_or(settings.lag);
    settings.moved.position = args.tolerance.unwrap_or(settings.moved.position);
    settings.validate().and_then(|()| noise.validate()).map_err(Failure::bad_input)?;
    let plan = clearway::read_plan(&args.plan)?;
    let directory = directory_of(&args.plan);
    let budget = budget(args.threads);
    let failed = |error| match error {
        CannotSimulate::Stopped(Stop::Cancelled) => {
            Failure { exit: Exit::Interrupted, message: "interrupted".to_owned() }
        }
        other => Failure::bad_input(format!("{}: {other}", args.plan.display())),
    };
    if args.trials.is_none() && noise.is_none() {
        let outcome = simulate(&plan, &directory, &settings, &budget).map_err(failed)?;
        return tell(args.json, &outcome, outcome.as_planned);
    }
    let drawn = (args.trials.unwrap_or(1), args.seed);
    let report = trials(&plan, &directory, &settings, &noise, drawn, &budget).map_err(failed)?;
    tell(args.json, &report, report.as_planned == report.trials.len())
}

fn tell<R: Serialize + Display>(json: bool, report: &R, as_planned: bool) -> Result<Exit, Failure> {
    if json {
        let json = serde_json::to_string(report).map_err(|e| Failure::internal(e.to_string()))?;
        print(format!("{json}\n"))?;
    } else {
        print(report.to_string())?;
    }
    Ok(if as_planned { Exit::Done } else { Exit::Violations })
}
