//! From the points' places to the mesh.

use std::collections::HashMap;

use crate::materials::cell::{FIRST_INNER, FIRST_JUNCTION, Filling, Node};
use crate::materials::interfaces::{Interfaces, across};
use crate::materials::labels::pair;
use crate::materials::mesh::MaterialMesh;
use crate::mesh::fit::{Fit, Polygon};
use crate::parallel;
use crate::surface::cell::{LoopShape, table};
use crate::vector::{add, subtract};

/// Layers of cells per piece of work.
const LAYERS: usize = 8;

impl MaterialMesh {
    /// The mesh of interfaces whose points are at these places and whose curves have these slopes, see
    /// [`Optimum`](crate::materials::Optimum). The slopes only choose among triangulations.
    ///
    /// # Panics
    /// When there is not one unknown for each crossing and two for each junction, or one pair of slopes
    /// for each crossing.
    pub fn span(interfaces: &Interfaces, unknowns: &[f64], slopes: &[[f32; 2]]) -> Self {
        let (crossings, junctions) = (interfaces.crossings().len(), interfaces.junctions().len());
        assert_eq!(unknowns.len(), crossings + 2 * junctions, "all unknowns");
        assert_eq!(slopes.len(), crossings, "the slopes of every crossing");
        let places = places(interfaces, unknowns);
        let unit = interfaces.grid().min_spacing();
        let scale = interfaces.grid().spacing().map(|spacing| spacing / unit);
        let normals = normals(interfaces, slopes);
        let frame = Frame { interfaces, places: &places, normals: &normals, scale };
        let layers = interfaces.grid().dims()[2] - 1;
        let pieces = parallel::blocks(layers, LAYERS, |range| {
            let mut piece = Piece { first: places.len() as u32, ..Piece::default() };
            range.for_each(|layer| frame.add_layer(layer, &mut piece));
            piece.fit.finish(&mut piece.triangles);
            piece
        });
        join(interfaces, places, pieces)
    }
}

/// Places of crossings and junctions, in units of the index.
fn places(interfaces: &Interfaces, unknowns: &[f64]) -> Vec<[f64; 3]> {
    let (crossings, junctions) = (interfaces.crossings(), interfaces.junctions());
    let mut places = vec![[0.0; 3]; crossings.len() + junctions.len()];
    parallel::fill(&mut places, |point| match crossings.get(point) {
        Some(crossing) => {
            let mut place = crossing.low().map(|index| index as f64);
            place[crossing.axis()] += unknowns[point];
            place
        }
        None => {
            let junction = junctions[point - crossings.len()];
            let mut place = junction.low.map(f64::from);
            let first = crossings.len() + 2 * (point - crossings.len());
            for (n, axis) in junction.axes().into_iter().enumerate() {
                place[axis] += unknowns[first + n];
            }
            place
        }
    });
    places
}

/// Unit normals at the crossings from the first label to the second, as if the axes were orthogonal.
fn normals(interfaces: &Interfaces, slopes: &[[f32; 2]]) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; slopes.len()];
    parallel::fill(&mut normals, |v| {
        let crossing = interfaces.crossings()[v];
        let [s0, s1] = slopes[v];
        let sign = if crossing.inside_low() { 1.0 } else { -1.0 };
        let factor = sign / (1.0 + s0 * s0 + s1 * s1).sqrt();
        let mut normal = [0.0; 3];
        // The curve of the first plane runs across the edge along the normal of the second.
        let [first, second] = across(crossing.axis());
        normal[crossing.axis()] = factor;
        normal[second] = -s0 * factor;
        normal[first] = -s1 * factor;
        normal
    });
    normals
}

/// Triangles of some layers.
#[derive(Default)]
struct Piece {
    triangles: Vec<[u32; 3]>,
    /// Ranks.
    pairs: Vec<[u32; 2]>,
    lines: Vec<[u32; 2]>,
    /// Cell points; the first has the number `first` until the pieces are joined.
    inner: Vec<[f64; 3]>,
    first: u32,
    fit: Fit,
    /// By the order of the labels at the corners, see [`order`].
    fillings: HashMap<[u8; 8], Filling>,
}

fn join(interfaces: &Interfaces, mut places: Vec<[f64; 3]>, pieces: Vec<Piece>) -> MaterialMesh {
    let mut mesh = MaterialMesh::default();
    let names = interfaces.labels().values();
    for mut piece in pieces {
        let shift = places.len() as u32 - piece.first;
        let shift_all = |points: &mut [u32]| {
            points.iter_mut().filter(|p| **p >= piece.first).for_each(|p| *p += shift);
        };
        shift_all(piece.triangles.as_flattened_mut());
        shift_all(piece.lines.as_flattened_mut());
        places.append(&mut piece.inner);
        mesh.surface.triangles.append(&mut piece.triangles);
        mesh.lines.append(&mut piece.lines);
        mesh.pairs.extend(piece.pairs.iter().map(|pair| pair.map(|rank| names[rank as usize])));
    }
    let grid = interfaces.grid();
    parallel::update(&mut places, |_, place| *place = grid.point(*place));
    mesh.surface.vertices = places;
    if grid.is_mirrored() {
        parallel::update(&mut mesh.surface.triangles, |_, triangle| triangle.swap(1, 2));
    }
    mesh
}

/// What the cells need to know of the points.
struct Frame<'a> {
    interfaces: &'a Interfaces,
    places: &'a [[f64; 3]],
    normals: &'a [[f32; 3]],
    scale: [f64; 3],
}

impl Frame<'_> {
    fn add_layer(&self, layer: usize, piece: &mut Piece) {
        self.interfaces.for_each_cell(layer, |low, labels| {
            let first = labels[0];
            let second = labels.into_iter().find(|&label| label != first).unwrap_or(first);
            if labels.iter().all(|&label| label == first || label == second) {
                self.add_binary(low, labels, pair(first, second), piece);
            } else {
                self.add_filling(low, labels, piece);
            }
        });
    }

    /// A cell of two labels is one of a binary volume with the first label inside.
    fn add_binary(&self, low: [usize; 3], labels: [u32; 8], pair: [u32; 2], piece: &mut Piece) {
        let inside = |bits, c| bits | u8::from(labels[c] == pair[0]) << c;
        let pattern = (0..8).fold(0, inside);
        for shape in table(self.interfaces.face_rule()).loops(pattern) {
            let mut vertices = [0; 8];
            for (vertex, &edge) in vertices.iter_mut().zip(shape.edges()) {
                *vertex = self.interfaces.cell_crossing(low, edge.into());
            }
            self.cut(shape, &vertices[..shape.edges().len()], piece);
        }
        piece.pairs.resize(piece.triangles.len(), pair);
    }

    /// Cuts a loop as the binary mesh does.
    fn cut(&self, shape: &LoopShape, vertices: &[u32], piece: &mut Piece) {
        let at = piece.triangles.len();
        if shape.is_free() && vertices.len() > 3 {
            piece.triangles.resize(at + vertices.len() - 2, [0; 3]);
            let origin = self.places[vertices[0] as usize];
            piece.fit.push(&Loop { frame: self, vertices, origin }, at, &mut piece.triangles);
        } else {
            piece.triangles.extend(shape.fixed_triangles(vertices));
        }
    }

    fn add_filling(&self, low: [usize; 3], labels: [u32; 8], piece: &mut Piece) {
        let (digits, ranks) = order(labels);
        let rule = self.interfaces.face_rule();
        let new = || Filling::new(digits.map(u32::from), rule);
        let filling = piece.fillings.entry(digits).or_insert_with(new);
        let first = piece.first + piece.inner.len() as u32;
        let point = |node: Node| match node {
            FIRST_INNER.. => first + u32::from(node - FIRST_INNER),
            FIRST_JUNCTION.. => {
                self.interfaces.cell_junction(low, usize::from(node - FIRST_JUNCTION))
            }
            edge => self.interfaces.cell_crossing(low, edge.into()),
        };
        for triangle in &filling.triangles {
            piece.triangles.push(triangle.nodes.map(point));
            piece.pairs.push(triangle.pair.map(|digit| ranks[digit as usize]));
        }
        piece.lines.extend(filling.lines.iter().map(|line| line.map(point)));
        let low = low.map(|index| index as f64);
        for inner in &filling.inner {
            let place = inner.place(|node| {
                let point = point(node) as usize;
                let known = piece.first as usize;
                let place =
                    if point < known { self.places[point] } else { piece.inner[point - known] };
                subtract(place, low)
            });
            piece.inner.push(add(low, place));
        }
    }
}

/// The labels of a cell by their order, from 1 on, so that pairs ascend: the background is the last.
/// With the ranks that the numbers stand for.
pub(super) fn order(labels: [u32; 8]) -> ([u8; 8], [u32; 9]) {
    let key = |label: u32| label.wrapping_sub(1);
    let digits = labels.map(|label| {
        let before = |n: usize| key(labels[n]) < key(label) && !labels[..n].contains(&labels[n]);
        1 + (0..8).filter(|&n| before(n)).count() as u8
    });
    let mut ranks = [0; 9];
    for (digit, label) in digits.into_iter().zip(labels) {
        ranks[usize::from(digit)] = label;
    }
    (digits, ranks)
}

/// A loop that is to be cut into triangles.
struct Loop<'a> {
    frame: &'a Frame<'a>,
    vertices: &'a [u32],
    origin: [f64; 3],
}

impl Polygon for Loop<'_> {
    #[inline(always)]
    fn vertices(&self) -> &[u32] {
        self.vertices
    }

    #[inline(always)]
    fn corner(&self, n: usize) -> ([f32; 3], [f32; 3]) {
        let v = self.vertices[n] as usize;
        let (place, scale) = (self.frame.places[v], self.frame.scale);
        let place = std::array::from_fn(|a| ((place[a] - self.origin[a]) * scale[a]) as f32);
        (place, self.frame.normals[v])
    }
}
