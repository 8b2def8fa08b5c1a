//! Files built byte by byte, as the formats prescribe.

use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use shrouds::Select;
use shrouds_io::{
    Error, Selected, Values, Volume, VolumeOptions, read_contents, read_occupancy, read_volume,
    volume_files,
};
use tempfile::TempDir;

/// A number that files store.
pub(crate) trait Stored: Copy {
    fn bytes(self, big: bool) -> Vec<u8>;
}

macro_rules! stored {
    ($($type:ty),*) => {$(
        impl Stored for $type {
            fn bytes(self, big: bool) -> Vec<u8> {
                if big { self.to_be_bytes().into() } else { self.to_le_bytes().into() }
            }
        }
    )*};
}
stored!(u8, i8, u16, i16, u32, i32, u64, i64, f32, f64);

pub(crate) fn bytes<T: Stored>(values: &[T], big: bool) -> Vec<u8> {
    values.iter().flat_map(|v| v.bytes(big)).collect()
}

/// 24 values for a grid of 4 × 3 × 2, in every type: their bytes in one order, and themselves.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) values: Values,
    pub(crate) bytes: Vec<u8>,
}

/// Every type that all formats hold, with values from end to end of its range.
pub(crate) fn cases(big: bool) -> Vec<Case> {
    macro_rules! case {
        ($variant:ident, $type:ident, $ends:expr) => {{
            let mut values: Vec<$type> = (0..24).map(|n| (n * 5) as $type).collect();
            [values[0], values[23]] = $ends;
            let bytes = bytes(&values, big);
            Case { name: stringify!($type), values: Values::$variant(values), bytes }
        }};
    }
    vec![
        case!(U8, u8, [u8::MIN, u8::MAX]),
        case!(I8, i8, [i8::MIN, i8::MAX]),
        case!(U16, u16, [u16::MIN, u16::MAX]),
        case!(I16, i16, [i16::MIN, i16::MAX]),
        case!(U32, u32, [u32::MIN, u32::MAX]),
        case!(I32, i32, [i32::MIN, i32::MAX]),
        case!(U64, u64, [u64::MIN, u64::MAX]),
        case!(I64, i64, [i64::MIN, i64::MAX]),
        case!(F32, f32, [-1.5e-30, 0.1]),
        case!(F64, f64, [-1.5e-300, 0.1]),
    ]
}

pub(crate) fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.bytes());
    file.extend(data);
    file
}

/// A NIfTI-1 header that tests change by offset before they use it.
pub(crate) struct Nifti {
    pub(crate) header: Vec<u8>,
    pub(crate) big: bool,
}

impl Nifti {
    pub(crate) fn new(dims: &[i16], datatype: i16, big: bool) -> Self {
        let mut file = Self { header: vec![0; 352], big };
        file.put(0, 348i32);
        file.put(40, dims.len() as i16);
        for (n, length) in dims.iter().enumerate() {
            file.put(42 + 2 * n, *length);
        }
        file.put(70, datatype);
        for n in 0..8 {
            file.put(76 + 4 * n, 1f32);
        }
        file.put(108, 352f32);
        file.header[344..348].copy_from_slice(b"n+1\0");
        file
    }

    pub(crate) fn put<T: Stored>(&mut self, at: usize, value: T) -> &mut Self {
        let bytes = value.bytes(self.big);
        self.header[at..at + bytes.len()].copy_from_slice(&bytes);
        self
    }

    pub(crate) fn put_all<T: Stored>(&mut self, at: usize, values: &[T]) -> &mut Self {
        for (n, value) in values.iter().enumerate() {
            self.put(at + n * size_of::<T>(), *value);
        }
        self
    }

    pub(crate) fn with(&self, data: &[u8]) -> Vec<u8> {
        [&self.header, data].concat()
    }
}

pub(crate) fn datatype(name: &str) -> i16 {
    let codes = [
        ("u8", 2),
        ("i16", 4),
        ("i32", 8),
        ("f32", 16),
        ("f64", 64),
        ("i8", 256),
        ("u16", 512),
        ("u32", 768),
        ("i64", 1024),
        ("u64", 1280),
    ];
    codes.iter().find(|(known, _)| *known == name).unwrap().1
}

pub(crate) fn nrrd(fields: &str, data: &[u8]) -> Vec<u8> {
    [b"NRRD0004\n# made by hand\n", fields.as_bytes(), b"\n", data].concat()
}

pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

pub(crate) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// An `.mha` file; or an `.mhd` file, where `fields` end with the name of the data.
pub(crate) fn metaimage(fields: &str, data: &[u8]) -> Vec<u8> {
    let named = fields.contains("ElementDataFile");
    let end = if named { "" } else { "ElementDataFile = LOCAL\n" };
    [b"ObjectType = Image\n", fields.as_bytes(), end.as_bytes(), data].concat()
}

/// The volume of a file; reading it straight into bits must come to the same, but for layers of
/// segments, which only bits can unite.
pub(crate) fn read_both(path: &Path, options: &VolumeOptions) -> Result<Volume, Error> {
    let volume = read_volume(path, options);
    for select in [Select::NonZero, Select::Above(3.5), Select::Labels(vec![1, 3, -2])] {
        let bits = read_occupancy(path, options, &select);
        match &volume {
            Err(Error::Choice { .. }) if has_layered_segments(path, options) => {
                if let Err(error) = bits {
                    assert!(error.to_string().starts_with(&path.display().to_string()));
                }
            }
            Err(error) => assert_eq!(bits.unwrap_err().to_string(), error.to_string()),
            Ok(volume) => match volume.occupancy(&select) {
                Ok(occupancy) => {
                    let (frame, contents) = (volume.frame.clone(), volume.contents.clone());
                    assert_eq!(bits.unwrap(), Selected { occupancy, frame, contents });
                }
                Err(error) => {
                    let expected = format!("{}: {error}", path.display());
                    assert_eq!(bits.unwrap_err().to_string(), expected);
                }
            },
        }
    }
    volume
}

fn has_layered_segments(path: &Path, options: &VolumeOptions) -> bool {
    // Which array is meant may be open even before the contents are.
    options.layer.is_none()
        && read_contents(path, options)
            .is_ok_and(|(_, _, contents)| contents.has_layers_of_segments())
}

/// A folder that goes away, and the files in it.
pub(crate) struct Folder(TempDir);

impl Folder {
    /// The names of the files that a volume is read from, relative to this folder.
    pub(crate) fn files_of(&self, name: &str) -> Vec<String> {
        let files = volume_files(self.path(name), &VolumeOptions::default()).unwrap();
        let own = |file: &PathBuf| file.strip_prefix(self.path("")).unwrap().display().to_string();
        files.iter().map(own).collect()
    }

    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// One of several volumes of a file, read both ways.
    pub(crate) fn layer(&self, name: &str, layer: usize) -> Result<Volume, Error> {
        let options = VolumeOptions { layer: Some(layer), ..VolumeOptions::default() };
        read_both(&self.path(name), &options)
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    /// The volume of a file, read both as values and as bits.
    pub(crate) fn volume(&self, name: &str, bytes: &[u8]) -> Result<Volume, Error> {
        read_both(&self.file(name, bytes), &VolumeOptions::default())
    }

    /// The message of the error that these bytes must be.
    pub(crate) fn refusal(&self, name: &str, bytes: &[u8]) -> String {
        let error = self.volume(name, bytes).expect_err("must be refused").to_string();
        assert!(error.contains(name), "the message must name the file: {error}");
        error
    }
}

/// A NumPy archive of these arrays.
pub(crate) fn npz(arrays: &[(&str, Vec<u8>)], deflate: bool) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let method =
        if deflate { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in arrays {
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// VTK image data of 4 × 3 × 2 points, or so many cells, with what stands in the piece.
pub(crate) fn vti(file: &str, image: &str, piece: &str, appended: &[u8]) -> Vec<u8> {
    let start = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" {file}>\n<ImageData {image}>\n\
         <Piece Extent=\"0 3 0 2 0 1\">\n{piece}\n</Piece>\n</ImageData>\n"
    );
    let end = if appended.is_empty() { "" } else { "\n</AppendedData>\n" };
    [start.as_bytes(), appended, end.as_bytes(), b"</VTKFile>\n"].concat()
}

/// Tags of a page of a TIFF file: number, type, values.
pub(crate) type Tiff = Vec<(u16, u16, Vec<u64>)>;

/// The tags of an uncompressed page of one strip.
pub(crate) fn tiff_page(width: u64, height: u64, bits: u64, format: u64) -> Tiff {
    vec![
        (256, 3, vec![width]),
        (257, 4, vec![height]),
        (258, 3, vec![bits]),
        (259, 3, vec![1]),
        (262, 3, vec![1]),
        (277, 3, vec![1]),
        (278, 4, vec![height]),
        (339, 3, vec![format]),
    ]
}

/// The tag of a text.
pub(crate) fn tiff_text(tag: u16, text: &str) -> (u16, u16, Vec<u64>) {
    (tag, 2, text.bytes().chain([0]).map(u64::from).collect())
}

/// A TIFF file of pages, each with its strips or tiles, the data first.
pub(crate) fn tiff(pages: &[(Tiff, Vec<Vec<u8>>)], big: bool, wide: bool) -> Vec<u8> {
    let number = |value: u64, size: usize| match big {
        true => value.to_be_bytes()[8 - size..].to_vec(),
        false => value.to_le_bytes()[..size].to_vec(),
    };
    let field = if wide { 8 } else { 4 };
    let mut file = if big { b"MM".to_vec() } else { b"II".to_vec() };
    file.extend(number(if wide { 43 } else { 42 }, 2));
    if wide {
        file.extend([number(8, 2), number(0, 2)].concat());
    }
    let mut link = file.len();
    file.extend(number(0, field));
    for (tags, chunks) in pages {
        let mut tags = tags.clone();
        let tiles = tags.iter().any(|tag| tag.0 == 322);
        let (mut places, mut lengths) = (Vec::new(), Vec::new());
        for chunk in chunks {
            places.push(file.len() as u64);
            lengths.push(chunk.len() as u64);
            file.extend(chunk);
        }
        tags.push((if tiles { 324 } else { 273 }, if wide { 16 } else { 4 }, places));
        tags.push((if tiles { 325 } else { 279 }, 4, lengths));
        tags.sort_by_key(|tag| tag.0);
        let mut directory = number(tags.len() as u64, if wide { 8 } else { 2 });
        for (tag, kind, values) in &tags {
            let size = [0, 1, 1, 2, 4, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8][usize::from(*kind)];
            // A fraction is two numbers.
            let count = values.len() as u64 / if *kind == 5 { 2 } else { 1 };
            let mut bytes: Vec<u8> = values.iter().flat_map(|value| number(*value, size)).collect();
            if bytes.len() > field {
                let place = file.len() as u64;
                file.extend(&bytes);
                bytes = number(place, field);
            }
            bytes.resize(field, 0);
            directory.extend([number(u64::from(*tag), 2), number(u64::from(*kind), 2)].concat());
            directory.extend([number(count, field), bytes].concat());
        }
        let place = number(file.len() as u64, field);
        file[link..link + field].copy_from_slice(&place);
        file.extend(directory);
        link = file.len();
        file.extend(number(0, field));
    }
    file
}
