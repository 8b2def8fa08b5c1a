//! The Python environment of the judges: pinned packages in `target/python`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::{root, run, target};

/// What the judges need, and what the tests of the chunked runs of the Python package need.
const REQUIREMENTS: [&str; 2] =
    ["tests/python/requirements.txt", "python/tests/requirements-distributed.txt"];

/// The interpreter of an environment with the packages of [`REQUIREMENTS`], made anew when these files have
/// changed.
pub(crate) fn environment() -> Result<PathBuf> {
    let folder = target().join("python");
    let interpreter = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let requirements = REQUIREMENTS.map(|path| root().join(path).display().to_string());
    let read =
        |path: &String| fs::read_to_string(path).with_context(|| format!("cannot read {path}"));
    let wanted = requirements.iter().map(read).collect::<Result<String>>()?;
    // Written last: an environment that broke off half-way has none.
    let mark = folder.join("requirements.txt");
    if interpreter.exists() && fs::read_to_string(&mark).is_ok_and(|installed| installed == wanted)
    {
        return Ok(interpreter);
    }
    run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder)).context(
        "cannot make a Python environment: install Python 3.10 or newer with its module venv \
         (on Debian and Ubuntu: apt-get install python3-venv)",
    )?;
    let [judges, distributed] = &requirements;
    install(&interpreter, &["-r", judges, "-r", distributed])?;
    fs::write(&mark, wanted).with_context(|| format!("cannot write {}", mark.display()))?;
    Ok(interpreter)
}

/// Installs packages, given as to pip, unless they are there.
pub(crate) fn install(interpreter: &Path, packages: &[&str]) -> Result<()> {
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    run(Command::new(interpreter).args(pip).args(packages)).context(
        "cannot install the Python packages: is a package index reachable (pip config list)?",
    )
}
