//! Area, volume and extent of a mesh, and its triangles with little or no area.

use std::ops::Range;

use crate::check::found::Found;
use crate::check::predicates::{area_vector, dot, is_degenerate, is_surely_proper};
use crate::check::structure::{Structure, corners};
use crate::mesh::TriMesh;
use crate::parallel;

/// Triangles per block of parallel work.
const BLOCK: usize = 1 << 14;
/// A triangle is a sliver when its area is below this part of the mean area.
const SLIVER: f64 = 1e-9;

/// What one block of triangles measures.
#[derive(Default)]
struct Measured {
    area: f64,
    volume: f64,
    /// The smallest area that is not zero.
    smallest: f64,
    degenerate: Found<u32>,
}

/// Adds area and volume to a structure, and the triangles with little or no area.
pub(super) fn measure(mesh: &TriMesh, structure: &mut Structure) {
    let count = mesh.triangles.len();
    let centre = centre(&mesh.vertices);
    let blocks = parallel::blocks(count, BLOCK, |range| measure_block(mesh, centre, range));
    structure.area = blocks.iter().map(|block| block.area).sum();
    structure.volume = blocks.iter().map(|block| block.volume).sum();
    let least = SLIVER * structure.area / count.max(1) as f64;
    let mut slivers = Found::default();
    let with_slivers = blocks.iter().enumerate().filter(|(_, block)| block.smallest < least);
    for (n, _) in with_slivers {
        for t in n * BLOCK..((n + 1) * BLOCK).min(count) {
            let area = area_vector(&corners(mesh, t));
            if 0.5 * dot(area, area).sqrt() < least && !has_no_area(mesh, t) {
                slivers.push(t as u32);
            }
        }
    }
    structure.sliver_triangles = slivers;
    structure.degenerate_triangles =
        Found::gather(blocks.into_iter().map(|block| block.degenerate));
}

fn measure_block(mesh: &TriMesh, centre: [f64; 3], range: Range<usize>) -> Measured {
    let mut measured = Measured { smallest: f64::INFINITY, ..Measured::default() };
    for t in range {
        let triangle = corners(mesh, t);
        let normal = area_vector(&triangle);
        let squared = dot(normal, normal);
        let area = 0.5 * squared.sqrt();
        let origin: [f64; 3] = std::array::from_fn(|d| triangle[0][d] - centre[d]);
        measured.area += area;
        measured.volume += dot(origin, normal) / 6.0;
        if is_surely_proper(&triangle, squared) || !has_no_area(mesh, t) {
            measured.smallest = measured.smallest.min(area);
        } else {
            measured.degenerate.push(t as u32);
        }
    }
    measured
}

fn has_no_area(mesh: &TriMesh, t: usize) -> bool {
    let [a, b, c] = mesh.triangles[t];
    a == b || b == c || c == a || is_degenerate(&corners(mesh, t))
}

/// Centre of the bounding box: volumes relative to it do not drown in a far-off origin.
fn centre(vertices: &[[f64; 3]]) -> [f64; 3] {
    let (low, high) = bounds(vertices);
    std::array::from_fn(|d| if low[d] <= high[d] { 0.5 * (low[d] + high[d]) } else { 0.0 })
}

/// Smallest and largest coordinates; infinite the wrong way round when there are no vertices.
pub(super) fn bounds(vertices: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    let blocks = parallel::blocks(vertices.len(), BLOCK, |range| {
        let points = vertices[range].iter().map(|&p| (p, p));
        points.fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), wider)
    });
    blocks.into_iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), wider)
}

fn wider(a: ([f64; 3], [f64; 3]), b: ([f64; 3], [f64; 3])) -> ([f64; 3], [f64; 3]) {
    let lower = |a: f64, b: f64| if a < b { a } else { b };
    let higher = |a: f64, b: f64| if a > b { a } else { b };
    let (low, high) = ((a.0, b.0), (a.1, b.1));
    (
        [lower(low.0[0], low.1[0]), lower(low.0[1], low.1[1]), lower(low.0[2], low.1[2])],
        [higher(high.0[0], high.1[0]), higher(high.0[1], high.1[1]), higher(high.0[2], high.1[2])],
    )
}
