//! File in, volume out.

use std::io::Read;
use std::ops::Range;

use rayon::prelude::*;
use shrouds::{Grid, Occupancy};

use crate::error::Error;
use crate::file::{Chunk, Content, Damage, Header, Kind};
use crate::topology::slab::{self, State};

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Unpacked {
    /// What the file says of itself.
    pub header: Header,
    /// The volume, or as many of its first layers as are there.
    pub volume: Occupancy,
    /// The bit planes that are there, still coded, from the first on.
    pub planes: Vec<Chunk>,
    /// Why there is less than the header promises, if there is.
    pub lost: Option<String>,
}

/// Unpacks a volume. Planes that are damaged or missing are left out, and [`Unpacked::lost`] says so.
///
/// # Errors
/// What is wrong with the file: [`Error::NotShroud`], [`Error::Version`], [`Error::Header`],
/// [`Error::Chunk`], [`Error::Cut`], [`Error::Trailing`]; [`Error::Content`] when it holds labels;
/// [`Error::Memory`]; [`Error::Io`] when reading fails.
pub fn unpack(input: impl Read) -> Result<Unpacked, Error> {
    match first_layers(input)? {
        (_, Some(damage)) => Err(damage),
        (unpacked, None) => Ok(unpacked),
    }
}

/// Unpacks as many of the first layers of a volume as are sound, if there are any.
///
/// # Errors
/// As [`unpack`]; [`Error::Chunk`] and [`Error::Cut`] only when there is no sound layer.
pub fn unpack_partial(input: impl Read) -> Result<Unpacked, Error> {
    let (mut unpacked, damage) = first_layers(input)?;
    if let Some(damage) = damage {
        let [layers, all] = [unpacked.volume.grid(), &unpacked.header.grid].map(|g| g.dims()[2]);
        unpacked.lost = Some(format!("only the first {layers} of {all} layers: {damage}"));
    }
    Ok(unpacked)
}

/// The layers of a volume that are sound, from the first on, and why there are no more; planes only if
/// all are.
fn first_layers(input: impl Read) -> Result<(Unpacked, Option<Error>), Error> {
    let mut file = File::open(input)?;
    let header = file.volume_header()?;
    let (words, damage) = file.all_slabs(&header)?;
    let [nx, ny, _] = header.grid.dims();
    let layers = words.len() / (nx.div_ceil(64) * ny);
    let (planes, lost) = match damage {
        Some(damage) if layers == 0 => return Err(damage),
        Some(_) => (Vec::new(), None),
        None => file.planes(&header)?,
    };
    let grid = Grid::with_affine([nx, ny, layers], header.grid.affine())?;
    let volume = Occupancy::from_words(grid, words)?;
    Ok((Unpacked { header, volume, planes, lost }, damage))
}

/// Unpacks some layers of a volume. Of independent slabs only those are decoded that hold some of
/// them, else all before them, too.
///
/// # Errors
/// As [`unpack`]; [`Error::Grid`] when the range holds no layers of the volume.
pub fn unpack_layers(input: impl Read, layers: Range<usize>) -> Result<Occupancy, Error> {
    let mut file = File::open(input)?;
    let header = file.volume_header()?;
    let [nx, ny, nz] = header.grid.dims();
    if layers.is_empty() || layers.end > nz {
        let Range { start, end } = layers;
        return Err(shrouds::Error::NoSuchPoints { axis: 'z', start, end, points: nz }.into());
    }
    let layer = nx.div_ceil(64) * ny;
    let (mut words, mut state) = (Vec::new(), None);
    for slab in 0..layers.end.div_ceil(header.slab_height) {
        let chunk = file.slab(&header, Kind::Topology, slab)?;
        let first = slab * header.slab_height;
        let end = first + header.layers_in(slab);
        if header.independent && end <= layers.start {
            continue;
        }
        let decoded = decode_slab(&header, &mut state, &chunk)?;
        let wanted = layers.start.max(first) - first..layers.end.min(end).max(first) - first;
        if !wanted.is_empty() {
            words.extend_from_slice(&decoded[wanted.start * layer..wanted.end * layer]);
        }
    }
    let mut affine = header.grid.affine();
    let first = header.grid.point([0.0, 0.0, layers.start as f64]);
    affine.iter_mut().zip(first).for_each(|(row, place)| row[3] = place);
    let grid = Grid::with_affine([nx, ny, layers.len()], affine)?;
    Ok(Occupancy::from_words(grid, words)?)
}

/// What a file says of itself; the rest is not looked at.
///
/// # Errors
/// [`Error::NotShroud`], [`Error::Version`], [`Error::Header`]; [`Error::Io`] when reading fails.
pub fn read_header(input: impl Read) -> Result<Header, Error> {
    Ok(File::open(input)?.header)
}

/// A chunk of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// What it holds.
    pub kind: Kind,
    /// The slab, from 0, or the plane, from 1.
    pub number: u64,
    /// Bytes of its payload.
    pub bytes: u64,
}

/// What a file holds, without decoding it: the header and the chunks.
///
/// # Errors
/// As [`unpack`].
pub fn survey(input: impl Read) -> Result<(Header, Vec<Part>), Error> {
    let mut file = File::open(input)?;
    let header = file.header.clone();
    let mut chunks = Vec::new();
    while let Some(chunk) = file.next(&format!("chunk {}", chunks.len()))? {
        let Chunk { kind, number, payload, .. } = chunk;
        chunks.push(Part { kind, number, bytes: payload.len() as u64 });
    }
    Ok((header, chunks))
}

/// A file whose header is read.
pub(crate) struct File<R> {
    pub(crate) header: Header,
    input: R,
}

impl<R: Read> File<R> {
    pub(crate) fn open(mut input: R) -> Result<Self, Error> {
        Ok(Self { header: Header::read(&mut input)?, input })
    }

    fn volume_header(&self) -> Result<Header, Error> {
        if self.header.content == Content::Volume {
            return Ok(self.header.clone());
        }
        Err(Error::Content { found: "labels", wanted: "a volume: unpack its labels" })
    }

    /// The next chunk, which is `what`.
    fn next(&mut self, what: &str) -> Result<Option<Chunk>, Error> {
        let damaged = |problem: &str| Error::Chunk { what: what.into(), problem: problem.into() };
        Chunk::read(&mut self.input).map_err(|damage| match damage {
            Damage::End => damaged("the file ends within it"),
            Damage::Sum => damaged("its check sum is wrong"),
            Damage::Io(error) => error.into(),
        })
    }

    /// The chunk of a slab.
    pub(crate) fn slab(
        &mut self,
        header: &Header,
        kind: Kind,
        slab: usize,
    ) -> Result<Chunk, Error> {
        let what = slab_name(header, slab);
        let all = header.grid.dims()[2];
        let cut = || Error::Cut { layers: slab * header.slab_height, all };
        let chunk = self.next(&what)?.ok_or_else(cut)?;
        if chunk.kind != kind || chunk.number != slab as u64 {
            let problem = "another chunk is in its place".into();
            return Err(Error::Chunk { what, problem });
        }
        Ok(chunk)
    }

    /// The words of the layers that are sound, from the first on, and why there are no more.
    fn all_slabs(&mut self, header: &Header) -> Result<(Vec<u64>, Option<Error>), Error> {
        let (mut words, mut state) = (Vec::new(), None);
        let together = if header.independent { rayon::current_num_threads().max(1) } else { 1 };
        let slabs: Vec<usize> = (0..header.slabs()).collect();
        for slabs in slabs.chunks(together) {
            let chunks: Vec<_> =
                slabs.iter().map(|&slab| self.slab(header, Kind::Topology, slab)).collect();
            let decoded: Vec<Result<Vec<u64>, Error>> = if header.independent {
                let decode = |chunk: Result<Chunk, Error>| {
                    chunk.and_then(|chunk| decode_slab(header, &mut None, &chunk))
                };
                chunks.into_par_iter().map(decode).collect()
            } else {
                let decode = |chunk: Result<Chunk, Error>| {
                    chunk.and_then(|chunk| decode_slab(header, &mut state, &chunk))
                };
                chunks.into_iter().map(decode).collect()
            };
            for part in decoded {
                match part {
                    // The first one as it is: mostly there is no other.
                    Ok(part) if words.is_empty() => words = part,
                    Ok(part) => extend(&mut words, &part)?,
                    Err(error) => return Ok((words, Some(error))),
                }
            }
        }
        Ok((words, None))
    }

    /// The planes that are there, from the first on, and why there are no more.
    fn planes(&mut self, header: &Header) -> Result<(Vec<Chunk>, Option<String>), Error> {
        let mut planes = Vec::new();
        for number in 1..=header.planes {
            let what = format!("bit plane {number}");
            let problem = match self.next(&what) {
                Ok(Some(chunk)) if chunk.kind == Kind::Plane && chunk.number == number.into() => {
                    planes.push(chunk);
                    continue;
                }
                Ok(Some(_)) => "another chunk is in its place".into(),
                Ok(None) => "the file ends before it".into(),
                Err(Error::Chunk { problem, .. }) => problem,
                Err(other) => return Err(other),
            };
            let all = header.planes;
            let lost = format!("only {} of {all} bit planes: of {what}, {problem}", number - 1);
            return Ok((planes, Some(lost)));
        }
        self.end()?;
        Ok((planes, None))
    }

    /// Fails when something follows.
    pub(crate) fn end(&mut self) -> Result<(), Error> {
        let mut more = Vec::new();
        self.input.by_ref().take(1).read_to_end(&mut more)?;
        if more.is_empty() { Ok(()) } else { Err(Error::Trailing) }
    }
}

/// What a message calls a slab.
pub(crate) fn slab_name(header: &Header, slab: usize) -> String {
    let first = slab * header.slab_height;
    format!("slab {slab} (layers {first} to {})", first + header.layers_in(slab) - 1)
}

/// The words of a slab. The state is made once there is a chunk that can hold so many voxels.
fn decode_slab(
    header: &Header,
    state: &mut Option<State>,
    chunk: &Chunk,
) -> Result<Vec<u64>, Error> {
    let slab = chunk.number as usize;
    let damaged =
        |problem: &str| Error::Chunk { what: slab_name(header, slab), problem: problem.into() };
    let [nx, ny, _] = header.grid.dims();
    let layer = nx.div_ceil(64) * ny;
    let count = layer as u64 * header.layers_in(slab) as u64;
    if !slab::is_possible(chunk.payload.len(), count) {
        return Err(damaged("it is too short for so many voxels"));
    }
    let mut words = Vec::new();
    extend_zeros(&mut words, count)?;
    if header.independent || state.is_none() {
        check_room(8 * State::LAYERS * layer as u64)?;
        *state = None;
    }
    let state = state.get_or_insert_with(|| crate::pack::state(header));
    if slab::decode(state, &chunk.payload, &mut words, layer) != chunk.decoded_sum {
        return Err(damaged("its voxels have another check sum than those that were packed"));
    }
    Ok(words)
}

/// Fails when there is no room for so many bytes. Only asks: memory that is zero by nature cannot be had
/// from what is reserved so.
pub(crate) fn check_room(bytes: u64) -> Result<(), Error> {
    let room = usize::try_from(bytes).map_err(|_| Error::Memory(bytes))?;
    Vec::<u8>::new().try_reserve_exact(room).map_err(|_| Error::Memory(bytes))
}

/// Makes room for so many words before it asks for them.
fn extend_zeros(words: &mut Vec<u64>, count: u64) -> Result<(), Error> {
    let memory = || Error::Memory(count.saturating_mul(8));
    let room = usize::try_from(count).map_err(|_| memory())?;
    words.try_reserve_exact(room).map_err(|_| memory())?;
    words.resize(words.len() + room, 0);
    Ok(())
}

fn extend(words: &mut Vec<u64>, part: &[u64]) -> Result<(), Error> {
    let bytes = 8 * (words.len() + part.len()) as u64;
    words.try_reserve(part.len()).map_err(|_| Error::Memory(bytes))?;
    words.extend_from_slice(part);
    Ok(())
}
