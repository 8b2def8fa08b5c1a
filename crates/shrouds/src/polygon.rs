//! Two dimensions: in an image, out its optimal separating polygons (Figure 1).
//!
//! An image is a volume of one slice along z. The grid edges that its polygons cross run along x and
//! y, and the polygons are the planar curves of that one slice: all that is said of surfaces holds
//! for them, and they come out of the same stages. Every lattice point stays on its own side.
//!
//! ```
//! use shrouds::{Grid, Occupancy, Settings, polygon};
//!
//! let grid = Grid::new([13, 13, 1], [1.0; 3])?;
//! let disc = Occupancy::from_fn(grid, |[i, j, _]| i.abs_diff(6).pow(2) + j.abs_diff(6).pow(2) < 28);
//! let found = polygon::separate(&disc, &Settings::default())?;
//! let [polygon] = &found.polygons[..] else { unreachable!("one disc") };
//! assert!(polygon.closed && (polygon.area / disc.count() as f64 - 1.0).abs() < 0.05);
//! # Ok::<(), shrouds::Error>(())
//! ```
//!
//! Uses: `grid`, `volume`, `surface`, `network`, `optimize`, the settings of the pipeline.

use std::ops::ControlFlow;

use crate::error::Error;
use crate::grid::Grid;
use crate::network::{Curve, Network};
use crate::optimize::{Observer, Report, optimize};
use crate::settings::Settings;
use crate::surface::Surface;
use crate::vector::{cross, length, subtract};
use crate::volume::Occupancy;

/// The optimal separating polygons of an image and all that led to them.
#[derive(Debug, Clone)]
pub struct Separation {
    /// Where the polygons cross the grid.
    pub surface: Surface,
    /// δ of every vertex of the surface, in `[margin, 1 − margin]`; 1 is the inside end.
    pub delta: Vec<f64>,
    /// The polygons: those that an open border ends first, each kind in the order of their smallest
    /// vertices.
    pub polygons: Vec<Polygon>,
    /// How the optimisation went.
    pub report: Report,
}

/// A polygon between inside and outside points of an image.
///
/// With x to the right and y upwards it has the inside on its left: it runs counter-clockwise around
/// inside points, and clockwise around a hole.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    /// World coordinates of its vertices, in order.
    pub points: Vec<[f64; 3]>,
    /// The same as indices `(i, j)` of the image, which are whole on lattice points.
    pub index: Vec<[f64; 2]>,
    /// δ of its vertices: 1 at the inside end of the grid edge, 0 at the outside end.
    pub delta: Vec<f64>,
    /// Which vertices of the surface they are.
    pub vertices: Vec<u32>,
    /// Whether the last vertex is joined to the first; only an open border leaves a polygon open.
    pub closed: bool,
    /// Area in squared world units, negative for a hole; 0 unless the polygon is closed. The sum over
    /// all polygons is the area inside.
    pub area: f64,
    /// Length in world units.
    pub length: f64,
}

/// The optimal separating polygons of an image.
///
/// The settings are those of a shroud; those of its mesh have no meaning here. An empty image gives no
/// polygon, with status [`Empty`](crate::optimize::Status::Empty).
///
/// # Errors
/// [`Error::NotAnImage`] when the volume has several slices along z, of which [`Occupancy::slice`] takes
/// one; otherwise those of [`Surface::of_image`] and [`optimize()`].
pub fn separate(image: &Occupancy, settings: &Settings) -> Result<Separation, Error> {
    separate_observed(image, settings, &mut |_| ControlFlow::Continue(()))
}

/// As [`separate`], telling an observer after every iteration how far it has come; the observer may
/// stop the optimisation.
///
/// # Errors
/// As [`separate`].
pub fn separate_observed(
    image: &Occupancy,
    settings: &Settings,
    observer: &mut Observer,
) -> Result<Separation, Error> {
    let surface = Surface::of_image(image, settings.faces, settings.border)?;
    let optimum = optimize(&surface, &settings.optimize, observer)?;
    let polygons = place(image, &surface, &optimum.delta);
    Ok(Separation { surface, delta: optimum.delta, polygons, report: optimum.report })
}

/// The polygons of an image whose surface is `surface`, with these δ (equation 3).
///
/// # Panics
/// When `delta` has not one value per vertex, or the surface is none of this image.
pub fn place(image: &Occupancy, surface: &Surface, delta: &[f64]) -> Vec<Polygon> {
    assert_eq!(delta.len(), surface.vertex_count(), "one delta per vertex");
    let [nx, ny, _] = image.grid().dims();
    let [wide, high, slices] = surface.grid().dims();
    let frame = (wide - nx) / 2;
    assert_eq!(
        [wide, high, slices],
        [nx + 2 * frame, ny + 2 * frame, 1],
        "a surface of this image"
    );
    let index: Vec<[f64; 2]> = surface
        .crossings()
        .zip(delta)
        .map(|(crossing, &delta)| {
            let [i, j, _] = crossing.position(delta);
            [i - frame as f64, j - frame as f64]
        })
        .collect();
    let network = Network::trace(surface);
    let curves = network.curves().filter(|curve| curve.axis == 2);
    curves.map(|curve| Polygon::new(image.grid(), curve, &index, delta)).collect()
}

impl Polygon {
    /// The polygon on one curve, from the places and δ of all vertices.
    fn new(grid: &Grid, curve: Curve, index: &[[f64; 2]], delta: &[f64]) -> Self {
        let Curve { mut vertices, closed, .. } = curve;
        // Curves have the inside on their right.
        vertices.reverse();
        let index: Vec<[f64; 2]> = vertices.iter().map(|&v| index[v as usize]).collect();
        let points: Vec<[f64; 3]> = index.iter().map(|&[i, j]| grid.point([i, j, 0.0])).collect();
        let next = |n: usize| (n + 1) % index.len();
        let segments = if closed { index.len() } else { index.len() - 1 };
        let pixel = length(cross(grid.vector([1.0, 0.0, 0.0]), grid.vector([0.0, 1.0, 0.0])));
        // About its first vertex, so that an area far from the origin keeps its digits.
        let triangle = |n: usize| {
            let [a, b] = [n, next(n)].map(|n| subtract(index[n], index[0]));
            (a[0] * b[1] - a[1] * b[0]) / 2.0
        };
        let area = if closed { pixel * (0..segments).map(triangle).sum::<f64>() } else { 0.0 };
        let chord = |n: usize| length(subtract(points[next(n)], points[n]));
        let length = (0..segments).map(chord).sum();
        let delta = vertices.iter().map(|&v| delta[v as usize]).collect();
        Self { points, index, delta, vertices, closed, area, length }
    }
}
