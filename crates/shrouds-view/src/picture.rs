//! The finished picture: drawn band by band, so that memory does not grow with the mesh.

use std::io::Write;
use std::ops::Range;

use crate::camera::Camera;
use crate::error::Error;
use crate::lens::Lens;
use crate::paint::Painter;
use crate::raster::Band;
use crate::scene::Scene;
use crate::shade::{Gamma, Sample, Style};
use crate::text::{self, Ink};

/// Samples held at a time, if a single row of pixels does not need more.
const BAND: usize = 1 << 22;

/// A picture of 8-bit sRGB pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

impl Picture {
    /// Draw a scene. The same input gives the same bytes on every run.
    ///
    /// Triangles without area do not show; a scene without triangles and lines gives the background.
    /// Besides the pixels, about 40 megabytes are needed at most, and for smooth shading three numbers
    /// per vertex.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Memory`] for the size of the picture; [`Error::Setting`] for camera,
    /// style and line widths; [`Error::NotFinite`], [`Error::Index`], [`Error::Length`] for a damaged
    /// mesh or colours that do not fit it; [`Error::TooClose`] when the scene is thousands of times
    /// larger than what the camera frames.
    pub fn draw(scene: &Scene, camera: &Camera, style: &Style) -> Result<Self, Error> {
        style.check()?;
        scene.check()?;
        let (width, height) = (style.width as usize, style.height as usize);
        let samples = style.samples as usize;
        let lens = Lens::of(scene, camera, style)?;
        let mut picture = Self::without_pixels(style.width, style.height)?;

        let gamma = Gamma::new();
        let background = gamma.sample(style.background);
        let painter = match &lens {
            Some(lens) => Some(Painter::new(scene, style, lens, &gamma)?),
            None => None,
        };
        let rows_at_once = (BAND / (width * samples * samples)).max(1);
        for top in (0..height).step_by(rows_at_once) {
            let rows = top * samples..(top + rows_at_once).min(height) * samples;
            let mut band = Band::new(width * samples, rows, background);
            if let Some(painter) = &painter {
                painter.paint(&mut band);
            }
            shrink(band.samples(), width, samples, &gamma, &mut picture.pixels);
        }
        Ok(picture)
    }

    /// A picture of this size with room for its pixels.
    pub(crate) fn without_pixels(width: u32, height: u32) -> Result<Self, Error> {
        let mut pixels = Vec::new();
        let bytes = width as usize * height as usize * 3;
        pixels.try_reserve_exact(bytes).map_err(|_| Error::Memory { width, height })?;
        Ok(Self { width, height, pixels })
    }

    /// A picture of one colour.
    pub(crate) fn plain(width: u32, height: u32, colour: [u8; 3]) -> Result<Self, Error> {
        let limit = Style::MAX_SIDE;
        if [width, height].iter().any(|side| !(1..=limit).contains(side)) {
            return Err(Error::Size { width, height, limit });
        }
        let mut picture = Self::without_pixels(width, height)?;
        let count = width as usize * height as usize;
        (0..count).for_each(|_| picture.pixels.extend(colour));
        Ok(picture)
    }

    /// Copies a picture to where its upper left corner is at `x`, `y`; it has to fit.
    pub(crate) fn put(&mut self, other: &Self, [x, y]: [usize; 2]) {
        let [across, run] = [self.width, other.width].map(|width| 3 * width as usize);
        for (n, row) in other.pixels.chunks_exact(run).enumerate() {
            let start = (y + n) * across + 3 * x;
            self.pixels[start..start + run].copy_from_slice(row);
        }
    }

    /// Fills a rectangle of columns and rows with a colour; it has to fit.
    pub(crate) fn fill(&mut self, [columns, rows]: [Range<usize>; 2], colour: [u8; 3]) {
        for y in rows {
            let start = y * self.width as usize;
            for x in columns.clone() {
                self.pixels[3 * (start + x)..][..3].copy_from_slice(&colour);
            }
        }
    }

    /// Writes a line of text whose upper left corner is at `x`, `y`; letters that do not fit are left
    /// out.
    pub(crate) fn write(&mut self, place: [usize; 2], line: &str, ink: Ink) {
        text::write(&mut self.pixels, self.width as usize, place, line, ink);
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green, blue of every pixel, row by row from the top left: `height × width × 3`.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Red, green, blue of the pixel `x` from the left and `y` from the top; none outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let start = (y as usize * self.width as usize + x as usize) * 3;
        Some([self.pixels[start], self.pixels[start + 1], self.pixels[start + 2]])
    }

    /// Write the picture as a PNG file.
    ///
    /// # Errors
    /// [`Error::Png`] when the writer fails.
    pub fn write_png<W: Write>(&self, writer: W) -> Result<(), Error> {
        let mut encoder = png::Encoder::new(writer, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        writer.finish()?;
        Ok(())
    }
}

/// Means of `samples × samples` samples in linear light, appended as sRGB pixels.
fn shrink(band: &[Sample], width: usize, samples: usize, gamma: &Gamma, pixels: &mut Vec<u8>) {
    let row = width * samples;
    let count = (samples * samples) as u32;
    for rows in band.chunks_exact(row * samples) {
        for x in 0..width {
            let mut sum = [0u32; 3];
            for line in rows.chunks_exact(row) {
                for sample in &line[x * samples..(x + 1) * samples] {
                    sum = std::array::from_fn(|i| sum[i] + u32::from(sample[i]));
                }
            }
            pixels.extend(gamma.colour(sum.map(|part| ((part + count / 2) / count) as u16)));
        }
    }
}
