//! Segments in layers within which no two overlap, and their labels slice by slice.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::Error;
use crate::volume::dicom::frames::{Mask, Pixels, Stored};
use crate::volume::{Slabs, Values};

/// Most layers: more overlaps at one place are no anatomy.
const MAX_LAYERS: usize = 256;

/// One slice of one segment.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) segment: usize,
    pub(super) slice: usize,
    pub(super) mask: Mask,
}

/// Segments in layers.
#[derive(Debug)]
pub(super) struct Packed {
    pub(super) layers: usize,
    /// Segment and layer, by segment.
    pub(super) layer_of: Vec<(usize, usize)>,
    /// By segment, then slice.
    frames: Vec<Frame>,
}

/// Puts each segment, by number, into the first layer whose segments it does not overlap.
pub(super) fn pack(path: &Path, mut frames: Vec<Frame>) -> Result<Packed, Error> {
    frames.sort_by_key(|frame| (frame.segment, frame.slice));
    let place = |frame: &Frame| (frame.segment, frame.slice);
    if let Some(twice) = frames.windows(2).find(|pair| place(&pair[0]) == place(&pair[1])) {
        let what =
            format!("a segmentation with two frames of segment {} in one slice", twice[0].segment);
        return Err(Error::unsupported(path, what, "write the segments of one time only"));
    }
    // What each layer holds of a slice.
    let mut layers: Vec<BTreeMap<usize, Mask>> = Vec::new();
    let mut layer_of = Vec::new();
    for segment in frames.chunk_by(|a, b| a.segment == b.segment) {
        let is_free = |layer: &BTreeMap<usize, Mask>| {
            segment.iter().all(|frame| {
                layer.get(&frame.slice).is_none_or(|taken| {
                    taken.iter().zip(&frame.mask).all(|(taken, bits)| taken & bits == 0)
                })
            })
        };
        let layer = layers.iter().position(is_free).unwrap_or(layers.len());
        if layer == MAX_LAYERS {
            let what =
                format!("a segmentation with more than {MAX_LAYERS} segments over each other");
            return Err(Error::unsupported(path, what, "write fewer segments into one file"));
        }
        if layer == layers.len() {
            layers.push(BTreeMap::new());
        }
        for frame in segment {
            match layers[layer].get_mut(&frame.slice) {
                Some(taken) => {
                    taken.iter_mut().zip(&frame.mask).for_each(|(taken, bits)| *taken |= bits);
                }
                None => drop(layers[layer].insert(frame.slice, frame.mask.clone())),
            }
        }
        layer_of.push((segment[0].segment, layer));
    }
    Ok(Packed { layers: layers.len(), layer_of, frames })
}

/// Labels of a layer, slice after slice.
pub(super) struct LabelSlices {
    /// Pixels of a slice.
    pixels: usize,
    slices: usize,
    next: usize,
    source: Source,
}

enum Source {
    /// The segments of the layer, by slice.
    Segments { by_slice: BTreeMap<usize, Vec<Frame>>, wide: bool },
    /// The frame of each slice.
    LabelMap { frame_of: BTreeMap<usize, usize>, shape: Stored, pixels: Pixels },
}

impl LabelSlices {
    pub(super) fn of_segments([nx, ny, nz]: [usize; 3], packed: Packed, layer: usize) -> Self {
        let wide = packed.layer_of.last().is_some_and(|(segment, _)| *segment > 255);
        let layer_of: BTreeMap<usize, usize> = packed.layer_of.into_iter().collect();
        let mut by_slice: BTreeMap<usize, Vec<Frame>> = BTreeMap::new();
        for frame in packed.frames {
            if layer_of.get(&frame.segment) == Some(&layer) {
                by_slice.entry(frame.slice).or_default().push(frame);
            }
        }
        let source = Source::Segments { by_slice, wide };
        Self { pixels: nx * ny, slices: nz, next: 0, source }
    }

    pub(super) fn of_label_map(
        path: &Path,
        [nx, ny, nz]: [usize; 3],
        slice_of: Vec<usize>,
        shape: Stored,
        pixels: Pixels,
    ) -> Result<Self, Error> {
        let frame_of: BTreeMap<usize, usize> =
            slice_of.iter().enumerate().map(|(frame, slice)| (*slice, frame)).collect();
        if frame_of.len() < slice_of.len() {
            let what = "a label map with two frames in one slice";
            return Err(Error::unsupported(path, what, "write the label map of one time only"));
        }
        let source = Source::LabelMap { frame_of, shape, pixels };
        Ok(Self { pixels: nx * ny, slices: nz, next: 0, source })
    }
}

impl Slabs for LabelSlices {
    fn next(&mut self) -> Result<Option<Values>, Error> {
        if self.next == self.slices {
            return Ok(None);
        }
        let (pixels, slice) = (self.pixels, self.next);
        self.next += 1;
        Ok(Some(match &self.source {
            Source::Segments { by_slice, wide } => {
                let frames = by_slice.get(&slice).map_or(&[][..], Vec::as_slice);
                if *wide {
                    labels(frames, pixels, |segment| segment as u16).into()
                } else {
                    labels(frames, pixels, |segment| segment as u8).into()
                }
            }
            Source::LabelMap { frame_of, shape, pixels: stored } => {
                shape.labels(stored, frame_of.get(&slice).copied())
            }
        }))
    }
}

fn labels<T: Copy + Default>(
    frames: &[Frame],
    pixels: usize,
    label: impl Fn(usize) -> T,
) -> Vec<T> {
    let mut labels = vec![T::default(); pixels];
    for frame in frames {
        for (n, word) in frame.mask.iter().enumerate() {
            let mut bits = *word;
            while bits != 0 {
                labels[64 * n + bits.trailing_zeros() as usize] = label(frame.segment);
                bits &= bits - 1;
            }
        }
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(segment: usize, slice: usize, bits: u64) -> Frame {
        Frame { segment, slice, mask: vec![bits] }
    }

    #[test]
    fn segments_go_into_the_first_layer_that_is_free() {
        let frames = vec![
            frame(3, 1, 0b0110),
            frame(1, 0, 0b1111),
            frame(2, 1, 0b1100),
            frame(1, 1, 0b0001),
            frame(7, 0, 0b0001),
            frame(4, 0, 0b1000),
        ];
        let packed = pack(Path::new("a.dcm"), frames).unwrap();
        assert_eq!(packed.layer_of, [(1, 0), (2, 0), (3, 1), (4, 1), (7, 1)]);
        let mut second = LabelSlices::of_segments([4, 1, 2], packed, 1);
        assert_eq!(second.next().unwrap(), Some(Values::U8(vec![7, 0, 0, 4])));
        assert_eq!(second.next().unwrap(), Some(Values::U8(vec![0, 3, 3, 0])));
        assert_eq!(second.next().unwrap(), None);
    }

    #[test]
    fn a_segment_has_one_frame_in_a_slice() {
        let frames = vec![frame(2, 5, 1), frame(1, 5, 1), frame(2, 5, 2)];
        let error = pack(Path::new("a.dcm"), frames).unwrap_err().to_string();
        assert!(error.contains("two frames of segment 2"), "{error}");
    }
}
