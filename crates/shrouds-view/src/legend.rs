//! The column that says which colour is which number.

use std::ops::Range;

use crate::error::{Error, require};
use crate::picture::Picture;
use crate::scale::ColourScale;
use crate::text::{self, DARK, NOTE, TITLE};

/// Pixels between the column's parts and around them.
const GAP: usize = 14;
/// Pixels across the bar of colours, and of a tick beside it.
const BAR: usize = 24;
const TICK: usize = 6;
/// Pixels from the bar to its numbers.
const APART: usize = 10;
/// Least and most pixels down the bar.
const SHORTEST: usize = 80;
const LONGEST: usize = 480;
/// Pixels down a point at the end of the bar.
const POINT: usize = BAR / 2;

/// What the colours of a picture mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// What the numbers are: a word to a line.
    pub title: String,
    /// Their unit, below the title.
    pub unit: String,
    /// The colours.
    pub scale: ColourScale,
    /// Whether there are numbers below and above the range of the scale: the bar then ends in a point.
    pub beyond: [bool; 2],
}

impl Legend {
    /// Pixels across the column.
    pub fn width(&self) -> u32 {
        let words = self.title.split_whitespace().chain([self.unit.as_str()]);
        let widest = |words: &mut dyn Iterator<Item = &str>| {
            words.map(|word| text::width(word.chars().count())).max().unwrap_or(0)
        };
        let ticks = self.scale.ticks();
        let numbers = widest(&mut ticks.iter().map(|(_, text)| text.as_str()));
        (2 * GAP + widest(&mut words.into_iter()).max(BAR + APART + numbers)) as u32
    }

    /// Fewest pixels down the column.
    pub fn least_height(&self) -> u32 {
        (self.heading() + 2 * GAP + 2 * POINT + SHORTEST) as u32
    }

    /// Pixels down title and unit, and to the bar.
    fn heading(&self) -> usize {
        (self.title.split_whitespace().count() + 1) * (text::HEIGHT + 2) + 2 * GAP
    }

    /// Draws the column into the part of a picture from `left` on and down to `height`.
    pub(crate) fn draw(
        &self,
        picture: &mut Picture,
        left: usize,
        height: usize,
    ) -> Result<(), Error> {
        let least = self.least_height() as usize;
        let range = "larger, so that the legend has room";
        require(height >= least, "the height of the picture", height, range)?;
        let long = (height - self.heading() - 2 * GAP - 2 * POINT).min(LONGEST);
        // In the middle, the heading included.
        let mut y = (height - self.heading() - 2 * POINT - long) / 2;
        let left = left + GAP;
        for word in self.title.split_whitespace() {
            picture.write([left, y], word, TITLE);
            y += text::HEIGHT + 2;
        }
        picture.write([left, y], &self.unit, NOTE);
        y += text::HEIGHT + 2 + 2 * GAP + POINT;
        self.draw_bar(picture, left, y..y + long);
        Ok(())
    }

    fn draw_bar(&self, picture: &mut Picture, left: usize, rows: Range<usize>) {
        let [low, high] = self.scale.range();
        for y in rows.clone() {
            let part = (rows.end - y) as f64 - 0.5;
            let value = low + part / rows.len() as f64 * (high - low);
            picture.fill([left..left + BAR, y..y + 1], self.scale.colour(value));
        }
        for n in 0..POINT {
            let across = left + n + 1..left + BAR - n - 1;
            if self.beyond[0] {
                let y = rows.end + n;
                picture.fill([across.clone(), y..y + 1], self.scale.colour(low));
            }
            if self.beyond[1] {
                let y = rows.start - n - 1;
                picture.fill([across, y..y + 1], self.scale.colour(high));
            }
        }
        for (value, number) in self.scale.ticks() {
            let down = (high - value) / (high - low) * rows.len() as f64;
            let y = (rows.start + down.round() as usize).clamp(rows.start, rows.end - 1);
            picture.fill([left + BAR..left + BAR + TICK, y..y + 1], DARK.colour);
            let top = y.saturating_sub(text::HEIGHT / 2);
            picture.write([left + BAR + APART, top], &number, DARK);
        }
    }
}
