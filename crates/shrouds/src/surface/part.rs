//! A box of a surface, and what its vertices are in the whole.

use std::ops::Range;

use crate::surface::{Crossing, Region, Surface};

/// The piece of a surface between the lattice points of a box, with the numbers that its vertices have in
/// the whole.
pub(crate) struct Part<'a> {
    whole: &'a Surface,
    /// A surface with an open border.
    pub(crate) piece: Surface,
    /// Index of its first lattice point in the whole.
    pub(crate) first: [usize; 3],
}

impl<'a> Part<'a> {
    pub(crate) fn cut(whole: &'a Surface, points: &Region) -> Self {
        let first = points.each_ref().map(|range| range.start);
        Self { whole, piece: whole.crop(points), first }
    }

    /// What is known of the piece's vertices, from that of the whole surface; `missing` for grid edges
    /// that leave the piece there and not in the whole.
    pub(crate) fn read<T: Copy>(&self, all: &[T], missing: T) -> Vec<T> {
        let mut own = vec![missing; self.piece.vertex_count()];
        self.for_each_row(&self.whole.points(), |here, there| {
            own[here].copy_from_slice(&all[there]);
        });
        own
    }

    /// Puts what is known of the vertices whose grid edges start at some points of the whole to that of
    /// all.
    pub(crate) fn write<T: Copy>(&self, points: &Region, own: &[T], all: &mut [T]) {
        self.for_each_row(points, |here, there| all[there].copy_from_slice(&own[here]));
    }

    /// The crossings of the piece in its order, as they are in the whole surface.
    pub(crate) fn crossings(&self) -> impl Iterator<Item = Crossing> {
        self.piece.crossings().map(|crossing| crossing.moved(self.first))
    }

    /// Calls `f` with the vertices of every lattice row along every axis whose grid edges start at some
    /// points of the whole, as numbered here and there.
    pub(crate) fn for_each_row(&self, points: &Region, f: impl FnMut(Range<usize>, Range<usize>)) {
        self.piece.for_each_row_of(self.whole, self.first, points, f);
    }
}
