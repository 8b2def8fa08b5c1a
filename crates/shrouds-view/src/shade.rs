//! Style, light, and colours in and out of linear light.

use crate::error::{Error, require};
use crate::vector::{Vector, dot, is_finite, length, scaled};

/// Whether triangles look flat or round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// One brightness per triangle, from its own normal: the mesh as it is.
    #[default]
    Flat,
    /// Brightness from the vertex normals, blended across triangles: those of the mesh, or means of
    /// the triangle normals weighted by area where it has none.
    Smooth,
}

/// How the picture looks. Colours are sRGB, 8 bits each of red, green, blue.
///
/// A point whose unit normal on the seen side is n has the colour of its surface times
/// `ambient + diffuse · max(0, n·l)` in linear light, l the unit vector along `light`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Pixels across, 1 to [`Style::MAX_SIDE`].
    pub width: u32,
    /// Pixels down, 1 to [`Style::MAX_SIDE`].
    pub height: u32,
    /// Each pixel is the mean of `samples × samples` samples: 1 (jagged) to 4.
    pub samples: u32,
    /// Free border on each side, as a fraction of the shorter side: 0 to 0.4.
    pub margin: f64,
    /// Colour where nothing is.
    pub background: [u8; 3],
    /// Colour of the inner side of the surface.
    pub back: [u8; 3],
    /// Flat or smooth.
    pub shading: Shading,
    /// Share of light from everywhere, 0 to 1.
    pub ambient: f64,
    /// Share of light from the lamp, 0 to 1.
    pub diffuse: f64,
    /// Direction towards the lamp as the viewer sees it: right, up, towards the viewer.
    pub light: [f64; 3],
}

impl Default for Style {
    fn default() -> Self {
        Self {
            width: 1200,
            height: 900,
            samples: 3,
            margin: 0.05,
            background: [246, 246, 244],
            back: [128, 62, 52],
            shading: Shading::Flat,
            ambient: 0.2,
            diffuse: 0.8,
            light: [-0.8, 1.0, 2.2],
        }
    }
}

impl Style {
    /// The largest width and height.
    pub const MAX_SIDE: u32 = 32768;

    pub(crate) fn check(&self) -> Result<(), Error> {
        let (width, height, limit) = (self.width, self.height, Self::MAX_SIDE);
        if [width, height].iter().any(|side| !(1..=limit).contains(side)) {
            return Err(Error::Size { width, height, limit });
        }
        require((1..=4).contains(&self.samples), "samples", self.samples, "between 1 and 4")?;
        require((0.0..=0.4).contains(&self.margin), "the margin", self.margin, "0 to 0.4")?;
        require((0.0..=1.0).contains(&self.ambient), "the ambient light", self.ambient, "0 to 1")?;
        require((0.0..=1.0).contains(&self.diffuse), "the diffuse light", self.diffuse, "0 to 1")?;
        let shines = is_finite(self.light) && (1e-9..=1e9).contains(&length(self.light));
        require(shines, "the light", self.light, "a direction of length 1e-9 to 1e9")
    }

    /// The part of its colour that a surface with this normal sends to the viewer; the normal, in
    /// view coordinates, points to the seen side and need not have unit length.
    pub(crate) fn brightness(&self, normal: Vector) -> f64 {
        let lengths = length(normal) * length(self.light);
        let cosine = if lengths > 0.0 { dot(normal, self.light) / lengths } else { 0.0 };
        (self.ambient + self.diffuse * cosine.max(0.0)).min(1.0)
    }
}

/// Linear light of one sample, 16 bits for each of red, green, blue.
pub(crate) type Sample = [u16; 3];

/// The tables between sRGB bytes and linear light (IEC 61966-2-1).
pub(crate) struct Gamma {
    linear: [u16; 256],
    /// Byte of every 16-bit amount of light.
    byte: Vec<u8>,
}

impl Gamma {
    pub(crate) fn new() -> Self {
        let light = |byte: f64| {
            let s = byte / 255.0;
            let linear = if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
            65535.0 * linear
        };
        let linear = std::array::from_fn(|byte| light(byte as f64).round() as u16);
        let mut byte = Vec::with_capacity(65536);
        for value in 0..=255u8 {
            // This byte is the nearest one up to half a step above it.
            let end =
                if value == 255 { 65536 } else { light(f64::from(value) + 0.5).ceil() as usize };
            byte.resize(end, value);
        }
        Self { linear, byte }
    }

    /// Linear light of a colour, each part from 0 to 1.
    pub(crate) fn light(&self, colour: [u8; 3]) -> Vector {
        self.sample(colour).map(|part| f64::from(part) / 65535.0)
    }

    pub(crate) fn sample(&self, colour: [u8; 3]) -> Sample {
        colour.map(|part| self.linear[usize::from(part)])
    }

    /// The colour of linear light.
    pub(crate) fn colour(&self, sample: Sample) -> [u8; 3] {
        sample.map(|part| self.byte[usize::from(part)])
    }
}

/// The sample of a colour in linear light (0 to 1) under a brightness.
pub(crate) fn lit(light: Vector, brightness: f64) -> Sample {
    scaled(light, 65535.0 * brightness).map(|part| (part + 0.5) as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_linear_light() {
        let gamma = Gamma::new();
        assert_eq!(gamma.byte.len(), 65536);
        for byte in 0..=255 {
            assert_eq!(gamma.colour(gamma.sample([byte; 3])), [byte; 3]);
        }
        // Half the light is 188 of 255 in sRGB.
        assert_eq!(gamma.colour([32768; 3]), [188; 3]);
    }
}
