//! The dual mesh: a vertex per patch, a polygon per crossing.
//!
//! The four patches around a crossing lie in the four cells around its grid edge, all within that
//! edge's extent, so their polygon crosses the edge once and no other: the dual separates the
//! lattice points as strictly as the primal mesh.
//!
//! Over an ambiguous face the same two patches can meet twice. Two edges would then join the same two
//! vertices, and four triangles meet at them; so the middle of each of the face's two network
//! segments becomes a vertex of its own.

use crate::mesh::fit::{self, Fit, misfit};
use crate::mesh::{TriMesh, Triangles};
use crate::parallel;
use crate::surface::triangulation::cheapest;
use crate::surface::{LoopShape, Surface};
use crate::vector::{Vector, add, scale, subtract};

/// Marks a quadrant without a patch; none on a closed border.
const NONE: u32 = u32::MAX;

/// The quadrants around a crossing, counter-clockwise seen from the high end of its grid edge, each
/// with the slot of the network segment between it and the next.
const RING: [(usize, usize); 4] = [(0, 0), (1, 3), (3, 1), (2, 2)];

/// The middle of a network segment as a vertex of the dual, seen from one of its ends.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Middle {
    end: u32,
    slot: usize,
    vertex: u32,
}

pub(super) fn mesh(
    surface: &Surface,
    positions: &[Vector],
    network_normals: &[[f32; 3]],
    triangles: Triangles,
) -> TriMesh {
    let count = surface.patch_count();
    let mut mesh = TriMesh { vertices: vec![[0.0; 3]; count], ..TriMesh::default() };
    mesh.normals = vec![[0.0; 3]; count];
    let ends = || (0..surface.layer_count()).map(|k| surface.layer_patches(k).end as usize);
    parallel::pieces(&mut mesh.vertices, ends(), |layer, piece| {
        let mut slots = piece.iter_mut();
        surface.for_each_patch(layer, |patch, _| {
            slots.next().into_iter().for_each(|slot| *slot = mean(patch, positions));
        });
    });
    let found = parallel::pieces(&mut mesh.normals, ends(), |layer, piece| {
        let (mut slots, mut found) = (piece.iter_mut(), Vec::new());
        for_each_patch(surface, layer, |p, patch, shape| {
            slots.next().into_iter().for_each(|slot| *slot = mean_normal(patch, network_normals));
            found.extend(twins(p, patch, shape));
        });
        found
    });
    let around = patches_around(surface);
    let segments = doubled_segments(found.concat(), &around);
    let mut middles = Vec::with_capacity(2 * segments.len());
    for segment in segments {
        let vertex = mesh.vertices.len() as u32;
        let ends = segment.map(|(end, _)| end);
        mesh.vertices.push(mean(&ends, positions));
        mesh.normals.push(mean_normal(&ends, network_normals));
        middles.extend(segment.map(|(end, slot)| Middle { end, slot, vertex }));
    }
    middles.sort_unstable();
    mesh.triangles =
        polygons(surface, &mesh.vertices, &around, &middles, network_normals, triangles);
    mesh
}

fn mean(of: &[u32], positions: &[Vector]) -> Vector {
    let sum = of.iter().fold([0.0; 3], |sum, &v| add(sum, positions[v as usize]));
    scale(sum, 1.0 / of.len() as f64)
}

fn mean_normal(of: &[u32], normals: &[[f32; 3]]) -> [f32; 3] {
    let sum = of.iter().fold([0.0; 3], |sum: [f32; 3], &v| {
        let normal = normals[v as usize];
        std::array::from_fn(|k| sum[k] + normal[k])
    });
    let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    if length > 0.0 { sum.map(|x| x / length) } else { sum }
}

/// The patch in each quadrant around every crossing.
fn patches_around(surface: &Surface) -> Vec<[u32; 4]> {
    let slices = surface.slice_count();
    let start = |k: usize| match k < slices {
        true => surface.slice_vertices(k).start as usize,
        false => surface.vertex_count(),
    };
    let mut around = vec![[NONE; 4]; surface.vertex_count()];
    // Layers with one between them share no slice.
    for odd in [0, 1] {
        let ends = (0..=slices / 2).map(|pair| start(2 * pair + 2 - odd));
        parallel::pieces(&mut around, ends, |pair, piece| {
            let Some(layer) = (2 * pair).checked_sub(odd) else { return };
            if layer >= surface.layer_count() {
                return;
            }
            let first = surface.slice_vertices(layer).start;
            for_each_patch(surface, layer, |p, patch, shape| {
                for (n, &v) in patch.iter().enumerate() {
                    piece[(v - first) as usize][shape.quadrant(n)] = p;
                }
            });
        });
    }
    around
}

/// Calls `f` with the number, the vertices and the shape of every patch of a layer.
fn for_each_patch(surface: &Surface, layer: usize, mut f: impl FnMut(u32, &[u32], &LoopShape)) {
    let mut number = surface.layer_patches(layer).start;
    surface.for_each_patch(layer, |patch, shape| {
        f(number, patch, shape);
        number += 1;
    });
}

/// A network segment as both ends with the slots they have each other in.
type Segment = [(u32, usize); 2];

/// A patch and two of its segments on the same cell face, each with the quadrant of its first end that
/// lies beyond the face.
type Twins = (u32, [(Segment, usize); 2]);

/// The segments of a patch that share a cell face.
fn twins<'p>(p: u32, patch: &'p [u32], shape: &'p LoopShape) -> impl Iterator<Item = Twins> + 'p {
    shape.twins().iter().map(move |twins| {
        let segments = twins.map(|n| {
            let n = usize::from(n);
            let slots = shape.slots(n);
            // The face of slot 2·c + side is crossed along the axis of quadrant bit c.
            let beyond = shape.quadrant(n) ^ (1 << (slots[0] / 2));
            ([(patch[n], slots[0]), (patch[(n + 1) % patch.len()], slots[1])], beyond)
        });
        (p, segments)
    })
}

/// Those of the segments across which two patches meet twice.
fn doubled_segments(twins: Vec<Twins>, around: &[[u32; 4]]) -> Vec<Segment> {
    let mut doubled = Vec::new();
    for (p, [first, second]) in twins {
        let [one, other] =
            [&first, &second].map(|(ends, beyond)| around[ends[0].0 as usize][*beyond]);
        // Both patches see the face; the one with the smaller number makes the vertices.
        if one == other && one != NONE && one > p {
            doubled.extend([first.0, second.0]);
        }
    }
    doubled
}

/// The triangles of the polygons around all crossings.
fn polygons(
    surface: &Surface,
    vertices: &[Vector],
    around: &[[u32; 4]],
    middles: &[Middle],
    network_normals: &[[f32; 3]],
    triangles: Triangles,
) -> Vec<[u32; 3]> {
    // A polygon has two triangles, and one more for every middle at its crossing.
    let middles_before = |v: u32| middles.partition_point(|middle| middle.end < v);
    let end = |k| {
        let v = surface.slice_vertices(k).end;
        2 * v as usize + middles_before(v)
    };
    let frame = Frame::new(surface, vertices);
    let slices = 0..surface.slice_count();
    let mut all = vec![[0; 3]; slices.clone().last().map_or(0, end)];
    parallel::pieces(&mut all, slices.map(end), |slice, piece| {
        let first = surface.slice_vertices(slice).start;
        let mut middles = &middles[middles_before(first)..];
        let (mut fit, mut at) = (Fit::default(), 0);
        for (v, crossing) in (first..).zip(surface.slice_crossings(slice)) {
            let own = middles.iter().take_while(|middle| middle.end == v).count();
            let (patches, ends) = (around[v as usize], &middles[..own]);
            middles = &middles[own..];
            let normal = network_normals[v as usize];
            if own > 0 {
                let polygon = Polygon::new(patches, ends, crossing.inside_low());
                let vertices = polygon.corners.map(|(vertex, _)| vertex);
                let placed = Placed::new(&frame, &vertices[..polygon.count], normal);
                polygon.cut(&placed, triangles, &mut piece[at..]);
                at += polygon.count - 2;
                continue;
            }
            let four = RING.map(|(quadrant, _)| patches[quadrant]);
            let [a, b, c, d] =
                if crossing.inside_low() { four } else { [four[3], four[2], four[1], four[0]] };
            match triangles {
                Triangles::Fixed => piece[at..at + 2].copy_from_slice(&[[a, b, d], [b, c, d]]),
                Triangles::Fitted => {
                    fit.push(&Placed::new(&frame, &[a, b, c, d], normal), at, piece);
                }
            }
            at += 2;
        }
        fit.finish(piece);
    });
    all
}

/// The polygon around a crossing: vertices of the dual, and whether each is a middle.
struct Polygon {
    corners: [(u32, bool); 8],
    count: usize,
}

impl Polygon {
    /// The polygon seen from the high end of the grid edge, or from the low one.
    fn new(patches: [u32; 4], middles: &[Middle], from_high: bool) -> Self {
        let mut polygon = Self { corners: [(NONE, false); 8], count: 0 };
        let mut push = |corner| {
            polygon.corners[polygon.count] = corner;
            polygon.count += 1;
        };
        for (quadrant, slot) in RING {
            push((patches[quadrant], false));
            let middle = middles.iter().find(|middle| middle.slot == slot);
            middle.into_iter().for_each(|middle| push((middle.vertex, true)));
        }
        if !from_high {
            polygon.corners[..polygon.count].reverse();
        }
        polygon
    }

    /// Cuts the polygon by its legal diagonals.
    fn cut(&self, placed: &Placed, triangles: Triangles, out: &mut [[u32; 3]]) {
        let cost = |i, k, j| match triangles {
            Triangles::Fixed => 0.0,
            Triangles::Fitted => {
                let [a, b, c] = [i, k, j].map(|n| fit::Polygon::corner(placed, n).0);
                let side = |p: [f32; 3]| std::array::from_fn(|k| p[k] - a[k]);
                misfit(side(b), side(c), placed.normal)
            }
        };
        let mut local = Vec::new();
        cheapest(self.count, |i, j| self.is_legal(i, j), cost, &mut local);
        for (slot, triangle) in out.iter_mut().zip(local) {
            *slot = triangle.map(|corner| self.corners[usize::from(corner)].0);
        }
    }

    /// Whether the diagonal `i`–`j` may be used: it must not run between the two neighbours of a
    /// middle, as the edge does that the middle is there to replace.
    fn is_legal(&self, i: usize, j: usize) -> bool {
        let cuts_off =
            |a: usize, b: usize| (a + 2) % self.count == b && self.corners[(a + 1) % self.count].1;
        !(cuts_off(i, j) || cuts_off(j, i))
    }
}

/// Where the vertices of the dual are.
struct Frame<'a> {
    vertices: &'a [Vector],
    /// World lengths in units of the smallest spacing.
    unit: f64,
    /// −1 where mirrored axes turn the polygons clockwise in the world.
    sign: f32,
}

impl<'a> Frame<'a> {
    fn new(surface: &Surface, vertices: &'a [Vector]) -> Self {
        let sign = if surface.grid().is_mirrored() { -1.0 } else { 1.0 };
        Self { vertices, unit: surface.grid().min_spacing().recip(), sign }
    }
}

/// A polygon with its places relative to its first corner.
struct Placed<'a> {
    vertices: &'a [u32],
    frame: &'a Frame<'a>,
    origin: Vector,
    normal: [f32; 3],
}

impl<'a> Placed<'a> {
    #[inline]
    fn new(frame: &'a Frame, vertices: &'a [u32], normal: [f32; 3]) -> Self {
        let origin = frame.vertices[vertices[0] as usize];
        Self { vertices, frame, origin, normal: normal.map(|x| frame.sign * x) }
    }
}

impl fit::Polygon for Placed<'_> {
    #[inline(always)]
    fn vertices(&self) -> &[u32] {
        self.vertices
    }

    #[inline(always)]
    fn corner(&self, n: usize) -> ([f32; 3], [f32; 3]) {
        let place = subtract(self.frame.vertices[self.vertices[n] as usize], self.origin);
        (place.map(|x| (self.frame.unit * x) as f32), self.normal)
    }
}
