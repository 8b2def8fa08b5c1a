//! Normals from the network's tangents.

use crate::network::Network;
use crate::parallel;
use crate::surface::{Crossing, Surface};
use crate::vector::{Vector, subtract};

/// Vertices whose arithmetic goes side by side.
const LANES: usize = 8;

/// One vector for each lane, by component.
type Vectors = [[f64; LANES]; 3];

/// Unit normal of the surface at every vertex, pointing outside: the cross product of the tangents
/// of its two planar curves, each that of the circle through three vertices.
///
/// `vertices` are the world positions of the surface's vertices. On smooth shapes these normals are
/// several times closer to the true ones than those of the triangles.
///
/// # Panics
/// When there is not one position per vertex.
pub fn network_normals(
    surface: &Surface,
    network: &Network,
    vertices: &[[f64; 3]],
) -> Vec<[f32; 3]> {
    assert_eq!(vertices.len(), surface.vertex_count(), "one position per vertex");
    let mirrored = surface.grid().is_mirrored();
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let curves = Curves { network, vertices, axes: axes.map(|axis| surface.grid().vector(axis)) };
    let mut normals = vec![[0.0; 3]; vertices.len()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut normals, ends, |k, piece| {
        let mut crossings = surface.slice_crossings(k);
        let mut v = surface.slice_vertices(k).start;
        for slots in piece.chunks_mut(LANES) {
            let mut chords = [[[[0.0; LANES]; 3]; 2]; 2];
            let mut sign = [1.0; LANES];
            for (lane, crossing) in crossings.by_ref().take(slots.len()).enumerate() {
                curves.read_chords(v, crossing, lane, &mut chords);
                // Curve 0 runs across on axis d + 2, curve 1 on axis d + 1: b × a points along +d.
                let outside_is_high = crossing.inside_low();
                sign[lane] = if outside_is_high != mirrored { 1.0 } else { -1.0 };
                v += 1;
            }
            let [a, b] = chords.each_ref().map(|[before, after]| tangents(before, after));
            let found = unit_crosses(&b, &a, &sign);
            for (lane, slot) in slots.iter_mut().enumerate() {
                *slot = [found[0][lane], found[1][lane], found[2][lane]];
            }
        }
    });
    normals
}

/// The planar curves with the places of their vertices.
struct Curves<'a> {
    network: &'a Network,
    vertices: &'a [Vector],
    /// World vectors of a step along each axis of the grid.
    axes: [Vector; 3],
}

impl Curves<'_> {
    /// Reads the chords before and after vertex `v` on both of its curves into a lane.
    #[inline]
    fn read_chords(&self, v: u32, crossing: Crossing, lane: usize, chords: &mut [[Vectors; 2]; 2]) {
        let here = self.vertices[v as usize];
        for (c, chords) in chords.iter_mut().enumerate() {
            let other =
                |slot| self.network.neighbour(v, slot).map(|(u, _)| self.vertices[u as usize]);
            let (before, after) = match (other(2 * c), other(2 * c + 1)) {
                (Some(p), Some(q)) => (subtract(here, p), subtract(q, here)),
                (Some(p), None) => (subtract(here, p), subtract(here, p)),
                (None, Some(q)) => (subtract(q, here), subtract(q, here)),
                // A curve of one vertex, in the corner of an open border: straight across.
                (None, None) => {
                    let across = self.axes[(crossing.axis() + 2 - c) % 3];
                    (across, across)
                }
            };
            for k in 0..3 {
                chords[0][k][lane] = before[k];
                chords[1][k][lane] = after[k];
            }
        }
    }
}

/// Directions of curves between two chords that both point forwards: the tangents of the circles
/// through three vertices. Their lengths mean nothing.
#[inline]
fn tangents(u: &Vectors, w: &Vectors) -> Vectors {
    let mut tangents = [[0.0; LANES]; 3];
    for n in 0..LANES {
        let uu = u[0][n] * u[0][n] + u[1][n] * u[1][n] + u[2][n] * u[2][n];
        let ww = w[0][n] * w[0][n] + w[1][n] * w[1][n] + w[2][n] * w[2][n];
        for k in 0..3 {
            tangents[k][n] = u[k][n] * ww + w[k][n] * uu;
        }
    }
    tangents
}

/// Cross products with length 1, and a sign; 0 where there is no direction.
#[inline]
fn unit_crosses(a: &Vectors, b: &Vectors, sign: &[f64; LANES]) -> [[f32; LANES]; 3] {
    let mut units = [[0.0; LANES]; 3];
    for n in 0..LANES {
        let x = a[1][n] * b[2][n] - a[2][n] * b[1][n];
        let y = a[2][n] * b[0][n] - a[0][n] * b[2][n];
        let z = a[0][n] * b[1][n] - a[1][n] * b[0][n];
        let length = (x * x + y * y + z * z).sqrt();
        let factor = if length > 0.0 { sign[n] / length } else { 0.0 };
        units[0][n] = (x * factor) as f32;
        units[1][n] = (y * factor) as f32;
        units[2][n] = (z * factor) as f32;
    }
    units
}
