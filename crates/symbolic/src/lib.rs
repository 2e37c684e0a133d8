//! PDDL with streams, joined to the retrieval planner (section V-C).
//!
//! | module | |
//! |---|---|
//! | [`pddl`] | domains, streams and goals, as read |
//! | [`facts`], [`ground`] | what holds; a domain over it without variables |
//! | [`relevance`] | which of its actions can matter |
//! | [`engine`] | symbolic engines behind a trait |
//! | [`store`], [`hope`], [`search`] | streams at work, and the focused and incremental algorithms |
//! | [`arm`] | the streams of pick-and-place |
//! | [`telling`] | a scene in facts |
//! | [`needs`], [`necessity`] | what certainly has to be moved for a goal |
//! | [`hopeless`], [`removals`] | goals for which that cannot be, and goals for which that is all |
//! | [`problem`] | a scene and a goal in, a plan out; the join with removal sequences |
//!
//! `domain.pddl` and `streams.pddl` beside this file are the built-in ones.

use clearway_files::FileError;
use pddl::{Domain, Stream};
use std::path::Path;

pub mod arm;
pub mod engine;
pub mod facts;
pub mod ground;
pub mod hope;
pub mod hopeless;
pub mod necessity;
pub mod needs;
pub mod pddl;
pub mod problem;
pub mod relevance;
pub mod removals;
pub mod search;
pub mod store;
pub mod telling;

/// The built-in domain and streams, as text.
pub const DOMAIN: &str = include_str!("domain.pddl");
pub const STREAMS: &str = include_str!("streams.pddl");

/// The built-in domain.
pub fn domain() -> Domain {
    built_in(Domain::read(Path::new("the built-in domain"), DOMAIN))
}

/// The built-in streams, for a domain that may have been changed.
pub fn streams(domain: &Domain) -> Result<Vec<Stream>, FileError> {
    Stream::read_all(Path::new("the built-in streams"), STREAMS, domain, &arm::PROVIDED)
}

/// What comes with the program is sound: a test reads it.
fn built_in<T>(read: Result<T, FileError>) -> T {
    read.unwrap_or_else(|error| unreachable!("{error}"))
}
