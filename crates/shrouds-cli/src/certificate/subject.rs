//! What a certificate is about: a mesh, its volume, and what is expected of them.

use std::path::Path;

use shrouds::check::{CheckReport, CheckSettings, check};
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy, TriMesh};
use shrouds_io::{mesh_format, read_mesh, volume_format};

use crate::args::{FrameChoice, VolumeArgs};
use crate::console::Console;
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;
use crate::selection::Selection;

/// A mesh, the volume it is to be the surface of, and how.
#[derive(Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub(crate) mesh: &'a Path,
    pub(crate) volume: &'a Path,
    /// Which voxels are inside, and the coordinates of the mesh.
    pub(crate) selection: &'a VolumeArgs,
    pub(crate) border: Border,
    pub(crate) faces: FaceRule,
    pub(crate) all_axes: bool,
}

/// Mesh and volume as their files have them, and what was found.
pub(crate) struct Examined {
    pub(crate) mesh: TriMesh,
    /// The inside points in the frame of the mesh, possibly none.
    pub(crate) volume: Occupancy,
    /// From the index to the world of the file, whatever the frame of the mesh.
    pub(crate) affine: [[f64; 4]; 3],
    /// Which voxels are inside, in words.
    pub(crate) words: String,
    pub(crate) report: CheckReport,
}

impl Subject<'_> {
    /// Fails unless both files are of a kind that is read.
    pub(crate) fn check_formats(&self) -> Result<(), Failure> {
        mesh_format(self.mesh)?;
        volume_format(self.volume)?;
        Ok(())
    }

    /// Reads both files and checks the one against the other.
    pub(crate) fn examine(
        &self,
        console: Console,
        progress: &Progress,
    ) -> Result<Examined, Failure> {
        self.check_formats()?;
        let (_, _, contents) = input::contents(self.volume, self.selection, console)?;
        let selection = Selection::new(self.volume, self.selection, &contents)?;
        let read = input::selected(self.volume, self.selection, &selection, console, progress)?;
        let affine = read.occupancy.grid().affine();
        let volume = match self.selection.coordinates() {
            FrameChoice::World => read.occupancy,
            FrameChoice::Index => {
                let grid = Grid::new(read.occupancy.grid().dims(), [1.0; 3])?;
                read.occupancy.with_grid(grid)?
            }
        };
        progress.stage("reading the mesh");
        let mesh = read_mesh(self.mesh)?;
        progress.stage("checking");
        let settings = CheckSettings {
            border: self.border,
            faces: self.faces,
            all_axes: self.all_axes,
            self_intersections: true,
        };
        let report = check(&mesh, &volume, &settings)
            .map_err(|error| Failure::Undone(format!("{}: {error}", self.mesh.display())))?;
        Ok(Examined { mesh, volume, affine, words: selection.words, report })
    }
}
