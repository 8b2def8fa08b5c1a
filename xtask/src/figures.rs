//! `cargo xtask figures`: the figures of the paper, made again.

use std::process::Command;

use anyhow::Result;

use crate::{cargo, data, program, root, run as execute, target};

/// Fetches the data that is not there yet and writes pictures and their page into docs/gallery.
pub(crate) fn run() -> Result<()> {
    data::run(&[])?;
    execute(&mut cargo("build --release --package shrouds-cli"))?;
    let mut command = Command::new(program());
    command.args(["demo", "figures", "--data"]).arg(target().join("data"));
    command.arg("--output").arg(root().join("docs/gallery"));
    execute(command.current_dir(root()))
}
