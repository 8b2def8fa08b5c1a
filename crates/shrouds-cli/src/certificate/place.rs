//! Names of files relative to a folder, the same on every machine.

use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::failure::Failure;

/// The folder that a file is in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The way from a folder to a file or folder, both of which exist, with `/` between names. Links on the
/// way are followed, but a link that is named itself is not.
pub(super) fn relative(path: &Path, folder: &Path) -> Result<String, Failure> {
    let (from, to) = (real(folder)?, named(path)?);
    let both = from.components().zip(to.components());
    let common = both.take_while(|(a, b)| a == b).count();
    let ups = from.components().skip(common).map(|_| Ok(".."));
    let downs = to.components().skip(common).map(|component| match component {
        Component::Normal(name) => name.to_str().ok_or("its name is not Unicode"),
        _ => Err("it is on another drive"),
    });
    let parts: Result<Vec<&str>, &str> = ups.chain(downs).collect();
    let parts = parts.map_err(|problem| {
        let advice = "a certificate cannot name it; copy it beside the certificate";
        Failure::Undone(format!("{}: {problem}: {advice}", path.display()))
    })?;
    Ok(if parts.is_empty() { ".".into() } else { parts.join("/") })
}

/// The path without links, but for its last name.
fn named(path: &Path) -> Result<PathBuf, Failure> {
    match path.file_name() {
        Some(name) => Ok(real(folder_of(path))?.join(name)),
        None => real(path),
    }
}

fn real(path: &Path) -> Result<PathBuf, Failure> {
    fs::canonicalize(path).map_err(|cause| {
        Failure::Undone(format!("{}: cannot find it ({cause}); check the path", path.display()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_lead_up_and_down() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        fs::create_dir_all(at("a/b")).unwrap();
        fs::create_dir_all(at("c")).unwrap();
        fs::write(at("c/file"), "").unwrap();
        for (path, folder, expected) in [
            ("c/file", "c", "file"),
            ("c/file", "", "c/file"),
            ("c/file", "a/b", "../../c/file"),
            ("a/../c/file", "a/b/..", "../c/file"),
            ("c", "c", "."),
            ("c", "a", "../c"),
        ] {
            assert_eq!(relative(&at(path), &at(folder)).unwrap(), expected, "{path} from {folder}");
        }
        assert!(relative(&at("no/file"), &at("c")).is_err());
        assert_eq!(folder_of(Path::new("file")), Path::new("."));
    }
}
