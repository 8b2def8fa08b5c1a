//! A piece of the surface that is worked on alone while all else stays where it is.

use std::ops::Range;

use crate::network::Network;
use crate::surface::Surface;

/// Lattice rows a tile holds beyond its own: two vertices away along a curve, and the upper ends of
/// grid edges.
const BELOW: usize = 2;
const ABOVE: usize = 3;

/// Smallest edge of a tile in lattice rows; those around it are worked on twice.
const MIN_EDGE: f64 = 24.0;

/// The rows of a tile: those of some slices between two y indices, whole along x.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TileRows {
    pub(super) y: Range<usize>,
    pub(super) z: Range<usize>,
}

impl TileRows {
    /// The rows of a whole surface.
    pub(super) fn all(surface: &Surface) -> Self {
        let [_, ny, nz] = surface.grid().dims();
        Self { y: 0..ny, z: 0..nz }
    }
}

/// The curves through some lattice rows, with enough around them to know their energy.
pub(super) struct Tile<'a> {
    whole: &'a Surface,
    rows: TileRows,
    /// The piece of the volume, from lattice row and slice `first` on.
    piece: Surface,
    first: [usize; 2],
    pub(super) network: Network,
}

impl<'a> Tile<'a> {
    pub(super) fn cut(whole: &'a Surface, rows: TileRows) -> Self {
        let [_, ny, nz] = whole.grid().dims();
        let widened = |own: &Range<usize>, count: usize| {
            own.start.saturating_sub(BELOW)..count.min(own.end + ABOVE)
        };
        let (y, z) = (widened(&rows.y, ny), widened(&rows.z, nz));
        let first = [y.start, z.start];
        let piece = whole.crop(y, z);
        let network = Network::trace(&piece);
        Self { whole, rows, piece, first, network }
    }

    /// The positions of the tile's vertices among those of the whole surface.
    pub(super) fn read(&self, x: &[f32]) -> Vec<f32> {
        // Grid edges that leave the piece are no part of it, all others are.
        let mut own = vec![0.5; self.piece.vertex_count()];
        self.for_each_row(|_, here, there| own[here].copy_from_slice(&x[there]));
        own
    }

    /// Puts what is known of the vertices of the tile's own rows to that of all.
    pub(super) fn write<T: Copy>(&self, own: &[T], all: &mut [T]) {
        self.for_each_row(|is_own, here, there| {
            if is_own {
                all[there].copy_from_slice(&own[here]);
            }
        });
    }

    /// Which vertices belong to rows of others.
    pub(super) fn is_fixed(&self) -> Vec<bool> {
        let mut fixed = vec![true; self.piece.vertex_count()];
        self.for_each_row(|is_own, here, _| fixed[here].fill(!is_own));
        fixed
    }

    /// Calls `f` with the vertices of every row along each axis, as numbered here and in the whole
    /// surface, and whether the row is the tile's own.
    fn for_each_row(&self, mut f: impl FnMut(bool, Range<usize>, Range<usize>)) {
        let [_, ny, nz] = self.piece.grid().dims();
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            let (y, z) = (self.first[0] + j, self.first[1] + k);
            let is_own = self.rows.y.contains(&y) && self.rows.z.contains(&z);
            for axis in 0..3 {
                let here = self.piece.row_vertices(axis, j, k);
                if !here.is_empty() {
                    f(is_own, here, self.whole.row_vertices(axis, y, z));
                }
            }
        }
    }
}

/// Cuts the lattice rows that the surface passes into tiles of about `vertices` vertices each, four
/// colours of them: two tiles of one colour never touch. With `shifted` the borders run through the
/// middles of the tiles without.
pub(super) fn partition(surface: &Surface, vertices: usize, shifted: bool) -> [Vec<TileRows>; 4] {
    let [_, ny, nz] = surface.grid().dims();
    let mut colours: [Vec<TileRows>; 4] = Default::default();
    let count = surface.vertex_count().div_ceil(vertices);
    let occupied = surface.occupied_rows();
    // Square tiles over the rows between the first and the last with vertices.
    let area: usize = occupied.iter().map(|range| range.len()).product();
    let edge = (area as f64 / count as f64).sqrt().max(MIN_EDGE);
    let cuts = |range: &Range<usize>, end: usize| -> Vec<usize> {
        let parts = (range.len() as f64 / edge).round().max(1.0) as usize;
        let half = usize::from(shifted && parts > 1);
        let inner = (1..parts + half)
            .map(|n| range.start + (2 * n - half) * range.len() / (2 * parts));
        std::iter::once(0).chain(inner).chain([end]).collect()
    };
    let (y, z) = (cuts(&occupied[0], ny), cuts(&occupied[1], nz));
    for (b, z) in z.windows(2).enumerate() {
        for (a, y) in y.windows(2).enumerate() {
            colours[a % 2 + 2 * (b % 2)].push(TileRows { y: y[0]..y[1], z: z[0]..z[1] });
        }
    }
    colours
}
