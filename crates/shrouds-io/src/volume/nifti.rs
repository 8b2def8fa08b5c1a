//! NIfTI-1 and NIfTI-2 in one file or in a pair of header and data, plain or gzip.
//!
//! Formats: the headers `nifti1.h` and `nifti2.h` of the NIfTI Data Format Working Group. The two
//! versions differ in the place and the width of the same fields.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::decode::{Element, Elements, Endian};
use crate::volume::nifti_affine::Placement;
use crate::volume::{Contents, Unread, VolumeOptions, lattice};

/// Bytes of a NIfTI-1 and a NIfTI-2 header; also the number each begins with.
const SIZES: [usize; 2] = [348, 540];
/// First byte that can hold data, after the header and four bytes for its extensions.
const FIRST_DATA: [u64; 2] = [352, 544];
/// Intent codes of matrices over surfaces and parcels.
const CIFTI: RangeInclusive<i32> = 3000..=3099;

/// What is needed of a header of either version.
struct Header {
    endian: Endian,
    /// Number of dimensions, then their lengths.
    dim: [i64; 8],
    intent_code: i32,
    datatype: i16,
    /// The data is in another file.
    detached: bool,
    data_offset: f64,
    /// First byte after the header, where data can start.
    first_data: u64,
    slope: f64,
    intercept: f64,
    unit_code: u8,
    placement: Placement,
}

/// A single file that must be compressed.
pub(super) fn open_compressed<'a>(
    mut stream: Stream<'a>,
    options: &VolumeOptions,
) -> Result<Unread<'a>, Error> {
    if !is_gzip(&mut stream)? {
        let advice = "if it is not compressed, call it .nii";
        return Err(Error::Content { path: stream.path.into(), expected: "gzip data", advice });
    }
    open(stream.unpacked(), options)
}

/// A single file that is not compressed, or has been unpacked.
pub(super) fn open<'a>(
    mut stream: Stream<'a>,
    options: &VolumeOptions,
) -> Result<Unread<'a>, Error> {
    let (header, used) = read_header(&mut stream)?;
    if header.detached {
        let what = "a NIfTI header whose data is in another file";
        let advice = "call it .hdr, beside the .img, or convert the pair to one .nii file";
        return Err(Error::unsupported(stream.path, what, advice));
    }
    values(stream, used, &header, options)
}

/// A pair of header and data, `path` being either of them.
pub(super) fn open_pair<'a>(
    path: &'a Path,
    options: &VolumeOptions<'a>,
) -> Result<Unread<'a>, Error> {
    let [first, second] = ["hdr", "img"].map(|extension| partner(path, extension));
    let mut stream = unpacked_if_gzip(Stream::open_part(path, &first, None, None)?)?;
    let (header, used) = read_header(&mut stream)?;
    let mut files = vec![first];
    let mut unread = if header.detached {
        let data = unpacked_if_gzip(Stream::open_part(path, &second, options.progress, None)?)?;
        files.push(second);
        values(data, 0, &Header { first_data: 0, ..header }, options)?
    } else {
        values(stream, used, &header, options)?
    };
    files.retain(|file| file != path);
    unread.contents.files = files;
    Ok(unread)
}

/// The file of a pair that has this extension: in the case of `path`, compressed as it is, or not.
fn partner(path: &Path, extension: &str) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let gzip = name.to_lowercase().ends_with(".gz");
    let bare = if gzip { &name[..name.len() - 3] } else { &name[..] };
    let stem = bare.rsplit_once('.').map_or(bare, |(stem, _)| stem);
    let upper = bare.ends_with(|last: char| last.is_ascii_uppercase());
    let extension = if upper { extension.to_uppercase() } else { extension.into() };
    let plain = path.with_file_name(format!("{stem}.{extension}"));
    let packed = path.with_file_name(format!("{stem}.{extension}.gz"));
    let (like, other) = if gzip { (packed, plain) } else { (plain, packed) };
    if !like.exists() && other.exists() { other } else { like }
}

fn is_gzip(stream: &mut Stream) -> Result<bool, Error> {
    Ok(stream.peek()?.starts_with(&[0x1f, 0x8b]))
}

fn unpacked_if_gzip<'a>(mut stream: Stream<'a>) -> Result<Stream<'a>, Error> {
    Ok(if is_gzip(&mut stream)? { stream.unpacked() } else { stream })
}

/// The values of one frame; `used` bytes of the stream, which holds the data, have been read.
fn values<'a>(
    mut stream: Stream<'a>,
    used: usize,
    header: &Header,
    options: &VolumeOptions,
) -> Result<Unread<'a>, Error> {
    let path = stream.path;
    if CIFTI.contains(&header.intent_code) {
        let what = "a CIFTI matrix, which has no lattice,";
        return Err(Error::unsupported(path, what, "take a volume out of it, as .nii"));
    }
    let (dims, layers) = dimensions(path, &header.dim)?;
    let element = element(path, header.datatype)?;
    let unit = match header.unit_code & 7 {
        1 => "m",
        2 => "mm",
        3 => "um",
        _ => "unknown",
    };
    let mut contents = Contents { layers, ..Contents::default() };
    if options.spacing.is_none() {
        header.placement.check(path, dims)?;
        contents.warnings = header.placement.warnings(dims, unit);
    }
    let (affine, frame) = header.placement.affine(dims, unit);
    let (grid, frame) = lattice(path, dims, affine, frame, options)?;
    let count = grid.point_count();
    // The caller refuses a frame that is not there.
    let layer = options.layer.filter(|layer| *layer < layers).unwrap_or(0);
    let before = (count as u64).saturating_mul(layer as u64).saturating_mul(element.size() as u64);
    stream.skip((data_offset(path, header)? - used as u64).saturating_add(before))?;
    let scaling = scaling(path, header)?;
    let slabs = Box::new(Elements::new(stream, element, header.endian, count, dims[0]));
    Ok(Unread { grid, frame, contents, slabs, z_fastest: false, scaling })
}

/// Where the data starts. Files that say 0 mean right after the header.
fn data_offset(path: &Path, header: &Header) -> Result<u64, Error> {
    let offset = header.data_offset;
    if offset == 0.0 {
        return Ok(header.first_data);
    }
    // Up to 2^53 a float holds every whole number.
    if offset < header.first_data as f64 || offset > 9e15 || offset.fract() != 0.0 {
        let first = header.first_data;
        let problem = format!("the data starts at byte {offset}, not at {first} or later");
        return Err(Error::header(path, problem));
    }
    Ok(offset as u64)
}

/// Slope and intercept if they change anything; a slope of 0 or none means that there is no scaling.
fn scaling(path: &Path, header: &Header) -> Result<Option<(f64, f64)>, Error> {
    let (slope, intercept) = (header.slope, header.intercept);
    if !slope.is_finite() || slope == 0.0 || (slope == 1.0 && intercept == 0.0) {
        return Ok(None);
    }
    if !intercept.is_finite() {
        let problem = format!("scl_slope is {slope} but scl_inter is {intercept}");
        return Err(Error::header(path, problem));
    }
    Ok(Some((slope, intercept)))
}

/// Dimensions of the lattice, and how many frames there are: the product of all further ones.
fn dimensions(path: &Path, dim: &[i64; 8]) -> Result<([usize; 3], usize), Error> {
    let count = match dim[0] {
        count @ 1..=7 => count as usize,
        count => return Err(Error::header(path, format!("it has {count} dimensions"))),
    };
    let lengths = &dim[1..=count];
    if let Some(length) = lengths.iter().find(|length| **length < 1) {
        return Err(Error::header(path, format!("a dimension has length {length}")));
    }
    // What no usize can hold, no grid can either: it refuses the largest one.
    let length = |axis| lengths.get(axis).map_or(1, |n| usize::try_from(*n).unwrap_or(usize::MAX));
    let frames = (3..count).fold(1, |frames: usize, axis| frames.saturating_mul(length(axis)));
    Ok((std::array::from_fn(length), frames))
}

fn element(path: &Path, datatype: i16) -> Result<Element, Error> {
    let name = match datatype {
        2 => return Ok(Element::U8),
        4 => return Ok(Element::I16),
        8 => return Ok(Element::I32),
        16 => return Ok(Element::F32),
        64 => return Ok(Element::F64),
        256 => return Ok(Element::I8),
        512 => return Ok(Element::U16),
        768 => return Ok(Element::U32),
        1024 => return Ok(Element::I64),
        1280 => return Ok(Element::U64),
        1 => "single bits",
        32 | 1792 | 2048 => "complex numbers",
        128 | 2304 => "colours",
        1536 => "128-bit floats",
        code => return Err(Error::header(path, format!("the datatype {code} does not exist"))),
    };
    let advice = "convert it to an integer or float type";
    Err(Error::unsupported(path, format!("NIfTI data of {name}"), advice))
}

/// The header and the number of bytes it took.
fn read_header(stream: &mut Stream) -> Result<(Header, usize), Error> {
    let path = stream.path;
    let mut bytes = [0; SIZES[1]];
    let start = stream.fill(&mut bytes[..4])?;
    let size = [bytes[0], bytes[1], bytes[2], bytes[3]];
    let sizes = [Endian::Little, Endian::Big].map(|endian| match endian {
        Endian::Little => (endian, i32::from_le_bytes(size)),
        Endian::Big => (endian, i32::from_be_bytes(size)),
    });
    let version = |number: i32| SIZES.iter().position(|size| *size as i32 == number);
    let known = sizes.iter().find_map(|&(endian, size)| Some((endian, version(size)?)));
    let content = |advice| Error::Content { path: path.into(), expected: "a NIfTI volume", advice };
    let Some((endian, version)) = known.filter(|_| start == 4) else {
        return Err(content(if bytes.starts_with(&[0x1f, 0x8b]) {
            "it is compressed: call it .nii.gz"
        } else {
            "check the extension, or write it again as .nii"
        }));
    };
    let size = SIZES[version];
    if stream.fill(&mut bytes[4..size])? < size - 4 {
        return Err(Error::header(path, "the file ends inside it"));
    }
    let fields = Fields { bytes: &bytes[..size], endian };
    let magic = if version == 0 { &bytes[344..348] } else { &bytes[4..8] };
    match magic {
        b"n+1\0" if version == 0 => Ok((fields.version_1(), size)),
        b"n+2\0" if version == 1 => Ok((fields.version_2(), size)),
        b"ni1\0" if version == 0 => Ok((Header { detached: true, ..fields.version_1() }, size)),
        b"ni2\0" if version == 1 => Ok((Header { detached: true, ..fields.version_2() }, size)),
        _ => Err(content("it may be an Analyze 7.5 file: convert it to .nii")),
    }
}

/// Numbers at given places of a header.
struct Fields<'a> {
    bytes: &'a [u8],
    endian: Endian,
}

macro_rules! field_reader {
    ($($name:ident: $type:ty),*) => {$(
        fn $name(&self, at: usize) -> $type {
            let mut bytes = [0; size_of::<$type>()];
            bytes.copy_from_slice(&self.bytes[at..at + size_of::<$type>()]);
            match self.endian {
                Endian::Little => <$type>::from_le_bytes(bytes),
                Endian::Big => <$type>::from_be_bytes(bytes),
            }
        }
    )*};
}

impl Fields<'_> {
    field_reader!(i16: i16, i32: i32, i64: i64, f32: f32, f64: f64);

    /// `N` successive floats of 32 bits, the first at byte `at`.
    fn singles<const N: usize>(&self, at: usize) -> [f64; N] {
        std::array::from_fn(|n| f64::from(self.f32(at + 4 * n)))
    }

    /// `N` successive floats of 64 bits, the first at byte `at`.
    fn doubles<const N: usize>(&self, at: usize) -> [f64; N] {
        std::array::from_fn(|n| self.f64(at + 8 * n))
    }

    fn version_1(&self) -> Header {
        let dim = std::array::from_fn(|n| i64::from(self.i16(40 + 2 * n)));
        Header {
            endian: self.endian,
            dim,
            intent_code: i32::from(self.i16(68)),
            datatype: self.i16(70),
            detached: false,
            data_offset: f64::from(self.f32(108)),
            first_data: FIRST_DATA[0],
            slope: f64::from(self.f32(112)),
            intercept: f64::from(self.f32(116)),
            unit_code: self.bytes[123],
            placement: Placement {
                dimensions: dim[0],
                pixdim: self.singles(76),
                qform_code: i32::from(self.i16(252)),
                sform_code: i32::from(self.i16(254)),
                quaternion: self.singles(256),
                offset: self.singles(268),
                rows: [self.singles(280), self.singles(296), self.singles(312)],
            },
        }
    }

    fn version_2(&self) -> Header {
        let dim = std::array::from_fn(|n| self.i64(16 + 8 * n));
        Header {
            endian: self.endian,
            dim,
            intent_code: self.i32(504),
            datatype: self.i16(12),
            detached: false,
            data_offset: self.i64(168) as f64,
            first_data: FIRST_DATA[1],
            slope: self.f64(176),
            intercept: self.f64(184),
            unit_code: (self.i32(500) & 0xff) as u8,
            placement: Placement {
                dimensions: dim[0],
                pixdim: self.doubles(104),
                qform_code: self.i32(344),
                sform_code: self.i32(348),
                quaternion: self.doubles(352),
                offset: self.doubles(376),
                rows: [self.doubles(400), self.doubles(432), self.doubles(464)],
            },
        }
    }
}
