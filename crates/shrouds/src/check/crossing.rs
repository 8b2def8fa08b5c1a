//! Where triangles meet the lines and points of the lattice, in units of the index.

use crate::check::predicates::area_vector;
use crate::check::predicates::{COORDINATE_LIMIT, Corners};
use crate::check::predicates::{side_of_line_shifted, side_of_plane};
use crate::check::structure::corners;
use crate::error::Error;
use crate::grid::Grid;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::volume::Border;

/// A lattice point this close to the mesh, in units of the index, touches it and has no side.
pub const TOUCH: f64 = 1e-4;
/// Triangles per block of parallel work.
const BLOCK: usize = 1 << 13;

/// A change of the winding number at a lattice point: its position, doubled, plus 1 where it rises.
pub(crate) type Change = u64;

/// By how much the winding number changes.
pub(crate) fn step(change: Change) -> i64 {
    if change & 1 == 1 { 1 } else { -1 }
}

/// The mesh with its vertices, each once, in units of the index, and its winding as seen there.
/// With an open border vertices that touch an outermost plane are put onto it, so that rounding
/// leaves no gap between them and the lines in that plane.
pub(crate) fn in_index_coordinates(
    mesh: &TriMesh,
    grid: &Grid,
    border: Border,
) -> Result<TriMesh, Error> {
    let inverse = grid.inverse_affine();
    let last = grid.dims().map(|n| (n - 1) as f64);
    let mut vertices = vec![[0.0; 3]; mesh.vertices.len()];
    parallel::fill(&mut vertices, |v| {
        let p = mesh.vertices[v];
        let index = inverse.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3]);
        match border {
            Border::Closed => index,
            Border::Open => std::array::from_fn(|d| {
                let plane = if 2.0 * index[d] < last[d] { 0.0 } else { last[d] };
                if (index[d] - plane).abs() <= TOUCH { plane } else { index[d] }
            }),
        }
    });
    let unusable = |index: &[f64; 3]| !index.iter().all(|x| x.abs() <= COORDINATE_LIMIT);
    if let Some(v) = vertices.iter().position(unusable) {
        let index = vertices[v];
        return Err(Error::Mesh(format!("vertex {v} lies too far from the volume, at {index:?}")));
    }
    let mut triangles = mesh.triangles.clone();
    if grid.is_mirrored() {
        triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    Ok(TriMesh { vertices, triangles, normals: Vec::new() })
}

/// All changes of the winding number along lines of the lattice in the direction of `axis`, sorted.
/// A change lies at the first lattice point at or behind its crossing; crossings behind the last
/// point of a line change nothing.
///
/// Each line is shifted by an infinitely small `(ε, ε²)` along the next two axes. With an open border
/// the shift goes inwards where the line runs in the last plane, in which the mesh ends.
pub(crate) fn crossings(
    mesh: &TriMesh,
    axis: usize,
    dims: [usize; 3],
    border: Border,
) -> Vec<Change> {
    let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let mut changes = Vec::new();
        let mut push = |_: &Corners, index: [usize; 3], side: i8| {
            if index[axis] < dims[axis] {
                // Against the normal the line goes in.
                changes.push(2 * position(index, dims) + u64::from(side < 0));
            }
        };
        range.for_each(|t| cross_triangle(&corners(mesh, t), axis, dims, border, &mut push));
        changes
    });
    let mut changes = blocks.concat();
    changes.sort_unstable();
    changes
}

/// Where a triangle crosses a grid edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EdgeCrossing {
    /// Position of the low end of the edge among the lattice points, x fastest.
    pub(crate) low: u64,
    /// Distance from there, in edge lengths, 0 to 1.
    pub(crate) along: f64,
    /// 1 where the edge leaves through the triangle, along its normal, and -1 where it enters.
    pub(crate) side: i8,
}

/// All crossings of the mesh with the grid edges along `axis`, sorted along the edges.
pub(crate) fn edge_crossings(mesh: &TriMesh, axis: usize, dims: [usize; 3]) -> Vec<EdgeCrossing> {
    let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let mut found = Vec::new();
        let mut push = |triangle: &Corners, mut index: [usize; 3], side: i8| {
            if (1..dims[axis]).contains(&index[axis]) {
                index[axis] -= 1;
                let along = (height(triangle, axis, index) - index[axis] as f64).clamp(0.0, 1.0);
                found.push(EdgeCrossing { low: position(index, dims), along, side });
            }
        };
        range.for_each(|t| {
            cross_triangle(&corners(mesh, t), axis, dims, Border::Closed, &mut push);
        });
        found
    });
    let mut found = blocks.concat();
    found.sort_by(|a, b| a.low.cmp(&b.low).then(a.along.total_cmp(&b.along)));
    found
}

/// Where the line through `point` along `axis` meets the plane of a triangle.
fn height(triangle: &Corners, axis: usize, point: [usize; 3]) -> f64 {
    let normal = area_vector(triangle);
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let aside = |d: usize| normal[d] * (point[d] as f64 - triangle[0][d]);
    triangle[0][axis] - (aside(u) + aside(v)) / normal[axis]
}

pub(super) fn position([i, j, k]: [usize; 3], dims: [usize; 3]) -> u64 {
    (k as u64 * dims[1] as u64 + j as u64) * dims[0] as u64 + i as u64
}

/// Visits the first lattice point at or behind each crossing of a line, and which way it passes.
fn cross_triangle(
    triangle: &Corners,
    axis: usize,
    dims: [usize; 3],
    border: Border,
    visit: &mut impl FnMut(&Corners, [usize; 3], i8),
) {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let flat = triangle.map(|p| [p[u], p[v]]);
    let limits = [dims[u], dims[v]];
    for_points_near(flat, 0.0, limits, |line| {
        let inwards = |d: usize| border == Border::Open && line[d] > 0 && line[d] + 1 == limits[d];
        let shift = [0, 1].map(|d| if inwards(d) { -1.0 } else { 1.0 });
        let side = passes_through(flat, line, shift);
        if side == 0 {
            return;
        }
        let behind = |along: usize| {
            let mut point = [along as f64; 3];
            (point[u], point[v]) = (line[0] as f64, line[1] as f64);
            side_of_plane(triangle, point) * side >= 0
        };
        let mut index = [0; 3];
        index[axis] = first_behind(triangle.map(|p| p[axis]), dims[axis], behind);
        (index[u], index[v]) = (line[0], line[1]);
        visit(triangle, index, side);
    });
}

/// `+1` when the line passes through the triangle along its normal, `-1` against it, `0` when it
/// misses.
fn passes_through(flat: [[f64; 2]; 3], line: [usize; 2], shift: [f64; 2]) -> i8 {
    let line = line.map(|x| x as f64);
    let [a, b, c] = flat;
    let side = side_of_line_shifted(a, b, line, shift);
    let same = |from, to| side_of_line_shifted(from, to, line, shift) == side;
    if side != 0 && same(b, c) && same(c, a) { side } else { 0 }
}

/// The first of the `count` lattice points along a line at or behind its crossing with a triangle
/// that has these coordinates along it, or `count` when there is none.
fn first_behind(along: [f64; 3], count: usize, behind: impl Fn(usize) -> bool) -> usize {
    let [a, b, c] = along;
    let whole = |x: f64| x.ceil().clamp(0.0, count as f64) as usize;
    let (mut low, mut high) = (whole(a.min(b).min(c)), whole(a.max(b).max(c)));
    while low < high {
        let middle = low + (high - low) / 2;
        if behind(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// Calls `visit` with the whole points `[u, v]` in `0..limits` that may lie within `margin` of the
/// flat triangle; a few more may be visited, none is left out.
pub(super) fn for_points_near(
    flat: [[f64; 2]; 3],
    margin: f64,
    limits: [usize; 2],
    mut visit: impl FnMut([usize; 2]),
) {
    let whole = |low: f64, high: f64, limit: usize| {
        let (low, high) = ((low - margin).ceil().max(0.0), (high + margin).floor());
        // Casts saturate, and a range that ends before it starts is empty.
        low as usize..(high + 1.0).min(limit as f64).max(0.0) as usize
    };
    let span = |d: usize| {
        let [a, b, c] = flat.map(|p| p[d]);
        (a.min(b).min(c), a.max(b).max(c))
    };
    let (low, high) = span(1);
    let (left, right) = span(0);
    let rows = whole(low, high, limits[1]);
    let few = right - left < 4.0;
    for v in rows {
        let (left, right) = if few { (left, right) } else { slab(flat, v as f64, margin) };
        whole(left, right, limits[0]).for_each(|u| visit([u, v]));
    }
}

/// Extent along the first axis of the part of the triangle within `margin` of the line `y` on the
/// second, and a little more.
fn slab(flat: [[f64; 2]; 3], y: f64, margin: f64) -> (f64, f64) {
    let margin = margin + 1e-6;
    let mut span = (f64::INFINITY, f64::NEG_INFINITY);
    for n in 0..3 {
        let ([ax, ay], [bx, by]) = (flat[n], flat[(n + 1) % 3]);
        let (low, high) = (ay.min(by), ay.max(by));
        if low > y + margin || high < y - margin {
            continue;
        }
        for level in [y - margin, y + margin] {
            let t = if ay == by { 0.0 } else { ((level - ay) / (by - ay)).clamp(0.0, 1.0) };
            let x = ax + t * (bx - ax);
            span = (span.0.min(x), span.1.max(x));
        }
        if ay == by {
            span = (span.0.min(bx), span.1.max(bx));
        }
    }
    (span.0 - margin, span.1 + margin)
}
