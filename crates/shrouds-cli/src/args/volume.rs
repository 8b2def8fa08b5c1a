//! How a volume file is read, and which of its voxels are inside.

use std::str::FromStr;

use clap::Args;
use serde::{Deserialize, Serialize};
use shrouds_io::{ElementType, RawLayout};

use crate::args::{Axes, FrameChoice, values};
use crate::failure::Failure;

#[derive(Args, Clone)]
#[command(next_help_heading = "Volume")]
pub(crate) struct VolumeArgs {
    /// Inside are the voxels with this label, a number or the name of a segment where the file has
    /// names; repeat it for several [default: all but 0]
    #[arg(long = "label", value_name = "LABEL", allow_negative_numbers = true)]
    pub(crate) labels: Vec<String>,
    /// Inside are the voxels with a value above this [default: all but 0]
    #[arg(long, value_name = "T", conflicts_with = "labels", allow_negative_numbers = true,
        value_parser = values::finite)]
    pub(crate) threshold: Option<f64>,
    /// A number: which volume of a file that holds several, such as the frames of a series, from 0 on.
    /// A word: the coordinates of the mesh, world for those of the file, in its unit of length, or
    /// index for voxel indices along x, y, z. Can be given once for each [default: the only one; world]
    #[arg(long = "frame", value_name = "N|world|index")]
    frames: Vec<Frame>,
    /// Which array of a file that holds several, by its name
    #[arg(long, value_name = "NAME")]
    pub(crate) array: Option<String>,
    /// Which resolution of an OME-Zarr image, from the finest, 0, on
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) level: usize,
    /// Voxels along x, y, z of a .raw file, which has no header; the first axis is the fastest
    #[arg(long, value_name = "NX,NY,NZ", value_parser = values::dims)]
    raw_dims: Option<[usize; 3]>,
    /// Type of the values of a .raw file
    #[arg(long, value_name = "TYPE", requires = "raw_dims", default_value = "uint8",
        value_parser = values::element)]
    raw_type: ElementType,
    /// The values of a .raw file have their most significant byte first
    #[arg(long, requires = "raw_dims")]
    raw_big_endian: bool,
    /// Byte of a .raw file at which the values begin
    #[arg(long, value_name = "BYTES", requires = "raw_dims", default_value_t = 0)]
    raw_offset: u64,
    /// Order of the axes of a NumPy array; other formats name their axes
    #[arg(long, value_enum, default_value_t = Axes::Zyx)]
    pub(crate) axes: Axes,
    /// Distance of the voxels along x, y, z in the unit of the file; replaces the whole frame of the
    /// file, origin and directions too [default: what the file says; 1,1,1 for NumPy arrays]
    #[arg(long, value_name = "SX,SY,SZ", value_parser = values::spacing)]
    pub(crate) spacing: Option<[f64; 3]>,
}

/// What `--frame` can be.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Frame {
    Number(usize),
    Coordinates(FrameChoice),
}

impl FromStr for Frame {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "world" => Ok(Self::Coordinates(FrameChoice::World)),
            "index" => Ok(Self::Coordinates(FrameChoice::Index)),
            _ => text.parse().map(Self::Number).map_err(|_| {
                "give a whole number from 0 for a frame of the file, or world or index for the \
                 coordinates of the mesh"
                    .into()
            }),
        }
    }
}

impl VolumeArgs {
    /// The number of the volume in its file, if one was given.
    pub(crate) fn layer(&self) -> Option<usize> {
        self.frames.iter().rev().find_map(|frame| match frame {
            Frame::Number(number) => Some(*number),
            Frame::Coordinates(_) => None,
        })
    }

    /// The coordinates of the mesh.
    pub(crate) fn coordinates(&self) -> FrameChoice {
        self.given_coordinates().unwrap_or(FrameChoice::World)
    }

    fn given_coordinates(&self) -> Option<FrameChoice> {
        self.frames.iter().rev().find_map(|frame| match frame {
            Frame::Number(_) => None,
            Frame::Coordinates(choice) => Some(*choice),
        })
    }

    /// Fails when coordinates were chosen for a verb that writes none.
    pub(crate) fn refuse_coordinates(&self) -> Result<(), Failure> {
        match self.given_coordinates() {
            None => Ok(()),
            Some(_) => Err(Failure::Call(
                "--frame takes a number here: no coordinates are written; leave world or index out"
                    .into(),
            )),
        }
    }

    /// How the values of a file without header lie.
    pub(crate) fn raw(&self) -> Option<RawLayout> {
        self.raw_dims.map(|dims| RawLayout {
            dims,
            element: self.raw_type,
            big_endian: self.raw_big_endian,
            offset: self.raw_offset,
        })
    }

    /// Whether the call says anything about a file.
    pub(crate) fn is_given(&self) -> bool {
        self.is_selecting() || self.spacing.is_some()
    }

    /// Whether the call says which part of a file is meant.
    pub(crate) fn is_selecting(&self) -> bool {
        !self.labels.is_empty()
            || !self.frames.is_empty()
            || self.array.is_some()
            || self.level > 0
            || self.raw_dims.is_some()
            || self.threshold.is_some()
    }
}

/// How a volume file was read and what was selected, as a certificate has it.
#[derive(Serialize, Deserialize, Debug, Clone, PartialEq)]
#[serde(deny_unknown_fields)]
pub(crate) struct Reading {
    labels: Vec<String>,
    threshold: Option<f64>,
    frame: Option<usize>,
    array: Option<String>,
    level: usize,
    axes: Axes,
    spacing: Option<[f64; 3]>,
    raw: Option<RawReading>,
}

/// The layout of raw voxels, where it came with the call.
#[derive(Serialize, Deserialize, Debug, Clone, PartialEq)]
#[serde(deny_unknown_fields)]
struct RawReading {
    dims: [usize; 3],
    #[serde(rename = "type")]
    element: String,
    big_endian: bool,
    offset: u64,
}

impl Reading {
    pub(crate) fn of(args: &VolumeArgs) -> Self {
        let raw = args.raw().map(|raw| RawReading {
            dims: raw.dims,
            element: raw.element.name().into(),
            big_endian: raw.big_endian,
            offset: raw.offset,
        });
        Self {
            labels: args.labels.clone(),
            threshold: args.threshold,
            frame: args.layer(),
            array: args.array.clone(),
            level: args.level,
            axes: args.axes,
            spacing: args.spacing,
            raw,
        }
    }

    /// The same as if it were typed, with coordinates of the mesh; or what no one can have typed.
    pub(crate) fn arguments(&self, coordinates: FrameChoice) -> Result<VolumeArgs, String> {
        let raw = self.raw.as_ref();
        if let Some(spacing) = self.spacing.filter(|spacing| spacing.iter().any(|x| *x <= 0.0)) {
            return Err(format!("the spacing {spacing:?} is not positive"));
        }
        let mut frames = vec![Frame::Coordinates(coordinates)];
        frames.extend(self.frame.map(Frame::Number));
        Ok(VolumeArgs {
            labels: self.labels.clone(),
            threshold: self.threshold,
            frames,
            array: self.array.clone(),
            level: self.level,
            raw_dims: raw.map(|raw| raw.dims),
            raw_type: raw.map_or(Ok(ElementType::U8), |raw| values::element(&raw.element))?,
            raw_big_endian: raw.is_some_and(|raw| raw.big_endian),
            raw_offset: raw.map_or(0, |raw| raw.offset),
            axes: self.axes,
            spacing: self.spacing,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_a_number_or_coordinates() {
        assert_eq!("3".parse(), Ok(Frame::Number(3)));
        assert_eq!("index".parse(), Ok(Frame::Coordinates(FrameChoice::Index)));
        for text in ["", "-1", "1.5", "World", "lps"] {
            assert!(text.parse::<Frame>().is_err(), "{text}");
        }
    }
}
