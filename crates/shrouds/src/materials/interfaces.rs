//! Where labels meet: crossings and junction points.

use crate::error::Error;
use crate::grid::Grid;
use crate::materials::face::{End, Segment, has_junction, segments};
use crate::materials::labels::{Labels, pair};
use crate::materials::marks::Marks;
use crate::surface::bits::{mask_below, set_bits, shifted};
use crate::surface::{Crossing, Surface};
use crate::volume::FaceRule;

/// The interfaces between all labels of a volume: the topology shared by all their separating
/// surfaces. Integers only.
///
/// *Points* are numbered: first the crossings, in scan order of the lower end of their grid edge (by
/// z, then y, then axis, then x), then the junction points, in scan order of the lowest corner of their
/// face (by z, then y, then the axis normal to the face, then x).
#[derive(Debug, Clone, PartialEq)]
pub struct Interfaces {
    labels: Labels,
    rule: FaceRule,
    edges: Marks,
    faces: Marks,
    crossings: Vec<Crossing>,
    junctions: Vec<Junction>,
}

/// A face in which three or four labels meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Junction {
    /// Index of its lowest corner, in the grid of the labels.
    pub low: [u32; 3],
    /// The axis normal to it.
    pub normal: u8,
}

impl Junction {
    /// The axes along the face, by which the junction point's two unknowns go.
    #[inline]
    pub fn axes(self) -> [usize; 2] {
        across(self.normal.into())
    }
}

/// The two axes after one, in cyclic order.
#[inline]
pub(super) fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// The corners of the face normal to `normal` with this lowest corner, in cyclic order, as steps along
/// its two axes.
const FACE_CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

impl Interfaces {
    /// Finds the interfaces of a volume.
    ///
    /// # Errors
    /// [`Error::TooManyVertices`] beyond [`Surface::MAX_VERTICES`] crossings and junctions.
    pub fn extract(labels: Labels, rule: FaceRule) -> Result<Self, Error> {
        let dims = labels.grid().dims();
        let edges = Marks::new(dims, |j, k, words| mark_edges(&labels, j, k, words));
        let faces = Marks::new(dims, |j, k, words| mark_faces(&labels, &edges, j, k, words));
        let (vertices, limit) = (edges.count() + faces.count(), Surface::MAX_VERTICES);
        if vertices > limit {
            return Err(Error::TooManyVertices { vertices, limit });
        }
        let (ranks, strides) = (labels.ranks(), labels.strides());
        let crossings = edges.places(|axis, low| {
            let at: usize = (0..3).map(|a| low[a] * strides[a]).sum();
            let (here, there) = (ranks[at], ranks[at + strides[axis]]);
            Crossing::new(low, axis, pair(here, there)[0] == here)
        });
        let junctions = faces.places(|normal, low| {
            let low = low.map(|index| index as u32);
            Junction { low, normal: normal as u8 }
        });
        Ok(Self { labels, rule, edges, faces, crossings, junctions })
    }

    /// The labels.
    pub fn labels(&self) -> &Labels {
        &self.labels
    }

    /// The lattice the points refer to: that of the volume with one more layer on all sides.
    pub fn grid(&self) -> &Grid {
        self.labels.grid()
    }

    /// How faces whose two diagonals have a label each were settled.
    pub fn face_rule(&self) -> FaceRule {
        self.rule
    }

    /// The crossings by number. The first label of the pair counts as the inside: δ is 1 where the
    /// first label is.
    pub fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// The junctions in order; the point of number `n` is point `crossings().len() + n`.
    pub fn junctions(&self) -> &[Junction] {
        &self.junctions
    }

    /// The ranks of the two labels at a crossing, first and second.
    pub fn labels_at(&self, crossing: Crossing) -> [u32; 2] {
        let strides = self.labels.strides();
        let at = |point: [usize; 3]| (0..3).map(|a| point[a] * strides[a]).sum::<usize>();
        [crossing.inside(), crossing.outside()].map(|point| self.labels.ranks()[at(point)])
    }

    /// The number of the crossing on an edge of a face.
    #[inline]
    pub(super) fn face_crossing(&self, normal: usize, low: [usize; 3], edge: End) -> u32 {
        let [u, v] = across(normal);
        // Edges 0 and 2 run along the first axis, 1 and 3 along the second.
        let mut start = low;
        start[v] += usize::from(edge == 2);
        start[u] += usize::from(edge == 1);
        self.edges.number(if edge & 1 == 0 { u } else { v }, start)
    }

    /// Calls `f` with all faces normal to an axis that a curve passes: the lowest corner, and a bit for
    /// each crossed edge.
    pub(super) fn for_each_face(&self, normal: usize, mut f: impl FnMut([usize; 3], u8)) {
        let [_, ny, nz] = self.grid().dims();
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            for w in 0..self.edges.words() {
                let Some(edges) = face_edges(&self.edges, [ny, nz], normal, [w, j, k]) else {
                    continue;
                };
                let [a, b, c, d] = edges;
                for bit in set_bits(a & (b | c | d) | b & (c | d) | c & d) {
                    let crossed = (0..4).fold(0, |all, q| all | (edges[q] >> bit & 1) << q);
                    f([64 * w + bit as usize, j, k], crossed as u8);
                }
            }
        }
    }

    /// The number of the junction on a face, from 0 on, if it has one.
    #[inline]
    pub(super) fn junction_on(&self, normal: usize, low: [usize; 3]) -> Option<u32> {
        self.faces.number_if_marked(normal, low)
    }

    /// The segments on a face.
    pub(super) fn segments_on(
        &self,
        normal: usize,
        low: [usize; 3],
    ) -> impl Iterator<Item = Segment> + use<> {
        let strides = self.labels.strides();
        let at = (0..3).map(|a| low[a] * strides[a]).sum();
        segments(face_labels(self.labels.ranks(), strides, normal, at), self.rule)
    }

    /// Calls `f` with all cells of a layer that an interface passes, in scan order: the lowest corner
    /// and the labels of the corners.
    pub(super) fn for_each_cell(&self, k: usize, mut f: impl FnMut([usize; 3], [u32; 8])) {
        let [nx, ny, _] = self.grid().dims();
        let (ranks, strides) = (self.labels.ranks(), self.labels.strides());
        let steps: [usize; 8] = std::array::from_fn(|c| {
            (0..3).map(|axis| (c >> axis & 1) * strides[axis]).sum::<usize>()
        });
        for j in 0..ny - 1 {
            let rows = [(j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1)];
            let row = |axis, (j, k)| self.edges.row(axis, j, k);
            for w in 0..self.edges.words() {
                let mut active = rows.iter().fold(0, |any, &at| any | row(0, at)[w]);
                for (axis, at) in [(1, rows[0]), (1, rows[2]), (2, rows[0]), (2, rows[1])] {
                    active |= row(axis, at)[w] | shifted(row(axis, at), w);
                }
                for bit in set_bits(active & mask_below(nx - 1, w)) {
                    let low = [64 * w + bit as usize, j, k];
                    let at = low[0] + j * strides[1] + k * strides[2];
                    f(low, steps.map(|step| ranks[at + step]));
                }
            }
        }
    }

    /// The number of the crossing on an edge of a cell, edge `4·axis + a + 2·b` as the cells of binary
    /// volumes have them.
    #[inline]
    pub(super) fn cell_crossing(&self, low: [usize; 3], edge: usize) -> u32 {
        let axis = edge / 4;
        let [u, v] = across(axis);
        let mut start = low;
        start[u] += edge & 1;
        start[v] += edge >> 1 & 1;
        self.edges.number(axis, start)
    }

    /// The number of the junction point on a face of a cell, face `2·axis + side`.
    #[inline]
    pub(super) fn cell_junction(&self, low: [usize; 3], face: usize) -> u32 {
        let mut start = low;
        start[face / 2] += face % 2;
        self.crossings.len() as u32 + self.faces.number(face / 2, start)
    }
}

#[inline]
fn face_labels(ranks: &[u32], strides: [usize; 3], normal: usize, at: usize) -> [u32; 4] {
    let [u, v] = across(normal).map(|axis| strides[axis]);
    FACE_CORNERS.map(|[a, b]| ranks[at + a * u + b * v])
}

/// Marks the crossed grid edges that start in a row.
fn mark_edges(labels: &Labels, j: usize, k: usize, words: &mut [u64]) {
    let [nx, ny, nz] = labels.grid().dims();
    let (ranks, strides) = (labels.ranks(), labels.strides());
    let start = k * strides[2] + j * strides[1];
    let row = &ranks[start..start + nx];
    let count = words.len() / 3;
    let is_last = [false, j + 1 == ny, k + 1 == nz];
    for (axis, words) in words.chunks_exact_mut(count).enumerate() {
        let length = if axis == 0 { nx - 1 } else { nx };
        if is_last[axis] {
            continue;
        }
        let next = &ranks[start + strides[axis]..][..length];
        if row[..length] == *next {
            continue;
        }
        for (word, (row, next)) in
            words.iter_mut().zip(row[..length].chunks(64).zip(next.chunks(64)))
        {
            let differs = |(bit, (a, b)): (usize, (&u32, &u32))| u64::from(a != b) << bit;
            *word = row.iter().zip(next).enumerate().map(differs).fold(0, |all, bit| all | bit);
        }
    }
}

/// Marks the faces with a junction whose lowest corner is in a row.
fn mark_faces(labels: &Labels, edges: &Marks, j: usize, k: usize, words: &mut [u64]) {
    let [_, ny, nz] = labels.grid().dims();
    let (ranks, strides) = (labels.ranks(), labels.strides());
    let start = k * strides[2] + j * strides[1];
    for (normal, words) in words.chunks_exact_mut(edges.words()).enumerate() {
        for (w, word) in words.iter_mut().enumerate() {
            let Some([a, b, c, d]) = face_edges(edges, [ny, nz], normal, [w, j, k]) else { break };
            let at_least_three = a & c & (b | d) | b & d & (a | c);
            for bit in set_bits(at_least_three) {
                let at = start + 64 * w + bit as usize;
                let meets = has_junction(face_labels(ranks, strides, normal, at));
                *word |= u64::from(meets) << bit;
            }
        }
    }
}

/// Which of the four edges of the faces whose lowest corners are in a word of a row are crossed; nothing
/// if the row has no such faces.
#[inline]
fn face_edges(
    edges: &Marks,
    [ny, nz]: [usize; 2],
    normal: usize,
    [w, j, k]: [usize; 3],
) -> Option<[u64; 4]> {
    if normal != 1 && j + 1 == ny || normal != 2 && k + 1 == nz {
        return None;
    }
    let row = |axis, j, k| edges.row(axis, j, k);
    Some(match normal {
        0 => [row(1, j, k)[w], row(2, j + 1, k)[w], row(1, j, k + 1)[w], row(2, j, k)[w]],
        1 => [row(2, j, k)[w], row(0, j, k + 1)[w], shifted(row(2, j, k), w), row(0, j, k)[w]],
        _ => [row(0, j, k)[w], shifted(row(1, j, k), w), row(0, j + 1, k)[w], row(1, j, k)[w]],
    })
}
