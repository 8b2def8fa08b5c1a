//! Contact sheets: pictures in rows, each above two lines that say what it shows.

use crate::error::Error;
use crate::picture::Picture;
use crate::text::{self, NOTE, TITLE};

/// Pixels around each picture with its caption.
const GAP: usize = 12;
/// Pixels from a picture down to the end of its caption.
const CAPTION: usize = 6 + 2 * (text::HEIGHT + 2);

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
    /// have the letters of Latin-1, question marks for others, and three dots where they are too long.
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
                sheet.write([x, y], &line, ink);
            }
        }
        Ok(sheet)
    }
}
