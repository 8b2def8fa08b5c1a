//! The bodies of a volume: all that is selected, each label, or each connected component.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use shrouds::optimize::Status;
use shrouds::volume::Border;
use shrouds::{Grid, Occupancy, TriMesh};
use shrouds_io::{Contents, Frame};
use shrouds_report::measure::Body;

use super::contacts::{self, Contact};
use super::report::Row;
use crate::args::MeasureArgs;
use crate::console::{Console, plural};
use crate::failure::Failure;
use crate::input::{self, Source};
use crate::label_map::{LabelMap, Window};
use crate::progress::Progress;
use crate::report::peak_memory;
use crate::settings::Job;
use crate::work;

/// Layers of outside voxels that are kept around a body.
const MARGIN: usize = 2;

/// The note on a body whose optimisation was to converge and did not.
pub(super) const LATE: &str = "the optimisation did not converge";

/// What another surface is made of.
pub(super) enum Other {
    Nothing,
    Mesh(TriMesh),
    /// A volume file, to be asked for the same labels.
    Volume,
}

/// What is measured, and how.
pub(super) struct Run<'a> {
    pub(super) args: &'a MeasureArgs,
    pub(super) job: &'a Job,
    pub(super) console: Console,
    pub(super) progress: &'a Progress,
    pub(super) other: Other,
}

/// All bodies of a volume.
pub(super) struct Bodies {
    pub(super) lattice: Grid,
    pub(super) frame: Frame,
    /// What was selected, in words.
    pub(super) selection: String,
    pub(super) rows: Vec<Row>,
    pub(super) contacts: Vec<Contact>,
}

/// What a row is about.
#[derive(Debug, Clone, Default)]
pub(super) struct Name {
    pub(super) label: Option<i128>,
    pub(super) segment: String,
    pub(super) component: Option<usize>,
}

impl Run<'_> {
    /// Measures a volume file.
    pub(super) fn volume(&self) -> Result<Bodies, Failure> {
        let (path, args) = (&self.args.input, &self.args.volume);
        if self.args.each.is_none() {
            let Source { occupancy, lattice, frame, selection, .. } =
                input::source(path, args, self.console, self.progress)?;
            let other = self.other_selection(Some(&frame))?;
            let rows = self.body(&Name::default(), occupancy, other.as_ref())?;
            return Ok(Bodies { lattice, frame, selection, rows, contacts: Vec::new() });
        }
        let (lattice, frame, contents) = input::contents(path, args, self.console)?;
        let layers = match args.layer() {
            Some(layer) => vec![Some(layer)],
            None if contents.has_layers_of_segments() => (0..contents.layers).map(Some).collect(),
            None => vec![None],
        };
        let selection = "every label but 0".into();
        let (rows, contacts) = (Vec::new(), Vec::new());
        let mut all = Bodies { lattice, frame, selection, rows, contacts };
        for layer in layers {
            self.layer(layer, &contents, &mut all)?;
        }
        if all.rows.is_empty() {
            let message = "there is no label but 0; check that this is the segmentation";
            return Err(Failure::Undone(format!("{}: {message}", path.display())));
        }
        Ok(all)
    }

    /// Adds the labels of one layer of the file, several at a time: most are small.
    fn layer(
        &self,
        layer: Option<usize>,
        contents: &Contents,
        all: &mut Bodies,
    ) -> Result<(), Failure> {
        let (map, frame) = self.label_map(&self.args.input, layer)?;
        let others = match (&self.other, &self.args.distance_to) {
            (Other::Volume, Some(path)) => {
                let (other, of_other) = self.label_map(path, layer)?;
                self.compare_frames(&frame, &of_other);
                Some(other)
            }
            _ => None,
        };
        let name = |(number, label)| {
            let mut segments = contents.segments_of(layer.unwrap_or(0));
            let segment = segments.find(|segment| segment.label == label);
            let segment = segment.map_or(String::new(), |segment| segment.name.clone());
            (number, Name { label: Some(label), segment, component: None })
        };
        let names: Vec<(u16, Name)> = map.all().map(name).collect();
        let begun = AtomicUsize::new(0);
        let rows = names.par_iter().map(|(number, name)| {
            let at = begun.fetch_add(1, Ordering::Relaxed) + 1;
            self.progress.part(&format!("label {at} of {}", names.len()));
            let other = match &others {
                Some(other) => self.other_label(other, map.label(*number))?,
                None => None,
            };
            let occupancy = map.occupancy(&self.window(&map, *number), |n| n == *number)?;
            self.body(name, occupancy, other.as_ref())
        });
        let rows: Vec<Vec<Row>> = rows.collect::<Result<_, Failure>>()?;
        let first = all.rows.len();
        all.rows.extend(rows.into_iter().flatten());
        if self.args.contacts {
            let found = contacts::find(&map, &names, self)?;
            for row in &mut all.rows[first..] {
                row.add_outside(found.outside_of(row.name.label));
            }
            all.contacts.extend(found.between);
        }
        self.progress.part("");
        Ok(())
    }

    fn label_map(
        &self,
        path: &std::path::Path,
        layer: Option<usize>,
    ) -> Result<(LabelMap, Frame), Failure> {
        let volume = input::volume(path, &self.args.volume, layer, self.progress)?;
        let map = LabelMap::new(&volume).ok_or_else(|| {
            let message = "the values are no labels; give --threshold instead of --labels";
            Failure::Undone(format!("{}: {message}", path.display()))
        })?;
        Ok((map, volume.frame))
    }

    /// What is around a label. At an open border the place of the border matters.
    fn window(&self, map: &LabelMap, number: u16) -> Window {
        match self.job.settings.border {
            Border::Closed => map.wider(&map.window(number), MARGIN),
            Border::Open => map.whole(),
        }
    }

    /// A row for a body, or for each of its components.
    fn body(
        &self,
        name: &Name,
        occupancy: Occupancy,
        other: Option<&TriMesh>,
    ) -> Result<Vec<Row>, Failure> {
        if !self.args.components {
            return Ok(vec![self.row(name.clone(), &self.cropped(occupancy)?, other)?]);
        }
        let components = occupancy.components(self.job.settings.faces);
        let row = |n: usize| {
            let one = self.cropped(components.select(|m| m == n))?;
            self.row(Name { component: Some(n + 1), ..name.clone() }, &one, other)
        };
        (0..components.count()).map(row).collect()
    }

    fn cropped(&self, occupancy: Occupancy) -> Result<Occupancy, Failure> {
        let bounds = occupancy.bounding_box();
        let (Border::Closed, Some(bounds)) = (self.job.settings.border, bounds) else {
            return Ok(occupancy);
        };
        let dims = occupancy.grid().dims();
        Ok(occupancy.crop(std::array::from_fn(|d| {
            bounds[d].start.saturating_sub(MARGIN)..dims[d].min(bounds[d].end + MARGIN)
        }))?)
    }

    fn row(
        &self,
        name: Name,
        occupancy: &Occupancy,
        other: Option<&TriMesh>,
    ) -> Result<Row, Failure> {
        let shroud = work::shroud(occupancy, self.job, self.progress)?;
        self.progress.stage("measuring");
        let body = Body {
            mesh: &shroud.mesh,
            surface: Some(&shroud.surface),
            kind: self.job.settings.mesh,
            voxels: Some(occupancy.count()),
        };
        let mesh = match &self.other {
            Other::Mesh(mesh) => Some(mesh),
            _ => other,
        };
        let mut measured = body.measure(mesh)?;
        if matches!(self.other, Other::Volume) && other.is_none() {
            measured.notes.push("the other volume has no voxel of it: there is no distance".into());
        }
        if !matches!(shroud.report.status, Status::Converged | Status::Preset | Status::Empty) {
            measured.notes.push(LATE.into());
        }
        Ok(Row { name, measured })
    }

    /// The surface of the same selection in the other volume, if there is one.
    pub(super) fn other_selection(
        &self,
        frame: Option<&Frame>,
    ) -> Result<Option<TriMesh>, Failure> {
        let (Other::Volume, Some(path)) = (&self.other, &self.args.distance_to) else {
            return Ok(None);
        };
        let source = input::source(path, &self.args.volume, self.console, self.progress)?;
        if let Some(frame) = frame {
            self.compare_frames(frame, &source.frame);
        }
        let occupancy = self.cropped(source.occupancy)?;
        Ok(Some(work::shroud(&occupancy, self.job, self.progress)?.mesh))
    }

    /// The surface of the same label in the other volume, if it has one.
    fn other_label(&self, other: &LabelMap, label: i128) -> Result<Option<TriMesh>, Failure> {
        let Some(number) = other.number_of(label) else { return Ok(None) };
        let occupancy = other.occupancy(&self.window(other, number), |n| n == number)?;
        Ok(Some(work::shroud(&occupancy, self.job, self.progress)?.mesh))
    }

    fn compare_frames(&self, one: &Frame, other: &Frame) {
        if one.name != other.name || one.unit != other.unit {
            self.console.warn(&format!(
                "the volumes are in different frames, {} in {} and {} in {}: distances mean something only if these are the same",
                one.name, one.unit, other.name, other.unit
            ));
        }
    }
}

/// How much memory and how many rows it took, in words.
pub(super) fn effort(rows: usize, seconds: f64) -> String {
    let memory = peak_memory().map_or(String::new(), |bytes| format!(", {} MB", bytes >> 20));
    format!("{}, {seconds:.2} s{memory}", plural(rows, "row"))
}
