//! `cargo xtask compression` and `cargo xtask train`: how small packed volumes are, and the prior.

use std::process::Command;

use anyhow::Result;

use crate::{cargo, program, python, root, run as execute, target};

/// What the script compares with, beside what comes with Python; JBIG1 is the program `pbmtojbg` of the
/// Debian package `jbigkit-bin`.
const PEERS: [&str; 5] = [
    "compresso==3.3.3",
    "crackle-codec==0.55.0",
    "DracoPy==2.2.0",
    "meshoptimizer==0.2.30a0",
    "zstandard==0.25.0",
];

/// Where the prior of the profile `dense` lies.
const PRIOR: &str = "crates/shrouds-codec/src/topology/prior.bin";

/// Rewrites the tables of compression in docs/benchmarks.md.
pub(crate) fn run() -> Result<()> {
    execute(&mut cargo("build --release --package shrouds-cli"))?;
    execute(&mut cargo("build --release --package shrouds-codec --examples"))?;
    let interpreter = python::environment()?;
    python::install(&interpreter, &PEERS)?;
    let example = |name: &str| {
        target().join("release/examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    };
    let mut command = Command::new(interpreter);
    command.args(["-B", "xtask/python/compression.py"]);
    for (name, path) in [
        ("--program", program()),
        ("--topology", example("topology")),
        ("--geometry", example("geometry")),
        ("--data", target().join("data")),
        ("--folder", target().join("compression")),
        ("--document", root().join("docs/benchmarks.md")),
    ] {
        command.arg(name).arg(path);
    }
    execute(command.current_dir(root()))
}

/// Makes the prior again. Files that were packed with another one can no longer be read: the version of
/// the format has to change with it.
pub(crate) fn train() -> Result<()> {
    execute(cargo("run --release --package shrouds-codec --example train --").arg(PRIOR))
}
