//! A piece of the surface that is worked on alone while all else stays where it is.

use std::ops::Range;

use crate::network::Network;
use crate::surface::{Part, Region, Surface};
use crate::volume::Border;

/// Lattice points a tile knows beyond those it may move: three vertices away along a curve, and the
/// upper ends of grid edges.
pub(crate) const BELOW: usize = 3;
pub(crate) const ABOVE: usize = 4;

/// Smallest edge of a tile of rows in lattice rows; those around it are worked on twice.
const MIN_EDGE: f64 = 24.0;

/// The lattice points of a tile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TilePoints {
    /// Those whose vertices become what the tile finds.
    pub(super) own: Region,
    /// Those whose vertices move: its own, and perhaps some around them, which others find better.
    pub(super) free: Region,
}

impl TilePoints {
    /// Those of a whole surface.
    pub(super) fn all(surface: &Surface) -> Self {
        Self::alone(surface.points())
    }

    /// A tile that moves its own vertices only.
    pub(super) fn alone(own: Region) -> Self {
        Self { free: own.clone(), own }
    }
}

/// The curves through some lattice points, with enough around them to know their energy.
pub(super) struct Tile<'a> {
    pub(super) points: TilePoints,
    pub(super) part: Part<'a>,
    pub(super) network: Network,
}

impl<'a> Tile<'a> {
    pub(super) fn cut(whole: &'a Surface, points: TilePoints) -> Self {
        let part = Part::cut(whole, &whole.widened(&points.free, [BELOW, ABOVE]));
        let network = Network::trace(&part.piece);
        Self { points, part, network }
    }

    /// What is known of the tile's vertices, from that of the whole surface; `missing` for grid edges
    /// that leave the tile there and not in the surface.
    pub(super) fn read<T: Copy>(&self, all: &[T], missing: T) -> Vec<T> {
        self.part.read(all, missing)
    }

    /// Puts what is known of the tile's own vertices to that of all.
    pub(super) fn write<T: Copy>(&self, own: &[T], all: &mut [T]) {
        self.part.write(&self.points.own, own, all);
    }

    /// The tile's own vertices, row by row, as numbered here and in the whole surface.
    pub(super) fn own_rows(&self) -> Vec<[Range<usize>; 2]> {
        let mut rows = Vec::new();
        self.part.for_each_row(&self.points.own, |here, there| rows.push([here, there]));
        rows
    }

    /// Which vertices must stay where they are.
    pub(super) fn is_fixed(&self) -> Vec<bool> {
        self.is_beyond(&self.points.free)
    }

    /// Which vertices others have.
    pub(super) fn is_foreign(&self) -> Vec<bool> {
        self.is_beyond(&self.points.own)
    }

    fn is_beyond(&self, points: &Region) -> Vec<bool> {
        let mut beyond = vec![true; self.part.piece.vertex_count()];
        self.part.for_each_row(points, |here, _| beyond[here].fill(false));
        beyond
    }
}

/// Cuts the lattice rows that the surface passes into tiles of about `vertices` vertices each, four
/// colours of them: two tiles of one colour never touch. With `shifted` the borders run through the
/// middles of the tiles without.
pub(super) fn partition(surface: &Surface, vertices: usize, shifted: bool) -> [Vec<TilePoints>; 4] {
    let [nx, ny, nz] = surface.grid().dims();
    let mut colours: [Vec<TilePoints>; 4] = Default::default();
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
            let own = [0..nx, y[0]..y[1], z[0]..z[1]];
            colours[a % 2 + 2 * (b % 2)].push(TilePoints::alone(own));
        }
    }
    colours
}

/// Edge of a block of the lattice in voxels; blocks with many vertices are cut into tiles, others are one.
pub(crate) const BLOCK: usize = 128;
/// Smallest edge of such a tile, and the most vertices of one that can be cut.
const EDGE: usize = 64;
const MOST: usize = 75_000;
/// How many lattice points around its own a tile moves too. Where tiles meet, positions go over from what
/// one finds to what the other does, over twice as many points (see [`shares`](crate::optimize::shares)).
pub(crate) const HALO: usize = 2;

/// Where the tiles of a lattice meet: after every [`BLOCK`] voxels, and half-way where there are many
/// vertices between. The layers of a closed border belong to the tiles they touch. A tile depends on the
/// block it lies in and on nothing else.
#[derive(Debug, Clone)]
pub(crate) struct Tiling {
    /// Voxels along x, y, z.
    voxels: [usize; 3],
    /// Layers around them.
    margin: usize,
    /// The lattice point at which the piece begins that is cut into tiles.
    first: [usize; 3],
}

impl Tiling {
    /// That of a whole surface.
    pub(crate) fn of(surface: &Surface) -> Self {
        let margin = usize::from(surface.border() == Border::Closed);
        let voxels = surface.grid().dims().map(|points| points - 2 * margin);
        Self { voxels, margin, first: [0; 3] }
    }

    /// That of a piece of it, which begins at lattice point `first`.
    pub(crate) fn of_piece(voxels: [usize; 3], margin: usize, first: [usize; 3]) -> Self {
        Self { voxels, margin, first }
    }

    /// The tiles of some points of the piece that move vertices, block by block, x fastest.
    pub(super) fn tiles(&self, piece: &Surface, points: &Region) -> Vec<TilePoints> {
        let [x, y, z] = [0, 1, 2].map(|d| self.parts(d, &points[d], BLOCK));
        let mut tiles = Vec::new();
        for (z, y) in z.iter().flat_map(|z| y.iter().map(move |y| (z, y))) {
            for x in &x {
                self.cut(piece, [x, y, z].map(Range::clone), &mut tiles);
            }
        }
        tiles
    }

    /// Cuts a part of a block into tiles, across z first: rows of bits stay long.
    fn cut(&self, piece: &Surface, own: Region, tiles: &mut Vec<TilePoints>) {
        let count = piece.vertices_within(&own);
        if count > MOST {
            for d in [2, 1, 0] {
                if let [low, high] = &self.parts(d, &own[d], EDGE)[..] {
                    for half in [low, high] {
                        let mut part = own.clone();
                        part[d] = half.clone();
                        self.cut(piece, part, tiles);
                    }
                    return;
                }
            }
        }
        let free = piece.widened(&own, [HALO; 2]);
        if piece.vertices_within(&free) > 0 {
            tiles.push(TilePoints { own, free });
        }
    }

    /// A range of indices of the piece, cut after every `edge` voxels of the lattice.
    fn parts(&self, axis: usize, range: &Range<usize>, edge: usize) -> Vec<Range<usize>> {
        let cuts = (1..self.voxels[axis].div_ceil(edge)).map(|n| self.margin + n * edge);
        let inner = cuts
            .filter_map(|cut| cut.checked_sub(self.first[axis]))
            .filter(|cut| range.start < *cut && *cut < range.end);
        let ends: Vec<usize> =
            std::iter::once(range.start).chain(inner).chain([range.end]).collect();
        ends.windows(2).map(|pair| pair[0]..pair[1]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::volume::{FaceRule, Occupancy, phantom};

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
                    let [_, y, z] = tile.own.clone();
                    for (j, k) in z.flat_map(|k| y.clone().map(move |j| (j, k))) {
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
                            let [_, y, z] = [0, 1, 2].map(|n| gap(&a.own[n], &b.own[n]));
                            let apart = y.max(z);
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

    #[test]
    fn tiles_of_the_lattice_hold_every_vertex_once() {
        // Blocks that are not cut, one beside, and blocks that are, one of them smaller than the others.
        let volumes = [phantom::sphere(150), phantom::gyroid(131)];
        for volume in volumes {
            let surface = Surface::extract(&volume.unwrap(), FaceRule::Join, Border::Closed);
            let surface = &surface.unwrap();
            let tiles = Tiling::of(surface).tiles(surface, &surface.points());
            assert!(tiles.len() > 1);
            let mut held = vec![0; surface.vertex_count()];
            for points in tiles {
                let tile = Tile::cut(surface, points);
                let mut once = held.clone();
                once.iter_mut().for_each(|count| *count += 1);
                tile.write(&tile.read(&once, 0), &mut held);
            }
            assert!(held.iter().all(|&count| count == 1));
        }
    }

    #[test]
    fn pieces_of_a_lattice_have_its_tiles() {
        // Plates, so many in the first blocks that these are cut.
        let grid = Grid::new([300, 70, 70], [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid, |[i, _, _]| i / 3 % 2 == 0);
        let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
        let of_whole = Tiling::of(&surface).tiles(&surface, &surface.points());
        let first = [100, 0, 0];
        let piece = surface.crop(&[100..300, 0..72, 0..72]);
        let tiling = Tiling::of_piece([300, 70, 70], 1, first);
        let of_piece = tiling.tiles(&piece, &[29..157, 0..72, 0..72]);
        assert_eq!(of_piece.len(), 4);
        let in_whole = of_piece.iter().map(|tile| {
            let own: Region =
                std::array::from_fn(|d| tile.own[d].start + first[d]..tile.own[d].end + first[d]);
            of_whole.iter().any(|whole| whole.own == own)
        });
        assert_eq!(in_whole.min(), Some(true));
    }
}
