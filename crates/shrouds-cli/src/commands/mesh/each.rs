//! `shrouds mesh --labels all`: a mesh for every label.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;
use shrouds::volume::Border;
use shrouds::{Occupancy, Select, TriMesh};
use shrouds_io::{Contents, Volume, mesh_format};

use super::{check_attributes, check_files};
use crate::args::MeshArgs;
use crate::console::{Console, grouped, plural, print_json};
use crate::failure::Failure;
use crate::input::{self, Source};
use crate::output::{check_targets, write_json, write_picture};
use crate::picture::View;
use crate::progress::Progress;
use crate::report::{Report, peak_memory};
use crate::settings::Job;
use crate::work::{Extras, Made, PartOf, make, write};

/// Layers of outside voxels that are kept around a label.
const MARGIN: usize = 2;

/// A label with voxels.
struct Label {
    label: i128,
    /// That of its segment, or empty.
    name: String,
    /// The layer of the file it is in.
    layer: usize,
}

/// One label in the report.
#[derive(Serialize)]
struct LabelReport {
    label: i128,
    name: String,
    /// The mesh file.
    file: String,
    #[serde(flatten)]
    report: Report,
}

pub(super) fn run(
    args: &MeshArgs,
    job: &Job,
    extras: &Extras,
    start: Instant,
    console: Console,
) -> Result<(), Failure> {
    let is_folder = is_folder(&args.output);
    let format = if is_folder { format!("x.{}", args.format).into() } else { args.output.clone() };
    let format = mesh_format(&format)?;
    check_attributes(args, format)?;
    if !is_folder && !format.holds_parts() {
        return Err(Failure::Call(format!(
            "{}: this format holds one mesh; name a folder, or a .ply, .obj, .glb, .vtp or .3mf file",
            args.output.display()
        )));
    }
    let target: &[&Path] = if is_folder { &[] } else { &[&args.output] };
    check_files(args, target)?;
    job.warn(console);
    let progress = Progress::new(console.quiet);
    let (lattice, frame, contents) = input::contents(&args.input, &args.volume, console)?;
    let mut run = Run { args, job, extras, console, progress: &progress, done: Vec::new() };
    let layers = match args.volume.layer() {
        Some(layer) => vec![Some(layer)],
        None if contents.has_layers_of_segments() => (0..contents.layers).map(Some).collect(),
        None => vec![None],
    };
    for layer in layers {
        let volume = input::volume(&args.input, &args.volume, layer, &progress)?;
        run.layer(&volume, layer.unwrap_or(0), &contents, is_folder)?;
    }
    progress.part("");
    if run.done.is_empty() {
        let message = "there is no label but 0; check that this is the segmentation";
        return Err(Failure::Undone(format!("{}: {message}", args.input.display())));
    }
    let mut done = run.done;
    progress.stage("writing");
    let picture = match &args.picture {
        Some(path) => Some((path, View::usual().draw(&merged(&done), &[])?)),
        None => None,
    };
    if !is_folder {
        let mut parts = Vec::new();
        for Finished { label, made, file } in &mut done {
            *file = args.output.clone();
            parts.push(PartOf { name: label.title(), label: Some(label.label), made });
        }
        write(&args.output, &mut parts, &lattice, &frame, job.frame, console)?;
    }
    if let Some((path, picture)) = picture {
        write_picture(path, &picture)?;
    }
    drop(progress);
    finish(args, job, console, done, start)
}

/// Reports, and the first verdict that is a failure.
fn finish(
    args: &MeshArgs,
    job: &Job,
    console: Console,
    done: Vec<Finished>,
    start: Instant,
) -> Result<(), Failure> {
    let vertices: u64 = done.iter().map(|one| one.made.report.topology.vertices).sum();
    let count = done.len();
    let verdict = done.iter().try_for_each(|one| one.made.verdict(job, console));
    let report = |one: Finished| {
        let mut report = one.made.report;
        report.times.total = start.elapsed().as_secs_f64();
        report.memory = peak_memory();
        let Label { label, name, .. } = one.label;
        LabelReport { label, name, file: one.file.display().to_string(), report }
    };
    let reports: Vec<LabelReport> = done.into_iter().map(report).collect();
    if let Some(path) = &args.report {
        write_json(path, &reports)?;
    }
    if args.json {
        print_json(&reports)?;
    } else {
        console.message(&format!(
            "{}: {}, {} vertices, {:.2} s",
            args.output.display(),
            plural(count, "label"),
            grouped(vertices),
            start.elapsed().as_secs_f64()
        ));
    }
    verdict
}

/// A label that is done.
struct Finished {
    label: Label,
    made: Made,
    /// The mesh file.
    file: PathBuf,
}

/// The labels so far.
struct Run<'a> {
    args: &'a MeshArgs,
    job: &'a Job,
    extras: &'a Extras,
    console: Console,
    progress: &'a Progress,
    done: Vec<Finished>,
}

impl Run<'_> {
    /// The labels of one layer of the file.
    fn layer(
        &mut self,
        volume: &Volume,
        layer: usize,
        contents: &Contents,
        to_folder: bool,
    ) -> Result<(), Failure> {
        let path = &self.args.input;
        let labels = volume.values.labels().ok_or_else(|| {
            let message = "the values are no labels; give --threshold instead of --labels";
            Failure::Undone(format!("{}: {message}", path.display()))
        })?;
        let count = labels.len();
        for (n, (label, _)) in labels.into_iter().filter(|(label, _)| *label != 0).enumerate() {
            self.progress.part(&format!("label {label}, {} of {count}", n + 1));
            let segment = contents.segments_of(layer).find(|segment| segment.label == label);
            let name = segment.map_or(String::new(), |segment| segment.name.clone());
            let label = Label { label, name, layer };
            let occupancy = input::occupancy(path, volume, &Select::Labels(vec![label.label]))?;
            let source = Source {
                path: path.clone(),
                selection: label.title(),
                occupancy: self.cropped(occupancy)?,
                lattice: volume.grid.clone(),
                frame: volume.frame.clone(),
                truth: [None; 2],
                seconds: 0.0,
            };
            let made = make(&source, self.job, self.extras, self.progress)?;
            let mut one = Finished { label, made, file: PathBuf::new() };
            if to_folder {
                one.file = self.write(&mut one, &source, contents.layers > 1)?;
            }
            self.done.push(one);
        }
        Ok(())
    }

    /// What is around a label: it costs what it is large, not what the volume is. At an open border
    /// the place of the border matters.
    fn cropped(&self, volume: Occupancy) -> Result<Occupancy, Failure> {
        let bounds = volume.bounding_box();
        let (Border::Closed, Some(bounds)) = (self.job.settings.border, bounds) else {
            return Ok(volume);
        };
        let dims = volume.grid().dims();
        Ok(volume.crop(std::array::from_fn(|d| {
            bounds[d].start.saturating_sub(MARGIN)..dims[d].min(bounds[d].end + MARGIN)
        }))?)
    }

    /// Writes a mesh into the folder; it stays in memory only for a picture.
    fn write(
        &self,
        one: &mut Finished,
        Source { lattice, frame, .. }: &Source,
        with_layer: bool,
    ) -> Result<PathBuf, Failure> {
        let folder = &self.args.output;
        fs::create_dir_all(folder).map_err(|cause| {
            let message = "cannot make this folder";
            Failure::Undone(format!("{}: {message} ({cause}); name another", folder.display()))
        })?;
        let layer = if with_layer { format!("{}-", one.label.layer) } else { String::new() };
        let file = format!("{layer}{}.{}", one.label.file_name(), self.args.format);
        let path = folder.join(file);
        check_targets(&[&path], &[&self.args.input])?;
        let part =
            PartOf { name: one.label.title(), label: Some(one.label.label), made: &mut one.made };
        write(&path, &mut [part], lattice, frame, self.job.frame, self.console)?;
        if self.args.picture.is_none() {
            one.made.mesh = TriMesh::default();
        }
        one.made.attributes = Vec::new();
        Ok(path)
    }
}

impl Label {
    /// What people call it.
    fn title(&self) -> String {
        if self.name.is_empty() { format!("label {}", self.label) } else { self.name.clone() }
    }

    /// A file name without extension that every system takes.
    fn file_name(&self) -> String {
        let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
        let name: String = self.name.chars().take(60).map(plain).collect();
        if name.is_empty() {
            format!("label-{}", self.label)
        } else {
            format!("{}-{name}", self.label)
        }
    }
}

/// Whether the results go to a folder: one that is there, or a name without extension.
fn is_folder(output: &Path) -> bool {
    output.is_dir()
        || output.extension().is_none()
        || output.as_os_str().to_string_lossy().ends_with('/')
}

/// All meshes in one, for the picture.
fn merged(done: &[Finished]) -> TriMesh {
    let mut all = TriMesh::default();
    for Finished { made, .. } in done {
        let first = all.vertices.len() as u32;
        all.vertices.extend(&made.mesh.vertices);
        all.triangles.extend(made.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        all.normals.extend(&made.mesh.normals);
    }
    all
}
