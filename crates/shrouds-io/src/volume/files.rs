//! The files that a volume is read from.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::volume::{VolumeFormat, VolumeOptions, read_contents, tiff, volume_format};

/// Most folders within each other.
const MOST_DEEP: usize = 64;

/// The files that the volume at `path` is read from, sorted: a header and its data, the slices of a
/// folder, everything in a folder of Zarr, or the one file that was named.
///
/// # Errors
/// As for [`read_contents`]; [`Error::Unsupported`] for folders nested more than 64 deep.
pub fn volume_files(
    path: impl AsRef<Path>,
    options: &VolumeOptions,
) -> Result<Vec<PathBuf>, Error> {
    let path = path.as_ref();
    let mut files = match volume_format(path)? {
        VolumeFormat::Zarr => below(path, MOST_DEEP)?,
        VolumeFormat::Tiff if path.is_dir() => tiff::slices(path)?.0,
        _ => {
            let mut files = read_contents(path, options)?.2.files;
            files.push(path.into());
            files
        }
    };
    files.sort();
    files.dedup();
    Ok(files)
}

/// All files in a folder and the folders in it.
fn below(folder: &Path, depth: usize) -> Result<Vec<PathBuf>, Error> {
    if depth == 0 {
        let advice = "name a folder nearer to the array";
        return Err(Error::unsupported(folder, "a folder so far down", advice));
    }
    let failed = |cause| Error::open(folder, cause);
    let mut files = Vec::new();
    for entry in folder.read_dir().map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            files.extend(below(&path, depth - 1)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}
