//! Volume in, file out.

use std::io::{self, Write};

use rayon::prelude::*;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy};

use crate::error::Error;
use crate::file::{Chunk, Content, Header, Kind, Profile};
use crate::topology::slab::{SlabEncoder, State};

/// How a volume is packed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settings {
    /// How the topology is coded.
    pub profile: Profile,
    /// Layers in a chunk, 1 or more; as many as have 2²⁴ lattice points if not given.
    pub slab_height: Option<usize>,
    /// Code each slab by itself: it can be read without those before it, and on a thread of its own,
    /// for some more bytes.
    pub independent: bool,
    /// How the surface passes through ambiguous faces. Packed with the volume, for whoever shrouds it.
    pub faces: FaceRule,
    /// What lies beyond the volume. Packed with it, too.
    pub border: Border,
    /// Name of the world frame, such as `RAS`.
    pub space: String,
    /// Unit of length, such as `mm`.
    pub unit: String,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            profile: Profile::default(),
            slab_height: None,
            independent: false,
            faces: FaceRule::default(),
            border: Border::default(),
            space: "index".into(),
            unit: "unknown".into(),
        }
    }
}

/// Lattice points in a slab unless a height is given.
const SLAB_POINTS: usize = 1 << 24;

impl Settings {
    /// The header of a file with these settings and without planes, for [`Packer`].
    ///
    /// # Errors
    /// [`Error::Setting`] for slabs of height 0.
    pub fn header(&self, grid: Grid, content: Content) -> Result<Header, Error> {
        let [nx, ny, nz] = grid.dims();
        let usual = SLAB_POINTS.div_ceil(nx * ny).min(nz);
        let slab_height = self.slab_height.unwrap_or(usual);
        if slab_height == 0 {
            let (value, range) = ("0".into(), "1 or more".into());
            return Err(Error::Setting { name: "slab height", value, range });
        }
        Ok(Header {
            grid,
            space: self.space.clone(),
            unit: self.unit.clone(),
            content,
            profile: self.profile,
            faces: self.faces,
            border: self.border,
            slab_height,
            independent: self.independent,
            planes: 0,
            plane_settings: Vec::new(),
        })
    }
}

/// Bit planes of the places of vertices, coded.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Planes {
    /// What their decoder has to know before the first of them.
    pub settings: Vec<u8>,
    /// The payload of each plane and the check sum of what it stands for, the highest bits first.
    pub payloads: Vec<(Vec<u8>, u32)>,
}

impl Planes {
    /// By how many bytes a file with these planes is longer than one of the same lattice and settings
    /// without.
    ///
    /// # Errors
    /// Those of [`pack_with_planes`].
    pub fn bytes(&self, grid: &Grid, settings: &Settings) -> Result<u64, Error> {
        let header = settings.header(grid.clone(), Content::Volume)?;
        let without = Writer::new(&header, io::sink())?.packed.bytes;
        let mut with = Writer::new(&self.announced(header)?, io::sink())?;
        with.planes(self)?;
        Ok(with.packed.bytes - without)
    }

    /// A header that tells of these planes.
    fn announced(&self, mut header: Header) -> Result<Header, Error> {
        header.planes = match self.payloads.len() {
            count @ 0..=8 => count as u8,
            more => {
                let (value, range) = (more.to_string(), "0 to 8".into());
                return Err(Error::Setting { name: "the number of bit planes", value, range });
            }
        };
        header.plane_settings.clone_from(&self.settings);
        Ok(header)
    }
}

/// What was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Packed {
    /// Bytes of the file.
    pub bytes: u64,
    /// Bytes of the topology alone, without header and check sums.
    pub topology: u64,
    /// Bytes of the bit planes alone.
    pub planes: u64,
    /// Chunks.
    pub chunks: u64,
    /// Pairs of neighbours that differ: the vertices of the surface, less those at a closed border; or
    /// of the boundaries between all labels.
    pub vertices: u64,
}

/// Packs the topology of a volume.
///
/// # Errors
/// [`Error::Setting`] for slabs of height 0; [`Error::Io`] when writing fails.
pub fn pack(volume: &Occupancy, settings: &Settings, out: impl Write) -> Result<Packed, Error> {
    pack_with_planes(volume, settings, &Planes::default(), out)
}

/// Packs the topology of a volume and the places of its vertices.
///
/// # Errors
/// As [`pack`]; [`Error::Setting`] for more than eight planes, too.
pub fn pack_with_planes(
    volume: &Occupancy,
    settings: &Settings,
    planes: &Planes,
    out: impl Write,
) -> Result<Packed, Error> {
    let header = planes.announced(settings.header(volume.grid().clone(), Content::Volume)?)?;
    let mut writer = pack_topology(volume, header, out)?;
    writer.planes(planes)?;
    Ok(writer.finish()?.0)
}

fn pack_topology<W: Write>(volume: &Occupancy, header: Header, out: W) -> Result<Writer<W>, Error> {
    let layer = |k: usize| -> Vec<u64> {
        let mut words = Vec::new();
        (0..volume.grid().dims()[1]).for_each(|j| words.extend_from_slice(volume.row(j, k)));
        words
    };
    if !header.independent {
        let mut packer = Packer::new(header, out)?;
        (0..volume.grid().dims()[2]).try_for_each(|k| packer.layer(&layer(k)))?;
        return Ok(packer.into_writer());
    }
    let mut writer = Writer::new(&header, out)?;
    let [nx, _, nz] = header.grid.dims();
    let mut crossings = Crossings::default();
    (0..nz).for_each(|k| crossings.layer(nx, &layer(k)));
    writer.packed.vertices = crossings.count;
    // As many slabs at a time as there are threads: they are in memory until they are written.
    let together = rayon::current_num_threads().max(1);
    let slabs: Vec<usize> = (0..header.slabs()).collect();
    for slabs in slabs.chunks(together) {
        let code = |&slab: &usize| {
            let mut state = state(&header);
            let mut encoder = SlabEncoder::new();
            let first = slab * header.slab_height;
            (first..first + header.layers_in(slab))
                .for_each(|k| encoder.layer(&mut state, &layer(k)));
            (slab, encoder.finish())
        };
        let coded: Vec<_> = slabs.par_iter().map(code).collect();
        coded.into_iter().try_for_each(|(slab, coded)| writer.slab(Kind::Topology, slab, coded))?;
    }
    Ok(writer)
}

/// Counts neighbours that differ, layer by layer.
#[derive(Debug, Default)]
struct Crossings {
    before: Vec<u64>,
    count: u64,
}

impl Crossings {
    /// Takes in a layer of rows of `nx` voxels.
    fn layer(&mut self, nx: usize, words: &[u64]) {
        let differing = |a: &[u64], b: &[u64]| -> u64 {
            a.iter().zip(b).map(|(a, b)| u64::from((a ^ b).count_ones())).sum()
        };
        let row = nx.div_ceil(64);
        self.count += differing(words, &self.before) + differing(words, &words[row..]);
        for words in words.chunks_exact(row) {
            for (w, &word) in words.iter().enumerate() {
                let next = words.get(w + 1).map_or(0, |next| next << 63);
                // The last voxel of a row has no neighbour.
                let pairs = u64::MAX >> (64 - (nx - 1 - 64 * w).min(64)).min(63);
                let pairs = if nx - 1 == 64 * w { 0 } else { pairs };
                self.count += u64::from(((word ^ (word >> 1 | next)) & pairs).count_ones());
            }
        }
        self.before.clear();
        self.before.extend_from_slice(words);
    }
}

/// The state before the first layer of a slab that knows of no other.
pub(crate) fn state(header: &Header) -> State {
    let [nx, ny, _] = header.grid.dims();
    State::new([nx, ny], header.profile)
}

/// Writes a header and chunks, and counts.
pub(crate) struct Writer<W> {
    out: W,
    pub(crate) packed: Packed,
}

impl<W: Write> Writer<W> {
    pub(crate) fn new(header: &Header, mut out: W) -> Result<Self, Error> {
        let mut bytes = Vec::new();
        header.write(&mut bytes)?;
        out.write_all(&bytes)?;
        Ok(Self { out, packed: Packed { bytes: bytes.len() as u64, ..Packed::default() } })
    }

    pub(crate) fn slab(
        &mut self,
        kind: Kind,
        slab: usize,
        (payload, decoded_sum): (Vec<u8>, u32),
    ) -> Result<(), Error> {
        self.packed.topology += payload.len() as u64;
        self.chunk(Chunk { kind, number: slab as u64, payload, decoded_sum })
    }

    fn planes(&mut self, planes: &Planes) -> Result<(), Error> {
        for (number, (payload, decoded_sum)) in (1..).zip(planes.payloads.iter().cloned()) {
            self.packed.planes += payload.len() as u64;
            self.chunk(Chunk { kind: Kind::Plane, number, payload, decoded_sum })?;
        }
        Ok(())
    }

    fn chunk(&mut self, chunk: Chunk) -> Result<(), Error> {
        self.packed.chunks += 1;
        self.packed.bytes += chunk.write(&mut self.out)?;
        Ok(())
    }

    pub(crate) fn finish(mut self) -> Result<(Packed, W), Error> {
        self.out.flush()?;
        Ok((self.packed, self.out))
    }
}

/// Packs the topology of a volume that comes layer by layer, in the memory of a few of them.
pub struct Packer<W> {
    header: Header,
    state: State,
    encoder: SlabEncoder,
    layers: usize,
    crossings: Crossings,
    writer: Writer<W>,
}

impl<W: Write> Packer<W> {
    /// Writes the header. Independent slabs are made anew one after another.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn new(header: Header, out: W) -> Result<Self, Error> {
        let writer = Writer::new(&header, out)?;
        let (state, encoder, crossings) =
            (state(&header), SlabEncoder::new(), Crossings::default());
        Ok(Self { header, state, encoder, layers: 0, crossings, writer })
    }

    /// Packs the next layer: the words of its rows, as [`Occupancy::row`] has them.
    ///
    /// # Errors
    /// [`Error::Setting`] when the layer has not as many words as the lattice says, or is one too
    /// many; [`Error::Io`] when writing fails.
    pub fn layer(&mut self, words: &[u64]) -> Result<(), Error> {
        let [nx, ny, nz] = self.header.grid.dims();
        let expected = nx.div_ceil(64) * ny;
        if words.len() != expected || self.layers == nz {
            let value = format!("layer {} of {} words", self.layers, words.len());
            let range = format!("one of {nz} layers of {expected} words");
            return Err(Error::Setting { name: "a layer", value, range });
        }
        self.encoder.layer(&mut self.state, words);
        self.crossings.layer(nx, words);
        self.layers += 1;
        if self.layers.is_multiple_of(self.header.slab_height) || self.layers == nz {
            let encoder = std::mem::replace(&mut self.encoder, SlabEncoder::new());
            let slab = (self.layers - 1) / self.header.slab_height;
            self.writer.slab(Kind::Topology, slab, encoder.finish())?;
            if self.header.independent {
                self.state = state(&self.header);
            }
        }
        Ok(())
    }

    /// What was written, and where it went.
    ///
    /// # Errors
    /// [`Error::Setting`] when layers are missing; [`Error::Io`] when writing fails.
    pub fn finish(self) -> Result<(Packed, W), Error> {
        let layers = self.header.grid.dims()[2];
        if self.layers != layers {
            let (value, range) = (self.layers.to_string(), layers.to_string());
            return Err(Error::Setting { name: "the number of layers", value, range });
        }
        self.into_writer().finish()
    }

    fn into_writer(mut self) -> Writer<W> {
        self.writer.packed.vertices = self.crossings.count;
        self.writer
    }
}
