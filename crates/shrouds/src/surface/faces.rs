//! The segments of the planar curves on the lattice faces.

use std::sync::LazyLock;

use crate::surface::Surface;
use crate::surface::bits::{mask_below, rank, set_bits};
use crate::surface::cells::rows_around;
use crate::surface::face_rule::segments;
use crate::volume::FaceRule;

/// The segments of a face as pairs of its edges; unused ones are at the end.
#[derive(Default, Clone, Copy)]
struct FaceSegments {
    count: usize,
    ends: [[usize; 2]; 2],
}

/// The segments for each of the sixteen corner patterns under a face rule, made on first use.
fn table(rule: FaceRule) -> &'static [FaceSegments; 16] {
    static SEPARATE: LazyLock<[FaceSegments; 16]> = LazyLock::new(|| new(FaceRule::Separate));
    static JOIN: LazyLock<[FaceSegments; 16]> = LazyLock::new(|| new(FaceRule::Join));
    fn new(rule: FaceRule) -> [FaceSegments; 16] {
        std::array::from_fn(|corners| {
            let inside = std::array::from_fn(|q| corners >> q & 1 == 1);
            let mut found = FaceSegments::default();
            for segment in segments(inside, rule) {
                found.ends[found.count] = segment;
                found.count += 1;
            }
            found
        })
    }
    match rule {
        FaceRule::Separate => &SEPARATE,
        FaceRule::Join => &JOIN,
    }
}

impl Surface {
    /// Calls `f` with the ends of every segment of the planar curves on the lattice faces normal to
    /// `normal` whose lowest corner lies in slice `k`: faces within the slice for normal 2, those up
    /// to the next slice for normals 0 and 1.
    ///
    /// Segments run from their first vertex to their second with the inside always on the same side,
    /// on all planes of one family: in the direction of the patches of the cells on the low side.
    pub(crate) fn for_each_segment(&self, normal: usize, k: usize, mut f: impl FnMut(u32, u32)) {
        let [_, ny, nz] = self.grid().dims();
        let (other_rows, other_slices) = [(1, 1), (0, 1), (1, 0)][normal];
        if k + other_slices >= nz {
            return;
        }
        let table = table(self.face_rule);
        for j in 0..ny - other_rows {
            let [low, high] = [k * ny + j, (k + other_slices) * ny + j];
            if self.first_vertex(low) == self.first_vertex(low + other_rows + 1)
                && self.first_vertex(high) == self.first_vertex(high + other_rows + 1)
            {
                continue;
            }
            let mut emit = |corners: usize, vertices: [u32; 4]| {
                let found = &table[corners];
                for [from, to] in &found.ends[..found.count] {
                    f(vertices[*from], vertices[*to]);
                }
            };
            match normal {
                0 => self.faces_across(j, k, &mut emit),
                1 => self.faces_along([[j, k], [j, k + 1]], normal, &mut emit),
                _ => self.faces_along([[j, k], [j + 1, k]], normal, &mut emit),
            }
        }
    }

    /// The faces normal to x between the rows `(j, k)` and `(j + 1, k + 1)`.
    fn faces_across(&self, j: usize, k: usize, emit: &mut impl FnMut(usize, [u32; 4])) {
        let [_, ny, _] = self.grid().dims();
        let (low, high) = (k * ny + j, (k + 1) * ny + j);
        let [a, b, d] = [self.rows[low], self.rows[low + 1], self.rows[high]];
        // First vertices on the edges in cyclic order: along y, up z, back along y, down z.
        let mut first = [a[1], b[2], d[1], a[2]];
        let [a, b, d, c] = rows_around(&self.volume, j, k);
        let pairs = a.iter().zip(b).zip(c.iter().zip(d));
        for ((&a, &b), (&c, &d)) in pairs {
            if (a ^ b) | (b ^ c) | (c ^ d) == 0 {
                continue;
            }
            let faces = FaceWord::new([a, b, c, d]);
            faces.visit(u64::MAX, first, emit);
            for (first, crossed) in first.iter_mut().zip(faces.crossed) {
                *first += crossed.count_ones();
            }
        }
    }

    /// The faces between two rows that neighbour each other along y (normal 2) or z (normal 1).
    fn faces_along(
        &self,
        rows: [[usize; 2]; 2],
        normal: usize,
        emit: &mut impl FnMut(usize, [u32; 4]),
    ) {
        let [nx, ny, _] = self.grid().dims();
        let [[aj, ak], [bj, bk]] = rows;
        let [a, b] = [self.rows[ak * ny + aj], self.rows[bk * ny + bj]];
        let mut first = [a[0], b[0], a[3 - normal]];
        let (a, b) = (self.volume.row(aj, ak), self.volume.row(bj, bk));
        let nexts = a[1..].iter().zip(&b[1..]).chain([(&0, &0)]);
        for (w, ((&a, &b), (&next_a, &next_b))) in a.iter().zip(b).zip(nexts).enumerate() {
            let (near, far) = ([a, b], [a >> 1 | next_a << 63, b >> 1 | next_b << 63]);
            if (a ^ b) | (a ^ far[0]) | (b ^ far[1]) == 0 {
                continue;
            }
            let cells = mask_below(nx - 1, w);
            let [xa, xb, across] = first;
            let high = across + ((near[0] ^ near[1]) & 1) as u32;
            // Counter-clockwise seen from the normal's high side.
            let (corners, edges) = if normal == 2 {
                ([near[0], far[0], far[1], near[1]], [xa, high, xb, across])
            } else {
                ([near[0], near[1], far[1], far[0]], [across, xb, high, xa])
            };
            FaceWord::new(corners).visit(cells, edges, emit);
            let streams =
                [(near[0] ^ far[0]) & cells, (near[1] ^ far[1]) & cells, near[0] ^ near[1]];
            for (first, stream) in first.iter_mut().zip(streams) {
                *first += stream.count_ones();
            }
        }
    }
}

/// Up to sixty-four neighbouring faces along x.
struct FaceWord {
    /// Bit `n` of each is a corner of face `n`, in cyclic order.
    corners: [u64; 4],
    /// Whether the edge from each corner to the next is crossed.
    crossed: [u64; 4],
}

impl FaceWord {
    #[inline]
    fn new(corners: [u64; 4]) -> Self {
        let [a, b, c, d] = corners;
        Self { corners, crossed: [a ^ b, b ^ c, c ^ d, d ^ a] }
    }

    /// Calls `emit` with the corners and the vertices of every face among `faces` that has any;
    /// `first` are the first vertices on each of the four edges.
    #[inline]
    fn visit(&self, faces: u64, first: [u32; 4], emit: &mut impl FnMut(usize, [u32; 4])) {
        let [a, b, c, _] = self.crossed;
        for bit in set_bits((a | b | c) & faces) {
            let mut vertices = [0; 4];
            let mut corners = 0;
            for q in 0..4 {
                vertices[q] = first[q] + rank(self.crossed[q], bit);
                corners |= (self.corners[q] >> bit & 1) << q;
            }
            emit(corners as usize, vertices);
        }
    }
}
