//! What a volume file holds.

use std::path::Path;

use serde::Serialize;
use shrouds::Select;
use shrouds_io::{Contents, Values, Volume};

use super::{lattice_in_words, table};
use crate::args::VolumeArgs;
use crate::console::{grouped, number};
use crate::failure::Failure;
use crate::frame::orientation;
use crate::input;
use crate::progress::Progress;
use crate::report::{Lattice, name};
use crate::selection::Selection;

/// Most labels that are shown to people.
const SHOWN: usize = 20;

#[derive(Serialize)]
pub(super) struct VolumeInfo {
    kind: &'static str,
    file: String,
    #[serde(flatten)]
    lattice: Lattice,
    /// Directions in the patient towards which x, y, z grow, where the file knows of a patient.
    orientation: Option<String>,
    /// Which part of the file gave the frame.
    frame_source: &'static str,
    /// Volumes in the file: frames of a series, channels, layers of segments.
    frames: usize,
    /// The ones that the rest is told of: all of a segmentation, else one.
    frames_read: Vec<usize>,
    /// Resolutions of a pyramid.
    levels: usize,
    /// Names of the arrays to choose from.
    arrays: Vec<String>,
    /// Type of the values.
    values: &'static str,
    /// Smallest and largest value.
    range: Option<(f64, f64)>,
    /// Null when the values are no labels.
    labels: Option<Vec<Label>>,
    selection: String,
    /// Voxels inside; null when some value is not a number.
    inside: Option<u64>,
    not_a_number: u64,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Label {
    label: i128,
    voxels: u64,
    /// The segment's, where the file has names.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    /// The layer it is in, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<usize>,
}

impl VolumeInfo {
    pub(super) fn new(
        path: &Path,
        args: &VolumeArgs,
        contents: Contents,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let selection = Selection::new(path, args, &contents)?;
        let layers = match args.layer() {
            Some(layer) => layer..layer + 1,
            None if contents.has_layers_of_segments() => 0..contents.layers,
            None => 0..1,
        };
        let mut info: Option<Self> = None;
        let mut chosen = Chosen::default();
        for layer in layers.clone() {
            let volume = input::volume(path, args, Some(layer), progress)?;
            progress.stage("counting");
            let labels = labels(&volume.values, layer, &contents);
            for (wanted, select) in &selection.parts {
                if wanted.is_none_or(|wanted| wanted == layer) {
                    chosen.add(&volume, select)?;
                }
            }
            match &mut info {
                None => info = Some(Self::of(path, &volume, labels)),
                Some(info) => info.add(&volume, labels),
            }
        }
        let mut info = info.ok_or_else(|| {
            Failure::Undone(format!("{}: there is no volume in it", path.display()))
        })?;
        info.frames = contents.layers;
        info.frames_read = layers.collect();
        info.selection = selection.words;
        info.inside = (chosen.not_a_number == 0).then_some(chosen.count());
        info.not_a_number = chosen.not_a_number;
        (info.arrays, info.warnings) = (contents.arrays, contents.warnings);
        Ok(info)
    }

    /// What one layer tells.
    fn of(path: &Path, volume: &Volume, labels: Option<Vec<Label>>) -> Self {
        Self {
            kind: "volume",
            file: name(path),
            lattice: Lattice::new(&volume.grid, &volume.frame.name, &volume.frame.unit),
            orientation: orientation(&volume.grid, &volume.frame),
            frame_source: volume.frame.source,
            frames: 1,
            frames_read: Vec::new(),
            levels: volume.contents.levels,
            arrays: Vec::new(),
            values: volume.values.type_name(),
            range: volume.values.range(),
            labels,
            selection: String::new(),
            inside: None,
            not_a_number: 0,
            warnings: Vec::new(),
        }
    }

    /// Takes in what another layer tells.
    fn add(&mut self, volume: &Volume, labels: Option<Vec<Label>>) {
        self.range = match (self.range, volume.values.range()) {
            (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
            (one, other) => one.or(other),
        };
        if let (Some(all), Some(labels)) = (&mut self.labels, labels) {
            all.extend(labels);
        }
    }

    pub(super) fn in_words(&self) -> String {
        let range = match self.range {
            Some((low, high)) => format!("{} to {}", number(low), number(high)),
            None => "no numbers".into(),
        };
        let inside = match self.inside {
            Some(inside) => format!("{} voxels: {}", grouped(inside), self.selection),
            None => format!("unknown: {} values are not a number", grouped(self.not_a_number)),
        };
        let frame = format!("{} (from: {})", self.lattice.frame, self.frame_source);
        let mut rows = vec![("volume", self.file.clone())];
        rows.extend(lattice_in_words(&self.lattice));
        rows.push(("frame", frame));
        if let Some(orientation) = &self.orientation {
            rows.push(("orientation", format!("{orientation} (x, y, z grow towards)")));
        }
        rows.extend(self.lattice.affine.iter().enumerate().map(|(r, row)| {
            let cells: Vec<String> = row.iter().map(|x| format!("{:>12}", number(*x))).collect();
            (["affine", "", ""][r], cells.concat())
        }));
        if self.frames > 1 {
            let read: Vec<String> = self.frames_read.iter().map(usize::to_string).collect();
            rows.push((
                "frames",
                format!("{}; what follows is of {}", self.frames, read.join(", ")),
            ));
        }
        if self.levels > 1 {
            rows.push(("levels", format!("{}, from the finest on", self.levels)));
        }
        if !self.arrays.is_empty() {
            rows.push(("arrays", self.arrays.join(", ")));
        }
        rows.push(("values", format!("{}, {range}", self.values)));
        rows.extend(self.labels_in_words());
        rows.push(("inside", inside));
        rows.extend(self.warnings.iter().map(|warning| ("warning", warning.clone())));
        table(&rows)
    }

    /// One line for all labels, or one for each where they have names.
    fn labels_in_words(&self) -> Vec<(&'static str, String)> {
        let Some(labels) = &self.labels else {
            return vec![("labels", "none: the values are no labels".into())];
        };
        let shown: Vec<String> = labels.iter().take(SHOWN).map(Label::in_words).collect();
        let more = match labels.len() - shown.len() {
            0 => String::new(),
            more => format!("and {more} more"),
        };
        if labels.iter().all(|label| label.name.is_none()) {
            let more = if more.is_empty() { more } else { format!(" {more}") };
            return vec![("labels", shown.join(", ") + &more)];
        }
        let lines = shown.into_iter().chain((!more.is_empty()).then_some(more)).enumerate();
        lines.map(|(n, line)| (if n == 0 { "labels" } else { "" }, line)).collect()
    }
}

/// What is inside of the layers so far.
#[derive(Default)]
struct Chosen {
    all: Option<shrouds::Occupancy>,
    not_a_number: u64,
}

impl Chosen {
    fn add(&mut self, volume: &Volume, select: &Select) -> Result<(), Failure> {
        match (volume.occupancy(select), &mut self.all) {
            (Ok(occupancy), Some(all)) => all.unite(&occupancy),
            (Ok(occupancy), None) => self.all = Some(occupancy),
            (Err(shrouds::Error::NotANumber { others, .. }), _) => {
                self.not_a_number += others as u64 + 1;
            }
            (Err(error), _) => return Err(error.into()),
        }
        Ok(())
    }

    fn count(&self) -> u64 {
        self.all.as_ref().map_or(0, shrouds::Occupancy::count)
    }
}

/// The labels of a layer with their names; segments without a voxel at the end.
fn labels(values: &Values, layer: usize, contents: &Contents) -> Option<Vec<Label>> {
    let frame = (contents.layers > 1).then_some(layer);
    let mut segments: Vec<_> = contents.segments_of(layer).collect();
    let mut labels = Vec::new();
    for (label, voxels) in values.labels()? {
        let named = segments.iter().position(|segment| segment.label == label);
        let name = named.map(|n| segments.remove(n).name.clone());
        labels.push(Label { label, voxels, name, frame });
    }
    let empty = |s: &shrouds_io::Segment| Label {
        label: s.label,
        voxels: 0,
        name: Some(s.name.clone()),
        frame,
    };
    labels.extend(segments.into_iter().map(empty));
    Some(labels)
}

impl Label {
    fn in_words(&self) -> String {
        let name = self.name.as_ref().map_or(String::new(), |name| format!(" {name}"));
        let frame = self.frame.map_or(String::new(), |frame| format!(", frame {frame}"));
        format!("{}{name} ({}{frame})", self.label, grouped(self.voxels))
    }
}
