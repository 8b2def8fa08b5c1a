//! What is packed: the volume, and the surface that says where its vertices lie.

use std::path::Path;

use shrouds::surface::Surface;
use shrouds::voxelize::deltas;
use shrouds::{Occupancy, Select};
use shrouds_io::{Frame, Selected};

use super::call::Call;
use super::places::Given;
use crate::args::{FrameChoice, PackArgs, Places};
use crate::body::Body;
use crate::console::{Console, plural};
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;
use crate::selection::Selection;
use crate::settings::Job;
use crate::work::{converged, shroud};

pub(super) struct Source {
    pub(super) occupancy: Occupancy,
    pub(super) frame: Frame,
    /// What is inside, in words.
    pub(super) selection: String,
    /// The surface with the places of its vertices, if they are packed.
    pub(super) given: Option<Given>,
}

pub(super) fn read(
    args: &PackArgs,
    call: &Call,
    console: Console,
    progress: &Progress,
) -> Result<Source, Failure> {
    let mut source = match *call {
        Call::Mesh(places) => mesh(args, places, console, progress),
        _ if call.places() == Some(Places::Isosurface) => isosurface(args, console, progress),
        _ => volume(args, console, progress),
    }?;
    if call.places() == Some(Places::Shroud) {
        source.given = Some(shrouded(args, &source.occupancy, console, progress)?);
    }
    Ok(source)
}

fn volume(args: &PackArgs, console: Console, progress: &Progress) -> Result<Source, Failure> {
    let (_, _, contents) = input::contents(&args.input, &args.volume, console)?;
    let selection = Selection::new(&args.input, &args.volume, &contents)?;
    let Selected { occupancy, frame, .. } =
        input::selected(&args.input, &args.volume, &selection, console, progress)?;
    Ok(Source { occupancy, frame, selection: selection.words, given: None })
}

/// Grey values with their isosurface.
fn isosurface(args: &PackArgs, console: Console, progress: &Progress) -> Result<Source, Failure> {
    let (_, _, contents) = input::contents(&args.input, &args.volume, console)?;
    let selection = Selection::new(&args.input, &args.volume, &contents)?;
    let level = args.volume.threshold.unwrap_or_default();
    let volume = input::volume(&args.input, &args.volume, args.volume.layer(), progress)?;
    let occupancy = input::occupancy(&args.input, &volume, &Select::Above(level))?;
    let surface = extract(args, &occupancy)?;
    let delta = volume.values.isosurface_deltas(&surface, level)?;
    let given = Some(Given { surface, delta });
    Ok(Source { occupancy, frame: volume.frame, selection: selection.words, given })
}

/// A mesh with the voxels inside it.
fn mesh(
    args: &PackArgs,
    places: Option<Places>,
    console: Console,
    progress: &Progress,
) -> Result<Source, Failure> {
    let Body { mesh, voxelized, frame } =
        Body::read(&args.input, &args.lattice, args.volume.spacing, progress)?;
    let warn = |note: &str| console.warn(&format!("{}: {note}", args.input.display()));
    voxelized.report.notes().iter().for_each(|note| warn(note));
    let occupancy = voxelized.volume;
    let mut given = None;
    if places == Some(Places::Mesh) {
        let surface = extract(args, &occupancy)?;
        let found = deltas(&mesh, &surface)?;
        if found.missing > 0 {
            let edges = plural(found.missing as usize, "grid edge");
            warn(&format!(
                "it does not cross {edges} where it should: holes; vertices go to their middles"
            ));
        }
        given = Some(Given { surface, delta: found.delta });
    }
    Ok(Source { occupancy, frame, selection: selection_of(&args.input), given })
}

fn selection_of(mesh: &Path) -> String {
    format!("inside {}", mesh.display())
}

/// The shroud of a volume.
fn shrouded(
    args: &PackArgs,
    volume: &Occupancy,
    console: Console,
    progress: &Progress,
) -> Result<Given, Failure> {
    let job = Job::new(&args.shroud, FrameChoice::World)?;
    job.warn(console);
    let shroud = shroud(volume, &job, progress)?;
    if !shroud.delta.is_empty() {
        converged(&shroud.report, &job, console)?;
    }
    Ok(Given { surface: shroud.surface, delta: shroud.delta })
}

fn extract(args: &PackArgs, volume: &Occupancy) -> Result<Surface, Failure> {
    let solve = &args.shroud.solve;
    Ok(Surface::extract(volume, solve.faces, solve.border)?)
}
