//! The command line: see `cli` for what can be said, `commands` for what is done.

mod cli;
mod commands;
mod exit;
mod interrupt;

use clap::Parser;
use cli::{Cli, Command};
use exit::Exit;

fn main() -> std::process::ExitCode {
    let cli = Cli::parse();
    interrupt::heed();
    let result = match cli.command {
        None => commands::demo::run(),
        Some(Command::Plan(args)) => commands::plan::run(&args),
        Some(Command::Verify(args)) => commands::verify::run(&args),
        Some(Command::Explain(args)) => commands::explain::run(&args),
        Some(Command::Generate(args)) => commands::generate::run(&args),
        Some(Command::View(args)) => commands::view::run(&args),
        Some(Command::Robot(args)) => commands::robot::run(&args),
        Some(Command::Motion(args)) => commands::motion::run(&args),
        Some(Command::Simulate(args)) => commands::simulate::run(&args),
        Some(Command::Bench(args)) => commands::bench::run(&args),
        Some(Command::Export(args)) => commands::export::run(&args),
        Some(Command::Schema(args)) => commands::schema::run(&args),
        Some(Command::Pddl(args)) => commands::pddl::run(&args),
    };
    result.unwrap_or_else(|failure| failure.tell()).into()
}

impl From<Exit> for std::process::ExitCode {
    fn from(exit: Exit) -> Self {
        std::process::ExitCode::from(exit as u8)
    }
}
