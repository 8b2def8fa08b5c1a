//! `cargo xtask data`: real data from package registries, by their ordinary clients.
//!
//! Versions are pinned and archives checked against their SHA-256; nothing of it is committed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};

use crate::{python, root, run as execute, target};

/// A file made from a package.
struct Source {
    /// The file in `target/data`.
    file: &'static str,
    /// What the package client is asked for.
    package: &'static str,
    client: Client,
    /// The archive as the client names it, and its SHA-256.
    archive: &'static str,
    sha256: &'static str,
    /// Script in `xtask/python` that makes the file from the archive.
    script: &'static str,
    licence: &'static str,
}

enum Client {
    Pip,
    Npm,
}

const SOURCES: [Source; 2] = [
    Source {
        file: "brain.nii.gz",
        package: "nilearn==0.14.1",
        client: Client::Pip,
        archive: "nilearn-0.14.1-py3-none-any.whl",
        sha256: "725206484e9fb3f6691f9c2d20204a068759d5072f12055324702ee0cb2bbe8a",
        script: "brain.py",
        licence: "package BSD-3-Clause; its ICBM 152 (2009a) maps are by the Montreal \
                  Neurological Institute, the package states no licence of theirs",
    },
    Source {
        file: "bunny.ply",
        package: "bunny@1.0.1",
        client: Client::Npm,
        archive: "bunny-1.0.1.tgz",
        sha256: "381e02c74b98cf18814d7bec794726ef70b9c67e037273e82054d0043f6ae303",
        script: "bunny.py",
        licence: "package in the public domain; scan by the Stanford 3D Scanning Repository",
    },
];

/// Fetches what is not there yet.
pub(crate) fn run() -> Result<()> {
    let folder = target().join("data");
    let packages = folder.join("packages");
    fs::create_dir_all(&packages).with_context(|| format!("cannot make {}", packages.display()))?;
    for source in &SOURCES {
        let file = folder.join(source.file);
        let state = if file.exists() {
            "is there"
        } else {
            source.make(&packages, &file)?;
            "fetched"
        };
        let size = fs::metadata(&file)?.len() / 1024;
        println!("{} {state}: {size} KiB, from {}", file.display(), source.package);
        println!("    {}", source.licence);
    }
    Ok(())
}

impl Source {
    fn make(&self, packages: &Path, file: &Path) -> Result<()> {
        let interpreter = python::environment()?;
        let archive = self.download(packages, &interpreter)?;
        let part = file.with_file_name(format!("part-{}", self.file));
        let script = root().join("xtask/python").join(self.script);
        execute(Command::new(interpreter).arg("-B").arg(script).arg(archive).arg(&part))?;
        fs::rename(&part, file).with_context(|| format!("cannot write {}", file.display()))
    }

    /// The archive, checked; from the registry unless it is there already.
    fn download(&self, packages: &Path, interpreter: &Path) -> Result<PathBuf> {
        let archive = packages.join(self.archive);
        if !archive.exists() {
            execute(&mut self.fetch(packages, interpreter)).with_context(|| {
                format!("cannot fetch {}: {}", self.package, self.client.advice())
            })?;
        }
        let bytes = fs::read(&archive)
            .with_context(|| format!("{} did not bring {}", self.package, archive.display()))?;
        let found = hex(&Sha256::digest(bytes));
        if found != self.sha256 {
            bail!(
                "{} has the SHA-256 {found}, not {}: delete it and try again; if that does not \
                 help, the package is not the one that was published",
                archive.display(),
                self.sha256
            );
        }
        Ok(archive)
    }

    fn fetch(&self, packages: &Path, interpreter: &Path) -> Command {
        let mut command = match self.client {
            Client::Pip => {
                let mut pip = Command::new(interpreter);
                pip.args(["-m", "pip", "download", "--quiet", "--disable-pip-version-check"]);
                pip.args(["--no-deps", "--only-binary=:all:", "--dest"]);
                pip
            }
            Client::Npm => {
                let mut npm = Command::new(if cfg!(windows) { "npm.cmd" } else { "npm" });
                npm.args(["pack", "--silent", "--pack-destination"]);
                npm
            }
        };
        command.arg(packages).arg(self.package);
        command
    }
}

impl Client {
    fn advice(&self) -> &'static str {
        match self {
            Self::Pip => "is a Python package index reachable (pip config list)?",
            Self::Npm => "is npm installed (it comes with Node.js), and its registry reachable?",
        }
    }
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
    fn every_source_is_complete() {
        for source in &SOURCES {
            assert_eq!(source.sha256.len(), 64);
            assert!(root().join("xtask/python").join(source.script).exists());
        }
    }

    #[test]
    fn a_damaged_archive_is_refused() {
        let folder = std::env::temp_dir().join(format!("shrouds-xtask-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(SOURCES[0].archive), "not a wheel").unwrap();
        let error = SOURCES[0].download(&folder, Path::new("python3")).unwrap_err();
        fs::remove_dir_all(&folder).unwrap();
        assert!(error.to_string().contains(SOURCES[0].sha256), "{error}");
    }
}
