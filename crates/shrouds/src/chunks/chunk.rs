//! One chunk with what lies around it.

use crate::chunks::Layout;
use crate::error::Error;
use crate::optimize::{self, FixedPass, Piece, Settings, Tiling, fixed_passes, shares};
use crate::surface::{Region, Surface};
use crate::volume::{FaceRule, Occupancy};

/// The passes that find the positions, and what they are to find.
pub struct Passes {
    settings: Settings,
    passes: Vec<FixedPass>,
}

impl Passes {
    /// Those of some settings.
    ///
    /// # Errors
    /// [`Error::Setting`] for what looks at the whole surface at once: `exact`, the sweeps, kept
    /// volumes, creases, rough places, intervals, a random start, a number of iterations.
    pub fn new(settings: &Settings) -> Result<Self, Error> {
        Ok(Self { passes: fixed_passes(settings)?, settings: settings.clone() })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.passes.len()
    }

    /// The mean energy to hand to pass `n`, where the one before found this for all chunks.
    ///
    /// # Panics
    /// When there is no such pass.
    pub fn mean_energy(&self, n: usize, before: &[u64], vertices: u64) -> Option<f64> {
        let sum = optimize::EnergySum(before.iter().sum());
        (!self.passes[n].is_first).then(|| sum.mean(vertices))
    }
}

/// What a pass finds for a chunk.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Relaxed {
    /// Its shares in positions along grid edges, in the order of [`Chunk::shared_rows`].
    pub shares: Vec<u32>,
    /// The slopes of the curves at the chunk's vertices, in the order of [`Chunk::rows`], see
    /// [`Optimum::slopes`](crate::optimize::Optimum::slopes).
    pub slopes: Vec<[f32; 2]>,
    /// The energy of these vertices, in whole units.
    pub energy: u64,
}

/// A chunk, with as much of the volume around it as its surface depends on.
///
/// Values of vertices come in arrays of two kinds: those of the *chunk*, in the order of [`Chunk::rows`], and
/// those that are *known*, [`Chunk::known_count`] of them, with those around it.
pub struct Chunk<'a> {
    pub(super) layout: &'a Layout,
    pub(super) index: [usize; 3],
    volume: Occupancy,
    /// The surface of what is known, and the lattice point where it begins.
    pub(super) surface: Surface,
    pub(super) first: [usize; 3],
}

impl<'a> Chunk<'a> {
    /// A chunk, where `voxels` gives those of each of [`Layout::around`].
    ///
    /// # Errors
    /// Those of `voxels`; [`Error::Length`] when it gives a volume of other dimensions than the chunk's.
    pub fn new<E: From<Error>>(
        layout: &'a Layout,
        index: [usize; 3],
        faces: FaceRule,
        mut voxels: impl FnMut([usize; 3]) -> Result<Occupancy, E>,
    ) -> Result<Self, E> {
        let piece = layout.piece(index);
        let start = piece.each_ref().map(|range| range.start);
        let grid = layout.lattice().window(start.map(|x| x as isize), piece.map(|x| x.len()));
        let mut volume = Occupancy::empty(grid);
        for chunk in layout.around(index) {
            let part = voxels(chunk)?;
            let ranges = layout.voxels(chunk);
            let (dims, expected) = (part.grid().dims(), ranges.each_ref().map(|x| x.len()));
            if dims != expected {
                let values = part.grid().point_count();
                let points = expected.iter().product();
                return Err(Error::Length { values, dims: expected, points }.into());
            }
            let place = |d: usize| (ranges[d].start + layout.margin()) as isize - start[d] as isize;
            volume.paste([0, 1, 2].map(place), &part);
        }
        let known = layout.known(index);
        let first = known.each_ref().map(|range| range.start);
        let within = std::array::from_fn(|d| known[d].start - start[d]..known[d].end - start[d]);
        let surface = Surface::of_piece(volume.cut_out(&within), faces)?;
        Ok(Self { layout, index, volume, surface, first })
    }

    /// Number of vertices that are known.
    pub fn known_count(&self) -> usize {
        self.surface.vertex_count()
    }

    /// The numbers of the first vertices of the rows of the chunk, and how many vertices it has.
    ///
    /// Rows come by z, then y, each along the grid edges of all axes, one after another; the vertices
    /// of a row in the order of growing x. Without any vertex there are no rows.
    pub fn rows(&self) -> Vec<u32> {
        self.rows_of(&self.layout.own(self.index))
    }

    /// The same for the vertices that the chunk has a share in: its own and some around them.
    pub fn shared_rows(&self) -> Vec<u32> {
        self.rows_of(&self.layout.shared(self.index))
    }

    fn rows_of(&self, points: &Region) -> Vec<u32> {
        let mut rows = vec![0];
        let mut count = 0;
        self.for_each_row(points, |_, range| {
            count += range.len() as u32;
            rows.push(count);
        });
        if count == 0 { Vec::new() } else { rows }
    }

    /// The known values of the vertices of a chunk beside this one, or of itself, among those that are
    /// known here.
    ///
    /// # Errors
    /// [`Error::Chunk`] when the values or the rows are not those of that chunk.
    ///
    /// # Panics
    /// When `known` has not one value for each vertex that is known.
    pub fn take<T: Copy>(
        &self,
        chunk: [usize; 3],
        rows: &[u32],
        values: &[T],
        known: &mut [T],
    ) -> Result<(), Error> {
        let own = self.layout.own(chunk);
        self.merge(chunk, &own, rows, values, known, |known, value| *known = value)
    }

    /// Adds the shares of a chunk [`beside`](Layout::beside) this one, or of itself, to those of the vertices
    /// that are known here. `rows` are its [`shared_rows`](Self::shared_rows).
    ///
    /// # Errors
    /// [`Error::Chunk`] when the shares or the rows are not those of that chunk.
    ///
    /// # Panics
    /// When `known` has not one share for each vertex that is known.
    pub fn add(
        &self,
        chunk: [usize; 3],
        rows: &[u32],
        shares: &[u32],
        known: &mut [u32],
    ) -> Result<(), Error> {
        let shared = self.layout.shared(chunk);
        // Of damaged files the sum may be anything.
        let add = |known: &mut u32, share| *known = known.wrapping_add(share);
        self.merge(chunk, &shared, rows, shares, known, add)
    }

    /// The positions that the shares of all chunks beside this one make together, from the low ends of the
    /// grid edges, in edge lengths.
    pub fn positions(&self, passes: &Passes, shares: &[u32]) -> Vec<f32> {
        shares::positions(&passes.settings, shares)
    }

    /// Brings values of the vertices of some points, those of another chunk, together with those known here.
    fn merge<T: Copy>(
        &self,
        chunk: [usize; 3],
        points: &Region,
        rows: &[u32],
        values: &[T],
        known: &mut [T],
        mut merge: impl FnMut(&mut T, T),
    ) -> Result<(), Error> {
        assert_eq!(known.len(), self.known_count(), "one value per known vertex");
        let here = self.layout.known(self.index);
        let common: Region = std::array::from_fn(|d| {
            points[d].start.max(here[d].start)..points[d].end.min(here[d].end)
        });
        let begins = common[0].start == points[0].start;
        let mut fits = true;
        self.for_each_row(&common, |[axis, j, k], here| {
            if here.is_empty() {
                return;
            }
            let row = (k - points[2].start) * points[1].len() + j - points[1].start;
            let ends = (rows.get(3 * row + axis), rows.get(3 * row + axis + 1));
            let (Some(&start), Some(&end)) = ends else { return fits = false };
            // What is known of a row is its beginning or its end.
            let start =
                if begins { start as usize } else { (end as usize).wrapping_sub(here.len()) };
            match values.get(start..start.wrapping_add(here.len())) {
                Some(values) => {
                    known[here].iter_mut().zip(values).for_each(|(a, &b)| merge(a, b));
                }
                None => fits = false,
            }
        });
        if fits { Ok(()) } else { Err(Error::Chunk { chunk }) }
    }

    /// Where the known vertices start, for the first of the passes.
    ///
    /// # Errors
    /// None for [`Passes`] that were made by [`Passes::new`].
    pub fn start(&self, passes: &Passes) -> Result<Vec<f32>, Error> {
        self.piece().start(&passes.settings)
    }

    /// Makes pass `n` from the known positions `x`, and with [`Passes::mean_energy`].
    ///
    /// # Panics
    /// When there is no such pass, or not one position for each known vertex.
    pub fn relax(&self, passes: &Passes, n: usize, mean: Option<f64>, x: &[f32]) -> Relaxed {
        assert_eq!(x.len(), self.known_count(), "one position per known vertex");
        let found = self.piece().relax(&passes.settings, &passes.passes[n], mean, x);
        Relaxed {
            shares: self.of_points(&self.layout.shared(self.index), &found.shares),
            slopes: self.of_chunk(&found.slopes),
            energy: found.energy.0,
        }
    }

    pub(super) fn piece(&self) -> Piece<'_> {
        let start = self.layout.piece(self.index).map(|range| range.start);
        let dims = self.layout.grid().dims();
        Piece {
            surface: &self.surface,
            volume: &self.volume,
            first: [0, 1, 2].map(|d| self.first[d] - start[d]),
            tiling: Tiling::of_piece(dims, self.layout.margin(), self.first),
            own: self.local(&self.layout.own(self.index)),
        }
    }

    /// The values of the vertices of the chunk, of those that are known.
    pub(super) fn of_chunk<T: Copy>(&self, known: &[T]) -> Vec<T> {
        self.of_points(&self.layout.own(self.index), known)
    }

    fn of_points<T: Copy>(&self, points: &Region, known: &[T]) -> Vec<T> {
        let mut values = Vec::new();
        self.for_each_row(points, |_, range| values.extend_from_slice(&known[range]));
        values
    }

    /// Points of the lattice as the surface of what is known has them.
    pub(super) fn local(&self, points: &Region) -> Region {
        std::array::from_fn(|d| points[d].start - self.first[d]..points[d].end - self.first[d])
    }

    /// Calls `f` with the axis, the y and z index and the known vertices of each row of some points of
    /// the lattice.
    fn for_each_row(&self, points: &Region, mut f: impl FnMut([usize; 3], std::ops::Range<usize>)) {
        let [x, y, z] = self.local(points);
        for (k, j) in z.flat_map(|k| y.clone().map(move |j| (k, j))) {
            for axis in 0..3 {
                let vertices = self.surface.span_vertices(axis, &x, j, k);
                f([axis, j + self.first[1], k + self.first[2]], vertices);
            }
        }
    }
}
