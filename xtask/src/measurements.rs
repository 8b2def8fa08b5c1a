//! `cargo xtask measurements`: the tables of docs/measurements.md.

use std::process::Command;

use anyhow::Result;

use crate::{cargo, python, root, run as execute, target};

/// Whose areas stand beside ours. pyradiomics says what it is built with only when it is too late.
const PEERS: [&str; 1] = ["scikit-image==0.26.0"];
const BUILD: [&str; 3] = ["setuptools==80.9.0", "wheel==0.48.0", "versioneer==0.29"];
const RADIOMICS: [&str; 2] = ["--no-build-isolation", "pyradiomics==3.0.1"];

/// Rewrites the tables; with `--quick` prints some of them.
pub(crate) fn run(options: &[&str]) -> Result<()> {
    execute(&mut cargo("build --release --package shrouds --example measurements"))?;
    let interpreter = python::environment()?;
    python::install(&interpreter, &PEERS)?;
    python::install(&interpreter, &BUILD)?;
    if let Err(error) = python::install(&interpreter, &RADIOMICS) {
        eprintln!("without pyradiomics: {error:#}");
    }
    let name = format!("measurements{}", std::env::consts::EXE_SUFFIX);
    let mut command = Command::new(interpreter);
    command.args(["-B", "xtask/python/measurements.py"]);
    for (name, path) in [
        ("--tool", target().join("release/examples").join(name)),
        ("--folder", target().join("measurements")),
        ("--document", root().join("docs/measurements.md")),
    ] {
        command.arg(name).arg(path);
    }
    execute(command.args(options).current_dir(root()))
}
