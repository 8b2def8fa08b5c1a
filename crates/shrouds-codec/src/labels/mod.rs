//! Label maps: every boundary between two labels is coded once.

mod layers;
mod scan;

use std::io::{Read, Write};

use shrouds::{Grid, Occupancy};

use crate::coder::{Coder, Decoder, Encoder};
use crate::error::Error;
use crate::file::{Chunk, Content, Header, Kind, Profile};
use crate::pack::{Packed, Settings, Writer};
use crate::topology::dense::Dense;
use crate::topology::fast::Fast;
use crate::unpack::{File, check_room, slab_name};
use scan::Scan;

/// A label for every lattice point.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelMap {
    grid: Grid,
    labels: Vec<i64>,
    /// The place in `labels` for each lattice point, x fastest.
    places: Vec<u32>,
}

impl LabelMap {
    /// A map of labels, one per lattice point, x fastest, then y, then z.
    ///
    /// # Errors
    /// [`Error::Setting`] when the number of labels is not that of lattice points, or more than 2³²
    /// labels differ.
    pub fn new(grid: Grid, values: &[i64]) -> Result<Self, Error> {
        let points = grid.point_count();
        if values.len() != points {
            let (value, range) = (values.len().to_string(), points.to_string());
            return Err(Error::Setting { name: "the number of labels", value, range });
        }
        let mut labels: Vec<i64> = values.to_vec();
        labels.dedup();
        labels.sort_unstable();
        labels.dedup();
        if u32::try_from(labels.len()).is_err() {
            let (value, range) = (labels.len().to_string(), "below 2^32".into());
            return Err(Error::Setting { name: "the number of different labels", value, range });
        }
        // Neighbours are mostly alike, so that few have to be looked up.
        let mut last = (0, 0);
        let places = values.iter().map(|&value| {
            if labels[last.1] != value || last.0 != value {
                last = (value, labels.binary_search(&value).unwrap_or(0));
            }
            last.1 as u32
        });
        let places = places.collect();
        Ok(Self { grid, labels, places })
    }

    /// The lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The labels that occur, in rising order.
    pub fn labels(&self) -> &[i64] {
        &self.labels
    }

    /// The label of each lattice point, x fastest, then y, then z.
    pub fn values(&self) -> impl Iterator<Item = i64> + Clone {
        self.places.iter().map(|&place| self.labels[place as usize])
    }

    /// Pairs of neighbours with different labels.
    fn crossings(&self) -> u64 {
        let [nx, ny, _] = self.grid.dims();
        let differing =
            |a: &[u32], b: &[u32]| a.iter().zip(b).filter(|(a, b)| a != b).count() as u64;
        let along = |length: usize, step: usize| -> u64 {
            let parts = self.places.chunks_exact(length);
            parts.map(|part| differing(part, &part[step..])).sum()
        };
        along(nx, 1) + along(nx * ny, nx) + along(self.places.len(), nx * ny)
    }

    /// The lattice points with a label.
    pub fn occupancy(&self, label: i64) -> Occupancy {
        let [nx, ny, _] = self.grid.dims();
        let place = self.labels.binary_search(&label).ok();
        Occupancy::from_fn(self.grid.clone(), |[i, j, k]| {
            place == Some(self.places[(k * ny + j) * nx + i] as usize)
        })
    }
}

/// Packs a label map.
///
/// # Errors
/// [`Error::Setting`] for slabs of height 0; [`Error::Io`] when writing fails.
pub fn pack_labels(map: &LabelMap, settings: &Settings, out: impl Write) -> Result<Packed, Error> {
    let header = settings.header(map.grid.clone(), Content::Labels(map.labels.clone()))?;
    let mut writer = Writer::new(&header, out)?;
    writer.packed.vertices = map.crossings();
    let [nx, ny, _] = map.grid.dims();
    let mut state = State::new(&header);
    for (slab, places) in map.places.chunks(nx * ny * header.slab_height).enumerate() {
        if header.independent {
            state = State::new(&header);
        }
        let mut coder = Encoder::new();
        let mut hasher = crc32fast::Hasher::new();
        for layer in places.chunks_exact(nx * ny) {
            hash(&mut hasher, layer);
            state.layer(&mut coder, &mut layer.to_vec());
        }
        writer.slab(Kind::Labels, slab, (coder.finish(), hasher.finalize()))?;
    }
    Ok(writer.finish()?.0)
}

/// Unpacks a label map, and tells what the file says of itself.
///
/// # Errors
/// As [`unpack`](crate::unpack()); [`Error::Content`] when the file holds a binary volume.
pub fn unpack_labels(input: impl Read) -> Result<(Header, LabelMap), Error> {
    let mut file = File::open(input)?;
    let header = file.header.clone();
    let Content::Labels(labels) = &header.content else {
        return Err(Error::Content { found: "a volume", wanted: "labels: unpack its volume" });
    };
    let (mut places, mut state) = (Vec::new(), None);
    for slab in 0..header.slabs() {
        let chunk = file.slab(&header, Kind::Labels, slab)?;
        decode(&header, &mut state, &chunk, &mut places)?;
    }
    file.end()?;
    let map = LabelMap { grid: header.grid.clone(), labels: labels.clone(), places };
    Ok((header, map))
}

/// Appends the labels of a slab.
fn decode(
    header: &Header,
    state: &mut Option<State>,
    chunk: &Chunk,
    places: &mut Vec<u32>,
) -> Result<(), Error> {
    let slab = chunk.number as usize;
    let damaged =
        |problem: &str| Error::Chunk { what: slab_name(header, slab), problem: problem.into() };
    let [nx, ny, _] = header.grid.dims();
    let (layer, start) = (nx * ny, places.len());
    let count = layer as u64 * header.layers_in(slab) as u64;
    // A row ends a run, and a run has at most 64 voxels.
    let words = count.div_ceil(nx as u64) * nx.div_ceil(64) as u64;
    if !crate::topology::slab::is_possible(chunk.payload.len(), words) {
        return Err(damaged("it is too short for so many voxels"));
    }
    let memory = || Error::Memory(count.saturating_mul(4));
    let room = usize::try_from(count).map_err(|_| memory())?;
    places.try_reserve_exact(room).map_err(|_| memory())?;
    places.resize(start + room, 0);
    if header.independent || state.is_none() {
        check_room(layer as u64 * State::BYTES)?;
        *state = None;
    }
    let state = state.get_or_insert_with(|| State::new(header));
    let mut coder = Decoder::new(&chunk.payload);
    let mut hasher = crc32fast::Hasher::new();
    for layer in places[start..].chunks_exact_mut(layer) {
        state.layer(&mut coder, layer);
        hash(&mut hasher, layer);
    }
    if hasher.finalize() != chunk.decoded_sum {
        return Err(damaged("its labels have another check sum than those that were packed"));
    }
    Ok(())
}

/// What has been learnt, and the last layers.
enum State {
    Fast(Box<Scan<Fast>>),
    Dense(Box<Scan<Dense>>),
}

impl State {
    /// At most so many bytes are in memory for it for each voxel of a layer, margins included.
    const BYTES: u64 = 4096;

    fn new(header: &Header) -> Self {
        let [nx, ny, _] = header.grid.dims();
        let labels = match &header.content {
            Content::Labels(labels) => labels.len(),
            Content::Volume => 0,
        };
        match header.profile {
            Profile::Fast => Self::Fast(Box::new(Scan::new([nx, ny], labels))),
            Profile::Dense => Self::Dense(Box::new(Scan::new([nx, ny], labels))),
        }
    }

    fn layer(&mut self, coder: &mut impl Coder, places: &mut [u32]) {
        match self {
            Self::Fast(scan) => scan.layer(coder, places),
            Self::Dense(scan) => scan.layer(coder, places),
        }
    }
}

fn hash(hasher: &mut crc32fast::Hasher, places: &[u32]) {
    let mut bytes = [0; 512];
    for places in places.chunks(128) {
        for (four, place) in bytes.chunks_exact_mut(4).zip(places) {
            four.copy_from_slice(&place.to_le_bytes());
        }
        hasher.update(&bytes[..4 * places.len()]);
    }
}
