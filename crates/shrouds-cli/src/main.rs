//! The program `shrouds`: a segmented volume in, a smooth separating surface out.
//!
//! The flow: `args` (what was typed) → `settings` (checked) → `commands` (one `run` per verb), which
//! share `input`, `work`, `output` and `report`. Every failure is one line on standard error and an
//! exit code.

mod args;
mod commands;
mod console;
mod failure;
mod frame;
mod input;
mod output;
mod picture;
mod progress;
mod report;
mod settings;
mod work;

use std::process::ExitCode;

use clap::Parser;
use rayon::ThreadPoolBuilder;

use crate::args::Cli;
use crate::failure::Failure;

fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            console::error(&failure);
            failure.exit_code()
        }
    }
}

/// Runs on as many threads as were asked for.
fn run(cli: &Cli) -> Result<(), Failure> {
    let Some(threads) = cli.common.threads else { return commands::run(cli) };
    let pool = ThreadPoolBuilder::new().num_threads(usize::from(threads)).build();
    let pool = pool.map_err(|cause| {
        Failure::Undone(format!("cannot start {threads} threads ({cause}); lower --threads"))
    })?;
    pool.install(|| commands::run(cli))
}
