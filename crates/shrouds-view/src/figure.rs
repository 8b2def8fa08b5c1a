//! Pictures with what it takes to read them: a legend, a scale bar, a caption.

use crate::camera::{Camera, Projection};
use crate::error::{Error, require};
use crate::legend::Legend;
use crate::lens::Lens;
use crate::picture::Picture;
use crate::scale::{rounded_down, text as number_text};
use crate::scene::Scene;
use crate::shade::Style;
use crate::text::{self, DARK, NOTE};

/// Pixels around the texts of the strip below.
const GAP: usize = 10;
/// Pixels down the strip below.
const STRIP: usize = text::HEIGHT + 2 * GAP;
/// Pixels down the ends and the line of a scale bar.
const ENDS: usize = 12;
const LINE: usize = 3;
/// Fewest pixels across and down that are left for the scene.
const LEAST: u32 = 64;

/// A picture with a legend in a column of its own at the right, and below it, in a strip of its own, a
/// caption and a scale bar. What is not wanted takes no room.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// What the colours mean.
    pub legend: Option<Legend>,
    /// A line below the picture, cut off with three dots where it is too long.
    pub caption: Option<String>,
    /// The unit of length of a scale bar, as it is written after 1 and after other numbers; nothing for no
    /// bar. The camera must look along parallel rays.
    pub scale_bar: Option<[String; 2]>,
}

impl Figure {
    /// Draws a scene with all that belongs to it in as many pixels as the style says.
    ///
    /// # Errors
    /// As for [`Picture::draw`]; [`Error::Setting`] when the picture is too small for what is wanted, or a
    /// scale bar in perspective.
    pub fn draw(&self, scene: &Scene, camera: &Camera, style: &Style) -> Result<Picture, Error> {
        let column = self.legend.as_ref().map_or(0, Legend::width);
        let strip =
            if self.caption.is_some() || self.scale_bar.is_some() { STRIP as u32 } else { 0 };
        if column == 0 && strip == 0 {
            return Picture::draw(scene, camera, style);
        }
        let room = "larger, so that the legend, the caption and the scene have room";
        require(style.width >= column + LEAST, "the width of the picture", style.width, room)?;
        require(style.height >= strip + LEAST, "the height of the picture", style.height, room)?;
        let inner = Style { width: style.width - column, height: style.height - strip, ..*style };
        let mut picture = Picture::plain(style.width, style.height, style.background)?;
        if let Some(legend) = &self.legend {
            legend.draw(&mut picture, inner.width as usize, inner.height as usize)?;
        }
        let bar = match &self.scale_bar {
            Some(unit) => ScaleBar::new(scene, camera, &inner, unit)?,
            None => None,
        };
        picture.put(&Picture::draw(scene, camera, &inner)?, [0, 0]);
        let top = inner.height as usize + GAP;
        let mut end = style.width as usize;
        if let Some(bar) = bar {
            let right = end - GAP;
            end = right.saturating_sub(bar.width());
            bar.draw(&mut picture, [right, top]);
        }
        if let Some(caption) = &self.caption {
            let line = text::fitted(caption, end.saturating_sub(2 * GAP));
            picture.write([GAP, top], &line, NOTE);
        }
        Ok(picture)
    }
}

/// A length and how long it looks.
struct ScaleBar {
    pixels: usize,
    label: String,
}

impl ScaleBar {
    /// A round length, at most a fifth of the picture; nothing if there is nothing to see.
    fn new(
        scene: &Scene,
        camera: &Camera,
        style: &Style,
        [one, several]: &[String; 2],
    ) -> Result<Option<Self>, Error> {
        let parallel = camera.projection == Projection::Orthographic;
        let range = "without perspective, in which lengths shrink with their distance";
        require(parallel, "the view with a scale bar", camera.projection, range)?;
        let Some(lens) = Lens::of(scene, camera, style)? else { return Ok(None) };
        let pixels_per_unit = lens.samples_per_unit() / f64::from(style.samples);
        let length = rounded_down(f64::from(style.width) / 5.0 / pixels_per_unit);
        let pixels = (length * pixels_per_unit).round();
        if !(pixels >= 1.0 && pixels <= f64::from(style.width)) {
            return Ok(None);
        }
        let number = number_text(length, length, length);
        let unit = if number == "1" { one } else { several };
        Ok(Some(Self { pixels: pixels as usize, label: format!("{number} {unit}") }))
    }

    /// Pixels across line and label.
    fn width(&self) -> usize {
        self.pixels + GAP + text::width(self.label.chars().count())
    }

    /// Draws it to the left of a place in the strip.
    fn draw(&self, picture: &mut Picture, [right, top]: [usize; 2]) {
        let Some(left) = right.checked_sub(self.width()) else { return };
        let middle = top + text::HEIGHT / 2;
        let columns = left..left + self.pixels;
        let rows = |down: usize| middle - down / 2..middle - down / 2 + down;
        picture.fill([columns.clone(), rows(LINE)], DARK.colour);
        for end in [columns.start, columns.end.saturating_sub(2)] {
            picture.fill([end..(end + 2).min(columns.end), rows(ENDS)], DARK.colour);
        }
        picture.write([columns.end + GAP, top], &self.label, DARK);
    }
}
