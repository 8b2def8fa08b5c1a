//! Contact sheets: pictures in rows, each above two lines that say what it shows.

use crate::error::Error;
use crate::picture::Picture;
use crate::shade::Style;
use crate::text::{self, Ink};

/// Pixels around each picture with its caption.
const GAP: usize = 12;
/// Pixels from a picture down to the end of its caption.
const CAPTION: usize = 6 + 2 * (text::HEIGHT + 2);
const TITLE: Ink = Ink { bold: true, colour: [24, 24, 28] };
const NOTE: Ink = Ink { bold: false, colour: [90, 90, 96] };

/// One picture of a contact sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// The picture.
    pub picture: Picture,
    /// The line below it, bold.
    pub title: String,
    /// The line below that.
    pub note: String,
}

impl Picture {
    /// A contact sheet: the pictures from left to right, so many to a row, each above its caption.
    ///
    /// Every cell is as large as the largest picture; smaller ones stand in its upper left. Captions
    /// have ASCII letters, question marks for others, and three dots where they are too long.
    ///
    /// # Errors
    /// [`Error::Size`] when there is no cell or no column, or the sheet is larger than a picture may
    /// be; [`Error::Memory`].
    pub fn sheet(cells: &[Cell], columns: u32, background: [u8; 3]) -> Result<Self, Error> {
        let columns = (columns as usize).min(cells.len());
        let rows = cells.len().div_ceil(columns.max(1));
        let largest = |side: fn(&Self) -> u32| {
            cells.iter().map(|cell| side(&cell.picture) as usize).max().unwrap_or(0)
        };
        let step = [largest(Self::width) + GAP, largest(Self::height) + CAPTION + GAP];
        let side = |count: usize, step: usize| {
            let pixels = if count == 0 { 0 } else { count.saturating_mul(step) + GAP };
            u32::try_from(pixels).unwrap_or(u32::MAX)
        };
        let mut sheet = Self::plain(side(columns, step[0]), side(rows, step[1]), background)?;
        for (n, cell) in cells.iter().enumerate() {
            let [x, y] = [n % columns * step[0] + GAP, n / columns * step[1] + GAP];
            sheet.put(&cell.picture, [x, y]);
            let below = y + step[1] - GAP - CAPTION + 6;
            let lines = [(&cell.title, TITLE, below), (&cell.note, NOTE, below + text::HEIGHT + 2)];
            for (line, ink, y) in lines {
                let line = text::fitted(line, step[0] - GAP);
                let across = sheet.width() as usize;
                text::write(sheet.pixels_mut(), across, [x, y], &line, ink);
            }
        }
        Ok(sheet)
    }

    /// A picture of one colour.
    fn plain(width: u32, height: u32, colour: [u8; 3]) -> Result<Self, Error> {
        let limit = Style::MAX_SIDE;
        if [width, height].iter().any(|side| !(1..=limit).contains(side)) {
            return Err(Error::Size { width, height, limit });
        }
        let mut picture = Self::without_pixels(width, height)?;
        let count = width as usize * height as usize;
        (0..count).for_each(|_| picture.push(colour));
        Ok(picture)
    }

    /// Copies a picture to where its upper left corner is at `x`, `y`; it has to fit.
    fn put(&mut self, other: &Self, [x, y]: [usize; 2]) {
        let [across, run] = [self.width(), other.width()].map(|width| 3 * width as usize);
        for (n, row) in other.pixels().chunks_exact(run).enumerate() {
            let start = (y + n) * across + 3 * x;
            self.pixels_mut()[start..start + run].copy_from_slice(row);
        }
    }
}
