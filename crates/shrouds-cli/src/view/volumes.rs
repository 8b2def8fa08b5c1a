//! The volumes of a session: read, selected from, made of each other.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use serde_json::{Value, json};
use shrouds::Occupancy;
use shrouds::materials::Labels;
use shrouds::volume::{self, Border};
use shrouds_io::{Contents, Frame, Volume, VolumeOptions, read_contents, read_volume};
use shrouds_view::server::{Files, Upload};

use super::edit::Edits;
use super::page::Page;
use super::request::{Origin, Slot};
use super::typed;
use crate::args::{Operation, VolumeArgs};
use crate::commands::mesh::materials::names;
use crate::console::Console;
use crate::failure::Failure;
use crate::input::{self, Source};
use crate::materials::labels_of;
use crate::phantom;
use crate::progress::Progress;
use crate::selection::Selection;
use crate::settings::volume_options;

/// Values of more kinds than this are no labels that anybody would choose from.
const MOST_LABELS: usize = 1024;
/// Between two colours of the circle: the golden angle, so that neighbours differ.
const HUE_STEP: f64 = 137.507_764;

/// A volume and where it comes from.
pub(super) struct Data {
    /// What is inside; shared with the surfaces made of it.
    pub(super) source: Arc<Source>,
    /// The values it was selected from, if there are some.
    pub(super) values: Option<Arc<Values>>,
    /// How it is called on the command line.
    pub(super) name: Name,
    /// Options of the command line that select it.
    pub(super) words: Vec<String>,
    pub(super) edits: Edits,
    warnings: Vec<String>,
}

/// A volume's name.
#[derive(Clone)]
pub(super) enum Name {
    Demo(String, usize),
    File(String),
    /// Made here: there is no file of it yet.
    Made(String),
}

impl Name {
    pub(super) fn text(&self) -> &str {
        match self {
            Self::Demo(name, _) | Self::File(name) | Self::Made(name) => name,
        }
    }
}

/// A file whose values are in memory.
pub(super) struct Values {
    pub(super) volume: Volume,
    path: PathBuf,
    /// Options that say which volume of the file it is.
    words: Vec<String>,
    contents: Contents,
    /// Labels and how many voxels have them, if there are not too many.
    pub(super) labels: Option<Vec<(i128, u64)>>,
    pub(super) range: Option<(f64, f64)>,
    _upload: Option<Upload>,
}

impl Data {
    pub(super) fn open(origin: Origin, files: &Files, page: &Page) -> Result<Self, Failure> {
        let Origin { demo, size, path, upload, frame, array, level } = origin;
        let mut words = Vec::new();
        words.extend(frame.map(|frame| format!("--frame={frame}")));
        words.extend(array.map(|array| format!("--array={array}")));
        words.extend(level.map(|level| format!("--level={level}")));
        match (demo, path, upload) {
            (Some(name), None, None) if words.is_empty() => Self::demo(&name, size, page),
            (None, Some(path), None) if size.is_none() => {
                let (path, name) = (PathBuf::from(&path), Name::File(path));
                Self::read(path, name, words, None, page)
            }
            (None, None, Some(id)) if size.is_none() => {
                let upload = files.take(&id).ok_or_else(|| {
                    Failure::Call("this upload is not there, or was opened; send the file again".into())
                })?;
                let path = upload.path().to_owned();
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                Self::read(path, Name::File(name), words, Some(upload), page)
            }
            _ => Err(Failure::Call(
                "a source is {demo, size?}, {path} or {upload}, the last two perhaps with frame, array and level"
                    .into(),
            )),
        }
    }

    fn demo(name: &str, size: Option<u16>, page: &Page) -> Result<Self, Failure> {
        page.progress("building the phantom", None);
        if size.is_some_and(|size| !(1..=2048).contains(&size)) {
            return Err(Failure::Call("the size of a demo is between 1 and 2048".into()));
        }
        let size = phantom::size(name, size);
        let path = PathBuf::from(format!("demo:{name}"));
        let start = Instant::now();
        let (source, labels) = phantom::labelled(name, size, path.clone(), start)?;
        let name = Name::Demo(name.into(), size);
        match labels {
            Some(labels) => {
                let volume = Volume {
                    grid: source.lattice,
                    values: labels.into(),
                    frame: source.frame,
                    contents: Contents::default(),
                };
                let values = Values::new(volume, path, Vec::new(), Contents::default(), None);
                Self::select(&Arc::new(values), name, &[], start)
            }
            None => Ok(Self::new(source, name)),
        }
    }

    /// A volume without values.
    fn new(source: Source, name: Name) -> Self {
        Self {
            source: Arc::new(source),
            values: None,
            name,
            words: Vec::new(),
            edits: Edits::default(),
            warnings: Vec::new(),
        }
    }

    fn read(
        path: PathBuf,
        name: Name,
        words: Vec<String>,
        upload: Option<Upload>,
        page: &Page,
    ) -> Result<Self, Failure> {
        let start = Instant::now();
        let args = typed::reading(&words)?;
        page.progress("reading", None);
        let told = |failure| in_the_words_of(&name, &path, failure);
        let values = Values::read(&path, &args, words, upload, page).map_err(told)?;
        Self::select(&Arc::new(values), name.clone(), &[], start).map_err(told)
    }

    /// The same file with these options of selection.
    pub(super) fn select_again(&self, selection: &[String]) -> Result<Self, Failure> {
        let Some(values) = &self.values else {
            let message = "has no values to select from: it was made here";
            return Err(Failure::Call(format!("{} {message}", self.name.text())));
        };
        Self::select(values, self.name.clone(), selection, Instant::now())
            .map_err(|failure| in_the_words_of(&self.name, &values.path, failure))
    }

    fn select(
        values: &Arc<Values>,
        name: Name,
        selection: &[String],
        start: Instant,
    ) -> Result<Self, Failure> {
        let words = [&values.words[..], selection].concat();
        let args = typed::reading(&words)?;
        let chosen = Selection::new(&values.path, &args, &values.contents)?;
        let occupancy = values.occupancy(&args, &chosen)?;
        let source = Source {
            path: PathBuf::from(name.text()),
            selection: chosen.words,
            lattice: occupancy.grid().clone(),
            occupancy,
            frame: values.volume.frame.clone(),
            truth: [None; 2],
            seconds: start.elapsed().as_secs_f64(),
        };
        let warnings = values.contents.warnings.clone();
        let values = Some(values.clone());
        Ok(Self { values, words, warnings, ..Self::new(source, name) })
    }

    /// The labels that are chosen, at least two besides the background, and the names they have.
    pub(super) fn materials(&self) -> Result<(Labels, BTreeMap<i128, String>), Failure> {
        match (&self.values, &self.name) {
            (None, _) | (_, Name::Made(_)) => Err(Failure::Call(format!(
                "{} has no labels: it is one body, or was made or changed here",
                self.name.text()
            ))),
            (Some(values), name) => {
                let labels = values.materials(&self.words);
                let labels =
                    labels.map_err(|failure| in_the_words_of(name, &values.path, failure))?;
                Ok((labels, values.names()))
            }
        }
    }

    /// A volume made of this one.
    fn made(&self, occupancy: Occupancy, how: &str) -> Self {
        Self::made_here(occupancy, Name::Made(how.into()), self.source.frame.clone())
    }

    /// A volume of which there is no file.
    pub(super) fn made_here(occupancy: Occupancy, name: Name, frame: Frame) -> Self {
        let source = Source {
            path: PathBuf::from(name.text()),
            selection: "all but 0".into(),
            lattice: occupancy.grid().clone(),
            occupancy,
            frame,
            truth: [None; 2],
            seconds: 0.0,
        };
        Self::new(source, name)
    }

    /// What the page is told.
    pub(super) fn about(&self, slot: Slot) -> Value {
        let Source { occupancy, frame, selection, seconds, .. } = &*self.source;
        let grid = occupancy.grid();
        let [x, y, z] = grid.affine();
        let mut warnings = self.warnings.clone();
        if occupancy.count() == 0 {
            warnings.push("nothing is inside: choose other labels or another threshold".into());
        }
        let values = self.values.as_deref();
        json!({
            "slot": slot.name(),
            "name": self.name.text(),
            "dims": grid.dims(),
            "spacing": grid.spacing(),
            "affine": [x, y, z, [0.0, 0.0, 0.0, 1.0]],
            "frame": frame.name,
            "unit": frame.unit,
            "inside": occupancy.count(),
            "selected": selection,
            "labels": values.and_then(Values::labels_for_page),
            "range": values.and_then(|values| values.range).map(|(low, high)| [low, high]),
            "warnings": warnings,
            "seconds": seconds,
            "undo": self.edits.can_undo(),
            "redo": self.edits.can_redo(),
        })
    }
}

impl Values {
    fn read(
        path: &Path,
        args: &VolumeArgs,
        words: Vec<String>,
        upload: Option<Upload>,
        page: &Page,
    ) -> Result<Self, Failure> {
        let told = std::cell::Cell::new(Instant::now());
        let report = |done: u64, bytes: u64| {
            if told.get().elapsed().as_millis() > 50 {
                told.set(Instant::now());
                page.progress("reading", (bytes > 0).then(|| done as f64 / bytes as f64));
            }
        };
        let options = volume_options(args, &report);
        let (_, _, contents) = read_contents(path, &options)?;
        // Of layers of segments the first stands for all when values are shown.
        let first = contents.has_layers_of_segments().then_some(0);
        let options = VolumeOptions { layer: options.layer.or(first), ..options };
        let volume = read_volume(path, &options)?;
        page.progress("counting labels", None);
        Ok(Self::new(volume, path.into(), words, contents, upload))
    }

    fn new(
        volume: Volume,
        path: PathBuf,
        words: Vec<String>,
        contents: Contents,
        upload: Option<Upload>,
    ) -> Self {
        let labels = volume.values.labels().filter(|labels| labels.len() <= MOST_LABELS);
        let range = volume.values.range();
        Self { volume, path, words, contents, labels, range, _upload: upload }
    }

    /// The labels that these words choose, at least two besides the background.
    fn materials(&self, words: &[String]) -> Result<Labels, Failure> {
        let args = typed::reading(words)?;
        let problem = match () {
            () if args.threshold.is_some() => "--materials wants labels, no threshold",
            () if self.contents.has_layers_of_segments() && args.layer().is_none() => {
                "the segments lie in several layers; open one of them, with its frame"
            }
            () if self.labels.is_none() => {
                "the values are no labels, or too many different ones for the page; shrouds mesh --materials takes any number"
            }
            () => {
                let labels = labels_of(&self.volume, &self.path, &args, &self.volume.grid)?;
                if labels.values().len() > 2 {
                    return Ok(labels);
                }
                "--materials wants at least two labels besides 0, and here is one"
            }
        };
        Err(Failure::Call(format!("{}: {problem}", self.path.display())))
    }

    /// Names of labels, where the file has some.
    fn names(&self) -> BTreeMap<i128, String> {
        names(&self.contents)
    }

    fn occupancy(&self, args: &VolumeArgs, chosen: &Selection) -> Result<Occupancy, Failure> {
        let is_all_here = !self.contents.has_layers_of_segments() || args.layer().is_some();
        match &chosen.parts[..] {
            [(_, select)] if is_all_here => input::occupancy(&self.path, &self.volume, select),
            _ => {
                let silent = Console { quiet: true };
                let progress = Progress::new(true);
                let selected = input::selected(&self.path, args, chosen, silent, &progress)?;
                Ok(selected.occupancy)
            }
        }
    }

    /// Labels with their counts, names and colours.
    fn labels_for_page(&self) -> Option<Value> {
        let named = |label: i128| {
            let mut segments = self.contents.segments.iter();
            segments.find(|segment| segment.label == label).map(|segment| segment.name.clone())
        };
        let entry = |&(label, count): &(i128, u64)| {
            let value = i64::try_from(label).unwrap_or(i64::MAX);
            let colour = colour(label).map(|part| format!("{part:02x}")).concat();
            json!({ "value": value, "count": count, "name": named(label), "colour": colour })
        };
        self.labels.as_ref().map(|labels| labels.iter().map(entry).collect())
    }
}

/// A file that was sent lies in a folder of ours: messages call it by its own name.
fn in_the_words_of(name: &Name, path: &Path, failure: Failure) -> Failure {
    let message = failure.message().replace(&path.display().to_string(), name.text());
    match failure {
        Failure::Undone(_) => Failure::Undone(message),
        Failure::Call(_) => Failure::Call(message),
        Failure::NotConverged(_) => Failure::NotConverged(message),
    }
}

/// A colour for a label that its neighbours do not have; 0 is grey.
pub(super) fn colour(label: i128) -> [u8; 3] {
    if label == 0 {
        return [96; 3];
    }
    let hue = (label as f64 * HUE_STEP).rem_euclid(360.0) / 60.0;
    let level = |shift: f64| {
        let place = (hue + shift).rem_euclid(6.0);
        let share = (place - 3.0).abs() - 1.0;
        (60.0 + 180.0 * share.clamp(0.0, 1.0)) as u8
    };
    [level(0.0), level(4.0), level(2.0)]
}

/// What two volumes give.
pub(super) fn combined(operation: Operation, a: &Data, b: &Data) -> Result<Data, Failure> {
    let (word, operation) = match operation {
        Operation::Union => ("∪", volume::Operation::Union),
        Operation::Intersect => ("∩", volume::Operation::Intersect),
        Operation::Subtract => ("−", volume::Operation::Subtract),
        Operation::Xor => ("⊻", volume::Operation::Xor),
    };
    let names = [a.name.text(), b.name.text()];
    let occupancy = a.source.occupancy.combine(operation, &b.source.occupancy);
    let occupancy = occupancy
        .map_err(|error| Failure::Undone(format!("{} and {}: {error}", names[0], names[1])))?;
    Ok(a.made(occupancy, &format!("{} {word} {}", names[0], names[1])))
}

/// A volume grown, or shrunk, by a distance; the lattice grows as needed.
pub(super) fn offset(data: &Data, by: f64) -> Result<Data, Failure> {
    if !by.is_finite() {
        return Err(Failure::Call("the distance is a number".into()));
    }
    let padded = data.source.occupancy.padded_for(by)?;
    let occupancy = padded.offset(by, Border::Closed)?;
    Ok(data.made(occupancy, &format!("{} {by:+}", data.name.text())))
}

/// The options that select these labels, or all above a threshold, or all but 0.
pub(super) fn selection(
    labels: Option<Vec<i64>>,
    threshold: Option<f64>,
) -> Result<Vec<String>, Failure> {
    match (labels, threshold) {
        (Some(labels), None) if labels.is_empty() => {
            Err(Failure::Call("choose at least one label".into()))
        }
        (Some(labels), _) if labels.len() > MOST_LABELS => {
            Err(Failure::Call(format!("choose at most {MOST_LABELS} labels")))
        }
        (Some(labels), None) => Ok(labels.iter().map(|label| format!("--label={label}")).collect()),
        (None, Some(level)) => Ok(vec![format!("--threshold={level}")]),
        (None, None) => Ok(Vec::new()),
        (Some(_), Some(_)) => {
            Err(Failure::Call("select labels or a threshold, not both at once".into()))
        }
    }
}
