//! The numbers of every step.

use std::path::{Path, PathBuf};

use serde::Serialize;
use shrouds::Shroud;
use shrouds::check::CheckReport;
use shrouds::containment::{self, Extent, Step};

use crate::args::ContainArgs;
use crate::console::{grouped, number};
use crate::failure::Failure;
use crate::report::{name, peak_memory};
use crate::scene::Told;
use crate::settings::{Job, SettingsReport};

/// Everything about a scene.
#[derive(Serialize)]
pub(super) struct Report {
    scene: String,
    /// Lattice points along x, y, z.
    dims: [usize; 3],
    /// In metres.
    spacing: [f64; 3],
    one_sided: bool,
    settings: SettingsReport,
    steps: Vec<StepReport>,
    /// The number of the contact, from 1, that left no place for the target.
    emptied_by: Option<usize>,
    /// Steps that were shrouded in a second of growing, intersecting and shrouding.
    steps_per_second: Option<f64>,
    /// In seconds.
    total: f64,
    /// Largest memory in bytes, where the system tells it.
    memory: Option<u64>,
    version: &'static str,
}

/// What is known after a contact.
#[derive(Serialize)]
pub(super) struct StepReport {
    /// From 1 on.
    contact: usize,
    /// In seconds.
    time: f64,
    path: &'static str,
    bearing: f64,
    half_width: f64,
    array: ArrayReport,
    /// Voxels of the region once grown, before the contact.
    grown: u64,
    voxels: u64,
    /// Null where nothing is left.
    region: Option<RegionReport>,
    truth: Option<TruthReport>,
    shroud: Option<ShroudReport>,
    files: Option<Written>,
    times: Times,
}

#[derive(Serialize)]
struct ArrayReport {
    position: [f64; 2],
    depth: f64,
    /// In degrees from north over east.
    course: f64,
}

/// In metres; the low end of z is the deepest.
#[derive(Serialize)]
struct RegionReport {
    volume: f64,
    low: [f64; 3],
    high: [f64; 3],
    centroid: [f64; 3],
    /// Whether the target could have left the lattice sideways.
    reaches_border: bool,
}

#[derive(Serialize)]
struct TruthReport {
    position: [f64; 3],
    /// Whether the voxel nearest to the target is in the region.
    inside: bool,
}

#[derive(Serialize)]
pub(super) struct ShroudReport {
    vertices: usize,
    triangles: usize,
    volume: f64,
    area: f64,
    status: &'static str,
    #[serde(skip)]
    seconds: f64,
}

#[derive(Serialize)]
pub(super) struct Written {
    pub(super) volume: PathBuf,
    pub(super) mesh: PathBuf,
    pub(super) picture: PathBuf,
}

/// Seconds.
#[derive(Serialize)]
struct Times {
    grow: f64,
    intersect: f64,
    shroud: Option<f64>,
}

impl Report {
    pub(super) fn new(args: &ContainArgs, told: &Told, job: &Job) -> Self {
        let grid = told.scene.sea().grid();
        Self {
            scene: name(&args.scene),
            dims: grid.dims(),
            spacing: grid.spacing(),
            one_sided: args.one_sided,
            settings: job.report.clone(),
            steps: Vec::new(),
            emptied_by: None,
            steps_per_second: None,
            total: 0.0,
            memory: None,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    pub(super) fn add(&mut self, step: StepReport) {
        if step.region.is_none() {
            self.emptied_by = Some(step.contact);
        }
        self.steps.push(step);
    }

    pub(super) fn finish(&mut self, total: f64) {
        let seconds = self.steps.iter().map(|step| &step.times);
        let whole: Vec<f64> = seconds
            .filter_map(|times| Some(times.grow + times.intersect + times.shroud?))
            .collect();
        self.steps_per_second =
            (!whole.is_empty()).then(|| whole.len() as f64 / whole.iter().sum::<f64>());
        self.total = total;
        self.memory = peak_memory();
    }

    /// A failure where a contact contradicts those before it.
    pub(super) fn verdict(&self) -> Result<(), Failure> {
        let Some(step) = self.steps.iter().find(|step| step.region.is_none()) else {
            return Ok(());
        };
        Err(Failure::Undone(format!(
            "{}: contact {} at {} s ({} at {} ± {} degrees) leaves no place for the target: it contradicts those before it; check its bearing and path, or widen it, or raise the target's speed",
            self.scene, step.contact, step.time, step.path, step.bearing, step.half_width
        )))
    }

    /// The numbers as a table for people.
    pub(super) fn in_words(&self, folder: &Path) -> String {
        let heading = [
            "contact",
            "time s",
            "path",
            "bearing",
            "grown",
            "voxels",
            "km³",
            "centre east",
            "north",
            "depth",
            "grow ms",
            "intersect",
            "shroud",
        ];
        let mut rows = vec![heading.map(String::from).to_vec()];
        rows.extend(self.steps.iter().map(StepReport::row));
        let columns = heading.len();
        let width = |n: usize| rows.iter().map(|row| row[n].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}"));
            cells.collect::<Vec<_>>().join("  ")
        };
        let mut lines: Vec<String> = rows.iter().map(line).collect();
        let truth: Vec<&TruthReport> =
            self.steps.iter().filter_map(|step| step.truth.as_ref()).collect();
        if !truth.is_empty() {
            let inside = truth.iter().filter(|truth| truth.inside).count();
            lines.push(format!("the true target is in {inside} of {} regions", truth.len()));
        }
        if self.steps.iter().any(|step| step.region.as_ref().is_some_and(|r| r.reaches_border)) {
            lines
                .push("a region reaches the border of the sea: the target may have left it".into());
        }
        if let Some(rate) = self.steps_per_second {
            lines.push(format!("{} steps a second; files in {}", number(rate), folder.display()));
        }
        lines.join("\n")
    }
}

impl StepReport {
    pub(super) fn new(told: &Told, step: &Step) -> Self {
        let contact = &told.scene.contacts()[step.contact];
        let [east, north] = step.array.axis;
        let extent = Extent::of(&step.region);
        let bounds = step.region.bounding_box();
        let dims = step.region.grid().dims();
        let reaches_border = bounds
            .is_some_and(|bounds| (0..2).any(|d| bounds[d].start == 0 || bounds[d].end == dims[d]));
        Self {
            contact: step.contact + 1,
            time: step.time,
            path: path_name(contact.path),
            bearing: contact.bearing,
            half_width: contact.half_width,
            array: ArrayReport {
                position: step.array.position,
                depth: step.array.depth,
                course: east.atan2(north).to_degrees().rem_euclid(360.0),
            },
            grown: step.grown,
            voxels: extent.map_or(0, |extent| extent.points),
            region: extent.map(|Extent { volume, low, high, centroid, .. }| RegionReport {
                volume,
                low,
                high,
                centroid,
                reaches_border,
            }),
            truth: TruthReport::new(told, step),
            shroud: None,
            files: None,
            times: Times { grow: step.seconds[0], intersect: step.seconds[1], shroud: None },
        }
    }

    pub(super) fn with_files(mut self, shroud: ShroudReport, files: Written) -> Self {
        self.times.shroud = Some(shroud.seconds);
        self.shroud = Some(shroud);
        self.files = Some(files);
        self
    }

    fn row(&self) -> Vec<String> {
        let milliseconds = |seconds: f64| format!("{:.1}", 1e3 * seconds);
        let region =
            |value: fn(&RegionReport) -> String| self.region.as_ref().map_or("-".into(), value);
        vec![
            self.contact.to_string(),
            number(self.time),
            self.path.into(),
            format!("{} ± {}", number(self.bearing), number(self.half_width)),
            grouped(self.grown),
            grouped(self.voxels),
            region(|region| number(region.volume / 1e9)),
            region(|region| format!("{:.0}", region.centroid[0])),
            region(|region| format!("{:.0}", region.centroid[1])),
            region(|region| format!("{:.0}", -region.centroid[2])),
            milliseconds(self.times.grow),
            milliseconds(self.times.intersect),
            self.times.shroud.map_or("-".into(), milliseconds),
        ]
    }
}

impl TruthReport {
    fn new(told: &Told, step: &Step) -> Option<Self> {
        let place = told.truth.as_ref()?.at(step.time)?;
        let position = [place.position[0], place.position[1], -place.depth];
        let grid = step.region.grid();
        let index = grid.inverse_affine().map(|row| {
            (row[0] * position[0] + row[1] * position[1] + row[2] * position[2] + row[3]).round()
        });
        let on_lattice = (0..3).all(|d| index[d] >= 0.0 && index[d] < grid.dims()[d] as f64);
        let inside = on_lattice && step.region.get(index.map(|x| x as usize));
        Some(Self { position, inside })
    }
}

impl ShroudReport {
    pub(super) fn new(shroud: &Shroud, checks: &CheckReport, seconds: f64) -> Self {
        Self {
            vertices: shroud.mesh.vertices.len(),
            triangles: shroud.mesh.triangles.len(),
            volume: checks.structure.volume,
            area: checks.structure.area,
            status: shroud.report.status.name(),
            seconds,
        }
    }
}

fn path_name(path: containment::Path) -> &'static str {
    match path {
        containment::Path::Direct => "direct",
        containment::Path::Bounce => "bounce",
        containment::Path::Either => "either",
    }
}
