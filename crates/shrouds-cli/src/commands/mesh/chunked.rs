//! `shrouds mesh --chunk N`: volumes that do not fit into memory, chunk by chunk.
//!
//! What is found lies in a folder beside the output until that is whole. A call that was broken off is
//! continued by the same call.

use std::ffi::OsString;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Instant, UNIX_EPOCH};

use serde::Serialize;
use sha2::{Digest, Sha256};
use shrouds::chunks::{Layout, Passes};
use shrouds::mesh::MeshKind;
use shrouds::{Grid, Occupancy, Select, TriMesh};
use shrouds_io::{
    ChunkRun, MeshFormat, MeshOptions, Totals, VolumeOptions, mesh_format, read_layers,
    volume_files,
};

use crate::args::{FrameChoice, MeshArgs, Reading};
use crate::console::{Console, grouped, json, plural, print_json};
use crate::failure::Failure;
use crate::frame::mesh_options;
use crate::input;
use crate::output::{check_targets, make_folder, write_json};
use crate::progress::Progress;
use crate::report::peak_memory;
use crate::selection::Selection;
use crate::settings::{Job, volume_options};

/// What is told at the end.
#[derive(Serialize)]
struct ChunkReport {
    /// Voxels along an edge of a chunk, and how many chunks there are.
    chunk: usize,
    chunks: usize,
    vertices: u64,
    triangles: u64,
    /// Seconds of this call.
    seconds: f64,
    /// Peak bytes.
    memory: Option<u64>,
    version: &'static str,
}

pub(super) fn run(
    args: &MeshArgs,
    edge: usize,
    job: &Job,
    start: Instant,
    console: Console,
) -> Result<(), Failure> {
    let is_folder = check(args, job)?;
    job.warn(console);
    let (lattice, frame, contents) = input::contents(&args.input, &args.volume, console)?;
    let selection = Selection::new(&args.input, &args.volume, &contents)?;
    let [(layer, select)] = &selection.parts[..] else {
        let message = "--chunk takes labels of one --frame of the file";
        return Err(Failure::Call(message.into()));
    };
    let in_call = |error: shrouds::Error| Failure::Call(error.to_string());
    let layout = Layout::new(lattice.clone(), job.settings.border, edge).map_err(in_call)?;
    Passes::new(&job.settings.optimize).map_err(in_call)?;
    let identity = identity(args, &selection.words, edge, job)?;
    let run = ChunkRun::open(work_folder(&args.output), &identity, layout, &job.settings)?;
    if is_folder && let Err(failure) = prepare_folder(&args.output, run.is_continued()) {
        run.remove()?;
        return Err(failure);
    }
    let options =
        mesh_options(&[&corners(&lattice)], MeshFormat::Ply, frame, lattice.min_spacing()).0;
    let progress = Progress::new(console.quiet);
    let work = Work { args, run, options, progress };
    work.read(*layer, select)?;
    let totals = work.relax()?;
    if totals.vertices == 0 {
        work.run.remove()?;
        let message = "there is no surface: all voxels are on one side; see --label, --threshold and --border";
        return Err(Failure::Undone(format!("{}: {message}", args.input.display())));
    }
    work.write(is_folder)?;
    let chunks = work.run.layout().chunks().count();
    work.run.remove()?;
    drop(work.progress);
    let report = ChunkReport {
        chunk: edge,
        chunks,
        vertices: totals.vertices,
        triangles: totals.triangles,
        seconds: start.elapsed().as_secs_f64(),
        memory: peak_memory(),
        version: env!("CARGO_PKG_VERSION"),
    };
    if let Some(path) = &args.report {
        write_json(path, &report)?;
    }
    if args.json {
        return print_json(&report);
    }
    console.message(&format!(
        "{}: {} vertices, {} triangles from {}, {:.2} s",
        args.output.display(),
        grouped(report.vertices),
        grouped(report.triangles),
        plural(chunks, "chunk"),
        report.seconds
    ));
    Ok(())
}

/// Refuses what does not go with chunks; whether the output is a folder of parts.
fn check(args: &MeshArgs, job: &Job) -> Result<bool, Failure> {
    let refuse = |message: &str| Err(Failure::Call(format!("--chunk {message}")));
    if job.settings.mesh == MeshKind::Dual {
        return refuse("needs --surface primal");
    }
    if job.frame == FrameChoice::Index {
        return refuse("writes world coordinates: leave --frame index out");
    }
    if job.strict {
        return refuse(
            "takes the presets fast and default, which do not converge: leave --strict out",
        );
    }
    let is_folder = args.output.extension().is_none();
    if !is_folder && mesh_format(&args.output)? != MeshFormat::Ply {
        return refuse("writes one .ply, or a folder of them: give such a name");
    }
    let file = (!is_folder).then_some(args.output.as_path());
    let targets: Vec<&Path> = file.into_iter().chain(args.report.as_deref()).collect();
    check_targets(&targets, &[&args.input])?;
    Ok(is_folder)
}

/// The folder of what is found, beside the output.
fn work_folder(output: &Path) -> PathBuf {
    let mut name = OsString::from(output.file_name().unwrap_or_default());
    name.push(".chunks");
    output.with_file_name(name)
}

/// A folder for parts, which must not have those of another call.
fn prepare_folder(folder: &Path, is_continued: bool) -> Result<(), Failure> {
    make_folder(folder)?;
    let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    if is_continued || is_empty {
        return Ok(());
    }
    let message = "this folder has other files already; give an empty one or a new name";
    Err(Failure::Undone(format!("{}: {message}", folder.display())))
}

/// What tells this work from all others: the program, the files of the volume with their sizes and
/// times, how they are read, and the settings.
fn identity(args: &MeshArgs, selected: &str, edge: usize, job: &Job) -> Result<String, Failure> {
    let mut hash = Sha256::new();
    let mut add = |text: &str| hash.update(format!("{}\n{text}\n", text.len()));
    add(env!("CARGO_PKG_VERSION"));
    let files = volume_files(&args.input, &volume_options(&args.volume, &|_, _| {}))?;
    for file in files {
        let data = fs::metadata(&file).ok();
        let changed = data.as_ref().and_then(|data| data.modified().ok());
        let changed = changed.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let length = data.map_or(0, |data| data.len());
        let place = fs::canonicalize(&file).unwrap_or(file);
        add(&format!("{} {length} {changed:?}", place.display()));
    }
    add(&json(&Reading::of(&args.volume))?);
    add(selected);
    job.settings.to_names().iter().for_each(|(name, value)| add(&format!("{name}={value}")));
    add(&format!("chunk={edge} parts={}", args.output.extension().is_none()));
    Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The corners of a lattice, no vertex lies beyond which.
fn corners(lattice: &Grid) -> TriMesh {
    let end = lattice.dims().map(|count| count as f64);
    let corner = |n: usize| [0, 1, 2].map(|d| if n >> d & 1 == 1 { end[d] } else { -1.0 });
    let vertices = (0..8).map(|n| lattice.point(corner(n))).collect();
    TriMesh { vertices, ..TriMesh::default() }
}

struct Work<'a> {
    args: &'a MeshArgs,
    run: ChunkRun,
    options: MeshOptions,
    progress: Progress,
}

impl Work<'_> {
    /// Brings the voxels of all chunks into the folder, unless they are there.
    fn read(&self, layer: Option<usize>, select: &Select) -> Result<(), Failure> {
        let layout = self.run.layout();
        let mut is_there = true;
        for chunk in layout.chunks() {
            is_there &= self.run.has_voxels(chunk)?;
        }
        if is_there {
            return Ok(());
        }
        self.progress.stage("reading");
        let report = |done, bytes| self.progress.read(done, bytes);
        let options = volume_options(&self.args.volume, &report);
        let options = VolumeOptions { layer: layer.or(options.layer), ..options };
        read_layers(&self.args.input, &options, select, layout.edge(), |place, voxels| {
            self.keep(&place, &voxels)
        })
    }

    /// Keeps the voxels of all chunks of a layer.
    fn keep(&self, place: &[Range<usize>; 3], voxels: &Occupancy) -> Result<(), Failure> {
        let layout = self.run.layout();
        let is_within = |chunk: &[usize; 3]| {
            let ranges = layout.voxels(*chunk);
            (0..3).all(|d| place[d].start <= ranges[d].start && ranges[d].end <= place[d].end)
        };
        for chunk in layout.chunks().filter(is_within) {
            let ranges = layout.voxels(chunk);
            let within = std::array::from_fn(|d| {
                ranges[d].start - place[d].start..ranges[d].end - place[d].start
            });
            let voxels = voxels.crop(within).map_err(|error| {
                Failure::Undone(format!("{}: {error}", self.args.input.display()))
            })?;
            self.run.put_voxels(chunk, &voxels)?;
        }
        Ok(())
    }

    /// Makes all passes.
    fn relax(&self) -> Result<Totals, Failure> {
        let mut totals = Totals::default();
        for pass in 0..self.run.passes() {
            let name = format!("pass {} of {}", pass + 1, self.run.passes());
            self.for_each_chunk(&name, |chunk| Ok(self.run.relax(pass, chunk)?))?;
            totals = self.run.finish(pass)?;
        }
        Ok(totals)
    }

    /// Writes the output.
    fn write(&self, is_folder: bool) -> Result<(), Failure> {
        let (output, options) = (&self.args.output, &self.options);
        if is_folder {
            return self.for_each_chunk("writing parts", |chunk| {
                self.run.write_part(chunk, output, options)?;
                Ok(())
            });
        }
        self.for_each_chunk("making triangles", |chunk| {
            Ok(self.run.write_piece(chunk, options)?)
        })?;
        self.progress.stage("writing");
        Ok(self.run.join(output, options)?)
    }

    fn for_each_chunk(
        &self,
        stage: &str,
        step: impl Fn([usize; 3]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let count = self.run.layout().chunks().count();
        for (n, chunk) in self.run.layout().chunks().enumerate() {
            self.progress.stage(&format!("{stage}: chunk {} of {count}", n + 1));
            step(chunk)?;
        }
        Ok(())
    }
}
