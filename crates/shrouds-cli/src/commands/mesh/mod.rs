//! `shrouds mesh`: a volume in, its shroud out.

mod chunked;
mod each;
pub(crate) mod materials;
pub(crate) mod materials_report;

use std::path::Path;
use std::time::Instant;

use shrouds::mesh::MeshKind;
use shrouds::{Occupancy, Select};
use shrouds_io::{MeshFormat, VolumeOptions, mesh_format, read_occupancy, volume_format};

use crate::args::{MeshArgs, SolveArgs};
use crate::certificate::{self, Subject};
use crate::console::{Console, grouped, number, print_json};
use crate::failure::Failure;
use crate::input::{self, Source};
use crate::output::{check_png, check_targets};
use crate::progress::Progress;
use crate::report::Report;
use crate::settings::Job;
use crate::work::{Extras, Outputs, produce};

pub(crate) fn run(args: &MeshArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let mut job = Job::new(&args.shroud, args.volume.coordinates())?;
    let extras = Extras { network: false, attributes: args.attributes.clone() };
    if args.materials {
        return materials::run(args, &job, start, console);
    }
    if args.each.is_some() {
        return each::run(args, &job, &extras, start, console);
    }
    if let Some(edge) = args.chunk {
        return chunked::run(args, edge, &job, start, console);
    }
    let outputs = Outputs {
        mesh: &args.output,
        picture: args.picture.as_deref(),
        report: args.report.as_deref(),
    };
    check_attributes(args, mesh_format(&args.output)?)?;
    check_certificate(args)?;
    check_files(args, &[&args.output])?;
    job.warn(console);
    let progress = Progress::new(console.quiet);
    let source = input::source(&args.input, &args.volume, console, &progress)?;
    if let Some(path) = &args.rough {
        job = job.with_rough(path, rough_places(path, &source)?);
    }
    let done = produce(&source, &job, &outputs, &extras, start, console, &progress)?;
    drop(progress);
    if args.json {
        print_json(&done.report)?;
    } else {
        console.message(&summary(&args.output, &done.report));
    }
    if let Some(path) = &args.certificate {
        certify(args, path, console)?;
    }
    done.verdict(&job, console)
}

/// The voxels of a mask on the lattice of the volume.
fn rough_places(path: &Path, source: &Source) -> Result<Occupancy, Failure> {
    let mask = read_occupancy(path, &VolumeOptions::default(), &Select::NonZero)?.occupancy;
    mask.grid().check_same_lattice(&source.lattice).map_err(|error| {
        Failure::Undone(format!("{}: {error}; --rough wants that of the volume", path.display()))
    })?;
    Ok(mask)
}

/// Finds out before the work whether the files can be what they are to be.
fn check_files(args: &MeshArgs, meshes: &[&Path]) -> Result<(), Failure> {
    volume_format(&args.input)?;
    let picture = args.picture.as_deref();
    picture.map_or(Ok(()), check_png)?;
    let others = [picture, args.report.as_deref(), args.certificate.as_deref()];
    let targets: Vec<&Path> = meshes.iter().copied().chain(others.into_iter().flatten()).collect();
    let inputs = [Some(args.input.as_path()), args.rough.as_deref()];
    check_targets(&targets, &inputs.into_iter().flatten().collect::<Vec<_>>())
}

/// Whether the mesh can be read again for its certificate.
fn check_certificate(args: &MeshArgs) -> Result<(), Failure> {
    let is_read =
        matches!(mesh_format(&args.output)?, MeshFormat::Ply | MeshFormat::Stl | MeshFormat::Obj);
    if args.certificate.is_none() || is_read {
        return Ok(());
    }
    let message =
        "no format that is read again, which a --certificate needs; .ply, .stl and .obj are";
    Err(Failure::Call(format!("{}: {message}", args.output.display())))
}

/// Checks the mesh as it was written and writes its certificate.
fn certify(args: &MeshArgs, path: &Path, console: Console) -> Result<(), Failure> {
    let SolveArgs { border, faces, .. } = args.shroud.solve;
    let subject = Subject {
        mesh: &args.output,
        volume: &args.input,
        selection: &args.volume,
        border,
        faces,
        all_axes: false,
    };
    // What is doubtful about the volume has been told.
    let silent = Console { quiet: true };
    certificate::certify(path, &subject, silent, &Progress::new(console.quiet))
}

/// Whether the mesh and the format can have the numbers per vertex that are wanted.
fn check_attributes(args: &MeshArgs, format: MeshFormat) -> Result<(), Failure> {
    if args.attributes.is_empty() {
        return Ok(());
    }
    if args.shroud.solve.surface == MeshKind::Dual {
        let message = "--attributes are those of the vertices of --surface primal";
        return Err(Failure::Call(message.into()));
    }
    if !format.holds_attributes() {
        let message = "holds no --attributes; .ply, .glb and .vtp do";
        return Err(Failure::Call(format!("{}: this format {message}", args.output.display())));
    }
    Ok(())
}

fn summary(output: &Path, report: &Report) -> String {
    let (topology, geometry) = (&report.topology, &report.geometry);
    let shortfall = report.shortfall().map_or(String::new(), |text| format!("; {text}"));
    let kept = report.kept().map_or(String::new(), |text| format!("; {text}"));
    format!(
        "{}: {} vertices, {} triangles, volume {}, area {}, {} of {} voxels on the wrong side, {:.2} s{kept}{shortfall}",
        output.display(),
        grouped(topology.vertices),
        grouped(topology.triangles),
        number(geometry.volume),
        number(geometry.area),
        report.checks.wrong_side,
        grouped(report.input.lattice.dims.iter().product::<usize>() as u64),
        report.times.total,
    )
}
