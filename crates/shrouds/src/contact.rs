//! Where two bodies of one lattice touch: how large the face between them is.
//!
//! The shroud of one body alone rounds the rim of that face, where it bends away from the other body, by
//! up to a voxel; counted by its vertices, the face of a ball of radius 10 that a plane cuts would be
//! several percent off. So the face is taken from two surfaces that both are smooth at the rim:
//!
//! - the *sheet* between the two bodies, continued beyond them: every lattice point outside both joins
//!   the body that is nearer to it;
//! - the shroud of both bodies together, which passes over the rim as if there were no face.
//!
//! The face is the part of the sheet within that shroud. What stands inside for the sheet is always the
//! body that comes first in the lattice, so the two bodies may be given in either order.

use crate::error::Error;
use crate::grid::Grid;
use crate::measure::area_within;
use crate::mesh::MeshKind;
use crate::optimize::VolumeRule;
use crate::pipeline::shroud;
use crate::settings::Settings;
use crate::volume::{Border, Occupancy};

/// Lattice points around the face that the work is done on: more than the reach of the solver's stars
/// and of `REACH` together.
const MARGIN: usize = 6;
/// How far from both bodies the sheet is continued, in lattice points along each axis: the last of them
/// bends, and must not bend the sheet within the bodies.
const REACH: isize = 4;
/// Nearness, the inverse square of the distance, counts by this power: the nearest points decide, further
/// ones break ties.
const POWER: i32 = 4;
/// What is added to the squares of the least squares, relative to them.
const RIDGE: f64 = 1e-6;

/// The area of the face between two bodies that have no lattice point in common, in squared world units;
/// 0 where no grid edge joins them.
///
/// `settings` are those of the shrouds; mesh kind, border and volume rule have no meaning here.
///
/// ```
/// use shrouds::{Grid, Occupancy, Settings, contact::contact_area};
///
/// // A ball of radius 10, cut through the middle by a tilted plane.
/// let half = |side: f64| {
///     Occupancy::from_fn(Grid::new([24; 3], [1.0; 3]).unwrap(), move |point| {
///         let [x, y, z] = point.map(|i| i as f64 - 11.4);
///         x * x + y * y + z * z <= 100.0 && (x + 0.5 * y - 0.2 * z) * side > 0.0
///     })
/// };
/// let area = contact_area(&half(1.0), &half(-1.0), &Settings::default())?;
/// assert!((area / (100.0 * std::f64::consts::PI) - 1.0).abs() < 0.02);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::DifferentLattices`] unless both bodies have the same one; those of [`shroud`].
pub fn contact_area(one: &Occupancy, other: &Occupancy, settings: &Settings) -> Result<f64, Error> {
    one.grid().check_same_lattice(other.grid())?;
    let Some(face) = face(one, other) else { return Ok(0.0) };
    let window = face.map(|[first, last]| first..last + 2 * MARGIN + 1);
    let around = |body: &Occupancy| body.padded(MARGIN)?.crop(window.clone());
    let (mut inner, mut outer) = (around(one)?, around(other)?);
    if first_point(&outer) < first_point(&inner) {
        std::mem::swap(&mut inner, &mut outer);
    }
    let mut settings = settings.clone();
    settings.mesh = MeshKind::Primal;
    settings.optimize.volume = VolumeRule::Free;
    settings.border = Border::Open;
    let sheet = shroud(&continued(&inner, &outer)?, &settings)?.mesh;
    settings.border = Border::Closed;
    inner.unite(&outer);
    let both = shroud(&inner, &settings)?.mesh;
    area_within(&sheet, &both)
}

/// First and last index along each axis of the points that a grid edge joins to the other body.
fn face(one: &Occupancy, other: &Occupancy) -> Option<[[usize; 2]; 3]> {
    let (a, b) = (one.bounding_box()?, other.bounding_box()?);
    let dims = one.grid().dims();
    // Where the lower ends of such edges can be.
    let [x, y, z]: [_; 3] = std::array::from_fn(|d| {
        a[d].start.max(b[d].start).saturating_sub(1)..a[d].end.min(b[d].end)
    });
    let points = z.flat_map(|k| {
        let (x, y) = (&x, &y);
        y.clone().flat_map(move |j| x.clone().map(move |i| [i, j, k]))
    });
    let mut found: Option<[[usize; 2]; 3]> = None;
    for low in points {
        for axis in (0..3).filter(|&axis| low[axis] + 1 < dims[axis]) {
            let mut high = low;
            high[axis] += 1;
            if one.get(low) && other.get(high) || other.get(low) && one.get(high) {
                let known = found.unwrap_or_else(|| low.map(|i| [i, i]));
                let wider = |d: usize| [known[d][0].min(low[d]), known[d][1].max(high[d])];
                found = Some([0, 1, 2].map(wider));
            }
        }
    }
    found
}

/// The place of the first inside point in the order x, y, z.
fn first_point(body: &Occupancy) -> Option<[usize; 3]> {
    let [nx, ny, nz] = body.grid().dims();
    let mut rows = (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k)));
    let (j, k) = rows.find(|&(j, k)| body.row(j, k).iter().any(|bits| *bits != 0))?;
    (0..nx).find(|&i| body.get([i, j, k])).map(|i| [k, j, i])
}

/// The inner body with those lattice points outside both that lie on its side of the face.
///
/// Near the face that is the side of a plane: the zeros of the linear function that comes nearest, in the
/// sense of least squares, to 1 at the inner and −1 at the outer lattice points along the face, near ones
/// counting more. Elsewhere it is the side of the body that is near, and far from both the outer one.
fn continued(inner: &Occupancy, outer: &Occupancy) -> Result<Occupancy, Error> {
    let steps = Steps::new(inner.grid());
    let along = along_face(inner, outer);
    let near_face = grown(&along)?;
    let [near_inner, near_outer] = [grown(inner)?, grown(outer)?];
    Ok(Occupancy::from_fn(inner.grid().clone(), |point| {
        if inner.get(point) || outer.get(point) {
            return inner.get(point);
        }
        if !near_face.get(point) {
            return near_inner.get(point) && !near_outer.get(point);
        }
        let mut fit = Fit::default();
        let mut lean = 0.0;
        for (at, way, nearness) in steps.around(point) {
            let side = f64::from(inner.get(at)) - f64::from(outer.get(at));
            lean += side * nearness.powi(POWER);
            if along.get(at) {
                fit.add(way, side, nearness);
            }
        }
        fit.value().unwrap_or(lean) > 0.0
    }))
}

/// All lattice points within the reach of a body, in steps whatever the spacing.
fn grown(body: &Occupancy) -> Result<Occupancy, Error> {
    let grid = Grid::new(body.grid().dims(), [1.0; 3])?;
    body.clone().with_grid(grid)?.offset(REACH as f64, Border::Closed)
}

/// The lattice points of either body that are neighbours of the other, diagonal ones too.
fn along_face(inner: &Occupancy, outer: &Occupancy) -> Occupancy {
    let dims = inner.grid().dims();
    Occupancy::from_fn(inner.grid().clone(), |point| {
        let other = match (inner.get(point), outer.get(point)) {
            (true, _) => outer,
            (_, true) => inner,
            _ => return false,
        };
        let [x, y, z]: [_; 3] =
            std::array::from_fn(|d| point[d].saturating_sub(1)..(point[d] + 2).min(dims[d]));
        z.into_iter().any(|k| y.clone().any(|j| x.clone().any(|i| other.get([i, j, k]))))
    })
}

/// The steps to the lattice points around one, with the ways in the world, shortest spacing 1, and the
/// inverse squares of their lengths.
struct Steps {
    dims: [usize; 3],
    all: Vec<([isize; 3], [f64; 3], f64)>,
}

impl Steps {
    fn new(grid: &Grid) -> Self {
        let side = || -REACH..=REACH;
        let steps = side().flat_map(|k| side().flat_map(move |j| side().map(move |i| [i, j, k])));
        let all = steps.filter(|step| *step != [0; 3]).map(|step| {
            let way = grid.vector(step.map(|n| n as f64)).map(|x| x / grid.min_spacing());
            (step, way, way.iter().map(|x| x * x).sum::<f64>().recip())
        });
        Self { dims: grid.dims(), all: all.collect() }
    }

    /// The lattice points around one.
    fn around(&self, point: [usize; 3]) -> impl Iterator<Item = ([usize; 3], [f64; 3], f64)> {
        self.all.iter().filter_map(move |&(step, way, nearness)| {
            let at: [isize; 3] = std::array::from_fn(|d| point[d] as isize + step[d]);
            let is_there = (0..3).all(|d| (0..self.dims[d] as isize).contains(&at[d]));
            is_there.then(|| (at.map(|x| x as usize), way, nearness))
        })
    }
}

/// Normal equations for a linear function of the way from a place.
#[derive(Default)]
struct Fit {
    matrix: [[f64; 4]; 4],
    right: [f64; 4],
    /// Sums of weights at values above and below 0.
    sides: [f64; 2],
}

impl Fit {
    fn add(&mut self, way: [f64; 3], value: f64, weight: f64) {
        let terms = [1.0, way[0], way[1], way[2]];
        for (row, term) in self.matrix.iter_mut().zip(terms) {
            *row = std::array::from_fn(|k| row[k] + weight * term * terms[k]);
        }
        self.right = std::array::from_fn(|k| self.right[k] + weight * terms[k] * value);
        self.sides[usize::from(value < 0.0)] += weight;
    }

    /// What the function is at the place itself; nothing unless there were values on both sides.
    fn value(mut self) -> Option<f64> {
        if self.sides.contains(&0.0) {
            return None;
        }
        // So that values along a line or in a plane have a solution too: that with the least slope.
        for k in 0..4 {
            self.matrix[k][k] *= 1.0 + RIDGE;
        }
        // Gauss from the last unknown on; the first stays.
        for pivot in (1..4).rev() {
            let (row, right) = (self.matrix[pivot], self.right[pivot]);
            for n in 0..pivot {
                let factor = self.matrix[n][pivot] / row[pivot];
                self.matrix[n] = std::array::from_fn(|k| self.matrix[n][k] - factor * row[k]);
                self.right[n] -= factor * right;
            }
        }
        let value = self.right[0] / self.matrix[0][0];
        value.is_finite().then_some(value)
    }
}
