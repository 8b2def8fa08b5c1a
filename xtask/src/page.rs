//! The page of the test bed: checked, built anew and compared with what is committed, and used in a browser.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::{program, root, run as execute, target};

/// Debian's browser, unless the environment names another.
const BROWSER: &str = "/usr/bin/chromium";

fn folder() -> PathBuf {
    root().join("crates/shrouds-view/web")
}

fn npm(arguments: &[&str]) -> Command {
    let mut command = Command::new("npm");
    command.args(arguments).current_dir(folder());
    command
}

/// Why the page cannot be built here, if it cannot.
pub(crate) fn obstacle() -> Option<&'static str> {
    let found = Command::new("npm").arg("--version").stdout(Stdio::null()).status();
    (!found.is_ok_and(|status| status.success())).then_some("npm is not installed")
}

/// Checks the sources and that the committed bundle is what they make.
pub(crate) fn build() -> Result<()> {
    execute(&mut npm(&["ci", "--no-audit", "--no-fund"]))?;
    execute(&mut npm(&["run", "--silent", "check"]))?;
    execute(&mut npm(&["test", "--silent"]))?;
    let made = target().join("page");
    let made_name = made.display().to_string();
    execute(&mut npm(&[
        "run",
        "--silent",
        "build",
        "--",
        "--outDir",
        &made_name,
        "--emptyOutDir",
    ]))?;
    let committed = folder().join("dist");
    let (old, new) = (files(&committed)?, files(&made)?);
    let names = old.keys().chain(new.keys());
    if let Some(name) = names.into_iter().find(|&name| old.get(name) != new.get(name)) {
        let name = name.display();
        bail!(
            "{name} of the committed page is not what its sources make: run `npm run build` in {}, \
             and commit dist/",
            folder().strip_prefix(root()).unwrap_or(&folder()).display()
        );
    }
    Ok(())
}

/// The files below a folder, by their paths in it.
fn files(folder: &Path) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in
            fs::read_dir(&next).with_context(|| format!("cannot list {}", next.display()))?
        {
            let path = entry?.path();
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    let bytes = fs::read(&path)?;
                    found.insert(path.strip_prefix(folder)?.to_owned(), bytes);
                }
            }
        }
    }
    Ok(found)
}

fn browser() -> String {
    std::env::var("SHROUDS_CHROMIUM").unwrap_or_else(|_| BROWSER.into())
}

/// Why the page cannot be used in a browser here, if it cannot.
pub(crate) fn browser_obstacle() -> Option<String> {
    obstacle().map(str::to_owned).or_else(|| {
        let browser = browser();
        let is_there = Path::new(&browser).exists();
        (!is_there).then(|| format!("there is no {browser}; SHROUDS_CHROMIUM can name another"))
    })
}

/// Uses the page of the release build in the browser.
pub(crate) fn browse() -> Result<()> {
    let mut tests = npm(&["run", "--silent", "browse"]);
    tests.env("SHROUDS_BIN", program()).env("SHROUDS_CHROMIUM", browser());
    execute(&mut tests)
}
