//! Files out. That they can be written is found out before the work begins.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;
use shrouds_io::write_atomically;
use shrouds_view::Picture;

use crate::console::json;
use crate::failure::Failure;

/// Fails unless every one of these files can appear; leaves nothing behind. `inputs` are files that
/// must not be replaced.
pub(crate) fn check_targets(targets: &[&Path], inputs: &[&Path]) -> Result<(), Failure> {
    let mut taken: BTreeSet<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
    for target in targets {
        if !taken.insert(identity(target)) {
            let message = "is also another file of this call; give it a name of its own";
            return Err(Failure::Call(format!("{}: {message}", target.display())));
        }
        probe(target)?;
    }
    Ok(())
}

/// Makes a folder for files that are to come, unless it is there.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|cause| {
        let folder = folder.display();
        Failure::Undone(format!(
            "{folder}: cannot make this folder ({cause}); give another with --output"
        ))
    })
}

/// The file itself, whatever name it goes by.
fn identity(path: &Path) -> PathBuf {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    fs::canonicalize(path).unwrap_or_else(|_| {
        let name = path.file_name().unwrap_or_default();
        fs::canonicalize(folder).unwrap_or_else(|_| folder.into()).join(name)
    })
}

fn probe(path: &Path) -> Result<(), Failure> {
    let mut reached = false;
    let result = write_atomically(path, |_| {
        reached = true;
        Err::<(), _>(io::Error::other("only a probe"))
    });
    match result {
        Err(error) if !reached => Err(error.into()),
        _ => Ok(()),
    }
}

/// Fails unless the name ends as that of a PNG picture does.
pub(crate) fn check_png(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("png") {
        return Ok(());
    }
    let message = "not a picture by its name; pictures are written to .png";
    Err(Failure::Call(format!("{}: {message}", path.display())))
}

/// Writes a picture as PNG.
pub(crate) fn write_picture(path: &Path, picture: &Picture) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    picture.write_png(&mut bytes)?;
    Ok(write_atomically(path, |writer| writer.write_all(&bytes))?)
}

/// Writes a value as JSON.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let text = json(value)?;
    Ok(write_atomically(path, |writer| writeln!(writer, "{text}"))?)
}
