//! The tables of a scene file as they are written there.

use std::path::PathBuf;

use serde::Deserialize;
use toml::Spanned;

/// A scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneTable {
    pub(super) sea: Spanned<SeaTable>,
    pub(super) floor: Spanned<FloorTable>,
    #[serde(default)]
    pub(super) sound: Option<Spanned<SoundTable>>,
    pub(super) target: Spanned<TargetTable>,
    pub(super) platform: Vec<Spanned<WaypointTable>>,
    pub(super) contact: Vec<Spanned<ContactTable>>,
    /// Where the target truly is, where that is known.
    #[serde(default)]
    pub(super) truth: Vec<Spanned<PlaceTable>>,
}

/// The lattice.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SeaTable {
    pub(super) from: [f64; 2],
    pub(super) to: [f64; 2],
    pub(super) depth: f64,
    pub(super) spacing: SpacingValue,
}

/// One for all axes, or one for each.
#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, expecting = "a number, or three for x, y and z")]
pub(super) enum SpacingValue {
    All(f64),
    Each([f64; 3]),
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum FloorTable {
    Flat(FlatTable),
    Slope(SlopeTable),
    Ridge(RidgeTable),
    Fractal(FractalTable),
    Grid(GridTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FlatTable {
    pub(super) depth: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SlopeTable {
    pub(super) depth: f64,
    pub(super) slope: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RidgeTable {
    pub(super) depth: f64,
    pub(super) height: f64,
    pub(super) width: f64,
    pub(super) through: [f64; 2],
    pub(super) course: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FractalTable {
    pub(super) depth: f64,
    pub(super) relief: f64,
    pub(super) longest: f64,
    pub(super) shortest: f64,
    pub(super) seed: u64,
}

/// Depths by rows, or in a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GridTable {
    pub(super) from: [f64; 2],
    pub(super) spacing: [f64; 2],
    pub(super) rows: Option<Vec<Vec<f64>>>,
    pub(super) file: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SoundTable {
    pub(super) speed: Option<f64>,
    pub(super) profile: Option<Vec<[f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TargetTable {
    pub(super) speed: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WaypointTable {
    pub(super) time: f64,
    pub(super) position: [f64; 2],
    pub(super) depth: f64,
    pub(super) course: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    pub(super) time: f64,
    pub(super) bearing: f64,
    pub(super) half_width: f64,
    #[serde(default)]
    pub(super) path: PathName,
    pub(super) range: Option<[f64; 2]>,
}

#[derive(Deserialize, Clone, Copy, Default)]
#[serde(rename_all = "lowercase")]
pub(super) enum PathName {
    #[default]
    Direct,
    Bounce,
    Either,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlaceTable {
    pub(super) time: f64,
    pub(super) position: [f64; 2],
    pub(super) depth: f64,
}
