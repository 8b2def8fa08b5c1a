//! The patches of a cell for each of the 256 corner patterns.
//!
//! Corner `c` of a cell lies at `(c & 1, c >> 1 & 1, c >> 2 & 1)`. Edge `4·axis + a + 2·b` runs along
//! `axis`, offset by `a` along the next axis and by `b` along the one after it.

use std::sync::LazyLock;

use crate::surface::face_rule::segments;
use crate::surface::triangulation::{MAX_CORNERS, cheapest};
use crate::volume::FaceRule;

/// One closed loop of crossings in a cell.
#[derive(Debug, Clone)]
pub struct LoopShape {
    edges: Vec<u8>,
    /// Bit `j` of `legal[i]`: corners `i` and `j` do not lie on a common cell face.
    legal: [u8; MAX_CORNERS],
    fixed: Vec<[u8; 3]>,
    twins: Vec<[u8; 2]>,
    /// Slots of each segment.
    slots: Vec<[u8; 2]>,
    free: bool,
}

impl LoopShape {
    /// Whether corners `i` and `j` of the loop may be joined by a diagonal.
    ///
    /// A diagonal on a cell face could be chosen by both cells that share the face, and four
    /// triangles would meet at it.
    pub fn diagonal_is_legal(&self, i: usize, j: usize) -> bool {
        self.legal[i] >> j & 1 == 1
    }

    /// The fixed triangulation as loop corner numbers: legal, with the shortest diagonals between the
    /// middles of the grid edges.
    #[inline]
    pub fn fixed(&self) -> &[[u8; 3]] {
        &self.fixed
    }

    /// The fixed triangles of a patch of this shape, as vertex indices.
    pub(crate) fn fixed_triangles(&self, patch: &[u32]) -> impl Iterator<Item = [u32; 3]> {
        self.fixed.iter().map(move |t| t.map(|corner| patch[usize::from(corner)]))
    }

    /// The cell of the loop as seen from the grid edge of corner `i`, which four cells surround: bit
    /// 0 is set when the cell lies on the high side along the axis after the edge's own, bit 1 along
    /// the one after that.
    pub fn quadrant(&self, i: usize) -> usize {
        usize::from(!self.edges[i] & 3)
    }

    /// Whether the loop may be cut in any way: it is the only one of its cell, touches no cell face
    /// twice, has at most six corners, and all its diagonals are legal.
    pub fn is_free(&self) -> bool {
        self.free
    }

    /// The slots of the network, as numbered there, in which the two ends of segment `n` have each
    /// other: of its first corner and of its second.
    pub(crate) fn slots(&self, n: usize) -> [usize; 2] {
        self.slots[n].map(usize::from)
    }

    /// Pairs of loop segments that lie on the same cell face, which then is ambiguous. Segment `n`
    /// joins corner `n` to the next one.
    pub fn twins(&self) -> &[[u8; 2]] {
        &self.twins
    }

    /// The cell edges of the loop's corners.
    #[inline]
    pub(crate) fn edges(&self) -> &[u8] {
        &self.edges
    }
}

/// The loops of all corner patterns under one face rule.
pub(crate) struct CellTable {
    shapes: Vec<LoopShape>,
    /// Loops of pattern `p` are `shapes[starts[p]..starts[p + 1]]`.
    starts: [u16; 257],
    /// The fixed triangles of all loops of a pattern, as cell edges.
    triangles: Vec<Vec<[u8; 3]>>,
}

impl CellTable {
    /// The loops of a cell with these inside corners (bit `c` for corner `c`).
    #[inline]
    pub(crate) fn loops(&self, corners: u8) -> &[LoopShape] {
        let pattern = usize::from(corners);
        &self.shapes[usize::from(self.starts[pattern])..usize::from(self.starts[pattern + 1])]
    }

    /// The fixed triangles of all loops of a cell, in order, as cell edges.
    #[inline]
    pub(super) fn triangles(&self, corners: u8) -> &[[u8; 3]] {
        &self.triangles[usize::from(corners)]
    }

    fn new(rule: FaceRule) -> Self {
        let mut table = Self { shapes: Vec::new(), starts: [0; 257], triangles: Vec::new() };
        for pattern in 0..256 {
            let loops = trace_loops(pattern as u8, rule);
            let alone = loops.len() == 1;
            table.shapes.extend(loops.into_iter().map(|edges| loop_shape(edges, alone)));
            table.starts[pattern + 1] = table.shapes.len() as u16;
            let loops = table.loops(pattern as u8).iter();
            let triangles = loops.flat_map(|shape| {
                shape.fixed.iter().map(|t| t.map(|corner| shape.edges[usize::from(corner)]))
            });
            table.triangles.push(triangles.collect());
        }
        table
    }
}

/// The table of a face rule, made on first use.
pub(crate) fn table(rule: FaceRule) -> &'static CellTable {
    static SEPARATE: LazyLock<CellTable> = LazyLock::new(|| CellTable::new(FaceRule::Separate));
    static JOIN: LazyLock<CellTable> = LazyLock::new(|| CellTable::new(FaceRule::Join));
    match rule {
        FaceRule::Separate => &SEPARATE,
        FaceRule::Join => &JOIN,
    }
}

/// Corners of the face normal to `axis` at `side`, counter-clockwise seen from outside the cell.
pub(crate) fn face_corners(axis: usize, side: usize) -> [usize; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| side << axis | a << u | b << v);
    if side == 0 {
        corners.reverse();
    }
    corners
}

/// The edge between two corners.
pub(crate) fn edge_between(a: usize, b: usize) -> usize {
    let axis = (a ^ b).trailing_zeros() as usize;
    4 * axis + (a >> ((axis + 1) % 3) & 1) + 2 * (a >> ((axis + 2) % 3) & 1)
}

/// The two faces an edge lies on, as bits `2·axis + side`.
fn faces_of_edge(edge: usize) -> u8 {
    let (axis, a, b) = (edge / 4, edge & 1, edge >> 1 & 1);
    1 << (2 * ((axis + 1) % 3) + a) | 1 << (2 * ((axis + 2) % 3) + b)
}

/// The closed loops of crossed edges, each starting at its smallest edge.
fn trace_loops(pattern: u8, rule: FaceRule) -> Vec<Vec<u8>> {
    let mut next = [None; 12];
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
        let corners = face_corners(axis, side);
        for segment in segments(corners.map(|c| pattern >> c & 1 == 1), rule) {
            let [from, to] = segment.map(|q| edge_between(corners[q], corners[(q + 1) % 4]));
            next[from] = Some(to);
        }
    }
    let mut loops = Vec::new();
    for start in 0..12 {
        let mut corners = Vec::new();
        let mut edge = start;
        while let Some(to) = next[edge].take() {
            corners.push(edge as u8);
            edge = to;
        }
        if !corners.is_empty() {
            loops.push(corners);
        }
    }
    loops
}

/// The shape of a loop; `alone` if there is no other in its cell.
pub(crate) fn loop_shape(edges: Vec<u8>, alone: bool) -> LoopShape {
    let faces: Vec<u8> = edges.iter().map(|&e| faces_of_edge(usize::from(e))).collect();
    let mut legal = [0; MAX_CORNERS];
    for (i, row) in legal.iter_mut().enumerate().take(edges.len()) {
        *row = (0..edges.len()).fold(0, |bits, j| bits | u8::from(faces[i] & faces[j] == 0) << j);
    }
    let squared_length = |i: usize, j: usize| {
        let (p, q) = (doubled_middle(edges[i]), doubled_middle(edges[j]));
        (0..3).map(|k| (p[k] - q[k]).pow(2)).sum::<i32>()
    };
    let mut fixed = Vec::new();
    // Enumerated over all patterns in the tests below: a legal triangulation always exists.
    let found = cheapest(
        edges.len(),
        |i, j| legal[i] >> j & 1 == 1,
        |i, k, j| squared_length(i, k) + squared_length(k, j) + squared_length(i, j),
        &mut fixed,
    );
    debug_assert!(found, "no legal triangulation of loop {edges:?}");
    let segment_face = |n: usize| faces[n] & faces[(n + 1) % faces.len()];
    let twins: Vec<[u8; 2]> = (0..edges.len())
        .flat_map(|n| (n + 1..edges.len()).map(move |m| [n, m]))
        .filter(|&[n, m]| segment_face(n) & segment_face(m) != 0)
        .map(|pair| pair.map(|n| n as u8))
        .collect();
    let count = edges.len();
    let is_legal = |i: usize, j: usize| legal[i] >> j & 1 == 1;
    let all_legal =
        (0..count).all(|i| (i + 2..count).all(|j| (i, j) == (0, count - 1) || is_legal(i, j)));
    let free = alone && twins.is_empty() && all_legal && count <= 6;
    let slots = (0..count).map(|n| {
        let face = segment_face(n).trailing_zeros() as usize / 2;
        [edges[n], edges[(n + 1) % count]].map(|edge| slot(edge, face))
    });
    LoopShape { slots: slots.collect(), edges, legal, fixed, twins, free }
}

/// The network slot in which a vertex has its neighbour across a cell face normal to `normal`, by
/// the edge of the cell that it lies on.
fn slot(edge: u8, normal: usize) -> u8 {
    let curve = u8::from(normal != (usize::from(edge / 4) + 1) % 3);
    // The curve runs across along the axis whose offset is bit 1 for curve 0, bit 0 for curve 1.
    let high = edge >> (1 - curve) & 1;
    2 * curve + (1 - high)
}

/// Twice the coordinates of the middle of an edge, in cell units.
fn doubled_middle(edge: u8) -> [i32; 3] {
    let axis = usize::from(edge / 4);
    let mut point = [0; 3];
    point[axis] = 1;
    point[(axis + 1) % 3] = 2 * i32::from(edge & 1);
    point[(axis + 2) % 3] = 2 * i32::from(edge >> 1 & 1);
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: [FaceRule; 2] = [FaceRule::Separate, FaceRule::Join];

    fn crossed(pattern: u8, edge: usize) -> bool {
        let axis = edge / 4;
        let low = (edge & 1) << ((axis + 1) % 3) | (edge >> 1 & 1) << ((axis + 2) % 3);
        (pattern >> low ^ pattern >> (low | 1 << axis)) & 1 == 1
    }

    #[test]
    fn loops_of_all_256_cells_use_each_crossed_edge_once() {
        for rule in RULES {
            for pattern in 0..=255u8 {
                let mut used: Vec<usize> = table(rule)
                    .loops(pattern)
                    .iter()
                    .flat_map(|shape| shape.edges().iter().map(|&e| usize::from(e)))
                    .collect();
                used.sort_unstable();
                let expected: Vec<usize> = (0..12).filter(|&e| crossed(pattern, e)).collect();
                assert_eq!(used, expected, "{rule:?} {pattern:08b}");
            }
        }
    }

    #[test]
    fn consecutive_corners_share_a_face_and_fixed_diagonals_do_not() {
        for rule in RULES {
            for pattern in 0..=255 {
                for shape in table(rule).loops(pattern) {
                    let count = shape.edges().len();
                    assert!((3..=7).contains(&count), "{count} corners");
                    assert_eq!(shape.fixed().len(), count - 2);
                    for i in 0..count {
                        assert!(!shape.diagonal_is_legal(i, (i + 1) % count));
                    }
                    for [a, b, c] in shape.fixed().iter().map(|t| t.map(usize::from)) {
                        for (i, j) in [(a, b), (b, c), (a, c)] {
                            let is_side = j == i + 1 || (i == 0 && j == count - 1);
                            assert!(is_side || shape.diagonal_is_legal(i, j));
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn loops_alone_in_their_cell_that_touch_no_face_twice_are_free() {
        for rule in RULES {
            for pattern in 0..=255 {
                let loops = table(rule).loops(pattern);
                for shape in loops {
                    assert_eq!(shape.is_free(), loops.len() == 1 && shape.twins().is_empty());
                }
            }
        }
    }

    /// Directed segments that a pattern's loops lay on one face, as pairs of in-face edges.
    fn face_segments(pattern: u8, rule: FaceRule, axis: usize, side: usize) -> Vec<[usize; 2]> {
        let face = 1u8 << (2 * axis + side);
        let mut found = Vec::new();
        for shape in table(rule).loops(pattern) {
            let edges = shape.edges();
            for (n, &a) in edges.iter().enumerate() {
                let b = edges[(n + 1) % edges.len()];
                let [a, b] = [a, b].map(usize::from);
                if faces_of_edge(a) & faces_of_edge(b) & face != 0 {
                    // The same edges seen from the neighbour lie on its opposite face.
                    let strip = |edge: usize| {
                        let run = edge / 4;
                        let bit = if (run + 1) % 3 == axis { 1 } else { 2 };
                        edge & !bit
                    };
                    found.push([strip(a), strip(b)]);
                }
            }
        }
        found.sort_unstable();
        found
    }

    #[test]
    fn all_pairs_of_adjacent_cells_agree_on_their_face_with_opposite_directions() {
        for rule in RULES {
            for axis in 0..3 {
                let far: Vec<usize> = (0..8).filter(|c| c >> axis & 1 == 1).collect();
                for a in 0..=255u8 {
                    for b in 0..=255u8 {
                        let shared =
                            far.iter().all(|&c| (a >> c ^ b >> (c & !(1 << axis))) & 1 == 0);
                        if !shared {
                            continue;
                        }
                        let here = face_segments(a, rule, axis, 1);
                        let mut there = face_segments(b, rule, axis, 0);
                        there.iter_mut().for_each(|s| s.reverse());
                        there.sort_unstable();
                        assert_eq!(here, there, "{rule:?} axis {axis} {a:08b} {b:08b}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_lone_inside_corner_is_seen_counter_clockwise_from_outside() {
        let shape = &table(FaceRule::Separate).loops(1)[0];
        assert_eq!(shape.edges(), [0, 4, 8], "x, y, z edges at corner 0");
    }
}
