//! `clearway bench`: experiments that can be run again.

use super::{bench_motion, bench_report, bench_retrieval};
use crate::cli::{BenchArgs, Experiment as Named};
use crate::exit::{Exit, Failure};
use clearway_experiments::retrieval::Experiment;

pub fn run(args: &BenchArgs) -> Result<Exit, Failure> {
    match &args.experiment {
        Named::Motion(args) => bench_motion::run(args),
        Named::Known(args) => bench_retrieval::run(Experiment::Known, args),
        Named::Graphs(args) => bench_retrieval::run(Experiment::Graphs, args),
        Named::Peers(args) => bench_retrieval::run(Experiment::Peers, args),
        Named::Large(args) => bench_retrieval::run(Experiment::Large, args),
        Named::Optimal(args) => bench_retrieval::run(Experiment::Optimal, args),
        Named::Occlusion(args) => bench_retrieval::run(Experiment::Occlusion, args),
        Named::Mobile(args) => bench_retrieval::run(Experiment::Mobile, args),
        Named::Stacked(args) => bench_retrieval::run(Experiment::Stacked, args),
        Named::Report(args) => bench_report::run(args),
    }
}
