//! Contours: the curves in which parallel planes cut a mesh.
//!
//! Every vertex is on one side of a plane, by one number compared once; a vertex in the plane counts
//! as above it. So a plane passes through the insides of edges only, in one point each, and every
//! triangle with corners on both sides gives one segment between two of these points. Whatever the
//! numbers, segments of neighbouring triangles fit together, and the contours of a closed mesh close.
//! What such a cut has that is nothing but points at one place, where a plane touches the mesh or
//! vertices lie in it, is left out afterwards.

use crate::error::Error;
use crate::grid::Grid;
use crate::measure::planes::Planes;
use crate::mesh::TriMesh;
use crate::network::Network;
use crate::parallel;
use crate::surface::Surface;
use crate::vector::{Vector, add, cross, dot, length, subtract};

/// Triangles that one block looks at.
const BLOCK: usize = 1 << 14;
/// Points are at one place when they are nearer than this part of the largest coordinate.
const SAME_PLACE: f64 = 1e-12;
/// As for the certificate: squares of larger coordinates leave the range of the numbers.
const COORDINATE_LIMIT: f64 = 1e90;

/// A polygon in a plane that cuts a surface.
///
/// Seen from the side to which positions grow it has the inside on its left: it runs counter-clockwise
/// around inside and clockwise around a hole.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// Position of its plane, in world units or as an index of the lattice.
    pub position: f64,
    /// Its points in order, in world coordinates.
    pub points: Vec<[f64; 3]>,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Length in world units.
    pub length: f64,
    /// Enclosed area in squared world units, negative for a hole; 0 unless it is closed. Over all
    /// contours of a plane the sum is the area inside.
    pub area: f64,
}

/// The contours of a mesh, plane by plane.
///
/// Those of a closed mesh whose triangles all face outside are closed. They end where the mesh does, and
/// where neighbouring triangles face opposite sides. In each plane open contours come first, each kind
/// in the order of its first triangle; results have the same bits on any number of threads.
///
/// ```
/// use shrouds::{Settings, shroud, volume::phantom};
/// use shrouds::measure::{Planes, contours};
///
/// let mesh = shroud(&phantom::sphere(32)?, &Settings::default())?.mesh; // of radius 12.8
/// let [low, high] = [0.0, 31.0];
/// let every = (0..=62).map(|n| low + f64::from(n) / 62.0 * (high - low)).collect();
/// let contours = contours(&mesh, &Planes::across(2, every))?;
/// let volume: f64 = contours.iter().map(|contour| contour.area * 0.5).sum(); // Cavalieri
/// assert!((volume / mesh.volume() - 1.0).abs() < 1e-3);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] when a triangle names a vertex that does not exist or a coordinate is not finite or
/// beyond 1e90.
pub fn contours(mesh: &TriMesh, planes: &Planes) -> Result<Vec<Contour>, Error> {
    let (chains, normal) = (chains(mesh, planes)?, planes.normal());
    let largest = mesh.vertices.iter().flatten().fold(0.0, |max: f64, x| max.max(x.abs()));
    let blocks = parallel::blocks(chains.len(), 64, |range| {
        chains[range].iter().filter_map(|chain| chain.contour(planes, normal, largest)).collect()
    });
    let blocks: Vec<Vec<Contour>> = blocks;
    Ok(blocks.into_iter().flatten().collect())
}

/// The curves of the 4\*-network by the axis of the lattice across them, x first: what the lattice
/// planes cut out of a primal mesh, through its vertices.
///
/// `vertices` are those of the primal mesh, in the world of `grid`, the lattice of the volume. Positions
/// are indices of that lattice.
///
/// # Panics
/// When there is not one position per vertex, or the surface is none of a volume on such a lattice.
pub fn network_contours(
    surface: &Surface,
    network: &Network,
    vertices: &[[f64; 3]],
    grid: &Grid,
) -> [Vec<Contour>; 3] {
    assert_eq!(vertices.len(), network.vertex_count(), "one position per vertex");
    let [wide, high, deep] = surface.grid().dims();
    // A closed border is one more layer on all sides.
    let margin = (wide - grid.dims()[0]) / 2;
    let dims = grid.dims().map(|count| count + 2 * margin);
    assert_eq!(dims, [wide, high, deep], "a surface of a volume on this lattice");
    let crossings: Vec<_> = surface.crossings().collect();
    let normals = [0, 1, 2].map(|axis| Planes::across_lattice(grid, axis, Vec::new()).normal());
    let mut families = [const { Vec::new() }; 3];
    for mut curve in network.curves() {
        // Curves have the inside on their right, as the lattice is seen.
        if !grid.is_mirrored() {
            curve.vertices.reverse();
        }
        let slice = crossings[curve.vertices[0] as usize].low()[curve.axis];
        let points = curve.vertices.iter().map(|&v| vertices[v as usize]).collect();
        let position = slice as f64 - margin as f64;
        let contour = Contour::new(position, points, curve.closed, normals[curve.axis]);
        families[curve.axis].push(contour);
    }
    families
}

impl Contour {
    fn new(position: f64, points: Vec<Vector>, closed: bool, normal: Vector) -> Self {
        let next = |n: usize| points[(n + 1) % points.len()];
        let segments = if closed { points.len() } else { points.len().saturating_sub(1) };
        let length = (0..segments).map(|n| length(subtract(next(n), points[n]))).sum();
        // About its first point, so that an area far from the origin keeps its digits.
        let triangle = |n: usize| {
            cross(subtract(points[n], points[0]), subtract(next(n), points[0])).map(|x| 0.5 * x)
        };
        let area = (0..segments).map(triangle).fold([0.0; 3], add);
        let area = if closed { dot(area, normal) } else { 0.0 };
        Self { position, points, closed, length, area }
    }
}

/// The edge of a mesh by its vertices, the smaller first.
type Edge = [u32; 2];

/// What a plane cuts out of a triangle.
#[derive(Debug, Clone, Copy)]
struct Segment {
    level: u32,
    triangle: u32,
    from: Edge,
    to: Edge,
}

/// Segments that follow each other.
pub(super) struct Chain {
    pub(super) level: usize,
    pub(super) closed: bool,
    /// Where each segment begins and, if it is open, where the last one ends.
    pub(super) points: Vec<Vector>,
    /// The triangle of every segment.
    pub(super) triangles: Vec<u32>,
}

/// All that the planes cut out of the mesh, plane by plane.
pub(super) fn chains(mesh: &TriMesh, planes: &Planes) -> Result<Vec<Chain>, Error> {
    refuse_damage(mesh)?;
    let mut heights = vec![0.0; mesh.vertices.len()];
    parallel::fill(&mut heights, |v| planes.height(mesh.vertices[v]));
    let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let mut found = Vec::new();
        range.for_each(|t| cut(mesh, planes, &heights, t, &mut found));
        found
    });
    let mut segments = blocks.concat();
    segments.sort_by_key(|segment| segment.level);
    let firsts: Vec<usize> = (0..=planes.positions().len())
        .map(|level| segments.partition_point(|segment| (segment.level as usize) < level))
        .collect();
    let place = |level: usize, [u, v]: Edge| {
        let [a, b] = [u, v].map(|v| v as usize);
        planes.meet(level, [mesh.vertices[a], mesh.vertices[b]], [heights[a], heights[b]])
    };
    let levels = parallel::blocks(planes.positions().len(), 1, |levels| {
        levels
            .flat_map(|level| {
                let segments = &segments[firsts[level]..firsts[level + 1]];
                join(segments, level, |edge| place(level, edge))
            })
            .collect()
    });
    let levels: Vec<Vec<Chain>> = levels;
    Ok(levels.into_iter().flatten().collect())
}

/// What cannot be measured.
pub(super) fn refuse_damage(mesh: &TriMesh) -> Result<(), Error> {
    let count = mesh.vertices.len();
    let missing = |t: &&[u32; 3]| t.iter().any(|&v| v as usize >= count);
    if let Some(triangle) = mesh.triangles.iter().find(missing) {
        let text = format!("a triangle names the vertices {triangle:?}, but there are {count}");
        return Err(Error::Mesh(text));
    }
    let good = |p: &Vector| p.iter().all(|x| x.abs() <= COORDINATE_LIMIT);
    match mesh.vertices.iter().position(|p| !good(p)) {
        Some(v) => Err(Error::Mesh(format!("vertex {v} lies at {:?}", mesh.vertices[v]))),
        None => Ok(()),
    }
}

/// The segments that planes cut out of triangle `t`. Each leads from the edge that the triangle, seen
/// from outside, goes down along to the one it goes up along: so it has the inside on its left.
fn cut(mesh: &TriMesh, planes: &Planes, heights: &[f64], t: usize, found: &mut Vec<Segment>) {
    let corners = mesh.triangles[t];
    let [a, b, c] = corners.map(|v| heights[v as usize]);
    for level in planes.between(a.min(b).min(c), a.max(b).max(c)) {
        let position = planes.positions()[level];
        let above = [a >= position, b >= position, c >= position];
        let edge = |from_above: bool| {
            let n = (0..3).find(|&n| above[n] == from_above && above[(n + 1) % 3] != from_above);
            let [u, v] = [n.unwrap_or(0), n.unwrap_or(0) + 1].map(|n| corners[n % 3]);
            [u.min(v), u.max(v)]
        };
        let (level, triangle) = (level as u32, t as u32);
        found.push(Segment { level, triangle, from: edge(true), to: edge(false) });
    }
}

/// Joins the segments of one plane: open chains first, each from the smallest segment on.
fn join(segments: &[Segment], level: usize, place: impl Fn(Edge) -> Vector) -> Vec<Chain> {
    let next = successors(segments);
    let mut is_next = vec![false; segments.len()];
    next.iter().flatten().for_each(|&n| is_next[n as usize] = true);
    let mut done = vec![false; segments.len()];
    let mut chains = Vec::new();
    let heads = (0..segments.len()).filter(|&n| !is_next[n]);
    for first in heads.chain(0..segments.len()) {
        if done[first] {
            continue;
        }
        let (mut chain, mut at) = (Vec::new(), Some(first));
        while let Some(n) = at.filter(|&n| !done[n]) {
            done[n] = true;
            chain.push(segments[n]);
            at = next[n].map(|n| n as usize);
        }
        let last = chain[chain.len() - 1].to;
        let closed = at.is_some();
        let ends = (!closed).then_some(last);
        let points = chain.iter().map(|segment| segment.from).chain(ends).map(&place).collect();
        let triangles = chain.iter().map(|segment| segment.triangle).collect();
        chains.push(Chain { level, closed, points, triangles });
    }
    chains
}

/// The segment that follows each one: it begins on the edge on which this one ends. On an edge of more
/// than two triangles they are paired in their order.
fn successors(segments: &[Segment]) -> Vec<Option<u32>> {
    let sorted = |edge: fn(&Segment) -> Edge| {
        let mut all: Vec<(Edge, u32)> =
            segments.iter().zip(0..).map(|(segment, n)| (edge(segment), n)).collect();
        all.sort_unstable();
        all
    };
    let (starts, ends) = (sorted(|segment| segment.from), sorted(|segment| segment.to));
    let mut next = vec![None; segments.len()];
    let mut starts = starts.into_iter().peekable();
    for (edge, n) in ends {
        while starts.next_if(|(other, _)| *other < edge).is_some() {}
        next[n as usize] = starts.next_if(|(other, _)| *other == edge).map(|(_, start)| start);
    }
    next
}

impl Chain {
    /// Without points at one place; nothing if too few are left.
    fn contour(&self, planes: &Planes, normal: Vector, largest: f64) -> Option<Contour> {
        let near = |a: Vector, b: Vector| length(subtract(a, b)) <= SAME_PLACE * largest;
        let mut points: Vec<Vector> = Vec::with_capacity(self.points.len());
        for &point in &self.points {
            if points.last().is_none_or(|&last| !near(last, point)) {
                points.push(point);
            }
        }
        while self.closed && points.len() > 1 && near(points[0], points[points.len() - 1]) {
            points.pop();
        }
        let least = if self.closed { 3 } else { 2 };
        let position = planes.positions()[self.level];
        (points.len() >= least).then(|| Contour::new(position, points, self.closed, normal))
    }
}
