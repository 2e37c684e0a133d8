//! One file per command.

pub mod bench;
mod bench_motion;
mod bench_report;
mod bench_retrieval;
pub mod demo;
pub mod explain;
pub mod export;
pub mod generate;
pub mod motion;
pub mod output;
pub mod pddl;
pub mod plan;
pub mod robot;
mod rows;
pub mod schema;
pub mod simulate;
mod summary;
mod symbolic;
pub mod verify;
pub mod view;

use crate::interrupt;
use clearway::Budget;
use std::path::{Path, PathBuf};

/// Nothing ends it but an interrupt; on so many threads, or on all cores.
fn budget(threads: Option<u32>) -> Budget {
    let threads = threads.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), |n| n as usize);
    Budget::unlimited().with_cancel(interrupt::flag()).with_threads(threads)
}

/// The directory of a file to be written or read, for paths relative to it.
fn directory_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}
