//! The voxels of an array on their lattice, from chunks to rows along x.
//!
//! Of a layer of chunks across z all that are stored are in memory, unpacked; rows are put together
//! from them a few megabytes at a time.

use crate::error::Error;
use crate::stream::Progress;
use crate::volume::decode::decode;
use crate::volume::zarr::chunks::{ChunkFile, Piece, Presence};
use crate::volume::zarr::metadata::Array;
use crate::volume::{Slabs, Values};

/// Bytes put together at a time, unless a row is longer.
const SLAB: usize = 1 << 20;
/// Most bytes of voxels, and most files to look for, whatever little is stored of them.
const MOST_BYTES: u128 = 1 << 30;
const MOST_FILES: u128 = 1 << 20;
/// Bytes that one byte may become, over many chunks; equal voxels do not count.
const EXPANSION: u64 = 1 << 14;
/// Voxels for each one that is stored, and files to look for for each one that is there, at most.
const SPARSEST: u128 = 4096;

/// Which axes of an array run along x, y and z.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    /// Along x, y and z, as far as the array has them.
    pub(super) spatial: [Option<usize>; 3],
    /// The others, the slowest first.
    pub(super) others: Vec<usize>,
}

impl Layout {
    /// Lattice points along x, y and z.
    pub(super) fn dims(&self, shape: &[usize]) -> [usize; 3] {
        self.spatial.map(|axis| axis.map_or(1, |axis| shape[axis]))
    }

    /// Number of lattices.
    pub(super) fn layers(&self, shape: &[usize]) -> usize {
        self.others.iter().fold(1, |all, axis| all.saturating_mul(shape[*axis]))
    }

    /// The index of the first voxel of a layer.
    fn start(&self, shape: &[usize], mut layer: usize) -> Vec<usize> {
        let mut start = vec![0; shape.len()];
        for &axis in self.others.iter().rev() {
            start[axis] = layer % shape[axis];
            layer /= shape[axis];
        }
        start
    }
}

/// The files that cross one layer of chunks, each with those of its chunks that lie in the layer.
struct Sheet {
    /// z of its first and behind its last lattice point.
    range: [usize; 2],
    /// By y, then x.
    files: Vec<Option<Vec<Option<Piece>>>>,
}

/// The values of one layer of an array.
pub(super) struct Rows<'a> {
    array: Array,
    layout: Layout,
    dims: [usize; 3],
    /// Lattice points in a file and in a chunk along x, y, z.
    file: [usize; 3],
    chunk: [usize; 3],
    /// Distance of neighbours along x, y, z in a chunk, in elements.
    strides: [usize; 3],
    /// The first voxel of the layer: numbers of its file and, within that, of its chunk.
    first: [Vec<usize>; 2],
    /// Place of the first voxel of the layer in its chunk.
    offset: usize,
    sheet: Option<Sheet>,
    /// Rows that have been handed out.
    done: usize,
    progress: Option<Progress<'a>>,
    read: u64,
    /// Bytes of all files, if they are all read.
    total: u64,
}

impl<'a> Rows<'a> {
    pub(super) fn new(
        array: Array,
        layout: Layout,
        layer: usize,
        progress: Option<Progress<'a>>,
    ) -> Self {
        let along = |shape: &[usize]| layout.dims(shape);
        let (file, chunk) = (along(&array.stored), along(&array.chunk.shape));
        let mut steps = vec![0; array.shape.len()];
        let mut step = 1usize;
        for &axis in array.chunk.order.iter().rev() {
            steps[axis] = step;
            step = step.saturating_mul(array.chunk.shape[axis]);
        }
        let start = layout.start(&array.shape, layer);
        let numbers = |n: usize| {
            [start[n] / array.stored[n], start[n] % array.stored[n] / array.chunk.shape[n]]
        };
        let axes = 0..start.len();
        let first = [0, 1].map(|level| axes.clone().map(|n| numbers(n)[level]).collect());
        let offset = axes.map(|n| start[n] % array.chunk.shape[n] * steps[n]).sum();
        let strides = layout.spatial.map(|axis| axis.map_or(0, |axis| steps[axis]));
        let dims = along(&array.shape);
        let (sheet, done, read, total) = (None, 0, 0, 0);
        Self {
            array,
            layout,
            dims,
            file,
            chunk,
            strides,
            first,
            offset,
            sheet,
            done,
            progress,
            read,
            total,
        }
    }

    /// That the array is not so much larger than what is stored of it that reading it would mean
    /// writing down nothing for hours.
    fn check_presence(&mut self) -> Result<(), Error> {
        let presence = Presence::of(&self.array)?;
        if self.layout.layers(&self.array.shape) == 1 {
            self.total = presence.bytes;
        }
        let product =
            |numbers: &[usize]| numbers.iter().fold(1u128, |all, n| all.saturating_mul(*n as u128));
        let element = self.array.element.size() as u128;
        let voxels = product(&self.dims);
        let there = product(&self.file).saturating_mul(presence.files as u128);
        let files: u128 = (0..3).map(|n| self.dims[n].div_ceil(self.file[n]) as u128).product();
        let too_sparse = voxels * element > MOST_BYTES && voxels / SPARSEST > there;
        let too_many = files > MOST_FILES + SPARSEST * presence.files as u128;
        if too_sparse || too_many {
            let [x, y, z] = self.dims;
            let what = format!(
                "an array of {x} × {y} × {z} voxels in {files} chunk files, of which {} are there,",
                presence.files
            );
            let advice = "check that the chunks were copied too, or take a coarser level or a part";
            return Err(Error::unsupported(&self.array.folder, what, advice));
        }
        Ok(())
    }

    /// Reads the layer of chunks that has lattice points of this z.
    fn read_sheet(&mut self, z: usize) -> Result<Sheet, Error> {
        let [across, down] = [0, 1].map(|n| self.dims[n].div_ceil(self.file[n]));
        let low = z - z % self.chunk[2];
        // A file may end within a chunk layer of the lattice, but not a chunk within a file.
        let high = (low + self.chunk[2]).min(self.dims[2]);
        let mut files = Vec::new();
        let (mut packed, mut unpacked) = (0u64, 0u64);
        for (y, x) in (0..down).flat_map(|y| (0..across).map(move |x| (y, x))) {
            let numbers = self.numbers(0, [x, y, z / self.file[2]]);
            let Some(mut file) = ChunkFile::open(&self.array, &numbers)? else {
                files.push(None);
                continue;
            };
            let [wide, high] = [0, 1].map(|n| self.file[n] / self.chunk[n]);
            let within = z % self.file[2] / self.chunk[2];
            let mut pieces = Vec::new();
            for (y, x) in (0..high).flat_map(|y| (0..wide).map(move |x| (y, x))) {
                let piece = file.chunk(&self.numbers(1, [x, y, within]))?;
                if let Some(Piece::Whole(bytes)) = &piece {
                    unpacked += bytes.len() as u64;
                }
                pieces.push(piece);
            }
            packed += file.length();
            if unpacked > MOST_BYTES as u64 + EXPANSION * packed {
                let what = format!("chunks that unpack to {unpacked} bytes from {packed}");
                let advice = "check where the file comes from: it looks made to fill memory";
                return Err(Error::unsupported(&self.array.folder, what, advice));
            }
            self.read += file.length();
            files.push(Some(pieces));
            if let Some(progress) = self.progress {
                progress(self.read.min(self.total), self.total);
            }
        }
        Ok(Sheet { range: [low, high], files })
    }

    /// The number along each axis of a file (level 0) or of a chunk within it (level 1).
    fn numbers(&self, level: usize, along: [usize; 3]) -> Vec<usize> {
        let mut numbers = self.first[level].clone();
        for (axis, number) in self.layout.spatial.iter().zip(along) {
            if let Some(axis) = axis {
                numbers[*axis] = number;
            }
        }
        numbers
    }

    /// Appends the row at y and z, as stored.
    fn push_row(&self, sheet: &Sheet, [y, z]: [usize; 2], bytes: &mut Vec<u8>) {
        let size = self.array.element.size();
        let across = self.dims[0].div_ceil(self.file[0]);
        let [wide, _] = [0, 1].map(|n| self.file[n] / self.chunk[n]);
        let within = y % self.file[1] / self.chunk[1];
        let start =
            self.offset + z % self.chunk[2] * self.strides[2] + y % self.chunk[1] * self.strides[1];
        for file in 0..across {
            let left = self.file[0].min(self.dims[0] - file * self.file[0]);
            let Some(pieces) = &sheet.files[y / self.file[1] * across + file] else {
                push_alike(&self.array.fill, left, bytes);
                continue;
            };
            for (n, piece) in pieces[within * wide..][..wide].iter().enumerate() {
                let count = self.chunk[0].min(left.saturating_sub(n * self.chunk[0]));
                match piece {
                    None => push_alike(&self.array.fill, count, bytes),
                    Some(Piece::Uniform(value)) => push_alike(value, count, bytes),
                    Some(Piece::Whole(all)) if self.strides[0] == 1 => {
                        bytes.extend_from_slice(&all[start * size..(start + count) * size]);
                    }
                    Some(Piece::Whole(all)) => {
                        for n in 0..count {
                            let at = (start + n * self.strides[0]) * size;
                            bytes.extend_from_slice(&all[at..at + size]);
                        }
                    }
                }
            }
        }
    }
}

impl Slabs for Rows<'_> {
    fn next(&mut self) -> Result<Option<Values>, Error> {
        let [nx, ny, nz] = self.dims;
        if self.done == ny * nz {
            return Ok(None);
        }
        if self.done == 0 {
            self.check_presence()?;
        }
        let z = self.done / ny;
        let sheet = match self.sheet.take().filter(|sheet| z < sheet.range[1]) {
            Some(sheet) => sheet,
            None => self.read_sheet(z)?,
        };
        let row = nx * self.array.element.size();
        let count = (SLAB / row).max(1).min(sheet.range[1] * ny - self.done);
        let mut bytes = Vec::with_capacity(count * row);
        for n in self.done..self.done + count {
            self.push_row(&sheet, [n % ny, n / ny], &mut bytes);
        }
        self.done += count;
        self.sheet = Some(sheet);
        Ok(Some(decode(self.array.element, self.array.chunk.endian, &bytes)))
    }
}

fn push_alike(value: &[u8], count: usize, bytes: &mut Vec<u8>) {
    if value.iter().all(|byte| *byte == value[0]) {
        bytes.resize(bytes.len() + count * value.len(), value[0]);
    } else {
        (0..count).for_each(|_| bytes.extend_from_slice(value));
    }
}
