//! The whole story in a few calls.

use std::time::Instant;

use crate::error::Error;
use crate::materials::interfaces::Interfaces;
use crate::materials::keep::{LabelVolume, keep_volumes};
use crate::materials::labels::Labels;
use crate::materials::mesh::MaterialMesh;
use crate::materials::optimize::{Optimum, Report, optimize};
use crate::optimize::{ComponentVolume, Preset, Start, VolumeRule};
use crate::pipeline::{self, Times};
use crate::settings;
use crate::volume::{FaceRule, Occupancy};

/// What a caller can choose.
#[derive(Debug, Clone)]
pub struct Settings {
    /// How a face is cut both of whose diagonals have a label each; the first label of the pair counts
    /// as the inside. Default [`FaceRule::Separate`].
    pub faces: FaceRule,
    /// How much work goes into the minimum. Default [`Preset::Default`].
    pub preset: Preset,
    /// Where the crossings start; not given. Default [`Start::Blur`].
    pub start: Start,
    /// All unknowns stay within `[margin, 1 − margin]`, so that no vertex touches a lattice point and no
    /// junction the border of its face. Range [1e-6, 0.1]; default 0.002.
    pub margin: f64,
    /// [`Preset::Exact`] stops when the root mean square of a step, in edge lengths, falls to this.
    /// Range (0, 1); default 5e-4.
    pub tolerance: f64,
    /// Whether volumes are kept: with [`VolumeRule::Keep`] the boundary of every label encloses the volume of its
    /// voxels, as far as the bounds allow. Interfaces then move evenly from where the energy has them. Default
    /// [`VolumeRule::Free`].
    pub volume: VolumeRule,
    /// The most Gauss–Newton steps of [`Preset::Exact`] on its last energy. Default 100.
    pub max_iterations: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            faces: FaceRule::default(),
            preset: Preset::default(),
            start: Start::default(),
            margin: 0.002,
            tolerance: 5e-4,
            volume: VolumeRule::default(),
            max_iterations: 100,
        }
    }
}

impl Settings {
    pub(super) fn validate(&self) -> Result<(), Error> {
        let refuse =
            |name, value: f64, range| Err(Error::Setting { name, value: value.to_string(), range });
        if !(1e-6..=0.1).contains(&self.margin) {
            return refuse("margin", self.margin, "between 1e-6 and 0.1");
        }
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return refuse("tolerance", self.tolerance, "above 0 and below 1");
        }
        if matches!(self.start, Start::Given(_)) {
            let (value, range) =
                (self.start.to_string(), "found, not given, for several materials");
            return Err(Error::Setting { name: "start", value, range });
        }
        Ok(())
    }

    /// The same for the binary flow.
    fn of_two_labels(&self) -> settings::Settings {
        settings::Settings {
            faces: self.faces,
            optimize: crate::optimize::Settings {
                preset: self.preset,
                start: self.start.clone(),
                margin: self.margin,
                tolerance: Some(self.tolerance),
                volume: self.volume,
                max_iterations: Some(self.max_iterations),
                ..Default::default()
            },
            ..Default::default()
        }
    }
}

/// The interfaces of all labels of a volume.
#[derive(Debug, Clone)]
pub struct Shrouds {
    /// The mesh of all interfaces.
    pub mesh: MaterialMesh,
    /// How the optimisation went.
    pub report: Report,
    /// How long each stage took.
    pub times: Times,
    /// Number of crossings.
    pub crossings: usize,
    /// Number of junction points.
    pub junctions: usize,
}

/// The optimal interfaces between all labels of a volume.
///
/// A volume without labels gives an empty mesh. One with a single label besides the background gives
/// what [`shroud`](crate::shroud) does, bit by bit.
///
/// # Errors
/// Those of [`Interfaces::extract`]; [`Error::Setting`] when a setting is outside its range.
pub fn shrouds(labels: Labels, settings: &Settings) -> Result<Shrouds, Error> {
    settings.validate()?;
    if let [_, label] = *labels.values() {
        return of_two_labels(&labels, label, settings);
    }
    let mut times = Times::default();
    let interfaces = timed(&mut times.surface, || Interfaces::extract(labels, settings.faces))?;
    let Optimum { unknowns, slopes, mut report } =
        timed(&mut times.optimize, || optimize(&interfaces, settings))?;
    let mut mesh = timed(&mut times.mesh, || MaterialMesh::span(&interfaces, &unknowns, &slopes));
    if settings.volume == VolumeRule::Keep {
        let bounds = [settings.margin, 1.0 - settings.margin];
        report.volumes =
            timed(&mut times.optimize, || keep_volumes(&interfaces, bounds, &unknowns, &mut mesh));
    }
    let (crossings, junctions) = (interfaces.crossings().len(), interfaces.junctions().len());
    Ok(Shrouds { mesh, report, times, crossings, junctions })
}

/// Leaves a volume of one label and background to the binary flow.
fn of_two_labels(labels: &Labels, label: i64, settings: &Settings) -> Result<Shrouds, Error> {
    let volume: Occupancy = labels.occupancy(1)?;
    let shroud = pipeline::shroud(&volume, &settings.of_two_labels())?;
    let passes = shroud.report.rounds.into_iter().map(|round| round.energies).collect();
    let crossings = shroud.mesh.vertices.len();
    let mesh = MaterialMesh {
        pairs: vec![[label, 0]; shroud.mesh.triangles.len()],
        surface: shroud.mesh,
        lines: Vec::new(),
    };
    let volumes = of_components(label, &shroud.report.volumes).into_iter().collect();
    let report = Report { status: shroud.report.status, passes, volumes };
    Ok(Shrouds { mesh, report, times: shroud.times, crossings, junctions: 0 })
}

/// What the components of a label enclose together, where their volumes were kept.
fn of_components(label: i64, volumes: &[ComponentVolume]) -> Option<LabelVolume> {
    let sum = |part: fn(&ComponentVolume) -> f64| volumes.iter().map(part).sum();
    let is_held = volumes.iter().any(|volume| volume.is_held);
    let (target, reached) = (sum(|volume| volume.target), sum(|volume| volume.reached));
    (!volumes.is_empty()).then_some(LabelVolume { label, target, reached, is_held })
}

fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds += start.elapsed().as_secs_f64();
    result
}
