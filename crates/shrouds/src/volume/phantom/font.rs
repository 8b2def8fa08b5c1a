//! The strokes of the block letters: capital letters, digits and the space.

/// A stroke's middle line: straight segment from one point to another, in font units.
pub(super) type Segment = [[f64; 2]; 2];

/// The segments of a letter's strokes, or `None` where the font has no such letter.
///
/// The middle lines of the strokes lie within 0 to 4 along x and 0 to 6 along y, the base line at 0.
pub(super) fn segments(letter: char) -> Option<Vec<Segment>> {
    let strokes = strokes(letter.to_ascii_uppercase())?;
    let lines = strokes.split(',').map(|stroke| stroke.split_whitespace().map(point));
    Some(
        lines
            .flat_map(|line| line.clone().zip(line.skip(1)).map(|(from, to)| [from, to]))
            .collect(),
    )
}

/// `"46"` is the point x = 4, y = 6.
fn point(digits: &str) -> [f64; 2] {
    let digit = |at: usize| f64::from(digits.as_bytes()[at] - b'0');
    [digit(0), digit(1)]
}

/// Strokes parted by commas, each a line through points.
fn strokes(letter: char) -> Option<&'static str> {
    Some(match letter {
        ' ' => "",
        'A' => "00 26 40, 12 32",
        'B' => "03 33 44 45 36 06 00 30 41 42 33",
        'C' => "45 36 16 05 01 10 30 41",
        'D' => "00 06 26 44 42 20 00",
        'E' => "46 06 00 40, 03 33",
        'F' => "46 06 00, 03 33",
        'G' => "45 36 16 05 01 10 30 41 43 23",
        'H' => "00 06, 40 46, 03 43",
        'I' => "10 30, 16 36, 20 26",
        'J' => "46 41 30 10 01",
        'K' => "00 06, 46 03 40",
        'L' => "06 00 40",
        'M' => "00 06 23 46 40",
        'N' => "00 06 40 46",
        'O' => "10 30 41 45 36 16 05 01 10",
        'P' => "00 06 36 45 44 33 03",
        'Q' => "10 30 41 45 36 16 05 01 10, 22 40",
        'R' => "00 06 36 45 44 33 03, 23 40",
        'S' => "45 36 16 05 04 13 33 42 41 30 10 01",
        'T' => "06 46, 20 26",
        'U' => "06 01 10 30 41 46",
        'V' => "06 20 46",
        'W' => "06 10 24 30 46",
        'X' => "00 46, 06 40",
        'Y' => "06 23 46, 23 20",
        'Z' => "06 46 00 40",
        '0' => "10 30 42 44 36 16 04 02 10",
        '1' => "15 26 20, 10 30",
        '2' => "05 16 36 45 44 00 40",
        '3' => "05 16 36 45 44 33 42 41 30 10 01, 23 33",
        '4' => "30 36 01 41",
        '5' => "46 06 04 34 43 41 30 10 01",
        '6' => "45 36 16 05 01 10 30 41 42 33 03",
        '7' => "06 46 20",
        '8' => "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",
        '9' => "01 10 30 41 45 36 16 05 04 13 43",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_stays_in_its_cell() {
        for letter in ('A'..='Z').chain('0'..='9') {
            for end in segments(letter).unwrap().into_iter().flatten() {
                assert!((0.0..=4.0).contains(&end[0]) && (0.0..=6.0).contains(&end[1]));
            }
            assert_eq!(segments(letter), segments(letter.to_ascii_lowercase()));
        }
        assert_eq!(segments(' '), Some(vec![]));
        assert_eq!(segments('é'), None);
    }

    #[test]
    fn a_stroke_is_its_segments() {
        let v = [[[0.0, 6.0], [2.0, 0.0]], [[2.0, 0.0], [4.0, 6.0]]];
        assert_eq!(segments('V').unwrap(), v);
    }
}
