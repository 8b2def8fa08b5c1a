//! Files that appear whole or not at all.

use std::fs::{self, Permissions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::error::Error;

/// Bytes gathered before the system is called.
const BUFFER: usize = 1 << 18;

/// Writes a file through `write` so that it appears whole or not at all.
///
/// The bytes go to a hidden file in the same folder, which takes the name `path` once all is
/// written. When anything fails, that file is removed and what was at `path` before stays. A new
/// file gets the permissions any new file would get; one that is replaced keeps its own. A link is
/// followed.
///
/// # Errors
/// [`Error::Target`] when the folder is missing or `path` is a folder, a device or write-protected;
/// [`Error::Io`] when the system refuses or `write` fails.
pub fn write_atomically<T>(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> Result<T, Error> {
    let path = path.as_ref();
    let (target, kept) = target(path)?;
    let failed = |cause: io::Error| {
        let advice = match cause.kind() {
            io::ErrorKind::PermissionDenied => "choose a folder you may write to",
            io::ErrorKind::StorageFull => "make room or choose another disk",
            _ => "check the folder and the disk",
        };
        Error::Io { path: path.into(), doing: "write it", cause, advice }
    };
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".shrouds-").suffix(".part");
    let new = new_file_permissions();
    if let Some(new) = new {
        builder.permissions(new);
    }
    let mut temporary = builder.tempfile_in(folder).map_err(failed)?;
    let mut writer = BufWriter::with_capacity(BUFFER, temporary.as_file_mut());
    let result = write(&mut writer).map_err(failed)?;
    writer.flush().map_err(failed)?;
    drop(writer);
    if let Some(kept) = kept {
        temporary.as_file().set_permissions(kept).map_err(failed)?;
    }
    temporary.persist(&target).map_err(|error| failed(error.error))?;
    Ok(result)
}

/// Where the file goes once links are followed, and the permissions of the one it replaces.
fn target(path: &Path) -> Result<(PathBuf, Option<Permissions>), Error> {
    let refuse = |problem, advice| Err(Error::Target { path: path.into(), problem, advice });
    let file = "give the name of a file";
    if path.file_name().is_none() {
        return refuse("it is a folder", file);
    }
    if let Ok(data) = fs::metadata(path) {
        if data.is_dir() {
            return refuse("it is a folder", file);
        }
        if !data.is_file() {
            return refuse("it is a device or a pipe, which cannot be replaced", file);
        }
        if data.permissions().readonly() {
            return refuse("it is there already and write-protected", "remove it first");
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.into());
        return Ok((target, Some(data.permissions())));
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            refuse("its folder does not exist", "create the folder first")
        }
        _ => Ok((path.into(), None)),
    }
}

/// What an ordinary new file asks for; the system takes the umask off it.
#[cfg(unix)]
fn new_file_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn new_file_permissions() -> Option<Permissions> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn the_file_is_whole_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let written = write_atomically(&path, |w| {
            w.write_all(b"whole")?;
            Ok(7)
        });
        assert_eq!(written.unwrap(), 7);
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failure_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let fail = |name: &str| {
            write_atomically(folder.path().join(name), |w| {
                w.write_all(&[0; 1 << 20])?;
                Err::<(), _>(io::Error::other("stop"))
            })
        };
        assert!(matches!(fail("a"), Err(Error::Io { .. })));
        assert!(names(folder.path()).is_empty());
        fs::write(folder.path().join("b"), "old").unwrap();
        assert!(fail("b").is_err());
        assert_eq!(fs::read(folder.path().join("b")).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["b"]);
    }

    #[test]
    fn impossible_targets_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let locked = folder.path().join("locked");
        fs::write(&locked, "old").unwrap();
        let mut permissions = fs::metadata(&locked).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&locked, permissions).unwrap();
        let missing = folder.path().join("no/such/a");
        for (path, word) in [
            (folder.path(), "folder"),
            (&missing, "does not exist"),
            (&locked, "write-protected"),
            (Path::new(".."), "folder"),
            (Path::new(""), "folder"),
        ] {
            let error = write_atomically(path, |w| w.write_all(b"x")).unwrap_err();
            assert!(matches!(error, Error::Target { .. }) && error.to_string().contains(word));
        }
        assert_eq!(names(folder.path()), ["locked"]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_links_and_devices() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
        fs::write(at("ordinary"), "").unwrap();
        write_atomically(at("new"), |w| w.write_all(b"1")).unwrap();
        assert_eq!(mode("new"), mode("ordinary"));
        fs::set_permissions(at("new"), Permissions::from_mode(0o640)).unwrap();
        symlink(at("new"), at("link")).unwrap();
        write_atomically(at("link"), |w| w.write_all(b"2")).unwrap();
        assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());
        assert_eq!((fs::read(at("new")).unwrap(), mode("new")), (b"2".to_vec(), 0o640));
        let unwritable = write_atomically("/proc/a.txt", |w| w.write_all(b"3"));
        assert!(matches!(unwritable, Err(Error::Io { .. })) || !Path::new("/proc").is_dir());
        let null = write_atomically("/dev/null", |w| w.write_all(b"3"));
        assert!(matches!(null, Err(Error::Target { .. })));
    }
}
