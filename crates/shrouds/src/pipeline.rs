//! The whole story in a few calls.

use std::time::Instant;

use crate::error::Error;
use crate::mesh::{MeshKind, TriMesh, network_normals, place_vertices, slope_normals};
use crate::network::Network;
use crate::optimize::{Observer, Optimum, Report, VolumeRule, keep_volumes, optimize};
use crate::settings::Settings;
use crate::surface::Surface;
use crate::volume::{Border, Occupancy};

/// An optimal separating surface and all that led to it, but for the network, which
/// [`Network::trace`](crate::network::Network::trace) finds again.
#[derive(Debug, Clone)]
pub struct Shroud {
    /// Crossings and patches.
    pub surface: Surface,
    /// δ of every vertex of the surface, in `[margin, 1 − margin]`; 1 is the inside end.
    pub delta: Vec<f64>,
    /// The mesh in world coordinates.
    pub mesh: TriMesh,
    /// How the optimisation went.
    pub report: Report,
    /// How long each stage took.
    pub times: Times,
}

/// Seconds spent in each stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Times {
    /// Finding crossings and patches.
    pub surface: f64,
    /// Optimising δ.
    pub optimize: f64,
    /// Placing vertices and choosing triangles.
    pub mesh: f64,
}

/// The shroud of a volume: the optimal separating surface of equation 4.
///
/// An empty volume gives an empty mesh, with status [`Status::Empty`](crate::optimize::Status::Empty).
///
/// # Errors
/// Those of [`Surface::extract`] and [`optimize()`]; [`Error::Setting`] when a dual mesh is asked of an
/// open border or to keep volumes.
pub fn shroud(volume: &Occupancy, settings: &Settings) -> Result<Shroud, Error> {
    shroud_observed(volume, settings, &mut |_| std::ops::ControlFlow::Continue(()))
}

/// As [`shroud`], telling an observer after every iteration how far it has come; the observer may
/// stop the optimisation.
///
/// # Errors
/// As [`shroud`].
pub fn shroud_observed(
    volume: &Occupancy,
    settings: &Settings,
    observer: &mut Observer,
) -> Result<Shroud, Error> {
    if settings.mesh == MeshKind::Dual && settings.border == Border::Open {
        let value = "open".to_string();
        return Err(Error::Setting { name: "border", value, range: "closed for a dual mesh" });
    }
    let keeps_volumes = settings.optimize.volume == VolumeRule::Keep;
    if settings.mesh == MeshKind::Dual && keeps_volumes {
        let value = "keep".to_string();
        return Err(Error::Setting { name: "volume", value, range: "free for a dual mesh" });
    }
    let mut times = Times::default();
    let surface =
        timed(&mut times.surface, || Surface::extract(volume, settings.faces, settings.border))?;
    let Optimum { mut delta, slopes, mut report } =
        timed(&mut times.optimize, || optimize(&surface, &settings.optimize, observer))?;
    let mesh = timed(&mut times.mesh, || {
        let normals = slope_normals(&surface, &slopes);
        // Their memory is wanted for the triangles.
        drop(slopes);
        let vertices = place_vertices(&surface, &delta);
        let mut mesh =
            TriMesh::span(&surface, vertices, normals, settings.mesh, settings.triangles);
        if keeps_volumes {
            keep_volumes(&surface, &mesh.triangles, &settings.optimize, &mut delta, &mut report);
            mesh.vertices = place_vertices(&surface, &delta);
            mesh.normals = network_normals(&surface, &Network::trace(&surface), &mesh.vertices);
        }
        mesh
    });
    Ok(Shroud { surface, delta, mesh, report, times })
}

fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}
