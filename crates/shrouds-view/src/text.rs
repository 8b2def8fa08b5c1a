//! Letters into pictures: Noto Sans Mono, drawn beforehand.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Pixels from the top of a line of text to its bottom.
pub(crate) const HEIGHT: usize = RASTER.val();
const RASTER: RasterHeight = RasterHeight::Size20;

/// How letters look.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ink {
    pub(crate) bold: bool,
    pub(crate) colour: [u8; 3],
}

/// Dark letters and lines.
pub(crate) const DARK: Ink = Ink { bold: false, colour: [40, 40, 46] };
/// Names.
pub(crate) const TITLE: Ink = Ink { bold: true, colour: [24, 24, 28] };
/// What is said beside them.
pub(crate) const NOTE: Ink = Ink { bold: false, colour: [90, 90, 96] };

/// Pixels across a line of so many letters.
pub(crate) const fn width(letters: usize) -> usize {
    letters * get_raster_width(FontWeight::Regular, RASTER)
}

/// The text, or as much of its beginning as fits with three dots into so many pixels.
pub(crate) fn fitted(text: &str, pixels: usize) -> String {
    let room = pixels / width(1);
    if text.chars().count() <= room {
        return text.into();
    }
    text.chars().take(room.saturating_sub(3)).chain("...".chars()).take(room).collect()
}

/// Writes a line whose upper left corner is `x` pixels from the left and `y` from the top into rows
/// of `across` pixels. Letters that are not wholly within are left out, those that the font does not
/// have become question marks.
pub(crate) fn write(pixels: &mut [u8], across: usize, [x, y]: [usize; 2], text: &str, ink: Ink) {
    let weight = if ink.bold { FontWeight::Bold } else { FontWeight::Regular };
    let down = pixels.len() / (3 * across.max(1));
    for (n, letter) in text.chars().enumerate() {
        let left = x + width(n);
        if left + width(1) > across || y + HEIGHT > down {
            return;
        }
        let glyph = |letter| get_raster(letter, weight, RASTER);
        let Some(raster) = glyph(letter).or_else(|| glyph('?')) else { continue };
        for (row, shades) in raster.rows().enumerate() {
            let start = ((y + row) * across + left) * 3;
            for (pixel, &shade) in pixels[start..].chunks_exact_mut(3).zip(shades) {
                for (part, wanted) in pixel.iter_mut().zip(ink.colour) {
                    *part = blended(*part, wanted, shade);
                }
            }
        }
    }
}

/// Between the two, at `shade` of 255 from the first.
fn blended(from: u8, to: u8, shade: u8) -> u8 {
    let [from, to, shade] = [from, to, shade].map(u32::from);
    ((from * (255 - shade) + to * shade + 127) / 255) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Ink = Ink { bold: false, colour: [0; 3] };

    #[test]
    fn a_text_that_is_too_long_ends_in_dots() {
        assert_eq!(fitted("bending", width(7)), "bending");
        assert_eq!(fitted("bending", width(7) - 1), "ben...");
        assert_eq!(fitted("bending", width(2)), "..");
        assert_eq!(fitted("bending", 0), "");
    }

    #[test]
    fn letters_leave_ink_where_they_stand_and_nowhere_else() {
        let (across, down) = (width(4), HEIGHT + 6);
        let blank = vec![255; across * down * 3];
        let written = |text: &str, at| {
            let mut pixels = blank.clone();
            write(&mut pixels, across, at, text, BLACK);
            pixels
        };
        let pixels = written(" I ", [0, 3]);
        let dark = |pixels: &[u8]| {
            let at = |(n, _): (usize, &u8)| [n / 3 % across, n / 3 / across];
            pixels.iter().enumerate().filter(|(_, p)| **p < 128).map(at).collect::<Vec<_>>()
        };
        assert!(dark(&pixels).len() > 30);
        assert!(
            dark(&pixels)
                .iter()
                .all(|[x, y]| { (width(1)..width(2)).contains(x) && (3..3 + HEIGHT).contains(y) })
        );
        assert_eq!(written("λ", [0, 0]), written("?", [0, 0]));
        for letter in ["µ", "²", "³", "é"] {
            assert_ne!(written(letter, [0, 0]), written("?", [0, 0]), "{letter}");
        }
        assert_eq!(written("abcd", [width(1), 0]), written("abc", [width(1), 0]));
        assert_eq!(written("a", [0, 7]), blank);
        assert_eq!(written("a", [usize::MAX / 2, 0]), blank);
        write(&mut [], 0, [0, 0], "a", BLACK);
    }
}
