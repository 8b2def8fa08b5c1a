//! Vertices by the lattice points at which their grid edges start.

use std::ops::Range;

use crate::error::Error;
use crate::surface::bits::{mask_below, shifted};
use crate::surface::{Surface, extract};
use crate::volume::{Border, FaceRule, Occupancy};

/// Lattice points whose indices along x, y, z lie in three ranges.
pub(crate) type Region = [Range<usize>; 3];

impl Surface {
    /// All lattice points.
    pub(crate) fn points(&self) -> Region {
        self.grid().dims().map(|count| 0..count)
    }

    /// Some lattice points with those up to so many steps below and above, as far as there are any.
    pub(crate) fn widened(&self, points: &Region, [below, above]: [usize; 2]) -> Region {
        let dims = self.grid().dims();
        std::array::from_fn(|d| {
            points[d].start.saturating_sub(below)..dims[d].min(points[d].end + above)
        })
    }

    /// The surface of some lattice points, as far as it lies between them.
    pub(crate) fn crop(&self, points: &Region) -> Self {
        extract::number(self.volume.cut_out(points), self.face_rule, Border::Open).0
    }

    /// The surface of lattice points that are a piece of others, as far as it lies between them.
    ///
    /// # Errors
    /// [`Error::TooManyVertices`] beyond [`Surface::MAX_VERTICES`].
    pub(crate) fn of_piece(piece: Occupancy, face_rule: FaceRule) -> Result<Self, Error> {
        let (surface, vertices) = extract::number(piece, face_rule, Border::Open);
        if vertices > Self::MAX_VERTICES {
            return Err(Error::TooManyVertices { vertices, limit: Self::MAX_VERTICES });
        }
        Ok(surface)
    }

    /// The vertices of lattice row `(j, k)` on grid edges along an axis.
    pub(crate) fn row_vertices(&self, axis: usize, j: usize, k: usize) -> Range<usize> {
        let stream = 3 * (k * self.grid().dims()[1] + j) + axis;
        let firsts = self.rows.as_flattened();
        firsts[stream] as usize..firsts[stream + 1] as usize
    }

    /// Those of [`row_vertices`](Self::row_vertices) whose grid edges start at some points of the row.
    pub(crate) fn span_vertices(
        &self,
        axis: usize,
        points: &Range<usize>,
        j: usize,
        k: usize,
    ) -> Range<usize> {
        let row = self.row_vertices(axis, j, k);
        let before = |i| if row.is_empty() { 0 } else { self.vertices_before(axis, i, j, k) };
        let start = row.start + before(points.start);
        start..if points.end >= self.grid().dims()[0] {
            row.end
        } else {
            row.start + before(points.end)
        }
    }

    /// How many grid edges of a row along an axis are crossed that start before point `i`.
    fn vertices_before(&self, axis: usize, i: usize, j: usize, k: usize) -> usize {
        let row = self.volume.row(j, k);
        let beside = match axis {
            0 => row,
            1 => self.volume.row(j + 1, k),
            _ => self.volume.row(j, k + 1),
        };
        let crossed = |w: usize| {
            let other = if axis == 0 { shifted(row, w) } else { beside[w] };
            ((row[w] ^ other) & mask_below(i, w)).count_ones() as usize
        };
        (0..i.div_ceil(64)).map(crossed).sum()
    }

    /// Number of vertices whose grid edges start at some points.
    pub(crate) fn vertices_within(&self, points: &Region) -> usize {
        let [x, y, z] = points;
        let in_row =
            |(j, k)| (0..3).map(|axis| self.span_vertices(axis, x, j, k).len()).sum::<usize>();
        z.clone().flat_map(|k| y.clone().map(move |j| (j, k))).map(in_row).sum()
    }

    /// Calls `f` with the vertices of every row along every axis whose grid edges start at `points` of
    /// `whole`, as they are numbered here and there. This surface is that of a box of it which begins at
    /// `first`.
    pub(crate) fn for_each_row_of(
        &self,
        whole: &Self,
        first: [usize; 3],
        points: &Region,
        mut f: impl FnMut(Range<usize>, Range<usize>),
    ) {
        let dims = self.grid().dims();
        let [x, y, z]: Region = std::array::from_fn(|d| {
            let end = points[d].end.saturating_sub(first[d]).min(dims[d]);
            points[d].start.saturating_sub(first[d])..end
        });
        for (k, j) in z.flat_map(|k| y.clone().map(move |j| (k, j))) {
            for axis in 0..3 {
                let here = self.span_vertices(axis, &x, j, k);
                if !here.is_empty() {
                    let x = x.start + first[0]..x.end + first[0];
                    let there = whole.span_vertices(axis, &x, j + first[1], k + first[2]);
                    // Grid edges leave the box at its end.
                    let count = here.len();
                    f(here, there.start..there.start + count);
                }
            }
        }
    }

    /// Between which y and z indices there are vertices.
    pub(crate) fn occupied_rows(&self) -> [Range<usize>; 2] {
        let [_, ny, nz] = self.grid().dims();
        let is_empty = |row: usize| self.first_vertex(row) == self.first_vertex(row + 1);
        let filled = |count: usize, is_filled: &dyn Fn(usize) -> bool| {
            let first = (0..count).find(|&n| is_filled(n)).unwrap_or_default();
            first..(0..count).rfind(|&n| is_filled(n)).map_or(first, |last| last + 1)
        };
        let z = filled(nz, &|k| !self.slice_vertices(k).is_empty());
        let y = filled(ny, &|j| z.clone().any(|k| !is_empty(k * ny + j)));
        [y, z]
    }
}
