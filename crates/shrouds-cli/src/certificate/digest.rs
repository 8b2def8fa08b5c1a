//! Which files these are: SHA-256 of one file, or of all that make up a volume.
//!
//! One file has the SHA-256 of its bytes. Several, such as a header with its data or a folder, have that
//! of the list that `sha256sum` prints for them, sorted: for every file a line of its SHA-256 in
//! hexadecimal digits, two spaces and its name relative to the folder they are in.

use std::fmt::Write;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Serialize;
use sha2::{Digest as _, Sha256};
use shrouds_io::volume_files;

use super::place::{folder_of, relative};
use crate::args::VolumeArgs;
use crate::failure::Failure;
use crate::settings::volume_options;

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 20;

/// A file or a folder, where it is and what is in it.
#[derive(Serialize)]
pub(super) struct Digest {
    /// Relative to the certificate.
    file: String,
    /// In hexadecimal digits.
    pub(super) sha256: String,
    /// How many files there are.
    files: usize,
}

impl Digest {
    pub(super) fn of_mesh(path: &Path, folder: &Path) -> Result<Self, Failure> {
        let sha256 = of_file(path)?;
        Ok(Self { file: relative(path, folder)?, sha256, files: 1 })
    }

    pub(super) fn of_volume(
        path: &Path,
        args: &VolumeArgs,
        folder: &Path,
    ) -> Result<Self, Failure> {
        let files = volume_files(path, &volume_options(args, &|_, _| {}))?;
        let sha256 = match &files[..] {
            [one] => of_file(one)?,
            several => of_list(several, if path.is_dir() { path } else { folder_of(path) })?,
        };
        Ok(Self { file: relative(path, folder)?, sha256, files: files.len() })
    }
}

/// Of the files that a folder has.
fn of_list(files: &[PathBuf], folder: &Path) -> Result<String, Failure> {
    let mut named: Vec<(String, &PathBuf)> = Vec::with_capacity(files.len());
    for file in files {
        named.push((relative(file, folder)?, file));
    }
    named.sort();
    let mut hash = Sha256::new();
    for (name, file) in named {
        hash.update(format!("{}  {name}\n", of_file(file)?));
    }
    Ok(digits(hash))
}

fn of_file(path: &Path) -> Result<String, Failure> {
    let mut hash = Sha256::new();
    let read = |hash: &mut Sha256| -> io::Result<()> {
        let mut file = File::open(path)?;
        let mut chunk = vec![0; CHUNK];
        loop {
            match file.read(&mut chunk)? {
                0 => return Ok(()),
                count => hash.update(&chunk[..count]),
            }
        }
    };
    read(&mut hash).map_err(|cause| {
        let message = format!("{}: cannot read it ({cause}); check the path", path.display());
        Failure::Undone(message)
    })?;
    Ok(digits(hash))
}

fn digits(hash: Sha256) -> String {
    hash.finalize().iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn digests_are_those_of_the_standard() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        // FIPS 180-2, appendix B, and the empty message.
        fs::write(at("b"), "abc").unwrap();
        fs::write(at("a"), "").unwrap();
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        let nothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        assert_eq!((of_file(&at("b")), of_file(&at("a"))), (Ok(abc.into()), Ok(nothing.into())));
        fs::write(at("list"), format!("{nothing}  a\n{abc}  b\n")).unwrap();
        let files = [at("b"), at("a")];
        assert_eq!(of_list(&files, root.path()), of_file(&at("list")));
        assert!(of_file(&at("missing")).is_err());
    }
}
