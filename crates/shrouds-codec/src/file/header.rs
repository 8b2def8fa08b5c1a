//! What a file says of itself first.

use std::io::{self, Read, Write};

use shrouds::Grid;
use shrouds::volume::{Border, FaceRule};

use crate::error::Error;
use crate::file::number;

/// The first bytes: the first is no letter, and line ends are among them, so that a file that was
/// taken for text, or changed as one, is noticed at once.
const MAGIC: [u8; 8] = *b"\x89SHR\r\n\x1a\n";
const VERSION: u8 = 1;

/// What the chunks hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// A binary volume, perhaps with the places of vertices.
    Volume,
    /// A label for each lattice point: the labels that occur, in rising order.
    Labels(Vec<i64>),
}

/// How the topology is coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Profile {
    /// One table: hundreds of millions of voxels a second.
    Fast,
    /// A network and several tables: a third smaller, a microsecond or two per vertex.
    #[default]
    Dense,
}

/// The header of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// The lattice with its place in the world.
    pub grid: Grid,
    /// Name of the world frame, such as `RAS`.
    pub space: String,
    /// Unit of length, such as `mm`.
    pub unit: String,
    /// What the chunks hold.
    pub content: Content,
    /// How the topology is coded.
    pub profile: Profile,
    /// How the surface passes through ambiguous faces.
    pub faces: FaceRule,
    /// What lies beyond the volume.
    pub border: Border,
    /// Layers in a chunk; the last chunk may have fewer.
    pub slab_height: usize,
    /// Whether each slab is coded by itself, so that it can be read without those before it.
    pub independent: bool,
    /// Bit planes of the places of the vertices, 0 to 8.
    pub planes: u8,
    /// What the decoder of the planes has to know; empty without planes.
    pub plane_settings: Vec<u8>,
}

impl Header {
    /// Chunks of topology or labels.
    pub fn slabs(&self) -> usize {
        self.grid.dims()[2].div_ceil(self.slab_height)
    }

    /// Layers in slab `slab`.
    pub fn layers_in(&self, slab: usize) -> usize {
        (self.grid.dims()[2] - slab * self.slab_height).min(self.slab_height)
    }

    pub(crate) fn write(&self, out: &mut impl Write) -> Result<(), Error> {
        let body = self.body();
        let mut bytes = MAGIC.to_vec();
        bytes.push(VERSION);
        number::write(&mut bytes, body.len() as u64);
        bytes.extend(body);
        let sum = crc32fast::hash(&bytes);
        bytes.extend(sum.to_le_bytes());
        Ok(out.write_all(&bytes)?)
    }

    fn body(&self) -> Vec<u8> {
        let flags = u8::from(self.faces == FaceRule::Join)
            | u8::from(self.border == Border::Open) << 1
            | u8::from(self.independent) << 2;
        let mut bytes = vec![
            u8::from(self.content != Content::Volume),
            u8::from(self.profile == Profile::Dense),
            flags,
            self.planes,
        ];
        for n in self.grid.dims().into_iter().chain([self.slab_height]) {
            number::write(&mut bytes, n as u64);
        }
        write_frame(&mut bytes, &self.grid);
        let labels = match &self.content {
            Content::Volume => Vec::new(),
            Content::Labels(labels) => label_bytes(labels),
        };
        let texts = [self.space.as_bytes(), self.unit.as_bytes(), &self.plane_settings, &labels];
        for text in texts {
            number::write(&mut bytes, text.len() as u64);
            bytes.extend(text);
        }
        bytes
    }

    pub(crate) fn read(input: &mut impl Read) -> Result<Self, Error> {
        let mut bytes = vec![0; MAGIC.len() + 1];
        input.read_exact(&mut bytes).map_err(early)?;
        if bytes[..MAGIC.len()] != MAGIC {
            return Err(Error::NotShroud);
        }
        if bytes[MAGIC.len()] != VERSION {
            return Err(Error::Version { found: bytes[MAGIC.len()], known: VERSION });
        }
        let length = number::read(input).map_err(early)?;
        number::write(&mut bytes, length);
        let start = bytes.len();
        // Grows with the bytes that are there, whatever the length says.
        input.by_ref().take(length).read_to_end(&mut bytes)?;
        if ((bytes.len() - start) as u64) < length {
            return Err(Error::Header("it ends early".into()));
        }
        let mut sum = [0; 4];
        input.read_exact(&mut sum).map_err(early)?;
        if crc32fast::hash(&bytes) != u32::from_le_bytes(sum) {
            return Err(Error::Header("its check sum is wrong".into()));
        }
        Self::parse(&bytes[start..])
    }

    fn parse(mut body: &[u8]) -> Result<Self, Error> {
        let input = &mut body;
        let mut start = [0; 4];
        input.read_exact(&mut start).map_err(early)?;
        let [content, profile, flags, planes] = start;
        if content > 1 || profile > 1 || flags > 7 || planes > 8 {
            return Err(Error::Header(format!("{start:?} are no settings of this version")));
        }
        let mut dims = [0; 4];
        for n in &mut dims {
            *n = usize::try_from(number::read(input).map_err(early)?).unwrap_or(usize::MAX);
        }
        let [nx, ny, nz, slab_height] = dims;
        let grid = read_frame(input, [nx, ny, nz])?;
        if slab_height == 0 {
            return Err(Error::Header("slabs have no layers".into()));
        }
        let space = text(input)?;
        let unit = text(input)?;
        let plane_settings = block(input)?.to_vec();
        let labels = read_labels(block(input)?)?;
        if !input.is_empty() {
            return Err(Error::Header("it is longer than it should be".into()));
        }
        if labels.is_empty() != (content == 0) {
            return Err(Error::Header("a label map has labels, and a volume has none".into()));
        }
        Ok(Self {
            grid,
            space,
            unit,
            content: if content == 1 { Content::Labels(labels) } else { Content::Volume },
            profile: if profile == 1 { Profile::Dense } else { Profile::Fast },
            faces: if flags & 1 == 1 { FaceRule::Join } else { FaceRule::Separate },
            border: if flags & 2 == 2 { Border::Open } else { Border::Closed },
            independent: flags & 4 == 4,
            slab_height,
            planes,
            plane_settings,
        })
    }
}

/// The frame in as few numbers as say it: none, spacings and origin, or the whole affine.
fn write_frame(bytes: &mut Vec<u8>, grid: &Grid) {
    let affine = grid.affine();
    let diagonal = |scale: [f64; 3], origin: [f64; 3]| -> [[f64; 4]; 3] {
        std::array::from_fn(|r| {
            std::array::from_fn(|c| match c {
                3 => origin[r],
                _ if c == r => scale[r],
                _ => 0.0,
            })
        })
    };
    let scale = std::array::from_fn(|r| affine[r][r]);
    let origin = std::array::from_fn(|r| affine[r][3]);
    // Bits are compared, so that no −0 is lost.
    let same = |other: [[f64; 4]; 3]| {
        affine.iter().flatten().zip(other.iter().flatten()).all(|(a, b)| a.to_bits() == b.to_bits())
    };
    let numbers: Vec<f64> = if same(diagonal([1.0; 3], [0.0; 3])) {
        Vec::new()
    } else if same(diagonal(scale, origin)) {
        scale.into_iter().chain(origin).collect()
    } else {
        affine.into_iter().flatten().collect()
    };
    bytes.push(numbers.len() as u8);
    bytes.extend(numbers.into_iter().flat_map(f64::to_le_bytes));
}

fn read_frame(input: &mut &[u8], dims: [usize; 3]) -> Result<Grid, Error> {
    let mut count = [0];
    input.read_exact(&mut count).map_err(early)?;
    let mut numbers = [0.0; 12];
    let count = usize::from(count[0]);
    for number in numbers.iter_mut().take(count) {
        let mut bytes = [0; 8];
        input.read_exact(&mut bytes).map_err(early)?;
        *number = f64::from_le_bytes(bytes);
    }
    let n = numbers;
    let diagonal = |s: [f64; 3], o: [f64; 3]| {
        [[s[0], 0.0, 0.0, o[0]], [0.0, s[1], 0.0, o[1]], [0.0, 0.0, s[2], o[2]]]
    };
    let affine = match count {
        0 => diagonal([1.0; 3], [0.0; 3]),
        6 => diagonal([n[0], n[1], n[2]], [n[3], n[4], n[5]]),
        12 => std::array::from_fn(|r| std::array::from_fn(|c| n[4 * r + c])),
        _ => return Err(Error::Header(format!("a frame of {count} numbers"))),
    };
    Ok(Grid::with_affine(dims, affine)?)
}

fn block<'a>(input: &mut &'a [u8]) -> Result<&'a [u8], Error> {
    let length = number::read(input).map_err(early)?;
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    let (block, rest) = input.split_at_checked(length).ok_or_else(early_end)?;
    *input = rest;
    Ok(block)
}

fn text(input: &mut &[u8]) -> Result<String, Error> {
    let bytes = block(input)?.to_vec();
    String::from_utf8(bytes).map_err(|_| Error::Header("a name is no text".into()))
}

/// Each label as its distance from the one before, less 1.
fn label_bytes(labels: &[i64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Some(&first) = labels.first() {
        number::write(&mut bytes, number::fold(first));
    }
    for pair in labels.windows(2) {
        number::write(&mut bytes, pair[1].wrapping_sub(pair[0]) as u64 - 1);
    }
    bytes
}

fn read_labels(mut bytes: &[u8]) -> Result<Vec<i64>, Error> {
    let mut labels: Vec<i64> = Vec::new();
    while !bytes.is_empty() {
        let number = number::read(&mut bytes).map_err(early)?;
        let label = match labels.last() {
            None => Some(number::unfold(number)),
            Some(&last) => last.checked_add_unsigned(number).and_then(|label| label.checked_add(1)),
        };
        labels.push(label.ok_or_else(|| Error::Header("a label is out of range".into()))?);
    }
    Ok(labels)
}

fn early_end() -> Error {
    Error::Header("it ends early".into())
}

/// What an end or an invalid number within the header means.
fn early(error: io::Error) -> Error {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => early_end(),
        io::ErrorKind::InvalidData => Error::Header("a number in it is invalid".into()),
        _ => Error::Io(error),
    }
}
