//! Normals from the network's tangents.

use crate::network::Network;
use crate::parallel;
use crate::surface::Surface;
use crate::vector::{Vector, cross, scale, subtract, tangent, unit};

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
) -> Vec<[f64; 3]> {
    assert_eq!(vertices.len(), surface.vertex_count(), "one position per vertex");
    let mirrored = surface.grid().is_mirrored();
    let crossings: Vec<_> = surface.crossings().collect();
    let mut normals = vec![[0.0; 3]; vertices.len()];
    parallel::fill(&mut normals, |v| {
        let [a, b] = [0, 1].map(|c| curve_tangent(surface, network, vertices, v as u32, c));
        // Curve 0 runs across on axis d + 2, curve 1 on axis d + 1: b × a points along +d.
        let outside_is_high = crossings[v].inside_low();
        let sign = if outside_is_high != mirrored { 1.0 } else { -1.0 };
        scale(unit(cross(b, a)), sign)
    });
    normals
}

fn curve_tangent(
    surface: &Surface,
    network: &Network,
    vertices: &[Vector],
    v: u32,
    c: usize,
) -> Vector {
    let here = vertices[v as usize];
    let chord = |slot| network.neighbour(v, slot).map(|(u, _)| vertices[u as usize]);
    let before = chord(2 * c).map(|p| subtract(here, p));
    let after = chord(2 * c + 1).map(|p| subtract(p, here));
    tangent(before, after).unwrap_or_else(|| {
        // A curve of one vertex, in the corner of an open border: straight across.
        let mut across = [0.0; 3];
        across[network.curve_axes(v, c).1] = 1.0;
        surface.grid().vector(across)
    })
}
