//! The Python package: its wheel in `target/wheels`, and the wheel in an environment.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::{python, root, run as execute, target};

/// Builds the wheel as anybody would.
pub(crate) fn run() -> Result<()> {
    let wheel = build(Command::new("python3").args(["-m", "pip", "wheel"]))?;
    println!("{}", wheel.display());
    Ok(())
}

/// Builds the wheel with the tools of an environment and installs it there, in place of any other.
pub(crate) fn install(interpreter: &Path) -> Result<()> {
    let pip = ["-m", "pip", "wheel", "--no-build-isolation"];
    let wheel = build(Command::new(interpreter).args(pip).env("PATH", path_of(interpreter)?))?;
    python::install(interpreter, &["--force-reinstall", "--no-deps", &wheel.display().to_string()])
}

/// Builds the one wheel there is then.
fn build(pip: &mut Command) -> Result<PathBuf> {
    let folder = target().join("wheels");
    if folder.exists() {
        fs::remove_dir_all(&folder)
            .with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    pip.args(["--quiet", "--disable-pip-version-check", "--no-deps", "--wheel-dir"]).arg(&folder);
    execute(pip.arg("./python").current_dir(root()))
        .context("cannot build the wheel: are Rust, Python 3.10 or newer, and pip here?")?;
    let wheels = fs::read_dir(&folder)
        .with_context(|| format!("cannot list {}", folder.display()))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<Vec<PathBuf>>>()?;
    match &wheels[..] {
        [wheel] => Ok(wheel.clone()),
        _ => bail!("{} holds {} wheels, not one", folder.display(), wheels.len()),
    }
}

/// The search path with the programs of an environment first.
fn path_of(interpreter: &Path) -> Result<std::ffi::OsString> {
    let folder = interpreter.parent().map(Path::to_owned).unwrap_or_default();
    let others = std::env::var_os("PATH").unwrap_or_default();
    let all = std::iter::once(folder).chain(std::env::split_paths(&others));
    std::env::join_paths(all).context("the search path cannot be written")
}
