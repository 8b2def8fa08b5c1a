//! A piece of the surface that is worked on alone while all else stays where it is.

use std::ops::Range;

use crate::network::Network;
use crate::surface::{Part, Surface};

/// Lattice points a tile holds beyond its own along each axis: three vertices away along a curve, and the upper ends of
/// grid edges.
const BELOW: usize = 3;
const ABOVE: usize = 4;

/// Smallest edge of a tile in lattice rows; those around it are worked on twice.
const MIN_EDGE: f64 = 24.0;

/// The curves through the lattice points of a box, with enough around them to know their energy.
pub(super) struct Tile<'a> {
    /// The lattice points where grid edges of the tile's own start.
    own: Range3,
    pub(super) part: Part<'a>,
    pub(super) network: Network,
}

/// A box of lattice points.
type Range3 = [Range<usize>; 3];

/// All lattice points of a surface.
pub(super) fn everything(surface: &Surface) -> Range3 {
    surface.grid().dims().map(|count| 0..count)
}

impl<'a> Tile<'a> {
    pub(super) fn cut(whole: &'a Surface, own: Range3) -> Self {
        let dims = whole.grid().dims();
        let widened = [0, 1, 2].map(|d| {
            own[d].start.saturating_sub(BELOW)..dims[d].min(own[d].end.saturating_add(ABOVE))
        });
        let part = Part::cut(whole, &widened);
        let network = Network::trace(&part.piece);
        Self { own, part, network }
    }

    /// What is known of the tile's vertices, from that of the whole surface.
    pub(super) fn read<T: Copy>(&self, x: &[T], blank: T) -> Vec<T> {
        self.part.read(x, blank)
    }

    /// Puts what is known of the tile's own vertices to that of all.
    pub(super) fn write<T: Copy>(&self, own: &[T], all: &mut [T]) {
        self.for_each_own(|here, there| all[there].copy_from_slice(&own[here]));
    }

    /// Calls `f` with the tile's own vertices, row by row, as numbered here and in the whole surface.
    pub(super) fn for_each_own(&self, mut f: impl FnMut(Range<usize>, Range<usize>)) {
        self.part.for_each_row(&self.own, |is_own, here, there| {
            if is_own {
                f(here, there);
            }
        });
    }

    /// Which vertices belong to others.
    pub(super) fn is_fixed(&self) -> Vec<bool> {
        let mut fixed = vec![true; self.part.piece.vertex_count()];
        self.part.for_each_row(&self.own, |is_own, here, _| fixed[here].fill(!is_own));
        fixed
    }
}

/// Cuts the lattice rows that the surface passes into tiles of about `vertices` vertices each, four
/// colours of them: two tiles of one colour never touch. With `shifted` the borders run through the
/// middles of the tiles without.
pub(super) fn partition(surface: &Surface, vertices: usize, shifted: bool) -> [Vec<Range3>; 4] {
    let [nx, ny, nz] = surface.grid().dims();
    let mut colours: [Vec<Range3>; 4] = Default::default();
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
            colours[a % 2 + 2 * (b % 2)].push([0..nx, y[0]..y[1], z[0]..z[1]]);
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
                for [_, y, z] in colours.iter().flatten() {
                    for (j, k) in z.clone().flat_map(|k| y.clone().map(move |j| (j, k))) {
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
                            let apart = gap(&a[1], &b[1]).max(gap(&a[2], &b[2]));
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
            // Halves and a rest of rows too.
            let cut = |[x, y, z]: Range3| {
                let parts = [0..x.end / 2, x.end / 2..x.end - 9, x.end - 9..x.end];
                parts.map(|x| [x, y.clone(), z.clone()])
            };
            for own in partition(&surface, 3000, true).into_iter().flatten().flat_map(cut) {
                let tile = Tile::cut(&surface, own);
                let own = tile.read(&x, -2.0);
                assert_eq!(own.len(), tile.network.vertex_count());
                tile.write(&own, &mut back);
            }
            assert_eq!(back, x);
        }
    }
}
