//! A piece of the surface that is worked on alone while all else stays where it is.

use std::ops::Range;

use crate::network::Network;
use crate::surface::Surface;

/// Lattice rows a tile holds beyond its own: three vertices away along a curve, and the upper ends of
/// grid edges.
const BELOW: usize = 3;
const ABOVE: usize = 4;

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

    /// What is known of the tile's vertices, from that of the whole surface; `missing` for grid edges
    /// that leave the piece there and not in the surface.
    pub(super) fn read<T: Copy>(&self, x: &[T], missing: T) -> Vec<T> {
        let mut own = vec![missing; self.piece.vertex_count()];
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

    /// Calls `f` with the vertices of every row, all at once or along each axis, as numbered here and
    /// in the whole surface, and whether the row is the tile's own.
    fn for_each_row(&self, mut f: impl FnMut(bool, Range<usize>, Range<usize>)) {
        let [_, ny, nz] = self.piece.grid().dims();
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            let here = self.piece.all_row_vertices(j, k);
            if here.is_empty() {
                continue;
            }
            let (y, z) = (self.first[0] + j, self.first[1] + k);
            let is_own = self.rows.y.contains(&y) && self.rows.z.contains(&z);
            let there = self.whole.all_row_vertices(y, z);
            if here.len() == there.len() {
                f(is_own, here, there);
                continue;
            }
            // Grid edges leave the piece here.
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
        let inner =
            (1..parts + half).map(|n| range.start + (2 * n - half) * range.len() / (2 * parts));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Border, FaceRule, phantom};

    fn surfaces() -> Vec<Surface> {
        let volumes = [phantom::gyroid(64), phantom::sphere(100), phantom::linked_tori(70)];
        let extract = |volume| Surface::extract(&volume, FaceRule::Separate, Border::Closed);
        volumes.into_iter().map(|volume| extract(volume.unwrap()).unwrap()).collect()
    }

    #[test]
    fn tiles_of_one_colour_are_far_apart_and_all_hold_every_row_once() {
        for surface in surfaces() {
            let [_, ny, nz] = surface.grid().dims();
            for shifted in [false, true] {
                let colours = partition(&surface, 3000, shifted);
                assert!(colours.iter().flatten().count() > 1);
                let mut held = vec![0; ny * nz];
                for tile in colours.iter().flatten() {
                    for (j, k) in tile.z.clone().flat_map(|k| tile.y.clone().map(move |j| (j, k))) {
                        held[k * ny + j] += 1;
                    }
                }
                assert!(held.iter().all(|&count| count == 1));
                for tiles in colours {
                    for (n, a) in tiles.iter().enumerate() {
                        for b in &tiles[..n] {
                            let gap = |a: &Range<usize>, b: &Range<usize>| {
                                a.start.max(b.start).saturating_sub(a.end.min(b.end))
                            };
                            let apart = gap(&a.y, &b.y).max(gap(&a.z, &b.z));
                            assert!(apart > BELOW + ABOVE, "{a:?} and {b:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_read_is_written_back_to_its_place() {
        for surface in surfaces() {
            let x: Vec<f32> = (0..surface.vertex_count()).map(|v| v as f32).collect();
            let mut back = vec![-1.0; x.len()];
            for rows in partition(&surface, 3000, true).into_iter().flatten() {
                let tile = Tile::cut(&surface, rows);
                let own = tile.read(&x, -2.0);
                assert_eq!(own.len(), tile.network.vertex_count());
                tile.write(&own, &mut back);
            }
            assert_eq!(back, x);
        }
    }
}
