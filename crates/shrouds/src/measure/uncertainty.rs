//! How far a measure can be from the truth.
//!
//! Two answers for each. The *bounds* are what any separating surface S(δ) of the volume could have: nothing
//! is known beyond the voxels. The *error* is what shrouds of bodies of known size turned out to be off.

use crate::grid::Grid;
use crate::measure::bounds::bounds;
use crate::measure::integrals::Integrals;
use crate::surface::Surface;

/// The constant, the power of size and the power of the spacings' ratio of a calibrated error.
type Law = [f64; 3];

/// See [`calibrated_error`]; made by `cargo xtask measurements`.
const VOLUME: Law = [1.562, 1.109, 0.150];
const AREA: Law = [1.811, 1.222, 0.149];

/// Between what a value lies, in its own unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Span {
    /// The least a separating surface could have; see [`uncertainty`].
    pub low: f64,
    /// The largest a separating surface could have.
    pub high: f64,
    /// The truth of smooth bodies lies within this of the value, 19 times out of 20.
    pub error: f64,
}

/// The uncertainty of the measures of a shroud.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Uncertainty {
    /// Of the volume.
    pub volume: Span,
    /// Of the area.
    pub area: Span,
}

/// The uncertainty of the volume and the area of a shroud, as [`smooth_integrals`] gives them.
///
/// The bounds depend on the surface alone. Of volume they are those with all vertices at the inside and
/// at the outside ends, and mean something for a closed border only. Of area they are safe but not
/// sharp: what triangles and a ball of that volume have at least, and triangles by themselves at most.
///
/// [`smooth_integrals`]: crate::measure::smooth_integrals
pub fn uncertainty(surface: &Surface, value: &Integrals) -> Uncertainty {
    let [volume, area] = bounds(surface);
    let [volume_error, area_error] = calibrated_error(value, surface.grid());
    let span = |[low, high]: [f64; 2], error| Span { low, high, error };
    Uncertainty { volume: span(volume, volume_error), area: span(area, area_error) }
}

/// The errors of volume and area that shrouds of smooth bodies of this size stay within, 19 times out
/// of 20, in cubic and squared world units.
///
/// The relative error is c·(h/r)^p·q^s·√(h²/area): r = 3·volume/area is the radius of a ball and less
/// for all else, h the cube root of the voxel's volume, q the ratio of the largest spacing to the
/// smallest; the root counts the places at which the surface is known. `docs/measurements.md` tells how
/// c, p and s were found and on what they were tried. 0 where there is no volume.
pub fn calibrated_error(value: &Integrals, grid: &Grid) -> [f64; 2] {
    let radius = 3.0 * value.volume.abs() / value.area;
    let size = grid.voxel_volume().cbrt() / radius;
    let largest = grid.spacing().into_iter().fold(0.0, f64::max);
    let ratio = largest / grid.min_spacing();
    let places = value.area / grid.voxel_volume().cbrt().powi(2);
    let error = |[constant, power, slant]: Law, value: f64| {
        let relative = constant * size.powf(power) * ratio.powf(slant) / places.sqrt();
        let error = relative * value.abs();
        if error.is_finite() { error } else { 0.0 }
    };
    [error(VOLUME, value.volume), error(AREA, value.area)]
}
