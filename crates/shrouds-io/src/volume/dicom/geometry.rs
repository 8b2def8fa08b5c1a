//! From the planes of frames to one lattice.
//!
//! A plane gives the centre of its first pixel and the directions of its rows and columns; the
//! lattice is the union of all of them, with slices evenly spaced along one line.

use std::path::Path;

use crate::error::Error;
use crate::volume::affine_of;
use crate::volume::dicom::elements::{Dataset, tag};

/// Error of a position that is tolerated, in slice spacings.
const TOLERANCE: f64 = 0.01;
/// Empty slices that a file may have for each one with a frame, and besides.
const MOST_EMPTY: (usize, usize) = (64, 1024);

/// Where the frame of an item of the per-frame functional groups lies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plane {
    /// World coordinates of the centre of the first pixel, mm.
    position: [f64; 3],
    /// Unit vectors along which the column and the row number grow.
    axes: [[f64; 3]; 2],
    /// Distance between columns, then between rows, mm.
    spacing: [f64; 2],
    /// Distance of slices that the file states, mm.
    between: Option<f64>,
    thickness: Option<f64>,
}

/// The lattice of all frames.
#[derive(Debug)]
pub(super) struct Stack {
    pub(super) affine: [[f64; 4]; 3],
    pub(super) slices: usize,
    /// The slice of each frame.
    pub(super) slice_of: Vec<usize>,
    pub(super) warnings: Vec<String>,
}

impl Plane {
    /// From the functional groups of the frame, then from the shared ones.
    pub(super) fn new(path: &Path, own: &Dataset, shared: &Dataset) -> Result<Self, Error> {
        let missing = |what: &str| Error::header(path, format!("a frame has no valid {what}"));
        let group = |tag| own.item(tag).or_else(|| shared.item(tag));
        let position = group(tag::PLANE_POSITION).and_then(|g| g.decimals(tag::POSITION));
        let position = position.ok_or_else(|| missing("position"))?;
        let axes = group(tag::PLANE_ORIENTATION).and_then(|g| g.decimals(tag::ORIENTATION));
        let [a, b, c, d, e, f] = axes.ok_or_else(|| missing("orientation"))?;
        let axes = [[a, b, c], [d, e, f]];
        let measures = group(tag::PIXEL_MEASURES).ok_or_else(|| missing("pixel measures"))?;
        // The first of the two is the distance between rows.
        let [rows, columns] =
            measures.decimals(tag::PIXEL_SPACING).ok_or_else(|| missing("pixel spacing"))?;
        let positive = |tag| measures.decimals(tag).map(|[x]| x).filter(|x| *x > 0.0);
        let square = axes.iter().all(|axis| (dot(*axis, *axis) - 1.0).abs() < 1e-2)
            && dot(axes[0], axes[1]).abs() < 1e-2;
        if !square || rows <= 0.0 || columns <= 0.0 {
            return Err(missing("orientation and pixel spacing"));
        }
        Ok(Self {
            position,
            axes,
            spacing: [columns, rows],
            between: positive(tag::SPACING_BETWEEN_SLICES),
            thickness: positive(tag::SLICE_THICKNESS),
        })
    }

    fn normal(&self) -> [f64; 3] {
        let [u, v] = self.axes;
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = dot(n, n).sqrt();
        n.map(|x| x / length)
    }

    fn is_parallel_to(&self, other: &Self) -> bool {
        let directions = self.axes.iter().flatten().zip(other.axes.iter().flatten());
        let spacings = self.spacing.iter().zip(&other.spacing);
        directions.clone().all(|(a, b)| (a - b).abs() < 1e-4)
            && spacings.clone().all(|(a, b)| (a - b).abs() < 1e-4 * b)
    }
}

/// The lattice of frames in these planes, of which there is at least one.
pub(super) fn stack(path: &Path, planes: &[Plane]) -> Result<Stack, Error> {
    let uneven = |what: String| {
        Error::unsupported(path, what, "resample it to evenly spaced parallel slices")
    };
    let first = &planes[0];
    if !planes.iter().all(|plane| plane.is_parallel_to(first)) {
        return Err(uneven("a segmentation of frames in different directions".into()));
    }
    let normal = first.normal();
    let height = |plane: &Plane| dot(plane.position, normal);
    let lowest = planes.iter().min_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(first);
    let highest = planes.iter().max_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(first);
    let heights: Vec<f64> = planes.iter().map(|plane| height(plane) - height(lowest)).collect();
    let mut warnings = Vec::new();
    let step = slice_distance(first, &heights, &mut warnings).map_err(uneven)?;
    let slice_of: Vec<usize> = heights.iter().map(|x| (x / step).round() as usize).collect();
    let last = slice_of.iter().copied().max().unwrap_or(0);
    let (factor, more) = MOST_EMPTY;
    if last >= planes.len().saturating_mul(factor).saturating_add(more) {
        let frames = planes.len();
        return Err(uneven(format!("{frames} frames in a stack of {last} slices {step} mm apart")));
    }
    // The line may be oblique to the slices, as after a gantry tilt.
    let axis = match last {
        0 => normal.map(|x| x * step),
        last => std::array::from_fn(|r| (highest.position[r] - lowest.position[r]) / last as f64),
    };
    let [columns, rows] = first.spacing;
    let limit = TOLERANCE * step.max(columns.min(rows));
    for (plane, slice) in planes.iter().zip(&slice_of) {
        let off: [f64; 3] = std::array::from_fn(|r| {
            plane.position[r] - lowest.position[r] - *slice as f64 * axis[r]
        });
        let off = dot(off, off).sqrt();
        if off > limit {
            return Err(uneven(format!(
                "a segmentation with a frame {off:.4} mm away from its place in a stack of slices \
                 {step:.4} mm apart"
            )));
        }
    }
    let [u, v] = first.axes;
    let affine = affine_of([u.map(|x| x * columns), v.map(|x| x * rows), axis], lowest.position);
    Ok(Stack { affine, slices: last + 1, slice_of, warnings })
}

/// The distance of slices with frames at these heights over the lowest; or why there is none.
fn slice_distance(
    plane: &Plane,
    heights: &[f64],
    warnings: &mut Vec<String>,
) -> Result<f64, String> {
    let mut distinct = heights.to_vec();
    distinct.sort_by(f64::total_cmp);
    let same = 1e-3 * plane.spacing[0].min(plane.spacing[1]);
    distinct.dedup_by(|a, b| *a - *b < same);
    let gaps: Vec<f64> = distinct.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let Some(smallest) = gaps.iter().copied().reduce(f64::min) else {
        let stated = plane.between.or(plane.thickness);
        if stated.is_none() {
            warnings.push("The only slice has no thickness: 1 mm is taken.".into());
        }
        return Ok(stated.unwrap_or(1.0));
    };
    let fits = |distance: f64| {
        let off = |count: f64| (count - count.round()).abs() / count.round().max(1.0);
        gaps.iter().all(|gap| off(gap / distance) < TOLERANCE)
    };
    let distance = match plane.between {
        Some(between) if fits(between) => {
            if (smallest / between).round() > 1.0 {
                warnings.push(format!(
                    "The frames lie at least {smallest} mm apart, but SpacingBetweenSlices is \
                     {between}: the slices between are taken as empty."
                ));
            }
            between
        }
        between if fits(smallest) => {
            if let Some(between) = between {
                warnings.push(format!(
                    "SpacingBetweenSlices is {between}, but the frames lie {smallest} mm apart: that \
                     is taken."
                ));
            }
            smallest
        }
        between => {
            let largest = gaps.iter().copied().fold(smallest, f64::max);
            let stated = between.map_or(String::new(), |between| format!(", said to be {between}"));
            return Err(format!(
                "a segmentation of slices from {smallest:.4} to {largest:.4} mm apart{stated}"
            ));
        }
    };
    // The positions are more precise than the distance that is stated.
    let steps: f64 = gaps.iter().map(|gap| (gap / distance).round()).sum();
    Ok(gaps.iter().sum::<f64>() / steps)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
