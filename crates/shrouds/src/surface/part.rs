//! A box of a surface, and what its vertices are in the whole.

use std::ops::Range;

use crate::surface::{Crossing, Surface};

/// The piece of a surface between the lattice points of a box, with the numbers that its vertices have in
/// the whole.
pub(crate) struct Part<'a> {
    whole: &'a Surface,
    /// A surface with an open border.
    pub(crate) piece: Surface,
    /// Index of its first lattice point in the whole.
    pub(crate) first: [usize; 3],
}

const EVERYTHING: [Range<usize>; 3] = [0..usize::MAX, 0..usize::MAX, 0..usize::MAX];

impl<'a> Part<'a> {
    pub(crate) fn cut(whole: &'a Surface, ranges: &[Range<usize>; 3]) -> Self {
        let first = ranges.each_ref().map(|range| range.start);
        Self { whole, piece: whole.crop(ranges), first }
    }

    /// What is known of the piece's vertices, from that of the whole surface.
    pub(crate) fn read<T: Copy>(&self, all: &[T], blank: T) -> Vec<T> {
        let mut own = vec![blank; self.piece.vertex_count()];
        self.for_each_row(&EVERYTHING, |_, here, there| own[here].copy_from_slice(&all[there]));
        own
    }

    /// Puts what is known of the piece's vertices to that of all.
    pub(crate) fn write<T: Copy>(&self, own: &[T], all: &mut [T]) {
        self.for_each_row(&EVERYTHING, |_, here, there| all[there].copy_from_slice(&own[here]));
    }

    /// The crossings of the piece in its order, as they are in the whole surface.
    pub(crate) fn crossings(&self) -> impl Iterator<Item = Crossing> {
        self.piece.crossings().map(|crossing| crossing.moved(self.first))
    }

    /// Calls `f` with the vertices of every row, all at once or along each axis, as numbered here and
    /// in the whole surface, and whether their grid edges start within `own`, a box of the whole's
    /// lattice points.
    pub(crate) fn for_each_row(
        &self,
        own: &[Range<usize>; 3],
        mut f: impl FnMut(bool, Range<usize>, Range<usize>),
    ) {
        let [nx, ny, nz] = self.piece.grid().dims();
        let [x0, y0, z0] = self.first;
        let is_whole_row = nx == self.whole.grid().dims()[0];
        let is_all_own = own[0].start <= x0 && x0 + nx <= own[0].end;
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            let here = self.piece.all_row_vertices(j, k);
            if here.is_empty() {
                continue;
            }
            let is_own = own[1].contains(&(y0 + j)) && own[2].contains(&(z0 + k));
            if is_whole_row && is_all_own {
                let there = self.whole.all_row_vertices(y0 + j, z0 + k);
                if here.len() == there.len() {
                    f(is_own, here, there);
                    continue;
                }
                // Grid edges leave the piece here.
            }
            for axis in 0..3 {
                self.for_each_stretch(axis, [j, k], is_own, &own[0], &mut f);
            }
        }
    }

    /// The same for the vertices of one row along one axis; `is_own` where x alone decides.
    fn for_each_stretch(
        &self,
        axis: usize,
        [j, k]: [usize; 2],
        is_own: bool,
        x: &Range<usize>,
        f: &mut impl FnMut(bool, Range<usize>, Range<usize>),
    ) {
        let here = self.piece.row_vertices(axis, j, k);
        if here.is_empty() {
            return;
        }
        let [x0, y0, z0] = self.first;
        let there = self.whole.first_vertex_from(axis, y0 + j, z0 + k, x0);
        let [mut start, mut end] = [here.end; 2];
        if is_own {
            let last = self.piece.grid().dims()[0];
            let place =
                |x: usize| self.piece.first_vertex_from(axis, j, k, x.saturating_sub(x0).min(last));
            [start, end] = [place(x.start), place(x.end)];
        }
        for (is_own, part) in
            [(false, here.start..start), (true, start..end), (false, end..here.end)]
        {
            if !part.is_empty() {
                let shift = |v: usize| there + (v - here.start);
                f(is_own, part.clone(), shift(part.start)..shift(part.end));
            }
        }
    }
}
