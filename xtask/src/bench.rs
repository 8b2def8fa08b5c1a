//! `cargo xtask bench`: how close the surfaces come to bodies with known surfaces, and at what cost.

use std::process::Command;

use anyhow::Result;

use crate::{cargo, program, python, root, run as execute, target};

/// Builds the program and prints the tables of `tests/python/accuracy.py`.
pub(crate) fn run() -> Result<()> {
    execute(&mut cargo("build --release --package shrouds-cli"))?;
    let mut command = Command::new(python::environment()?);
    command.args(["-B", "tests/python/accuracy.py", "--program"]).arg(program());
    command.arg("--folder").arg(target().join("bench")).current_dir(root());
    execute(&mut command)
}
