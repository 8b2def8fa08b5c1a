//! The cells that the surface passes, sixty-four along x at a time.

use crate::surface::Surface;
use crate::surface::bits::{mask_below, rank, set_bits, shifted};
use crate::volume::Occupancy;

/// Up to sixty-four neighbouring cells along x between four rows of lattice points, which are in
/// corner order: `(j, k)`, `(j + 1, k)`, `(j, k + 1)`, `(j + 1, k + 1)`.
pub(super) struct CellWord {
    /// Number of the word in its rows.
    word: usize,
    /// Bit `n` is the low corner of cell `n` on each row.
    near: [u64; 4],
    /// Bit `n` is the high corner of cell `n` on each row.
    far: [u64; 4],
    /// Cells with corners on both sides. Never 0.
    active: u64,
}

impl CellWord {
    /// The cells with corners on both sides.
    #[inline]
    pub(super) fn active(&self) -> u64 {
        self.active
    }

    /// Which cells have each of their twelve edges crossed.
    #[inline]
    pub(super) fn crossed(&self) -> [u64; 12] {
        let [a, b, c, d] = self.near;
        let [e, f, g, h] = self.far;
        [a ^ e, b ^ f, c ^ g, d ^ h, a ^ b, c ^ d, e ^ f, g ^ h, a ^ c, e ^ g, b ^ d, f ^ h]
    }

    /// Inside corners of cell `bit`, a bit each.
    #[inline]
    fn corners(&self, bit: u32) -> u8 {
        let mut corners = 0;
        for row in 0..4 {
            let pair = (self.near[row] >> bit & 1) | (self.far[row] >> bit & 1) << 1;
            corners |= pair << (2 * row);
        }
        corners as u8
    }

    /// The cells that may have more than one loop: those with an ambiguous face, or with two corners
    /// on a body diagonal that differ from all their neighbours. Their corners come along.
    #[inline]
    pub(super) fn entangled(&self, crossed: &[u64; 12]) -> impl Iterator<Item = u8> {
        let [xa, xb, xc, xd, ya, yb, yc, yd, za, zb, zc, zd] = *crossed;
        // The number of crossed edges around a face is even: three make four.
        let faces = (ya & yb & za) | (yc & yd & zb);
        let faces = faces | (xa & xc & za) | (xb & xd & zc);
        let faces = faces | (xa & xb & ya) | (xc & xd & yb);
        let diagonals = (xa & ya & za & xd & yd & zd) | (xa & yc & zb & xd & yb & zc);
        let diagonals = diagonals | (xb & ya & zc & xc & yd & zb) | (xb & yc & zd & xc & yb & za);
        set_bits((faces | diagonals) & self.active).map(|bit| self.corners(bit))
    }
}

/// The rows of lattice points around the row of cells `j` of a layer, in corner order.
#[inline]
pub(super) fn rows_around(volume: &Occupancy, j: usize, layer: usize) -> [&[u64]; 4] {
    [
        volume.row(j, layer),
        volume.row(j + 1, layer),
        volume.row(j, layer + 1),
        volume.row(j + 1, layer + 1),
    ]
}

/// Calls `f` for the words that hold active cells of the row of cells between four rows of lattice
/// points, in corner order, of `cells + 1` points each.
#[inline]
pub(super) fn for_each_word(rows: [&[u64]; 4], cells: usize, mut f: impl FnMut(&CellWord)) {
    let last = rows[0].len() - 1;
    let [a, b, c, d] = rows;
    let [a, b, c, d] = [&a[..=last], &b[..=last], &c[..=last], &d[..=last]];
    if (0..=last).fold(0, |any, w| any | a[w] | b[w] | c[w] | d[w]) == 0 {
        return;
    }
    let any_and_all = |w: usize| (a[w] | b[w] | c[w] | d[w], a[w] & b[w] & c[w] & d[w]);
    let (mut any, mut all) = any_and_all(0);
    for word in 0..=last {
        let (next_any, next_all) = if word < last { any_and_all(word + 1) } else { (0, 0) };
        let active = (any | any >> 1 | next_any << 63) & !(all & (all >> 1 | next_all << 63));
        let active = if word < last { active } else { active & mask_below(cells, word) };
        if active != 0 {
            let near = [a[word], b[word], c[word], d[word]];
            let far = [shifted(a, word), shifted(b, word), shifted(c, word), shifted(d, word)];
            f(&CellWord { word, near, far, active });
        }
        (any, all) = (next_any, next_all);
    }
}

impl Surface {
    /// Calls `f` with the inside corners and the vertices on the twelve edges of every active cell of
    /// a layer, in order. What stands for an edge that is not crossed means nothing, nor do the last
    /// four entries.
    #[inline]
    pub(super) fn for_each_cell(&self, layer: usize, mut f: impl FnMut(u8, &[u32; 16])) {
        let [nx, ny, _] = self.grid().dims();
        for j in 0..ny - 1 {
            let [low, high] = [layer * ny + j, (layer + 1) * ny + j];
            if self.first_vertex(low) == self.first_vertex(low + 2)
                && self.first_vertex(high) == self.first_vertex(high + 2)
            {
                continue;
            }
            let [a, b] = [self.rows[low], self.rows[low + 1]];
            let [c, d] = [self.rows[high], self.rows[high + 1]];
            // The first vertices of the rows of crossings around the cells: four along x, and those
            // along y and z, which serve two cell edges each.
            let mut first = [a[0], b[0], c[0], d[0], a[1], c[1], a[2], b[2]];
            for_each_word(rows_around(&self.volume, j, layer), nx - 1, |word| {
                let crossed = word.crossed();
                let [xa, xb, xc, xd, ya, yb, _, _, za, _, zb, _] = crossed;
                let [p, q, r, s, t, u, v, w] = first;
                let step = |stream: u64| (stream & 1) as u32;
                let base = [
                    p,
                    q,
                    r,
                    s,
                    t,
                    u,
                    t + step(ya),
                    u + step(yb),
                    v,
                    v + step(za),
                    w,
                    w + step(zb),
                ];
                let mut vertices = [0; 16];
                for bit in set_bits(word.active) {
                    for edge in 0..12 {
                        vertices[edge] = base[edge] + rank(crossed[edge], bit);
                    }
                    f(word.corners(bit), &vertices);
                }
                let valid = mask_below(nx - 1, word.word);
                let streams = [xa & valid, xb & valid, xc & valid, xd & valid, ya, yb, za, zb];
                for (first, stream) in first.iter_mut().zip(streams) {
                    *first += stream.count_ones();
                }
            });
        }
    }
}
