//! MetaImage: `.mha`, or an `.mhd` header with its data in other files; plain, zlib or text.
//!
//! Format: as the MetaIO library of ITK reads it; where two fields disagree, the one that ITK takes
//! is taken. The header is lines `Name = value`, the last of which names the data.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::data::{Data, Layers, Packing};
use crate::volume::decode::{Element, Endian};
use crate::volume::file_names::{MAX_FILES, beside, numbered};
use crate::volume::metaimage_frame::placement;
use crate::volume::{Contents, Unread, VolumeOptions, lattice};

/// Longest line and most lines that are read.
const MAX_LINE: u64 = 1 << 16;
const MAX_LINES: usize = 1 << 12;
const MAX_AXES: usize = 10;

pub(super) fn open<'a>(
    mut stream: Stream<'a>,
    options: &VolumeOptions<'a>,
) -> Result<Unread<'a>, Error> {
    let path = stream.path;
    let whole = stream.remaining();
    let mut header = Header::read(&mut stream)?;
    let sizes = header.sizes(path)?;
    let at = |n: usize| sizes.get(n).copied().unwrap_or(1);
    let dims = [at(0), at(1), at(2)];
    let (affine, frame) = placement(path, &mut header, sizes.len())?;
    let (grid, frame) = lattice(path, dims, affine, frame, options)?;
    let layers = header.layers(path, &sizes)?;
    let chosen = options.layer.filter(|layer| *layer < layers.count).unwrap_or(0);
    let mut data = header.data(path, dims[0], Layers { chosen, ..layers })?;
    let files = header.data_files(path, &mut stream, at(sizes.len() - 1))?;
    let slabs = match files.clone() {
        Some(files) => data.detached(path, files, options.progress)?,
        None => {
            // Counted from the start of the file, not from the end of the header.
            let passed = whole.zip(stream.remaining()).map(|(all, left)| (all - left) as i64);
            if data.byte_skip > 0 && passed == Some(data.byte_skip) {
                data.byte_skip = 0;
            }
            if data.byte_skip > 0 {
                let what = "data at another place than behind its header (HeaderSize)";
                return Err(Error::unsupported(path, what, "write it again without a HeaderSize"));
            }
            data.attached(stream)?
        }
    };
    let warnings = header.warnings;
    let files = files.unwrap_or_default();
    let contents = Contents { layers: layers.count, warnings, files, ..Contents::default() };
    Ok(Unread { grid, frame, contents, slabs, z_fastest: false, scaling: None })
}

/// The fields of a header by name, in lower case.
pub(super) struct Header {
    fields: BTreeMap<String, String>,
    pub(super) warnings: Vec<String>,
}

impl Header {
    /// Reads up to the field that names the data; the stream stands behind it.
    fn read(stream: &mut Stream) -> Result<Self, Error> {
        let path = stream.path;
        let mut header = Self { fields: BTreeMap::new(), warnings: Vec::new() };
        for n in 0..MAX_LINES {
            let Some(line) = stream.last_line(MAX_LINE)? else { break };
            if line.trim().is_empty() || line.starts_with('#') {
                continue;
            }
            let Some((name, value)) = line.split_once(['=', ':']) else {
                if n == 0 {
                    break;
                }
                return Err(Error::header(path, format!("the line '{line:.60}' has no field")));
            };
            let (name, value) = (name.trim().to_lowercase(), value.trim());
            header.fields.insert(name.clone(), value.into());
            if name == "elementdatafile" {
                return Ok(header);
            }
        }
        if ["ndims", "objecttype", "dimsize"].iter().any(|name| header.get(name).is_some()) {
            return Err(Error::header(path, "the field 'ElementDataFile' is missing"));
        }
        let advice = "check the extension, or write it again as .mha";
        Err(Error::Content { path: path.into(), expected: "a MetaImage", advice })
    }

    /// The value of a field.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.fields.get(&name.to_lowercase()).map(String::as_str)
    }

    fn need(&self, path: &Path, name: &str) -> Result<&str, Error> {
        self.get(name).ok_or_else(|| Error::header(path, format!("the field '{name}' is missing")))
    }

    /// The `count` numbers of a field.
    pub(super) fn numbers(
        &self,
        path: &Path,
        name: &str,
        count: usize,
    ) -> Result<Option<Vec<f64>>, Error> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
        let problem = format!("the {name} '{text:.80}' are not {count} numbers");
        let numbers = numbers.filter(|numbers| numbers.len() == count);
        numbers.map(Some).ok_or_else(|| Error::header(path, problem))
    }

    fn flag(&self, name: &str) -> Option<bool> {
        self.get(name).map(|value| value.starts_with(['T', 't', '1']))
    }

    fn sizes(&self, path: &Path) -> Result<Vec<usize>, Error> {
        let (text, dimension) = (self.need(path, "DimSize")?, self.need(path, "NDims")?);
        let number = dimension.parse().ok().filter(|n| (2..=MAX_AXES).contains(n));
        let number = number.ok_or_else(|| {
            let advice = "give an image or a volume";
            Error::unsupported(path, format!("a MetaImage of {dimension:.20} dimensions"), advice)
        })?;
        let sizes: Option<Vec<usize>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
        let sizes = sizes.filter(|sizes| sizes.len() == number && !sizes.contains(&0));
        let problem = format!("the DimSize '{text:.60}' is not {number} numbers from 1 on");
        sizes.ok_or_else(|| Error::header(path, problem))
    }

    /// Several volumes: channels, or those along a fourth axis.
    fn layers(&self, path: &Path, sizes: &[usize]) -> Result<Layers, Error> {
        let text = self.get("ElementNumberOfChannels").unwrap_or("1");
        let channels = text.parse().ok().filter(|n: &usize| *n > 0);
        let problem = || format!("the ElementNumberOfChannels is '{text:.20}'");
        let channels = channels.ok_or_else(|| Error::header(path, problem()))?;
        let all: Vec<usize> = [channels].iter().chain(sizes).copied().collect();
        let mut others = (0..all.len()).filter(|n| all[*n] > 1 && !(1..=3).contains(n));
        let layer = others.next().unwrap_or(all.len());
        if others.next().is_some() {
            let what = format!("a MetaImage of {channels} channels and sizes {sizes:?}");
            let advice = "extract one volume of three dimensions";
            return Err(Error::unsupported(path, what, advice));
        }
        let product = |sizes: &[usize]| sizes.iter().try_fold(1usize, |all, n| all.checked_mul(*n));
        let after = all.get(layer + 1..).unwrap_or_default();
        let (Some(inner), Some(outer)) = (product(&all[..layer]), product(after)) else {
            let problem = format!("sizes {sizes:?} are more than a file can hold");
            return Err(Error::header(path, problem));
        };
        let count = all.get(layer).copied().unwrap_or(1);
        Ok(Layers { inner, count, outer, chosen: 0 })
    }

    fn data(&mut self, path: &Path, row: usize, layers: Layers) -> Result<Data, Error> {
        let element = element(path, self.need(path, "ElementType")?)?;
        let (whole, elements) =
            (self.flag("BinaryDataByteOrderMSB"), self.flag("ElementByteOrderMSB"));
        if whole.is_some() && elements.is_some() && whole != elements && element.size() > 1 {
            self.warnings.push(
                "BinaryDataByteOrderMSB and ElementByteOrderMSB differ; the former is used.".into(),
            );
        }
        let big = whole.or(elements).unwrap_or(false);
        let endian = if big { Endian::Big } else { Endian::Little };
        let packing = match (self.flag("BinaryData"), self.flag("CompressedData")) {
            (_, Some(true)) => Packing::Zlib,
            (Some(false), _) => Packing::Decimal,
            _ => Packing::Raw,
        };
        let text = self.get("HeaderSize").unwrap_or("0");
        let byte_skip = text.parse().ok().filter(|skip: &i64| *skip >= -1).ok_or_else(|| {
            Error::header(path, format!("the HeaderSize is '{text:.40}', not -1 or more"))
        })?;
        if byte_skip != 0 && packing == Packing::Zlib {
            let what = "compressed data with a HeaderSize";
            return Err(Error::unsupported(path, what, "write it again without one"));
        }
        let scale = |name, nothing: f64| {
            self.get(name).is_some_and(|text| text.parse().is_ok_and(|n: f64| n != nothing))
        };
        if scale("ElementToIntensityFunctionSlope", 1.0)
            || scale("ElementToIntensityFunctionOffset", 0.0)
        {
            self.warnings.push(
                "The values are taken as stored: ElementToIntensityFunctionSlope and Offset are not \
                 applied (ITK does not either)."
                    .into(),
            );
        }
        Ok(Data { element, endian, packing, line_skip: 0, byte_skip, row, layers })
    }

    /// The files that hold the data, if it does not follow the header; a pattern without numbers
    /// stands for `slices` files from 1 on.
    fn data_files(
        &self,
        path: &Path,
        stream: &mut Stream,
        slices: usize,
    ) -> Result<Option<Vec<PathBuf>>, Error> {
        let text = self.need(path, "ElementDataFile")?;
        let words: Vec<&str> = text.split_whitespace().collect();
        let first = words.first().copied().unwrap_or_default();
        match first {
            "" => Err(Error::header(path, "the ElementDataFile has no name")),
            "LOCAL" | "Local" | "local" => Ok(None),
            "LIST" => listed(stream).map(Some),
            _ if first.contains('%') => {
                let number = |n: usize, default: i64| match words.get(n) {
                    Some(word) => word.parse().map_err(|_| {
                        Error::header(path, format!("the ElementDataFile is '{text:.80}'"))
                    }),
                    None => Ok(default),
                };
                let (low, step) = (number(1, 1)?, number(3, 1)?);
                let steps = i64::try_from(slices - 1).unwrap_or(i64::MAX);
                let high = number(2, low.saturating_add(step.saturating_mul(steps)))?;
                numbered(path, first, [low, high, step]).map(Some)
            }
            _ => Ok(Some(vec![beside(path, text)])),
        }
    }
}

/// The names of files in the lines that are left.
fn listed(stream: &mut Stream) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    while let Some(line) = stream.last_line(MAX_LINE)? {
        if files.len() == MAX_FILES {
            let problem = format!("it lists more than {MAX_FILES} files");
            return Err(Error::header(stream.path, problem));
        }
        if !line.trim().is_empty() {
            files.push(beside(stream.path, line.trim()));
        }
    }
    Ok(files)
}

fn element(path: &Path, name: &str) -> Result<Element, Error> {
    let plain = name.to_uppercase();
    Ok(match plain.strip_suffix("_ARRAY").unwrap_or(&plain) {
        "MET_CHAR" => Element::I8,
        "MET_UCHAR" => Element::U8,
        "MET_SHORT" => Element::I16,
        "MET_USHORT" => Element::U16,
        // Four bytes on every machine.
        "MET_INT" | "MET_LONG" => Element::I32,
        "MET_UINT" | "MET_ULONG" => Element::U32,
        "MET_LONG_LONG" => Element::I64,
        "MET_ULONG_LONG" => Element::U64,
        "MET_FLOAT" => Element::F32,
        "MET_DOUBLE" => Element::F64,
        _ => {
            let advice = "convert it to an integer or float type";
            return Err(Error::unsupported(path, format!("the ElementType '{name:.40}'"), advice));
        }
    })
}
