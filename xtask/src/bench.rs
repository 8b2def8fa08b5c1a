//! `cargo xtask bench`: how close the surfaces come to bodies with known surfaces, and at what cost.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::{bench_instructions, cargo, program, python, root, run as execute, target};

pub(crate) const HELP: &str = "\
Accuracy, time and memory of the release build, and of VTK in turns with it; rewrites the tables of
docs/benchmarks.md.

Usage: cargo xtask bench [OPTIONS]

Options:
  --quick         Small volumes only; prints the tables and leaves the document alone
  --large         Volumes of 512³ too: half an hour more and 8 GB of memory
  --repeats N     Turns of every contender [default: 7]
  --peers WHO     vtk, installed from the Python package index, or none: then the document is left
                  alone [default: vtk]
  --instructions  Instead: count the instructions of the hottest kernels and compare them with
                  xtask/instructions.txt
  --accept        With --instructions: make the counts of now the ones to compare with
";

/// What the peers are installed from.
const VTK: &str = "vtk==9.7.2";

/// What was asked for.
#[derive(Debug, PartialEq, Default)]
struct Options {
    /// Passed on to the script that measures.
    measure: Vec<String>,
    without_peers: bool,
    instructions: bool,
    accept: bool,
    help: bool,
}

impl Options {
    fn parse(arguments: &[&str]) -> Result<Self> {
        let mut options = Self::default();
        let mut rest = arguments.iter();
        while let Some(&argument) = rest.next() {
            let mut value = || rest.next().with_context(|| format!("{argument} needs a value"));
            match argument {
                "--quick" | "--large" => options.measure.push(argument.into()),
                "--repeats" => {
                    let repeats = value()?;
                    if !repeats.parse::<u32>().is_ok_and(|n| n > 0) {
                        bail!("--repeats is {repeats}: give a whole number from 1 on");
                    }
                    options.measure.extend([argument, repeats].map(String::from));
                }
                "--peers" => match *value()? {
                    "none" => options.without_peers = true,
                    "vtk" => options.without_peers = false,
                    other => bail!("--peers is {other}: give vtk or none"),
                },
                "--instructions" => options.instructions = true,
                "--accept" => options.accept = true,
                "--help" | "-h" => options.help = true,
                _ => bail!("unknown option {argument}; see cargo xtask bench --help"),
            }
        }
        if options.accept && !options.instructions {
            bail!("--accept has a meaning only with --instructions");
        }
        Ok(options)
    }
}

/// Does what the options ask for.
pub(crate) fn run(arguments: &[&str]) -> Result<()> {
    let options = Options::parse(arguments)?;
    if options.help {
        print!("{HELP}");
        return Ok(());
    }
    if options.instructions {
        return bench_instructions::run(options.accept);
    }
    execute(&mut cargo("build --release --package shrouds-cli"))?;
    let worker = worker()?;
    let interpreter = python::environment()?;
    let peers = if options.without_peers || !install_vtk(&interpreter) { "none" } else { "vtk" };
    let mut command = Command::new(interpreter);
    command.args(["-B", "xtask/python/bench.py", "--peers", peers]).args(options.measure);
    for (name, path) in [
        ("--worker", worker),
        ("--program", program()),
        ("--folder", target().join("bench")),
        ("--data", target().join("data")),
        ("--document", root().join("docs/benchmarks.md")),
    ] {
        command.arg(name).arg(path);
    }
    execute(command.current_dir(root()))
}

/// The built worker, `crates/shrouds-cli/examples/bench_worker.rs`.
pub(crate) fn worker() -> Result<PathBuf> {
    execute(&mut cargo("build --release --package shrouds-cli --example bench_worker"))?;
    let name = format!("bench_worker{}", std::env::consts::EXE_SUFFIX);
    Ok(target().join("release/examples").join(name))
}

/// Whether VTK is there in the end.
fn install_vtk(interpreter: &Path) -> bool {
    let installed = python::install(interpreter, &["--no-deps", VTK]);
    if let Err(error) = &installed {
        eprintln!("going on without peers, docs/benchmarks.md stays as it is: {error:#}");
    }
    installed.is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_others_refused() {
        let options = Options::parse(&["--large", "--repeats", "3", "--peers", "none"]).unwrap();
        assert_eq!(options.measure, ["--large", "--repeats", "3"]);
        assert!(options.without_peers && !options.instructions);
        for wrong in [
            &["--huge"][..],
            &["--repeats"],
            &["--repeats", "0"],
            &["--repeats", "many"],
            &["--peers", "itk"],
            &["--accept"],
        ] {
            assert!(Options::parse(wrong).is_err(), "{wrong:?}");
        }
    }
}
