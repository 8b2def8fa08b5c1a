//! DICOM data elements: what part 10 of the standard says about files, and part 5 about bytes.
//!
//! Only the elements that place a segmentation are kept, so that memory stays far below the bytes of
//! the file; nesting is bounded, and nothing is allocated because a length says so.

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::decode::Endian;

/// Group and element number.
pub(super) type Tag = u32;

/// The elements that are kept, by tag. Sequences among them come first: in files that do not spell
/// out the type of an element, only the tag tells what is a sequence.
pub(super) mod tag {
    use super::Tag;

    pub(in crate::volume::dicom) const SEGMENT_SEQUENCE: Tag = 0x0062_0002;
    pub(in crate::volume::dicom) const SEGMENT_IDENTIFICATION: Tag = 0x0062_000a;
    pub(in crate::volume::dicom) const SHARED_GROUPS: Tag = 0x5200_9229;
    pub(in crate::volume::dicom) const FRAME_GROUPS: Tag = 0x5200_9230;
    pub(in crate::volume::dicom) const PLANE_POSITION: Tag = 0x0020_9113;
    pub(in crate::volume::dicom) const PLANE_ORIENTATION: Tag = 0x0020_9116;
    pub(in crate::volume::dicom) const PIXEL_MEASURES: Tag = 0x0028_9110;
    pub(in crate::volume::dicom) const SEQUENCES: [Tag; 7] = [
        SEGMENT_SEQUENCE,
        SEGMENT_IDENTIFICATION,
        SHARED_GROUPS,
        FRAME_GROUPS,
        PLANE_POSITION,
        PLANE_ORIENTATION,
        PIXEL_MEASURES,
    ];

    pub(in crate::volume::dicom) const META_LENGTH: Tag = 0x0002_0000;
    pub(in crate::volume::dicom) const MEDIA_CLASS: Tag = 0x0002_0002;
    pub(in crate::volume::dicom) const TRANSFER_SYNTAX: Tag = 0x0002_0010;
    pub(in crate::volume::dicom) const SOP_CLASS: Tag = 0x0008_0016;
    pub(in crate::volume::dicom) const SLICE_THICKNESS: Tag = 0x0018_0050;
    pub(in crate::volume::dicom) const SPACING_BETWEEN_SLICES: Tag = 0x0018_0088;
    pub(in crate::volume::dicom) const POSITION: Tag = 0x0020_0032;
    pub(in crate::volume::dicom) const ORIENTATION: Tag = 0x0020_0037;
    pub(in crate::volume::dicom) const FRAMES: Tag = 0x0028_0008;
    pub(in crate::volume::dicom) const ROWS: Tag = 0x0028_0010;
    pub(in crate::volume::dicom) const COLUMNS: Tag = 0x0028_0011;
    pub(in crate::volume::dicom) const PIXEL_SPACING: Tag = 0x0028_0030;
    pub(in crate::volume::dicom) const BITS_ALLOCATED: Tag = 0x0028_0100;
    pub(in crate::volume::dicom) const TOTAL_COLUMNS: Tag = 0x0048_0006;
    pub(in crate::volume::dicom) const SEGMENTATION_TYPE: Tag = 0x0062_0001;
    pub(in crate::volume::dicom) const SEGMENT_NUMBER: Tag = 0x0062_0004;
    pub(in crate::volume::dicom) const SEGMENT_LABEL: Tag = 0x0062_0005;
    pub(in crate::volume::dicom) const REFERENCED_SEGMENT: Tag = 0x0062_000b;
    pub(in crate::volume::dicom) const MAXIMUM_FRACTIONAL_VALUE: Tag = 0x0062_000e;
    pub(in crate::volume::dicom) const PLAIN: [Tag; 20] = [
        META_LENGTH,
        TRANSFER_SYNTAX,
        SOP_CLASS,
        MEDIA_CLASS,
        SLICE_THICKNESS,
        SPACING_BETWEEN_SLICES,
        POSITION,
        ORIENTATION,
        FRAMES,
        ROWS,
        COLUMNS,
        PIXEL_SPACING,
        BITS_ALLOCATED,
        TOTAL_COLUMNS,
        SEGMENTATION_TYPE,
        SEGMENT_NUMBER,
        SEGMENT_LABEL,
        REFERENCED_SEGMENT,
        MAXIMUM_FRACTIONAL_VALUE,
        PIXEL_DATA,
    ];

    pub(in crate::volume::dicom) const PIXEL_DATA: Tag = 0x7fe0_0010;
    pub(in crate::volume::dicom) const ITEM: Tag = 0xfffe_e000;
    pub(super) const ITEM_END: Tag = 0xfffe_e00d;
    pub(in crate::volume::dicom) const SEQUENCE_END: Tag = 0xfffe_e0dd;
}

/// The length of what ends with a delimiter.
pub(super) const UNDEFINED: u32 = u32::MAX;
/// Longest value that is kept: the longest names are far shorter.
const MAX_VALUE: u32 = 1 << 12;
/// Deepest nesting that is followed.
const MAX_DEPTH: usize = 32;
/// Most elements and items that are kept: those of half a million frames.
const MAX_KEPT: usize = 1 << 23;

/// Elements in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Dataset(Vec<(Tag, Value)>);

#[derive(Debug)]
enum Value {
    Bytes(Vec<u8>),
    Items(Vec<Dataset>),
}

impl Dataset {
    /// The items of a sequence, none if it is not there.
    pub(super) fn items(&self, tag: Tag) -> &[Dataset] {
        match self.value(tag) {
            Some(Value::Items(items)) => items,
            _ => &[],
        }
    }

    /// The first item of a sequence.
    pub(super) fn item(&self, tag: Tag) -> Option<&Dataset> {
        self.items(tag).first()
    }

    /// Text without the padding around it.
    pub(super) fn text(&self, tag: Tag) -> Option<String> {
        let bytes = self.bytes(tag)?;
        // Names are UTF-8 or, in older files, Latin-1.
        let text = String::from_utf8(bytes.into())
            .unwrap_or_else(|_| bytes.iter().map(|byte| char::from(*byte)).collect());
        Some(text.trim_matches([' ', '\0']).to_owned())
    }

    /// An unsigned 16-bit or 32-bit number.
    pub(super) fn number(&self, tag: Tag) -> Option<usize> {
        match *self.bytes(tag)? {
            [a, b] => Some(u16::from_le_bytes([a, b]).into()),
            [a, b, c, d] => Some(u32::from_le_bytes([a, b, c, d]) as usize),
            _ => None,
        }
    }

    /// As many decimal numbers as asked for.
    pub(super) fn decimals<const N: usize>(&self, tag: Tag) -> Option<[f64; N]> {
        let text = self.text(tag)?;
        let numbers: Result<Vec<f64>, _> =
            text.split('\\').map(|number| number.trim().parse()).collect();
        let numbers: [f64; N] = numbers.ok()?.try_into().ok()?;
        numbers.iter().all(|number| number.is_finite()).then_some(numbers)
    }

    fn bytes(&self, tag: Tag) -> Option<&[u8]> {
        match self.value(tag) {
            Some(Value::Bytes(bytes)) => Some(bytes),
            _ => None,
        }
    }

    fn value(&self, tag: Tag) -> Option<&Value> {
        self.0.iter().find(|(other, _)| *other == tag).map(|(_, value)| value)
    }
}

/// Where a list of elements or items ends.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    /// At this distance from the start of the file.
    At(u64),
    /// With a delimiter.
    Delimiter,
}

struct Header {
    tag: Tag,
    /// Two letters, if the file spells them out.
    kind: [u8; 2],
    length: u32,
}

/// Elements read from a file.
pub(super) struct Reader<'a> {
    pub(super) stream: Stream<'a>,
    /// Elements spell out their type.
    pub(super) explicit: bool,
    pub(super) endian: Endian,
    at: u64,
    kept: usize,
}

impl<'a> Reader<'a> {
    /// Past the preamble and the mark of a DICOM file.
    pub(super) fn new(mut stream: Stream<'a>) -> Result<Self, Error> {
        let mut start = [0; 132];
        if stream.fill(&mut start)? < 132 || &start[128..] != b"DICM" {
            let advice =
                "check the extension; DICOM data without the preamble of a file is not read";
            let path = stream.path.into();
            return Err(Error::Content { path, expected: "a DICOM file", advice });
        }
        Ok(Self { stream, explicit: true, endian: Endian::Little, at: 132, kept: 0 })
    }

    /// The elements that say how the others are written.
    pub(super) fn meta(&mut self) -> Result<Dataset, Error> {
        let first = self.header()?;
        if first.tag != tag::META_LENGTH || first.length != 4 {
            return Err(self.damaged("the length of the file meta information is missing"));
        }
        let end = End::At(self.at + 4 + u64::from(u32::from_le_bytes(self.array()?)));
        let meta = self.elements(end, true, 0)?;
        // Longer elements than the whole: the position is that of no element.
        if end != End::At(self.at) {
            return Err(self.damaged("the length of the file meta information is wrong"));
        }
        Ok(meta)
    }

    /// From here on the bytes are deflated.
    pub(super) fn inflate(self) -> Self {
        Self { stream: self.stream.deflated(), ..self }
    }

    /// The elements before the pixels, and the length of those.
    pub(super) fn before_pixels(&mut self) -> Result<(Dataset, u32), Error> {
        let mut dataset = Dataset::default();
        loop {
            let header = self.header()?;
            if header.tag == tag::PIXEL_DATA {
                if self.endian == Endian::Big && header.kind == *b"OW" {
                    let what = "big-endian DICOM pixels in words";
                    let advice = "write it again as Explicit VR Little Endian";
                    return Err(Error::unsupported(self.stream.path, what, advice));
                }
                return Ok((dataset, header.length));
            }
            self.element(header, true, 0, &mut dataset)?;
        }
    }

    /// The next fragment of pixels that come in pieces; none after the last.
    pub(super) fn fragment(&mut self) -> Result<Option<Vec<u8>>, Error> {
        let header = self.header()?;
        match header.tag {
            tag::ITEM if header.length != UNDEFINED => self.bytes(header.length.into()).map(Some),
            tag::SEQUENCE_END => Ok(None),
            _ => Err(self.damaged("the frames are not a list of items")),
        }
    }

    /// As many bytes as asked for; memory grows as they arrive.
    pub(super) fn bytes(&mut self, length: u64) -> Result<Vec<u8>, Error> {
        let path = self.stream.path;
        if self.stream.most().is_some_and(|most| most < length) {
            let found = self.stream.most().unwrap_or(0);
            return Err(Error::Truncated { path: path.into(), expected: length, found });
        }
        let mut bytes = Vec::new();
        while (bytes.len() as u64) < length {
            let start = bytes.len();
            let step = (length - start as u64).min(1 << 20) as usize;
            bytes.resize(start + step, 0);
            let found = self.stream.fill(&mut bytes[start..])?;
            if found < step {
                let found = (start + found) as u64;
                return Err(Error::Truncated { path: path.into(), expected: length, found });
            }
        }
        self.at += length;
        Ok(bytes)
    }

    pub(super) fn damaged(&self, problem: impl Into<String>) -> Error {
        Error::header(self.stream.path, problem)
    }

    fn elements(&mut self, end: End, keep: bool, depth: usize) -> Result<Dataset, Error> {
        let mut dataset = Dataset::default();
        while !self.is_past(end) {
            let header = self.header()?;
            if end == End::Delimiter && header.tag == tag::ITEM_END {
                break;
            }
            self.element(header, keep, depth, &mut dataset)?;
        }
        Ok(dataset)
    }

    /// Reads the value of an element into `dataset` if it is wanted, else past it.
    fn element(
        &mut self,
        header: Header,
        keep: bool,
        depth: usize,
        dataset: &mut Dataset,
    ) -> Result<(), Error> {
        let Header { tag, kind, length } = header;
        let wanted = keep && tag::SEQUENCES.contains(&tag);
        if wanted || length == UNDEFINED {
            // A sequence of unknown type is written without types.
            let explicit = self.explicit;
            self.explicit &= kind != *b"UN";
            let items = self.items(length, wanted, depth + 1)?;
            self.explicit = explicit;
            if wanted {
                self.keep(dataset, tag, Value::Items(items))?;
            }
            return Ok(());
        }
        if keep && kind != *b"SQ" && tag::PLAIN.contains(&tag) && length <= MAX_VALUE {
            let mut bytes = self.bytes(length.into())?;
            if self.endian == Endian::Big && [*b"US", *b"UL"].contains(&kind) {
                bytes.reverse();
            }
            return self.keep(dataset, tag, Value::Bytes(bytes));
        }
        self.skip(length)
    }

    fn items(&mut self, length: u32, keep: bool, depth: usize) -> Result<Vec<Dataset>, Error> {
        if depth > MAX_DEPTH {
            return Err(self.damaged(format!("sequences lie more than {MAX_DEPTH} deep")));
        }
        let end = self.end(length);
        let mut items = Vec::new();
        while !self.is_past(end) {
            let header = self.header()?;
            match header.tag {
                tag::SEQUENCE_END if end == End::Delimiter => break,
                tag::ITEM if !keep && header.length != UNDEFINED => self.skip(header.length)?,
                tag::ITEM => {
                    let item = self.elements(self.end(header.length), keep, depth)?;
                    if keep {
                        self.count()?;
                        items.push(item);
                    }
                }
                _ => return Err(self.damaged("a sequence holds something else than items")),
            }
        }
        Ok(items)
    }

    fn keep(&mut self, dataset: &mut Dataset, tag: Tag, value: Value) -> Result<(), Error> {
        self.count()?;
        dataset.0.push((tag, value));
        Ok(())
    }

    fn count(&mut self) -> Result<(), Error> {
        self.kept += 1;
        if self.kept > MAX_KEPT {
            let what = "a segmentation of so many frames";
            let advice = "split it into segments or parts";
            return Err(Error::unsupported(self.stream.path, what, advice));
        }
        Ok(())
    }

    fn end(&self, length: u32) -> End {
        if length == UNDEFINED { End::Delimiter } else { End::At(self.at + u64::from(length)) }
    }

    fn is_past(&self, end: End) -> bool {
        matches!(end, End::At(place) if self.at >= place)
    }

    fn header(&mut self) -> Result<Header, Error> {
        let [a, b, c, d] = self.array()?;
        let tag = self.unsigned([a, b]) << 16 | self.unsigned([c, d]);
        if !self.explicit || tag >> 16 == 0xfffe {
            let length = self.array::<4>()?;
            return Ok(Header { tag, kind: *b"  ", length: self.unsigned(length) });
        }
        let [a, b, c, d] = self.array()?;
        let kind = [a, b];
        if !kind.iter().all(u8::is_ascii_uppercase) {
            return Err(self.damaged(format!("element {tag:08x} has no type")));
        }
        let long = b"OB OD OF OL OV OW SQ SV UC UN UR UT UV";
        let length = if long.chunks(3).any(|known| known[..2] == kind) {
            let length = self.array::<4>()?;
            self.unsigned(length)
        } else {
            self.unsigned([c, d])
        };
        Ok(Header { tag, kind, length })
    }

    fn unsigned<const N: usize>(&self, mut bytes: [u8; N]) -> u32 {
        if self.endian == Endian::Little {
            bytes.reverse();
        }
        bytes.iter().fold(0, |number, byte| number << 8 | u32::from(*byte))
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let mut bytes = [0; N];
        if self.stream.fill(&mut bytes)? < N {
            return Err(self.damaged("the file ends before the pixels"));
        }
        self.at += N as u64;
        Ok(bytes)
    }

    fn skip(&mut self, length: u32) -> Result<(), Error> {
        if self.stream.skip(length.into())? < length.into() {
            return Err(self.damaged("the file ends before the pixels"));
        }
        self.at += u64::from(length);
        Ok(())
    }
}
