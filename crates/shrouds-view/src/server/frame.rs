//! Binary messages for the page: a header of four numbers, then arrays that need no parsing.
//!
//! All little-endian, every array on a multiple of four bytes. `docs/test-bed.md` has the table.

use shrouds::network::Network;
use shrouds::surface::{Crossing, Surface};
use shrouds::volume::Border;

/// A binary message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame(Vec<u8>);

/// What kind of frame one is, as its header has it.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Topology = 1,
    Deltas = 2,
    Triangles = 3,
    Mesh = 4,
    Normals = 5,
    Scalars = 6,
    Lines = 7,
    Points = 8,
    Image = 9,
    Interfaces = 10,
}

/// What belongs to a surface whatever its δ.
pub struct Topology<'a> {
    /// Crossings.
    pub surface: &'a Surface,
    /// Its planar curves.
    pub network: &'a Network,
    /// Triangles of the primal mesh, in the order of the lattice axes.
    pub triangles: &'a [[u32; 3]],
    /// Whether they stay the same for every δ.
    pub are_fixed: bool,
}

impl Frame {
    /// Of which view and which surface or request it is, and how many items follow.
    fn new(kind: Kind, [view, revision]: [u32; 2], count: usize, bytes: usize) -> Self {
        let mut frame = Self(Vec::with_capacity(16 + bytes));
        frame.words([kind as u32, view, revision, count as u32]);
        frame
    }

    fn words(&mut self, words: impl IntoIterator<Item = u32>) {
        words.into_iter().for_each(|word| self.0.extend_from_slice(&word.to_le_bytes()));
    }

    fn numbers(&mut self, numbers: impl IntoIterator<Item = f32>) {
        numbers.into_iter().for_each(|number| self.0.extend_from_slice(&number.to_le_bytes()));
    }

    /// Where vertices can be, triangles and the segments of the network. Positions are lattice
    /// coordinates: index times spacing.
    pub fn topology(of: [u32; 2], topology: &Topology) -> Self {
        let Topology { surface, network, triangles, are_fixed } = topology;
        let (vertices, segments) = (surface.vertex_count(), Segments::of(network));
        let bytes = 16 + 24 * vertices + 12 * triangles.len() + 9 * segments.ends.len() + 3;
        let mut frame = Self::new(Kind::Topology, of, vertices, bytes);
        let counts = [vertices, triangles.len(), segments.ends.len(), usize::from(*are_fixed)];
        frame.words(counts.map(|count| count as u32));
        let places = Places::of(surface);
        surface.crossings().for_each(|crossing| frame.numbers(places.outside(crossing)));
        surface.crossings().for_each(|crossing| frame.numbers(places.along(crossing)));
        frame.words(triangles.as_flattened().iter().copied());
        frame.words(segments.ends.as_flattened().iter().copied());
        frame.0.extend(&segments.families);
        frame.0.resize(frame.0.len().next_multiple_of(4), 0);
        frame
    }

    /// δ of every vertex.
    pub fn deltas(of: [u32; 2], deltas: impl ExactSizeIterator<Item = f32>) -> Self {
        let mut frame = Self::new(Kind::Deltas, of, deltas.len(), 4 * deltas.len());
        frame.numbers(deltas);
        frame
    }

    /// Other triangles of the same vertices.
    pub fn triangles(of: [u32; 2], triangles: &[[u32; 3]]) -> Self {
        let mut frame = Self::new(Kind::Triangles, of, triangles.len(), 12 * triangles.len());
        frame.words(triangles.as_flattened().iter().copied());
        frame
    }

    /// A mesh of its own vertices.
    pub fn mesh(of: [u32; 2], vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let bytes = 8 + 12 * (vertices.len() + triangles.len());
        let mut frame = Self::new(Kind::Mesh, of, vertices.len(), bytes);
        frame.words([vertices.len(), triangles.len()].map(|count| count as u32));
        frame.numbers(vertices.as_flattened().iter().copied());
        frame.words(triangles.as_flattened().iter().copied());
        frame
    }

    /// A vector for every vertex.
    pub fn normals(of: [u32; 2], normals: impl ExactSizeIterator<Item = [f32; 3]>) -> Self {
        let mut frame = Self::new(Kind::Normals, of, normals.len(), 12 * normals.len());
        normals.for_each(|normal| frame.numbers(normal));
        frame
    }

    /// A number for every vertex.
    pub fn scalars(of: [u32; 2], scalars: impl ExactSizeIterator<Item = f32>) -> Self {
        let mut frame = Self::new(Kind::Scalars, of, scalars.len(), 4 * scalars.len());
        frame.numbers(scalars);
        frame
    }

    /// Polylines; one that closes repeats its first point.
    pub fn lines(of: [u32; 2], lines: &[Vec<[f32; 3]>]) -> Self {
        let points: usize = lines.iter().map(Vec::len).sum();
        let mut frame =
            Self::new(Kind::Lines, of, lines.len(), 4 * (1 + lines.len()) + 12 * points);
        frame.words([lines.len() as u32]);
        frame.words(lines.iter().map(|line| line.len() as u32));
        frame.numbers(lines.iter().flatten().flatten().copied());
        frame
    }

    /// Lattice points, each with whether it is inside.
    pub fn points(of: [u32; 2], points: &[([f32; 3], bool)]) -> Self {
        let mut frame = Self::new(Kind::Points, of, points.len(), 16 * points.len());
        for (point, is_inside) in points {
            frame.numbers(*point);
            frame.words([u32::from(*is_inside)]);
        }
        frame
    }

    /// An image in space: pixels across and down, the centres of its first pixel, of the last one of the
    /// first row and of the first one of the last row, then red, green, blue and opacity of each.
    pub fn image(
        of: [u32; 2],
        size: [usize; 2],
        corners: [[f32; 3]; 3],
        pixels: &[[u8; 4]],
    ) -> Self {
        let mut frame = Self::new(Kind::Image, of, pixels.len(), 8 + 36 + 4 * pixels.len());
        frame.words(size.map(|side| side as u32));
        frame.numbers(corners.into_iter().flatten());
        frame.0.extend_from_slice(pixels.as_flattened());
        frame
    }

    /// What the triangles of a mesh lie between: runs of triangles, each the places of both labels in a list
    /// and how many triangles it has; and the edges in which three or more labels meet, as vertices of
    /// the mesh.
    pub fn interfaces(of: [u32; 2], runs: &[[u32; 3]], edges: &[[u32; 2]]) -> Self {
        let bytes = 8 + 12 * runs.len() + 8 * edges.len();
        let mut frame = Self::new(Kind::Interfaces, of, runs.len(), bytes);
        frame.words([runs.len(), edges.len()].map(|count| count as u32));
        frame.words(runs.as_flattened().iter().copied());
        frame.words(edges.as_flattened().iter().copied());
        frame
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.0
    }
}

/// The segments of a network and the axes across their curves.
struct Segments {
    ends: Vec<[u32; 2]>,
    families: Vec<u8>,
}

impl Segments {
    fn of(network: &Network) -> Self {
        let (mut ends, mut families) = (Vec::new(), Vec::new());
        for curve in network.curves() {
            let closing = curve.vertices.last().zip(curve.vertices.first()).map(|(a, b)| [*a, *b]);
            let closing = closing.filter(|_| curve.closed && curve.vertices.len() > 1);
            ends.extend(curve.vertices.windows(2).map(|pair| [pair[0], pair[1]]));
            ends.extend(closing);
            families.resize(ends.len(), curve.axis as u8);
        }
        Self { ends, families }
    }
}

/// From the indices of a surface to lattice coordinates of its volume.
struct Places {
    spacing: [f64; 3],
    /// Layers that a closed border adds before the first point.
    margin: f64,
}

impl Places {
    fn of(surface: &Surface) -> Self {
        let margin = if surface.border() == Border::Closed { 1.0 } else { 0.0 };
        Self { spacing: surface.grid().spacing(), margin }
    }

    fn outside(&self, crossing: Crossing) -> [f32; 3] {
        let end = crossing.outside();
        std::array::from_fn(|d| ((end[d] as f64 - self.margin) * self.spacing[d]) as f32)
    }

    /// From the outside end to the inside one.
    fn along(&self, crossing: Crossing) -> [f32; 3] {
        let mut step = [0.0; 3];
        let axis = crossing.axis();
        let sign = if crossing.inside_low() { -1.0 } else { 1.0 };
        step[axis] = (sign * self.spacing[axis]) as f32;
        step
    }
}
