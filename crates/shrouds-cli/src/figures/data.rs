//! The volumes of the figures: from `cargo xtask data` where they are, else phantoms.

use std::path::{Path, PathBuf};

use shrouds::surface::Surface;
use shrouds::voxelize::{Rule, deltas};
use shrouds::{Grid, Occupancy, Select, TriMesh, voxelize};
use shrouds_io::{VolumeOptions, read_mesh, read_volume};

use super::panel::reach;
use crate::failure::Failure;

/// Lattice points that stay free around a body.
const FREE: f64 = 2.0;
/// Bodies are off the lattice points by something without a meaning.
const OFF: [f64; 3] = [0.01317, 0.02711, 0.00733];

/// The folder with real data.
pub(crate) struct Data {
    folder: PathBuf,
}

/// How a mesh comes onto a lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fit {
    /// As it is, as large as may be.
    Whole,
    /// Stretched along every axis by itself.
    Stretched,
}

/// A body on a lattice, and where it comes from.
pub(crate) struct Body {
    pub(crate) volume: Occupancy,
    pub(crate) source: String,
    shape: Shape,
}

/// What a volume was sampled from.
enum Shape {
    Mesh(TriMesh),
    /// Values at lattice points, x fastest, above 0 inside.
    Field(Vec<f64>),
    Voxels,
}

impl Data {
    pub(crate) fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.into() }
    }

    /// A mesh of this name on a lattice that it fills, stretched or not; else the phantom of a field.
    pub(crate) fn body(
        &self,
        mesh: &str,
        dims: [usize; 3],
        fit: Fit,
        field: impl Fn([f64; 3]) -> f64,
    ) -> Result<Body, Failure> {
        let grid = Grid::new(dims, [1.0; 3])?;
        let path = self.folder.join(mesh);
        if !path.exists() {
            return of_field(grid, field);
        }
        let mut body = read_mesh(&path)?;
        fit.apply(&mut body, dims);
        let volume = voxelize(&body, &grid, Rule::NonZero)?.volume;
        let source = format!("`{mesh}` of `cargo xtask data`");
        Ok(Body { volume, source, shape: Shape::Mesh(body) })
    }

    /// A volume of this name, if it is there.
    pub(crate) fn volume(&self, name: &str) -> Result<Option<Body>, Failure> {
        let path = self.folder.join(name);
        if !path.exists() {
            return Ok(None);
        }
        let read = read_volume(&path, &VolumeOptions::default())?;
        let volume = read.occupancy(&Select::NonZero)?;
        let source = format!("`{name}` of `cargo xtask data`");
        Ok(Some(Body { volume, source, shape: Shape::Voxels }))
    }
}

/// The phantom of a field on the unit cube that is positive inside.
pub(crate) fn of_field(grid: Grid, field: impl Fn([f64; 3]) -> f64) -> Result<Body, Failure> {
    let dims = grid.dims();
    let points = (0..grid.point_count()).map(|n| {
        let index = [n % dims[0], n / dims[0] % dims[1], n / (dims[0] * dims[1])];
        std::array::from_fn(|a| index[a] as f64 / (dims[a] - 1) as f64)
    });
    let values: Vec<f64> = points.map(field).collect();
    let volume = Occupancy::from_slice(grid, &values, |value| value > 0.0)?;
    Ok(Body { volume, source: "a phantom".into(), shape: Shape::Field(values) })
}

impl Body {
    /// Where the grid edges of the volume's surface cross the body, if that is known.
    pub(crate) fn crossings(&self, surface: &Surface) -> Result<Option<Vec<f64>>, Failure> {
        Ok(match &self.shape {
            Shape::Mesh(mesh) => Some(deltas(mesh, surface)?.delta),
            Shape::Field(values) => Some(surface.isosurface_deltas(values, 0.0)?),
            Shape::Voxels => None,
        })
    }
}

impl Fit {
    fn apply(self, mesh: &mut TriMesh, dims: [usize; 3]) {
        let [low, high] = reach(mesh).unwrap_or_default();
        let room: [f64; 3] = std::array::from_fn(|a| {
            (dims[a] as f64 - 1.0 - 2.0 * FREE) / (high[a] - low[a]).max(f64::MIN_POSITIVE)
        });
        let least = room.iter().copied().fold(f64::INFINITY, f64::min);
        let scale = if self == Self::Stretched { room } else { [least; 3] };
        for vertex in &mut mesh.vertices {
            *vertex = std::array::from_fn(|a| {
                let middle = (dims[a] as f64 - 1.0) / 2.0 + OFF[a];
                (vertex[a] - (low[a] + high[a]) / 2.0) * scale[a] + middle
            });
        }
    }
}
