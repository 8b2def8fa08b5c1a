//! The Python environment of the judges: pinned packages in `target/python`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::{root, run, target};

/// The interpreter of an environment with the packages of `tests/python/requirements.txt`, made
/// anew when that file has changed.
pub(crate) fn environment() -> Result<PathBuf> {
    let folder = target().join("python");
    let interpreter = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let requirements = root().join("tests/python/requirements.txt");
    let wanted = fs::read_to_string(&requirements)
        .with_context(|| format!("cannot read {}", requirements.display()))?;
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
    install(&interpreter, &["-r", &requirements.display().to_string()])?;
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
