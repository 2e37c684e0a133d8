//! `clearway bench`: experiments that can be run again.

use super::bench_motion;
use crate::cli::{BenchArgs, Experiment};
use crate::exit::{Exit, Failure};

pub fn run(args: &BenchArgs) -> Result<Exit, Failure> {
    match &args.experiment {
        Experiment::Motion(args) => bench_motion::run(args),
    }
}
