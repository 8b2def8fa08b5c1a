//! What the description of a TIFF file says of its pages: that of ImageJ, or OME-XML.

use std::collections::BTreeMap;

use crate::xml::Tags;

/// How the pages make volumes, and the lattice in the world.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan {
    pub(super) slices: usize,
    /// Channels and frames: the volumes, channels being the faster.
    pub(super) channels: usize,
    pub(super) frames: usize,
    /// Number of the page of a slice, a channel and a frame, where it is not in the order of channels,
    /// slices and frames.
    pub(super) pages: BTreeMap<[usize; 3], usize>,
    /// From one page to the next slice, channel and frame.
    pub(super) strides: [usize; 3],
    /// Distances between pixels and slices, where they are told.
    pub(super) spacing: [Option<f64>; 3],
    pub(super) unit: String,
    /// Slope and shift of the values.
    pub(super) scaling: Option<(f64, f64)>,
    /// Pages that there are to be, in one block if need be.
    pub(super) images: usize,
    pub(super) source: &'static str,
    pub(super) warnings: Vec<String>,
}

impl Plan {
    /// Every page is a slice.
    pub(super) fn slices(pages: usize) -> Self {
        Self {
            slices: pages,
            channels: 1,
            frames: 1,
            pages: BTreeMap::new(),
            strides: [1, 0, 0],
            spacing: [None; 3],
            unit: "unknown".into(),
            scaling: None,
            images: pages,
            source: "none",
            warnings: Vec::new(),
        }
    }

    /// How many pages make all the volumes.
    pub(super) fn total(&self) -> usize {
        self.slices.saturating_mul(self.channels).saturating_mul(self.frames)
    }

    /// The page of a slice of a volume.
    pub(super) fn page(&self, slice: usize, layer: usize) -> usize {
        let plane = [slice, layer % self.channels, layer / self.channels];
        let usual = || (0..3).map(|n| plane[n] * self.strides[n]).sum();
        self.pages.get(&plane).copied().unwrap_or_else(usual)
    }
}

/// What ImageJ writes; `resolution` is that of the tags, pixels per unit, and the unit of these.
pub(super) fn image_j(
    text: &str,
    pages: usize,
    resolution: [Option<f64>; 2],
    resolution_unit: u64,
) -> Option<Plan> {
    let text = text.strip_prefix("ImageJ=")?;
    let fields: BTreeMap<&str, &str> = text.lines().filter_map(|l| l.split_once('=')).collect();
    let count = |name: &str| fields.get(name)?.trim().parse::<usize>().ok().filter(|n| *n > 0);
    let number = |name: &str| fields.get(name)?.trim().parse::<f64>().ok();
    let images = count("images").unwrap_or(pages);
    let (channels, frames) = (count("channels").unwrap_or(1), count("frames").unwrap_or(1));
    let each = channels.saturating_mul(frames);
    // Plain stacks say `slices` only.
    let slices = count("slices").unwrap_or_else(|| (images / each).max(1));
    let strides = [channels, 1, channels.saturating_mul(slices)];
    let depth = number("spacing").map(f64::abs);
    // Programs that know nothing of the size of pixels write dots per inch.
    let told = fields.contains_key("unit") || depth.is_some();
    let pixel = resolution.map(|per_unit| {
        per_unit.filter(|per_unit| told && *per_unit > 0.0).map(|per_unit| 1.0 / per_unit)
    });
    let unit = match (fields.get("unit"), pixel[0].and(Some(resolution_unit))) {
        (Some(unit), _) => unit_name(unit),
        (None, Some(2)) => "inch".into(),
        (None, Some(3)) => "cm".into(),
        _ => "unknown".into(),
    };
    let scaling = match (number("cf"), number("c0"), number("c1")) {
        (Some(0.0), Some(shift), Some(slope)) if slope != 0.0 => Some((slope, shift)),
        _ => None,
    };
    let mut warnings = Vec::new();
    if slices > 1 && depth.is_none() && pixel[0].is_some() {
        warnings.push("ImageJ's description gives no spacing of slices: 1 was used.".into());
    }
    let spacing = [pixel[0], pixel[1], depth];
    let (pages, source) = (BTreeMap::new(), "ImageJ description");
    Some(Plan {
        slices,
        channels,
        frames,
        pages,
        strides,
        spacing,
        unit,
        scaling,
        images,
        source,
        warnings,
    })
}

/// What the OME-XML of the first image says.
pub(super) fn ome(text: &str, pages: usize) -> Option<Plan> {
    if !text.contains("<OME") && !text.contains(":OME") {
        return None;
    }
    let mut plan = Plan { source: "OME-XML", ..Plan::slices(pages) };
    let mut tags = Tags::new(text.as_bytes());
    let (mut images, mut sizes) = (0, [1; 3]);
    while let Ok(Some(tag)) = tags.next() {
        if tag.kind == crate::xml::Kind::End {
            continue;
        }
        let count = |name: &str| tag.get(name).and_then(|text| text.parse::<usize>().ok());
        match tag.name.as_str() {
            "Pixels" if images == 0 => {
                images = 1;
                sizes = ["SizeZ", "SizeC", "SizeT"].map(|name| count(name).unwrap_or(1).max(1));
                let order = tag.get("DimensionOrder").unwrap_or("XYZCT");
                let mut stride = 1usize;
                for axis in order.chars().filter_map(|axis| "ZCT".find(axis)) {
                    plan.strides[axis] = stride;
                    stride = stride.saturating_mul(sizes[axis]);
                }
                (plan.spacing, plan.unit) = physical(&tag);
            }
            "Pixels" => images += 1,
            "TiffData" if images == 1 => {
                let Some(start) = count("IFD") else { continue };
                let first = ["FirstZ", "FirstC", "FirstT"].map(|name| count(name).unwrap_or(0));
                // Without a count it is one plane.
                if count("PlaneCount").unwrap_or(1) == 1 {
                    plan.pages.insert(first, start);
                }
            }
            _ => {}
        }
    }
    [plan.slices, plan.channels, plan.frames] = sizes;
    plan.images = plan.total();
    if images > 1 {
        plan.warnings.push(format!("The OME-XML names {images} images: the first was read."));
    }
    if plan.slices > 1 && plan.spacing[2].is_none() && plan.spacing[0].is_some() {
        let text = "The OME-XML gives no spacing of slices: that of x was used.";
        plan.warnings.push(text.into());
        plan.spacing[2] = plan.spacing[0];
    }
    (images > 0).then_some(plan)
}

/// Sizes of a voxel, all in the unit of the first that is given.
fn physical(tag: &crate::xml::Tag) -> ([Option<f64>; 3], String) {
    let unit = |axis: char| {
        // Micrometres are what is meant by none.
        tag.get(&format!("PhysicalSize{axis}Unit")).map_or("um".into(), unit_name)
    };
    let size = |axis: char| {
        let size = tag.get(&format!("PhysicalSize{axis}"))?.parse::<f64>().ok();
        size.filter(|size| *size > 0.0 && size.is_finite())
    };
    let Some(first) = ['X', 'Y', 'Z'].into_iter().find(|axis| size(*axis).is_some()) else {
        return ([None; 3], "unknown".into());
    };
    let common = unit(first);
    let spacing = ['X', 'Y', 'Z'].map(|axis| {
        let factor = match (exponent(&unit(axis)), exponent(&common)) {
            (Some(own), Some(common)) => 10f64.powi(own - common),
            _ => 1.0,
        };
        size(axis).map(|size| size * factor)
    });
    (spacing, common)
}

/// The power of ten that a unit is in metres.
fn exponent(unit: &str) -> Option<i32> {
    let known = [("m", 0), ("cm", -2), ("mm", -3), ("um", -6), ("nm", -9), ("Å", -10)];
    known.iter().find(|(name, _)| *name == unit).map(|(_, exponent)| *exponent)
}

/// The usual name of a unit.
fn unit_name(unit: &str) -> String {
    match unit.trim() {
        "micron" | "microns" | "micrometer" | "micrometre" | "micrometers" | "µm" | "μm" | "um"
        | "\\u00B5m" | "\\u00b5m" => "um".into(),
        "nanometer" | "nanometre" | "nm" => "nm".into(),
        "millimeter" | "millimetre" | "mm" => "mm".into(),
        "centimeter" | "centimetre" | "cm" => "cm".into(),
        "meter" | "metre" | "m" => "m".into(),
        "inch" | "in" | "inches" => "inch".into(),
        "" | "pixel" | "pixels" | "null" => "unknown".into(),
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imagej_counts_channels_before_slices_before_frames() {
        let text =
            "ImageJ=1.53t\nimages=24\nchannels=2\nslices=4\nframes=3\nunit=micron\nspacing=-2.5\n";
        let plan = image_j(text, 24, [Some(4.0), Some(2.0)], 1).unwrap();
        assert_eq!((plan.slices, plan.channels, plan.frames, plan.images), (4, 2, 3, 24));
        assert_eq!(plan.spacing, [Some(0.25), Some(0.5), Some(2.5)]);
        assert_eq!(plan.unit, "um");
        // Slice 3, channel 1, frame 2.
        assert_eq!(plan.page(3, 5), 2 * 8 + 3 * 2 + 1);
    }

    #[test]
    fn dots_per_inch_are_no_spacing() {
        let plan = image_j("ImageJ=1.53t\nimages=5\n", 5, [Some(72.0); 2], 2).unwrap();
        assert_eq!((plan.slices, plan.spacing, plan.unit.as_str()), (5, [None; 3], "unknown"));
        assert!(image_j("made by hand", 5, [None; 2], 1).is_none());
    }

    #[test]
    fn ome_sizes_come_in_one_unit_and_planes_where_it_says() {
        let text = "<?xml version='1.0'?><OME xmlns='x'><Image><Pixels DimensionOrder='XYTZC' SizeX='9' \
            SizeY='8' SizeZ='3' SizeC='2' SizeT='4' PhysicalSizeX='0.5' PhysicalSizeY='500' \
            PhysicalSizeYUnit='nm' PhysicalSizeZ='0.002' PhysicalSizeZUnit='mm'>\
            <TiffData IFD='7' FirstZ='0' FirstC='0' FirstT='0'/></Pixels></Image>\
            <Image><Pixels SizeZ='99'/></Image></OME>";
        let plan = ome(text, 30).unwrap();
        assert_eq!((plan.slices, plan.channels, plan.frames), (3, 2, 4));
        assert_eq!(plan.unit, "um");
        for (size, expected) in plan.spacing.iter().zip([0.5, 0.5, 2.0]) {
            assert!((size.unwrap() - expected).abs() < 1e-12);
        }
        assert_eq!(plan.page(0, 0), 7);
        // Slice 2, channel 1, frame 3: frames are the fastest here, then slices.
        assert_eq!(plan.page(2, 7), 3 + 4 * 2 + 12);
        assert!(plan.warnings[0].contains("2 images"));
    }
}
