//! The panels of a figure, and the states of a shroud they show.

use std::ops::ControlFlow;
use std::sync::Arc;

use shrouds::energy::{Linear, Parameter};
use shrouds::measure::{Planes, contours};
use shrouds::optimize::{self, Preset, Solver, Start};
use shrouds::{Occupancy, Settings, Shroud, TriMesh, shroud, shroud_observed};
use shrouds_view::{Camera, Cell, LineSet, Picture, Scene, Style};

use crate::failure::Failure;

const PAPER: [u8; 3] = [255; 3];
const CONTOUR: [u8; 3] = [30, 30, 40];

/// From where the panels of a figure are seen.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub(super) azimuth: f64,
    pub(super) elevation: f64,
    pub(super) zoom: f64,
    /// Pixels across and down.
    pub(super) size: [u32; 2],
}

impl Look {
    pub(super) const fn new(azimuth: f64, elevation: f64, size: [u32; 2]) -> Self {
        Self { azimuth, elevation, zoom: 1.0, size }
    }

    /// A panel with a mesh and lines on it, in the box of the volume's lattice.
    pub(super) fn panel(
        self,
        [title, note]: [String; 2],
        scene: &Scene,
        frame: Option<[[f64; 3]; 2]>,
    ) -> Result<Cell, Failure> {
        let Self { azimuth, elevation, zoom, size: [width, height] } = self;
        let camera = Camera { azimuth, elevation, zoom, frame, ..Camera::default() };
        let style = Style { width, height, margin: 0.02, background: PAPER, ..Style::default() };
        Ok(Cell { picture: Picture::draw(scene, &camera, &style)?, title, note })
    }
}

/// The panels beside each other.
pub(super) fn row(cells: &[Cell]) -> Result<Picture, Failure> {
    Ok(Picture::sheet(cells, cells.len() as u32, PAPER)?)
}

/// The panels below each other.
pub(super) fn column(cells: &[Cell]) -> Result<Picture, Failure> {
    Ok(Picture::sheet(cells, 1, PAPER)?)
}

/// The box around a mesh.
pub(super) fn reach(mesh: &TriMesh) -> Option<[[f64; 3]; 2]> {
    let first = *mesh.vertices.first()?;
    let join = |[low, high]: [[f64; 3]; 2], vertex: &[f64; 3]| {
        let pick =
            |end: [f64; 3], of: fn(f64, f64) -> f64| std::array::from_fn(|a| of(end[a], vertex[a]));
        [pick(low, f64::min), pick(high, f64::max)]
    };
    Some(mesh.vertices.iter().fold([first; 2], join))
}

/// Sections of a mesh by planes across an axis, every so many lattice steps, as lines.
pub(super) fn contour_lines(mesh: &TriMesh, axis: usize, step: f64) -> Result<LineSet, Failure> {
    let [low, high] = reach(mesh).unwrap_or_default().map(|corner| corner[axis]);
    let count = ((high - low) / step) as usize;
    let positions = (0..=count).map(|n| low + (n as f64 + 0.5) * step).collect();
    let found = contours(mesh, &Planes::across(axis, positions))?;
    let mut segments = Vec::new();
    for contour in &found {
        segments.extend(contour.points.windows(2).map(|ends| [ends[0], ends[1]]));
        if let (true, [first, .., last]) = (contour.closed, &contour.points[..]) {
            segments.push([*last, *first]);
        }
    }
    Ok(LineSet { width: 1.0, ..LineSet::new(segments, CONTOUR) })
}

/// The paper's method: sweeps with the energy of equation 7; none is the midpoint surface.
pub(super) fn swept(volume: &Occupancy, start: Start, sweeps: usize) -> Result<Shroud, Failure> {
    solve(volume, optimize::Settings { max_iterations: Some(sweeps), ..paper(start) })
}

/// The limit of the paper's sweeps, to six digits.
pub(super) fn swept_to_the_limit(volume: &Occupancy) -> Result<Shroud, Failure> {
    solve(volume, paper(Start::Midpoint))
}

/// The least energy (7) by way of Newton, which is where the sweeps end: the energy is convex.
pub(super) fn limit(volume: &Occupancy, start: Start) -> Result<Shroud, Failure> {
    let tolerance = Some(1e-6);
    let (solver, preset) = (Solver::Newton, Preset::Exact);
    solve(volume, optimize::Settings { solver, preset, tolerance, ..paper(start) })
}

/// How much the last of so many sweeps changes δ: ‖δᵏ − δᵏ⁺¹‖/‖δᵏ⁺¹‖.
pub(super) fn change_in_sweep(volume: &Occupancy, sweep: usize) -> Result<f64, Failure> {
    let mut change = f64::NAN;
    let limit = Some(sweep);
    let optimize = optimize::Settings { max_iterations: limit, ..paper(Start::Midpoint) };
    shroud_observed(volume, &Settings { optimize, ..Settings::default() }, &mut |now| {
        change = now.change;
        ControlFlow::Continue(())
    })?;
    Ok(change)
}

/// The best that the library has.
pub(super) fn exact(volume: &Occupancy) -> Result<Shroud, Failure> {
    solve(volume, optimize::Settings { preset: Preset::Exact, ..Default::default() })
}

/// The same within an interval for every δ.
pub(super) fn within(volume: &Occupancy, intervals: Arc<[[f64; 2]]>) -> Result<Shroud, Failure> {
    let (preset, intervals) = (Preset::Exact, Some(intervals));
    solve(volume, optimize::Settings { preset, intervals, ..Default::default() })
}

pub(super) fn midpoint(volume: &Occupancy) -> Result<Shroud, Failure> {
    swept(volume, Start::Midpoint, 0)
}

pub(super) fn paper(start: Start) -> optimize::Settings {
    let energy = Some(Linear { parameter: Parameter::Uniform }.into());
    optimize::Settings { energy, solver: Solver::Sweeps, start, ..Default::default() }
}

fn solve(volume: &Occupancy, optimize: optimize::Settings) -> Result<Shroud, Failure> {
    Ok(shroud(volume, &Settings { optimize, ..Settings::default() })?)
}

/// The root mean square of the difference between two places of the vertices.
pub(super) fn apart(one: &[f64], other: &[f64]) -> f64 {
    let sum: f64 = one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / one.len().max(1) as f64).sqrt()
}
