//! Files for the page to keep.

use std::path::Path;

use serde_json::json;
use shrouds_io::{mesh_format, write_atomically, write_volume, written_format};

use super::numbers::packed;
use super::request::ViewNumber;
use super::surface::Surface;
use super::volumes::Name;
use super::worker::{Ended, Shown, Worker};
use crate::args::FrameChoice;
use crate::console::Console;
use crate::failure::Failure;
use crate::work::{self, PartOf};

/// What a surface and its volume can be written to.
pub(super) const FORMATS: [&str; 11] =
    ["ply", "stl", "obj", "glb", "vtp", "3mf", "nii.gz", "nrrd", "npy", "vti", "shroud"];
/// Bits for the place of a vertex in a packed file.
const BITS: u8 = 8;
/// Exports that are kept: the page fetches each at once.
const KEPT: usize = 8;

impl Worker {
    pub(super) fn export(
        &mut self,
        id: u64,
        view: ViewNumber,
        format: &str,
        frame: FrameChoice,
    ) -> Result<(), Ended> {
        if !FORMATS.contains(&format) {
            let known = FORMATS.join(", ");
            return Err(
                Failure::Call(format!("there is no format '{format}'; there are {known}")).into()
            );
        }
        self.page.progress("writing", None);
        let (name, download) = match self.shown(view)? {
            Shown::Body(surface) => {
                let name = format!("{}.{format}", stem(&surface.name));
                let download = self.files.offer(&name, |path| write(surface, path, frame))?;
                (name, download)
            }
            Shown::Several(several) => {
                let name = format!("{}.{format}", stem(&several.name));
                let download = self.files.offer(&name, |path| several.write(path, frame))?;
                (name, download)
            }
        };
        self.exports.push_back(download.clone());
        if self.exports.len() > KEPT {
            self.exports.pop_front().iter().for_each(|id| self.files.forget(id));
        }
        self.answer(id, &json!({ "download": download, "name": name }))
    }

    /// Removes all exports.
    pub(super) fn forget_exports(&mut self) {
        self.exports.drain(..).for_each(|id| self.files.forget(&id));
    }
}

/// The name of a file without ending, from what the volume is called.
fn stem(name: &Name) -> String {
    let text = match name {
        Name::Made(_) => "volume",
        name => name.text(),
    };
    let file = Path::new(text).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = file.split('.').next().unwrap_or_default();
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let plain: String = stem.chars().take(60).map(plain).collect();
    if plain.is_empty() { "shroud".into() } else { plain }
}

fn write(surface: &Surface, path: &Path, frame: FrameChoice) -> Result<(), Failure> {
    let source = &surface.source;
    if path.extension().is_some_and(|extension| extension == "shroud") {
        let bytes = packed(surface, &surface.now(), BITS)?;
        return Ok(write_atomically(path, |out| out.write_all(&bytes))?);
    }
    if mesh_format(path).is_ok() {
        let mut mesh = surface.now().mesh.clone();
        let part = PartOf { name: String::new(), label: None, mesh: &mut mesh, attributes: &[] };
        let silent = Console { quiet: true };
        return work::write(path, &mut [part], &source.lattice, &source.frame, frame, silent);
    }
    written_format(path)?;
    Ok(write_volume(path, &source.occupancy, &source.frame)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_after_their_volume() {
        for (name, expected) in [
            (Name::File("/data/organs.nii.gz".into()), "organs"),
            (Name::File("C:\\x y\".npy".into()), "C__x_y_"),
            (Name::Demo("letters:A B".into(), 64), "letters_A_B"),
            (Name::Made("a ∪ b".into()), "volume"),
            (Name::File("..".into()), "shroud"),
        ] {
            assert_eq!(stem(&name), expected);
        }
    }

    #[test]
    fn every_format_can_be_written() {
        for format in FORMATS.iter().filter(|format| **format != "shroud") {
            let path = Path::new("x").with_extension(format);
            assert!(mesh_format(&path).is_ok() || written_format(&path).is_ok(), "{format}");
        }
    }
}
