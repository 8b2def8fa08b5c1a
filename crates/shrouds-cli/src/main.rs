//! The program `shrouds`: a segmented volume in, a smooth separating surface out.
//!
//! The flow: `args` (what was typed) → `settings` (checked) → `commands` (one `run` per verb), which
//! share `input`, `work`, `output` and `report`. Every failure is one line on standard error and an
//! exit code.

mod args;
mod body;
mod by_name;
mod certificate;
mod colouring;
mod commands;
mod console;
mod each;
mod energies;
mod failure;
mod figures;
mod frame;
mod input;
mod label_map;
mod lines;
mod materials;
mod output;
mod packed;
mod picture;
mod phantom;
mod progress;
mod report;
mod scene;
mod selection;
mod settings;
mod truth;
mod view;
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

/// Runs on as many threads as were asked for, or as many as there are.
///
/// All of it runs on a thread of the pool: handing each of the solver's many short loops to the pool
/// from outside would cost more than some of the loops.
fn run(cli: &Cli) -> Result<(), Failure> {
    let threads = cli.common.threads.map_or(0, usize::from);
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|cause| {
        Failure::Undone(format!("cannot start threads ({cause}); give --threads a smaller number"))
    })?;
    pool.install(|| commands::run(cli))
}
