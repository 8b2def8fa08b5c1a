//! A mesh for every label, each in a file of a folder or all in one file.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;
use shrouds::volume::Border;
use shrouds::{Grid, Occupancy, TriMesh};
use shrouds_io::{Frame, MeshFormat, mesh_format};

use crate::console::{Console, grouped, plural, print_json};
use crate::failure::Failure;
use crate::input::Source;
use crate::output::{check_targets, make_folder, write_json};
use crate::progress::Progress;
use crate::report::{Report, peak_memory};
use crate::settings::Job;
use crate::work::{Extras, Made, PartOf, make, write};

/// Layers of outside voxels that are kept around a label.
const MARGIN: usize = 2;

/// Where the meshes go.
pub(crate) struct Target<'a> {
    /// The folder or the file.
    pub(crate) output: &'a Path,
    /// Extension of the files in a folder.
    pub(crate) extension: &'a str,
    /// The file they come from.
    pub(crate) input: &'a Path,
}

/// A label with voxels.
pub(crate) struct Label {
    pub(crate) label: i128,
    /// That of its segment, or empty.
    pub(crate) name: String,
    /// The layer of the file it is in, where there are several.
    pub(crate) layer: Option<usize>,
}

/// A label that is done.
pub(crate) struct Finished {
    label: Label,
    pub(crate) made: Made,
    /// The mesh file.
    file: PathBuf,
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

/// The labels so far.
pub(crate) struct Each<'a> {
    pub(crate) target: Target<'a>,
    pub(crate) job: &'a Job,
    pub(crate) extras: &'a Extras,
    pub(crate) console: Console,
    pub(crate) progress: Progress,
    /// Whether meshes are still wanted when they are written.
    pub(crate) keeps_meshes: bool,
    pub(crate) done: Vec<Finished>,
}

impl Target<'_> {
    /// Whether the meshes go to a folder: one that is there, or a name without extension.
    pub(crate) fn is_folder(&self) -> bool {
        self.output.is_dir()
            || self.output.extension().is_none()
            || self.output.as_os_str().to_string_lossy().ends_with('/')
    }

    /// The format of the files, which has to hold several meshes if it is one for all.
    pub(crate) fn format(&self) -> Result<MeshFormat, Failure> {
        if self.is_folder() {
            return Ok(mesh_format(format!("x.{}", self.extension))?);
        }
        let format = mesh_format(self.output)?;
        if !format.holds_parts() {
            let message = "this format holds one mesh; name a folder, or a .ply, .obj, .glb, .vtp or .3mf file";
            return Err(Failure::Call(format!("{}: {message}", self.output.display())));
        }
        Ok(format)
    }
}

impl Each<'_> {
    /// Shrouds a label; into a folder it is written at once.
    pub(crate) fn add(
        &mut self,
        label: Label,
        occupancy: Occupancy,
        frame: &Frame,
    ) -> Result<(), Failure> {
        let source = Source {
            path: self.target.input.into(),
            selection: label.title(),
            lattice: occupancy.grid().clone(),
            occupancy: self.cropped(occupancy)?,
            frame: frame.clone(),
            truth: [None; 2],
            seconds: 0.0,
        };
        let made = make(&source, self.job, self.extras, &self.progress)?;
        let mut one = Finished { label, made, file: PathBuf::new() };
        if self.target.is_folder() {
            one.file = self.write(&mut one, &source)?;
        }
        self.done.push(one);
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

    /// Writes a mesh into the folder.
    fn write(&self, one: &mut Finished, source: &Source) -> Result<PathBuf, Failure> {
        let folder = self.target.output;
        make_folder(folder)?;
        let path = folder.join(format!("{}.{}", one.label.file_name(), self.target.extension));
        check_targets(&[&path], &[self.target.input])?;
        let part = PartOf::new(&mut one.made, one.label.title(), Some(one.label.label));
        let Source { lattice, frame, .. } = source;
        write(&path, &mut [part], lattice, frame, self.job.frame, self.console)?;
        if !self.keeps_meshes {
            one.made.mesh = TriMesh::default();
        }
        one.made.attributes = Vec::new();
        Ok(path)
    }

    /// Fails when there was no label.
    pub(crate) fn require_labels(&self) -> Result<(), Failure> {
        if self.done.is_empty() {
            let message = "there is no label but 0; check that this is the segmentation";
            return Err(Failure::Undone(format!("{}: {message}", self.target.input.display())));
        }
        Ok(())
    }

    /// Writes all meshes to the one file, if they do not go to a folder.
    pub(crate) fn write_file(&mut self, lattice: &Grid, frame: &Frame) -> Result<(), Failure> {
        if self.target.is_folder() {
            return Ok(());
        }
        let output = self.target.output;
        let mut parts = Vec::new();
        for Finished { label, made, file } in &mut self.done {
            *file = output.into();
            parts.push(PartOf::new(made, label.title(), Some(label.label)));
        }
        write(output, &mut parts, lattice, frame, self.job.frame, self.console)
    }

    /// Reports, and the first verdict that is a failure.
    pub(crate) fn finish(
        self,
        start: Instant,
        report_file: Option<&Path>,
        json: bool,
    ) -> Result<(), Failure> {
        drop(self.progress);
        let vertices: u64 = self.done.iter().map(|one| one.made.report.topology.vertices).sum();
        let count = self.done.len();
        let verdict = self.done.iter().try_for_each(|one| one.made.verdict(self.job, self.console));
        let report = |one: Finished| {
            let mut report = one.made.report;
            report.times.total = start.elapsed().as_secs_f64();
            report.memory = peak_memory();
            let Label { label, name, .. } = one.label;
            LabelReport { label, name, file: one.file.display().to_string(), report }
        };
        let reports: Vec<LabelReport> = self.done.into_iter().map(report).collect();
        if let Some(path) = report_file {
            write_json(path, &reports)?;
        }
        if json {
            print_json(&reports)?;
        } else {
            self.console.message(&format!(
                "{}: {}, {} vertices, {:.2} s",
                self.target.output.display(),
                plural(count, "label"),
                grouped(vertices),
                start.elapsed().as_secs_f64()
            ));
        }
        verdict
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
        let layer = self.layer.map_or(String::new(), |layer| format!("{layer}-"));
        if name.is_empty() {
            format!("{layer}label-{}", self.label)
        } else {
            format!("{layer}{}-{name}", self.label)
        }
    }
}
