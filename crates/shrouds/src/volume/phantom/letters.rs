//! Block letters: flat ends, round corners, thin parts and holes, with a known topology.

use super::font::{Segment, segments};
use super::{check_shape, position, subtract};
use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// Half the thickness of a stroke, in font units.
const HALF_STROKE: f64 = 0.5;
/// Height of a letter with its strokes, in font units.
const HEIGHT: f64 = 7.0;
/// From one letter to the next, in font units: five for the letter, one between.
const ADVANCE: f64 = 6.0;

/// The lattice points of a line of block letters: capital letters, digits and spaces.
///
/// The text runs along x with its upper side towards +y, and is extruded along z. `centre` is the
/// middle of the text, `height` that of a letter and `depth` the thickness along z, all in world
/// units. Strokes are 1/7 of the height thick; the text is (6 · letters − 1)/7 of the height wide.
///
/// # Errors
/// [`Error::Setting`] when the centre is not finite, height or depth not positive and finite, or the
/// text empty or with other characters.
pub fn letters(
    grid: &Grid,
    text: &str,
    centre: [f64; 3],
    height: f64,
    depth: f64,
) -> Result<Occupancy, Error> {
    check_shape(centre, "height and depth", &[height, depth])?;
    let line = typeset(text)?;
    let unit = height / HEIGHT;
    let width = text_width(line.len(), height);
    let lower_left = [centre[0] - width / 2.0, centre[1] - height / 2.0, centre[2]];
    Ok(Occupancy::from_fn(grid.clone(), |index| {
        let [x, y, z] = subtract(position(grid, index), lower_left);
        let column = (x / unit / ADVANCE).floor();
        if z.abs() > depth / 2.0 || column < 0.0 || column >= line.len() as f64 {
            return false;
        }
        let in_cell = [x / unit - column * ADVANCE - HALF_STROKE, y / unit - HALF_STROKE];
        line[column as usize].iter().any(|s| distance_squared(in_cell, s) <= HALF_STROKE.powi(2))
    }))
}

/// Width of a line of `count` letters of this height.
pub(super) fn text_width(count: usize, height: f64) -> f64 {
    (ADVANCE * count as f64 - 1.0) * height / HEIGHT
}

fn typeset(text: &str) -> Result<Vec<Vec<Segment>>, Error> {
    let line: Option<Vec<_>> = text.chars().map(segments).collect();
    line.filter(|line| !line.is_empty()).ok_or_else(|| Error::Setting {
        name: "text",
        value: format!("{text:?}"),
        range: "made of the letters A to Z, digits and spaces",
    })
}

fn distance_squared(p: [f64; 2], [from, to]: &Segment) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let offset = [p[0] - from[0], p[1] - from[1]];
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let t = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
    let gap = [offset[0] - t * along[0], offset[1] - t * along[1]];
    dot(gap, gap)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::phantom::test_support::part_sizes;

    /// Parts of the letter and of its surroundings on one lattice plane, at `unit` points per font
    /// unit.
    fn parts_and_surroundings(text: &str, unit: f64) -> (usize, usize) {
        let height = HEIGHT * unit;
        let dims = [text_width(text.len(), height), height].map(|s| s.ceil() as usize + 4);
        let grid = Grid::new([dims[0], dims[1], 1], [1.0; 3]).unwrap();
        let centre = [(dims[0] as f64 - 1.1) / 2.0, (dims[1] as f64 - 0.9) / 2.0, 0.0];
        let volume = letters(&grid, text, centre, height, 1.0).unwrap();
        (part_sizes(&volume, true).len(), part_sizes(&volume, false).len())
    }

    #[test]
    fn every_letter_is_whole_and_has_its_holes() {
        for letter in ('A'..='Z').chain('0'..='9') {
            let holes = match letter {
                'B' | '8' => 2,
                'A' | 'D' | 'O' | 'P' | 'Q' | 'R' | '0' | '4' | '6' | '9' => 1,
                _ => 0,
            };
            for unit in [2.6, 3.0, 4.7, 8.0] {
                let expected = (1, holes + 1);
                assert_eq!(parts_and_surroundings(&letter.to_string(), unit), expected, "{letter}");
            }
        }
    }

    #[test]
    fn letters_of_a_line_stay_apart() {
        assert_eq!(parts_and_surroundings("ASU", 3.0), (3, 2));
        assert_eq!(parts_and_surroundings("A B8", 3.0), (3, 6));
    }

    #[test]
    fn a_letter_is_as_large_as_asked_for() {
        let grid = Grid::new([60, 80, 30], [1.0, 1.0, 2.0]).unwrap();
        let volume = letters(&grid, "I", [30.0, 40.0, 29.0], 56.0, 9.0).unwrap();
        let inside = |p| volume.get(p);
        // Eight points per unit: the stem of I is 8 wide, the letter 56 high, 9 deep.
        assert_eq!((0..60).filter(|&i| inside([i, 40, 14])).count(), 9, "both faces included");
        assert_eq!((0..80).filter(|&j| inside([30, j, 14])).count(), 57);
        assert_eq!((0..30).filter(|&k| inside([30, 40, k])).count(), 4);
        assert!(inside([30, 12, 14]) && inside([30, 68, 14]));
    }

    #[test]
    fn other_characters_are_refused() {
        let grid = Grid::new([4; 3], [1.0; 3]).unwrap();
        for text in ["", "A-B", "ß"] {
            assert!(letters(&grid, text, [0.0; 3], 7.0, 1.0).is_err());
        }
    }
}
