//! The dual mesh: a vertex per patch, a polygon per crossing.
//!
//! The four patches around a crossing lie in the four cells around its grid edge, all within that
//! edge's extent, so their polygon crosses the edge once and no other: the dual separates the
//! lattice points as strictly as the primal mesh.
//!
//! Over an ambiguous face the same two patches can meet twice. Two edges would then join the same two
//! vertices, and four triangles meet at them; so the middle of each of the face's two network
//! segments becomes a vertex of its own.

use crate::mesh::{TriMesh, Triangles, misfit};
use crate::network::Network;
use crate::surface::triangulation::cheapest;
use crate::surface::{LoopShape, Surface};
use crate::vector::{Vector, add, scale, unit};

/// Marks a quadrant without a patch; none on a closed border.
const NONE: u32 = u32::MAX;

/// The quadrants around a crossing, counter-clockwise seen from the high end of its grid edge, each
/// with the slot of the network segment between it and the next.
const RING: [(usize, usize); 4] = [(0, 0), (1, 3), (3, 1), (2, 2)];

pub(super) fn mesh(
    surface: &Surface,
    network: &Network,
    positions: &[Vector],
    network_normals: &[Vector],
    triangles: Triangles,
) -> TriMesh {
    let mut mesh = TriMesh::default();
    for_each_patch(surface, |_, patch, _| push_mean(&mut mesh, patch, positions, network_normals));
    let around = patches_around(surface);
    let middles = insert_middles(surface, network, &around, &mut mesh, positions, network_normals);
    let mirror = if surface.grid().is_mirrored() { -1.0 } else { 1.0 };
    let (mut polygon, mut local) = (Vec::new(), Vec::new());
    for (v, crossing) in surface.crossings().enumerate() {
        if around[v].contains(&NONE) {
            continue;
        }
        polygon.clear();
        for (quadrant, slot) in RING {
            polygon.push((around[v][quadrant], false));
            let found = middles.binary_search_by_key(&(v as u32, slot), |m| (m.0, m.1));
            polygon.extend(found.ok().map(|n| (middles[n].2, true)));
        }
        if !crossing.inside_low() {
            polygon.reverse();
        }
        let corner = |i: usize| mesh.vertices[polygon[i].0 as usize];
        let direction = scale(network_normals[v], mirror);
        local.clear();
        let legal = |i, j| !cuts_off_a_middle(&polygon, i, j);
        match triangles {
            Triangles::Fixed => cheapest(polygon.len(), legal, |_, _, _| 0, &mut local),
            Triangles::Fitted => cheapest(
                polygon.len(),
                legal,
                |i, k, j| misfit([corner(i), corner(k), corner(j)], direction),
                &mut local,
            ),
        };
        mesh.triangles.extend(local.iter().map(|t| t.map(|c| polygon[usize::from(c)].0)));
    }
    mesh
}

/// Adds the mean of some vertices of the surface as a vertex of the dual.
fn push_mean(mesh: &mut TriMesh, of: &[u32], positions: &[Vector], normals: &[Vector]) {
    let sum = |values: &[Vector]| of.iter().fold([0.0; 3], |sum, &v| add(sum, values[v as usize]));
    mesh.vertices.push(scale(sum(positions), 1.0 / of.len() as f64));
    mesh.normals.push(unit(sum(normals)));
}

/// Calls `f` with the number, the vertices and the shape of every patch.
fn for_each_patch(surface: &Surface, mut f: impl FnMut(u32, &[u32], &LoopShape)) {
    for layer in 0..surface.layer_count() {
        let mut number = surface.layer_patches(layer).start;
        surface.for_each_patch(layer, |patch, shape| {
            f(number, patch, shape);
            number += 1;
        });
    }
}

/// The patch in each quadrant around every crossing.
fn patches_around(surface: &Surface) -> Vec<[u32; 4]> {
    let mut around = vec![[NONE; 4]; surface.vertex_count()];
    for_each_patch(surface, |p, patch, shape| {
        for (n, &v) in patch.iter().enumerate() {
            around[v as usize][shape.quadrant(n)] = p;
        }
    });
    around
}

/// Finds the segments across which two patches meet twice and makes their middles vertices.
/// Returns `(vertex, slot, middle)` for both ends of each, sorted.
fn insert_middles(
    surface: &Surface,
    network: &Network,
    around: &[[u32; 4]],
    mesh: &mut TriMesh,
    positions: &[Vector],
    normals: &[Vector],
) -> Vec<(u32, usize, u32)> {
    let mut middles = Vec::new();
    for_each_patch(surface, |p, patch, shape| {
        for twins in shape.twins() {
            let [first, second] = twins.map(|n| {
                let n = usize::from(n);
                let (from, to) = (patch[n], patch[(n + 1) % patch.len()]);
                let slot = (0..4).find(|&s| network.neighbour(from, s).map(|n| n.0) == Some(to));
                // The face of slot 2·c + side is crossed along the axis of quadrant bit c.
                let slot = slot.unwrap_or(0);
                let beyond = around[from as usize][shape.quadrant(n) ^ (1 << (slot / 2))];
                (from, to, slot, beyond)
            });
            // Both patches see the face; the one with the smaller number makes the vertices.
            if first.3 != second.3 || first.3 == NONE || first.3 < p {
                continue;
            }
            for (from, to, slot, _) in [first, second] {
                let middle = mesh.vertices.len() as u32;
                push_mean(mesh, &[from, to], positions, normals);
                let back = network.neighbour(from, slot).map_or(0, |(_, l)| l.back_slot(slot));
                middles.extend([(from, slot, middle), (to, back, middle)]);
            }
        }
    });
    middles.sort_unstable();
    middles
}

/// Whether the diagonal `i`–`j` runs between the two neighbours of an inserted middle: the edge that
/// the middle is there to replace.
fn cuts_off_a_middle(polygon: &[(u32, bool)], i: usize, j: usize) -> bool {
    let count = polygon.len();
    [(i, j), (j, i)].iter().any(|&(a, b)| (a + 2) % count == b && polygon[(a + 1) % count].1)
}
