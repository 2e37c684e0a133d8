//! A plan played many times, each time in another world: how often it ends as planned, and what goes wrong.
//!
//! Every trial draws from its own generator, seeded by the seed and the trial's number: the same whatever the
//! number of threads.

use crate::bodies;
use crate::error::CannotSimulate;
use crate::noise;
use crate::outcome::Outcome;
use crate::run::{Course, Player};
use crate::settings::{Noise, Settings};
use clearway_plan::{Budget, PlanFile, parallel};
use clearway_verify::played::Played;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use serde::Serialize;
use std::path::Path;

/// A plan played many times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trials {
    pub seed: u64,
    pub noise: Noise,
    pub trials: Vec<Trial>,
    /// How many ended as planned, and in how many of them the robot touched what it should not.
    pub as_planned: usize,
    pub touched: usize,
    /// Objects that ended elsewhere, or were dropped, in any trial; the most frequent first.
    pub failing: Vec<Failing>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// From 0.
    pub index: usize,
    pub outcome: Outcome,
}

/// An object that fails.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failing {
    pub object: String,
    /// In how many trials.
    pub trials: usize,
    /// What became of it in most of them.
    pub why: String,
}

impl Trials {
    /// The part that ended as planned.
    pub fn rate(&self) -> f64 {
        self.as_planned as f64 / self.trials.len() as f64
    }
}

/// Plays a plan `count` times, on `threads` threads. `directory` is where its meshes are relative to.
pub fn trials(
    plan: &PlanFile,
    directory: &Path,
    settings: &Settings,
    noise: &Noise,
    (count, seed): (usize, u64),
    budget: &Budget,
) -> Result<Trials, CannotSimulate> {
    settings.validate().and_then(|()| noise.validate()).map_err(CannotSimulate::Settings)?;
    if count == 0 {
        return Err(CannotSimulate::Settings("the number of trials is 0; expected 1 or more".to_owned()));
    }
    let played = Played::new(plan, directory)?;
    let objects = bodies::objects(plan, &played)?;
    let course = Course::new(plan, &played);
    let one = |index: usize| {
        // Neighbouring seeds and trials differ in all their bits.
        let mixed = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (index as u64 + 1).wrapping_mul(0xD1B5_4A32_D192_ED03);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(mixed);
        let drawn = noise::draw(&played, &course.carriers, &objects, noise, &mut random);
        Player::new(plan, &played, &course, &drawn, settings, budget)?.play()
    };
    let trials =
        parallel::each(budget.threads(), 0..count, |index| one(index).map(|outcome| Trial { index, outcome }))?;
    Ok(Trials {
        as_planned: trials.iter().filter(|t| t.outcome.as_planned).count(),
        touched: trials.iter().filter(|t| t.outcome.touched).count(),
        failing: failing(&trials),
        seed,
        noise: *noise,
        trials,
    })
}

fn failing(trials: &[Trial]) -> Vec<Failing> {
    let mut failing: Vec<(String, Vec<&'static str>)> = Vec::new();
    for trial in trials {
        for (object, why) in failures(&trial.outcome) {
            match failing.iter_mut().find(|(o, _)| *o == object) {
                Some((_, whys)) => whys.push(why),
                None => failing.push((object, vec![why])),
            }
        }
    }
    let mut failing: Vec<Failing> = failing
        .into_iter()
        .map(|(object, whys)| {
            let count = |why: &str| whys.iter().filter(|w| **w == why).count();
            let why = whys.iter().rev().max_by_key(|w| count(w)).map_or(String::new(), |w| (*w).to_owned());
            Failing { object, trials: whys.len(), why }
        })
        .collect();
    failing.sort_by_key(|f| std::cmp::Reverse(f.trials));
    failing
}

/// Objects that failed, each once, with the first cause that there is.
fn failures(outcome: &Outcome) -> Vec<(String, &'static str)> {
    let mut found: Vec<(String, &'static str)> = Vec::new();
    let mut add = |object: &str, why| {
        if !found.iter().any(|(o, _)| o == object) {
            found.push((object.to_owned(), why));
        }
    };
    for hold in &outcome.holds {
        match (hold.held, hold.dropped) {
            (None, _) => add(&hold.object, "the hand did not have it"),
            (_, Some(_)) => add(&hold.object, "dropped from the hand"),
            _ => {}
        }
    }
    for end in outcome.elsewhere() {
        let why = match (end.moved, end.fallen) {
            (_, true) => "fell",
            (true, _) => "put down elsewhere than planned",
            (false, _) => "nudged",
        };
        add(&end.object, why);
    }
    found
}
