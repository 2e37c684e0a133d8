//! `clearway pddl`: the built-in domain and streams.

use super::output::print;
use crate::cli::{PddlArgs, PddlFile};
use crate::exit::{Exit, Failure};

pub fn run(args: &PddlArgs) -> Result<Exit, Failure> {
    print(match args.file {
        PddlFile::Domain => clearway::pddl::DOMAIN,
        PddlFile::Streams => clearway::pddl::STREAMS,
    })?;
    Ok(Exit::Done)
}
