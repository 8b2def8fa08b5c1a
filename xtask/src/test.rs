//! `cargo xtask test`: every check, in the order of what fails fastest.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Result, anyhow};

use crate::{bench_instructions, cargo, page, program, python, root, run as execute, shown, wheel};

/// Runs all steps and stops at the first that fails.
pub(crate) fn run() -> Result<()> {
    let mut steps = Steps { passed: 0 };
    steps.command("format", cargo("fmt --all --check"))?;
    steps.command("lints", cargo("clippy --workspace --all-targets -- -D warnings"))?;
    steps.command(
        "lints without features",
        cargo("clippy -p shrouds -p shrouds-io --no-default-features -- -D warnings"),
    )?;
    steps.command("Rust tests", cargo("test --workspace"))?;
    let mut docs = cargo("doc --workspace --no-deps");
    docs.env("RUSTDOCFLAGS", "-Dwarnings");
    steps.command("docs", docs)?;
    steps.command("release build", cargo("build --release --package shrouds-cli"))?;
    match page::obstacle() {
        Some(obstacle) => println!("\n== page: skipped, {obstacle}"),
        None => steps.step("page", "npm run build in crates/shrouds-view/web", page::build)?,
    }
    match page::browser_obstacle() {
        Some(obstacle) => println!("\n== browser: skipped, {obstacle}"),
        None => steps.step("browser", "npm run browse in crates/shrouds-view/web", page::browse)?,
    }
    let interpreter =
        steps.step("Python environment", "python3 -m venv target/python", python::environment)?;
    steps.command("Python tests", pytest(&interpreter, "tests/python"))?;
    let line = "pip wheel ./python; pip install target/wheels/*.whl";
    steps.step("Python package", line, || wheel::install(&interpreter))?;
    steps.command("tests of the Python package", pytest(&interpreter, "python/tests"))?;
    let counted = "cargo xtask bench --instructions";
    match bench_instructions::obstacle() {
        Some(obstacle) => println!("\n== instruction counts: skipped, {obstacle}"),
        None => steps.step("instruction counts", counted, || bench_instructions::run(false))?,
    }
    println!("\n{} passed, 0 failed", steps.passed);
    Ok(())
}

/// The tests in a folder, with the release build of the program to compare with.
fn pytest(interpreter: &Path, folder: &str) -> Command {
    let mut command = Command::new(interpreter);
    command
        .args(["-B", "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", folder])
        .env("SHROUDS_BIN", program())
        .current_dir(root());
    command
}

struct Steps {
    passed: usize,
}

impl Steps {
    fn command(&mut self, name: &str, mut command: Command) -> Result<()> {
        let line = shown(&command);
        self.step(name, &line, || execute(&mut command))
    }

    fn step<T>(&mut self, name: &str, line: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        println!("\n== {name}: {line}");
        let start = Instant::now();
        let done = work();
        let seconds = start.elapsed().as_secs_f64();
        match done {
            Ok(value) => {
                println!("== {name}: passed in {seconds:.1} s");
                self.passed += 1;
                Ok(value)
            }
            Err(error) => {
                println!("== {name}: failed in {seconds:.1} s");
                println!("\n{} passed, 1 failed", self.passed);
                Err(anyhow!("step \"{name}\" failed: {error:#}"))
            }
        }
    }
}
