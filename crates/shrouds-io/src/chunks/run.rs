//! From voxels to the positions of all vertices.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use shrouds::chunks::{Chunk, ChunkMesh, Layout, Passes};
use shrouds::volume::Border;
use shrouds::{Occupancy, Settings};

use crate::atomic::write_atomically;
use crate::chunks::artefact::Artefact;
use crate::chunks::{COARSER, IDENTITY};
use crate::error::Error;

/// What the voxels of a chunk are all; anything else where they differ.
const ALL_OUTSIDE: u64 = 0;
const ALL_INSIDE: u64 = 1;
const MIXED: u64 = 2;

/// The work on a surface in chunks, with a folder for what is found.
///
/// The steps are, in this order, each for all chunks before the next begins: [`put_voxels`](Self::put_voxels);
/// for every pass [`relax`](Self::relax), and once [`finish`](Self::finish); then
/// [`write_piece`](Self::write_piece) and [`join`](Self::join), or [`write_part`](Self::write_part), or, with the
/// feature `draco`, `write_fragments` here and for `coarser` runs, and `join_levels`.
pub struct ChunkRun {
    pub(super) folder: PathBuf,
    pub(super) layout: Layout,
    pub(super) settings: Settings,
    passes: Passes,
    is_continued: bool,
}

/// What a pass found for all chunks together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Totals {
    /// Vertices of the surface.
    pub vertices: u64,
    /// Triangles of the surface, after the last pass.
    pub triangles: u64,
    /// Its energy, in the units of [`shrouds::chunks::Relaxed`].
    pub energy: u64,
}

/// What a pass found for a chunk.
#[derive(Default)]
struct Passed {
    shared_rows: Vec<u32>,
    shares: Vec<u32>,
    /// After the last pass only.
    rows: Vec<u32>,
    slopes: Vec<[f32; 2]>,
}

impl ChunkRun {
    /// The work in a folder, which is made if need be. What is there already stays if it was found
    /// under the same `identity`, a text that tells volume and settings from all others; else it is
    /// removed.
    ///
    /// # Errors
    /// [`Error::Io`] when the folder cannot be made or read; [`Error::Chunks`] for settings that do not
    /// go with chunks, see [`Passes::new`].
    pub fn open(
        folder: impl Into<PathBuf>,
        identity: &str,
        layout: Layout,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let folder = folder.into();
        let passes = Passes::new(&settings.optimize)
            .map_err(|cause| Error::Chunks { path: folder.clone(), cause })?;
        let mut run =
            Self { folder, layout, settings: settings.clone(), passes, is_continued: false };
        fs::create_dir_all(&run.folder).map_err(|cause| run.refused("make it", cause))?;
        let key = run.folder.join(IDENTITY);
        run.is_continued = fs::read(&key).is_ok_and(|found| found == identity.as_bytes());
        if run.is_continued {
            return Ok(run);
        }
        run.clear()?;
        write_atomically(&key, |writer| writer.write_all(identity.as_bytes()))?;
        Ok(run)
    }

    /// The chunks.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// How many passes there are.
    pub fn passes(&self) -> usize {
        self.passes.count()
    }

    /// Whether a chunk has its voxels.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn has_voxels(&self, chunk: [usize; 3]) -> Result<bool, Error> {
        Ok(Artefact::summary(&self.file("voxels", chunk))?.is_some())
    }

    /// Takes in the voxels of a chunk. Those of [`Layout::voxels`] in their order; where they lie in the
    /// world does not matter.
    ///
    /// # Errors
    /// Those of writing a file.
    pub fn put_voxels(&self, chunk: [usize; 3], voxels: &Occupancy) -> Result<(), Error> {
        let [_, ny, nz] = voxels.grid().dims();
        let kind = match voxels.count() {
            0 => ALL_OUTSIDE,
            count if count == voxels.grid().point_count() as u64 => ALL_INSIDE,
            _ => MIXED,
        };
        let rows = (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k)));
        let words: Vec<u64> = match kind {
            MIXED => rows.flat_map(|(j, k)| voxels.row(j, k)).copied().collect(),
            _ => Vec::new(),
        };
        let artefact = Artefact::new([kind, 0, 0]).push(words.into_iter());
        artefact.write(&self.file("voxels", chunk))
    }

    /// Makes pass `n` for a chunk, unless that was done; those before must be done for all chunks.
    ///
    /// # Errors
    /// Those of reading and writing files; [`Error::Chunks`] when they do not go together.
    ///
    /// # Panics
    /// When there is no such pass.
    pub fn relax(&self, n: usize, chunk: [usize; 3]) -> Result<(), Error> {
        let path = self.pass_file(n, chunk);
        if Artefact::summary(&path)?.is_some() {
            return Ok(());
        }
        if self.has_no_surface(chunk)? {
            return Artefact::new([0; 3]).write(&path);
        }
        let before = if n == 0 { Totals::default() } else { self.totals(n - 1)? };
        let mean = self.passes.mean_energy(n, &[before.energy], before.vertices);
        let piece = self.chunk(chunk)?;
        let x = match n {
            0 => piece.start(&self.passes).map_err(|cause| self.failed(cause))?,
            _ => self.positions(n - 1, chunk, &piece)?,
        };
        let relaxed = piece.relax(&self.passes, n, mean, &x);
        let is_last = n + 1 == self.passes();
        let triangles = if is_last { piece.triangle_count() } else { 0 };
        let summary = [relaxed.slopes.len() as u64, triangles as u64, relaxed.energy];
        let artefact = Artefact::new(summary).push(piece.shared_rows().into_iter());
        let mut artefact = artefact.push(relaxed.shares.into_iter());
        if is_last {
            artefact = artefact.push(piece.rows().into_iter());
            artefact = artefact.push(relaxed.slopes.as_flattened().iter().copied());
        }
        artefact.write(&path)
    }

    /// Sums up pass `n`, which must be done for all chunks, unless that was done.
    ///
    /// # Errors
    /// Those of reading and writing files.
    pub fn finish(&self, n: usize) -> Result<Totals, Error> {
        if let Some(summary) = Artefact::summary(&self.totals_file(n))? {
            return Ok(totals(summary));
        }
        let (mut sum, mut firsts) = ([0u64; 3], Vec::new());
        for chunk in self.layout.chunks() {
            firsts.push(sum[0]);
            let path = self.pass_file(n, chunk);
            let own = Artefact::summary(&path)?.ok_or(Error::Artefact { path })?;
            sum = [0, 1, 2].map(|k| sum[k] + own[k]);
        }
        Artefact::new(sum).push(firsts.into_iter()).write(&self.totals_file(n))?;
        Ok(totals(sum))
    }

    /// The mesh of a chunk, and the number of its first vertex; all passes must be done.
    ///
    /// # Errors
    /// Those of reading files; [`Error::Chunks`] when they do not go together.
    pub fn mesh(&self, chunk: [usize; 3]) -> Result<(ChunkMesh, u64), Error> {
        let last = self.passes() - 1;
        let firsts: Vec<u64> = Artefact::read(&self.totals_file(last))?.next()?;
        let first_of = |[i, j, k]: [usize; 3]| {
            let [nx, ny, _] = self.layout.counts();
            firsts.get((k * ny + j) * nx + i).copied().unwrap_or_default()
        };
        if self.has_no_surface(chunk)? {
            return Ok((ChunkMesh::default(), first_of(chunk)));
        }
        let piece = self.chunk(chunk)?;
        let count = piece.known_count();
        let x = self.positions(last, chunk, &piece)?;
        let (mut slopes, mut numbers) = (vec![[0.0; 2]; count], vec![u64::MAX; count]);
        for other in self.layout.above(chunk) {
            let passed = self.passed(last, other)?;
            let own: Vec<u64> = (first_of(other)..).take(passed.slopes.len()).collect();
            let taken = piece
                .take(other, &passed.rows, &passed.slopes, &mut slopes)
                .and_then(|()| piece.take(other, &passed.rows, &own, &mut numbers));
            taken.map_err(|cause| self.failed(cause))?;
        }
        let mesh = piece.mesh(&x, &slopes, &numbers, self.settings.triangles);
        Ok((mesh, first_of(chunk)))
    }

    /// The positions of the vertices that a chunk must know, after pass `n`.
    fn positions(&self, n: usize, chunk: [usize; 3], piece: &Chunk<'_>) -> Result<Vec<f32>, Error> {
        let mut shares = vec![0; piece.known_count()];
        for other in self.layout.beside(chunk) {
            let passed = self.passed(n, other)?;
            let added = piece.add(other, &passed.shared_rows, &passed.shares, &mut shares);
            added.map_err(|cause| self.failed(cause))?;
        }
        Ok(piece.positions(&self.passes, &shares))
    }

    /// Removes everything that was found, coarser runs too, and the folder unless something else is in it.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn remove(&self) -> Result<(), Error> {
        self.clear()?;
        let refused = |cause| self.refused("remove what is in it", cause);
        fs::remove_file(self.folder.join(IDENTITY)).map_err(refused)?;
        // It stays where it is not empty.
        let _ = fs::remove_dir(&self.folder);
        Ok(())
    }

    pub(super) fn file(&self, what: &str, [i, j, k]: [usize; 3]) -> PathBuf {
        self.folder.join(format!("{what}-{i}-{j}-{k}.chunk"))
    }

    /// What the last pass found.
    pub(super) fn last_totals(&self) -> Result<Totals, Error> {
        self.totals(self.passes() - 1)
    }

    fn pass_file(&self, n: usize, chunk: [usize; 3]) -> PathBuf {
        self.file(&format!("pass{n}"), chunk)
    }

    fn totals_file(&self, n: usize) -> PathBuf {
        self.folder.join(format!("totals{n}.chunk"))
    }

    fn totals(&self, n: usize) -> Result<Totals, Error> {
        let path = self.totals_file(n);
        Ok(totals(Artefact::summary(&path)?.ok_or(Error::Artefact { path })?))
    }

    /// Whether no vertex can be where the chunk looks, as all is on one side.
    fn has_no_surface(&self, chunk: [usize; 3]) -> Result<bool, Error> {
        let mut kinds = Vec::new();
        for other in self.layout.beside(chunk) {
            let path = self.file("voxels", other);
            kinds.push(Artefact::summary(&path)?.ok_or(Error::Artefact { path })?[0]);
        }
        let is_at_border = (0..3).any(|d| [0, self.layout.counts()[d] - 1].contains(&chunk[d]));
        let is_wrapped = self.layout.border() == Border::Closed && is_at_border;
        Ok(kinds.iter().all(|&kind| kind == ALL_OUTSIDE)
            || !is_wrapped && kinds.iter().all(|&kind| kind == ALL_INSIDE))
    }

    fn chunk(&self, chunk: [usize; 3]) -> Result<Chunk<'_>, Error> {
        let voxels = |other| self.voxels(other).map_err(Found::File);
        let chunk = Chunk::new(&self.layout, chunk, self.settings.faces, voxels);
        chunk.map_err(|found| self.of(found))
    }

    pub(super) fn of(&self, found: Found) -> Error {
        match found {
            Found::File(error) => error,
            Found::Lattice(cause) => self.failed(cause),
        }
    }

    pub(super) fn voxels(&self, chunk: [usize; 3]) -> Result<Occupancy, Error> {
        let mut artefact = Artefact::read(&self.file("voxels", chunk))?;
        let grid = self.layout.grid().crop(self.layout.voxels(chunk));
        let grid = grid.map_err(|cause| self.failed(cause))?;
        let words = match artefact.summary[0] {
            MIXED => artefact.next()?,
            kind => {
                let [nx, ny, nz] = grid.dims();
                let word = if kind == ALL_INSIDE { u64::MAX } else { 0 };
                vec![word; nx.div_ceil(64) * ny * nz]
            }
        };
        Occupancy::from_words(grid, words).map_err(|cause| self.failed(cause))
    }

    fn passed(&self, n: usize, chunk: [usize; 3]) -> Result<Passed, Error> {
        let mut artefact = Artefact::read(&self.pass_file(n, chunk))?;
        let mut passed = Passed::default();
        if !artefact.is_empty() {
            passed.shared_rows = artefact.next()?;
            passed.shares = artefact.next()?;
            if n + 1 == self.passes() {
                passed.rows = artefact.next()?;
                let slopes: Vec<f32> = artefact.next()?;
                passed.slopes = slopes.as_chunks().0.to_vec();
            }
        }
        Ok(passed)
    }

    /// Removes what was found.
    fn clear(&self) -> Result<(), Error> {
        let refused = |cause| self.refused("remove what is in it", cause);
        for entry in fs::read_dir(&self.folder).map_err(refused)? {
            let path = entry.map_err(refused)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            // What a writer leaves that was killed.
            let is_rest = name.starts_with(".shrouds-") && name.ends_with(".part");
            if is_rest || path.extension().is_some_and(|extension| extension == "chunk") {
                fs::remove_file(&path).map_err(refused)?;
            }
        }
        // All of it is ours.
        match fs::remove_dir_all(self.folder.join(COARSER)) {
            Err(cause) if cause.kind() != ErrorKind::NotFound => Err(refused(cause)),
            _ => Ok(()),
        }
    }

    pub(super) fn refused(&self, doing: &'static str, cause: std::io::Error) -> Error {
        let advice = "check the folder and the disk";
        Error::Io { path: self.folder.clone(), doing, cause, advice }
    }

    pub(super) fn failed(&self, cause: shrouds::Error) -> Error {
        Error::Chunks { path: self.folder.clone(), cause }
    }

    /// Whether the folder was there already, with the same identity.
    pub fn is_continued(&self) -> bool {
        self.is_continued
    }
}

fn totals([vertices, triangles, energy]: [u64; 3]) -> Totals {
    Totals { vertices, triangles, energy }
}

/// What keeps voxels from being read.
pub(super) enum Found {
    File(Error),
    Lattice(shrouds::Error),
}

impl From<shrouds::Error> for Found {
    fn from(cause: shrouds::Error) -> Self {
        Self::Lattice(cause)
    }
}
