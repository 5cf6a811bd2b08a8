//! Measures techniques for light in fog: how fast, how right, and what it looks like.
//!
//! Measuring and reporting are two steps: a measurement becomes a [`record`], and table, charts and
//! page are made from records alone.

mod asked;
mod choose;
mod cli;
mod clouds;
mod cmd;
mod deferred;
mod failure;
mod falsecolor;
mod fit;
mod flip;
mod glyphs;
mod interrupt;
mod judge;
mod machine;
mod measure;
mod output;
mod papers;
mod peers;
mod plan;
mod progress;
mod record;
mod report;
mod stability;
mod techniques;
mod truth;
mod view;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use cli::{Cli, Command};

/// Counts what the program, its libraries but no driver, has on the heap.
#[global_allocator]
static HEAP: cap::Cap<std::alloc::System> = cap::Cap::new(std::alloc::System, usize::MAX);

fn main() -> ExitCode {
    let cli = Cli::parse();
    interrupt::listen();
    let outcome = match &cli.command {
        None => cmd::run::run(&cli.run),
        Some(Command::Render(arguments)) => cmd::render::run(arguments),
        Some(Command::Choose(arguments)) => choose::run(arguments),
        Some(Command::Targets(arguments)) => cmd::targets::run(arguments),
        Some(Command::Papers(arguments)) => papers::run(arguments),
        Some(Command::List) => Ok(cmd::list::run()),
        Some(Command::Report(arguments)) => cmd::report::run(arguments),
        Some(Command::Stability(arguments)) => stability::run(arguments),
        Some(Command::Diff(arguments)) => cmd::diff::run(arguments),
        Some(Command::View(arguments)) => view::run(arguments),
    };
    match outcome {
        Ok(text) => {
            print(&text);
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("harness: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Prints to stdout; a reader that went away (`harness list | head`) is no error.
fn print(text: &str) {
    drop(std::io::stdout().write_all(text.as_bytes()));
}
