//! Numbers as colours, and round numbers beside them.

use crate::error::{Error, require};

/// The colours from −1 to 1, at equal distances. Blue and orange are told apart with every kind of colour
/// blindness, and both get darker away from the middle, so that the map can be read without any colour.
const COLOURS: [[u8; 3]; 9] = [
    [8, 48, 107],
    [22, 96, 164],
    [71, 145, 201],
    [158, 198, 226],
    [228, 226, 220],
    [246, 199, 150],
    [230, 140, 58],
    [196, 92, 14],
    [127, 45, 4],
];
/// Where there is no number.
const NONE: [u8; 3] = [128; 3];

/// A diverging map from numbers to colours: blue below a centre, orange above it, light grey there.
///
/// Equal distances from the centre on both sides look equally strong; the colours at the end of the range
/// that is farther from it are the darkest. What is beyond the range looks like its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourScale {
    low: f64,
    high: f64,
    centre: f64,
}

impl ColourScale {
    /// A scale of the numbers from `low` to `high`.
    ///
    /// # Errors
    /// [`Error::Setting`] unless all three are finite and `low` lies below `high`.
    pub fn new(low: f64, high: f64, centre: f64) -> Result<Self, Error> {
        let finite = [low, high, centre, high - low].iter().all(|x| x.is_finite());
        let range = "two finite numbers, the smaller first";
        require(finite && low < high, "the range of the colours", [low, high], range)?;
        Ok(Self { low, high, centre })
    }

    /// The smallest and the largest number.
    pub fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// The sRGB colour of a number; grey for what is none.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        if value.is_nan() {
            return NONE;
        }
        let reach = (self.high - self.centre).abs().max((self.low - self.centre).abs());
        let t = (value.clamp(self.low, self.high) - self.centre) / reach;
        let place = (t.clamp(-1.0, 1.0) + 1.0) / 2.0 * (COLOURS.len() - 1) as f64;
        let before = (place as usize).min(COLOURS.len() - 2);
        let part = place - before as f64;
        std::array::from_fn(|i| {
            let [from, to] = [COLOURS[before][i], COLOURS[before + 1][i]].map(f64::from);
            (from + part * (to - from)).round() as u8
        })
    }

    /// Round numbers within the range, at equal distances, with their texts.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let step = rounded_up((self.high - self.low) / 7.0);
        let [first, last] = [(self.low / step - 1e-9).ceil(), (self.high / step + 1e-9).floor()];
        let count = (last - first).clamp(0.0, 10.0) as u32;
        let largest = self.low.abs().max(self.high.abs());
        let number = |n: u32| (first + f64::from(n)) * step;
        (0..=count).map(|n| (number(n), text(number(n), step, largest))).collect()
    }
}

/// The smallest 1, 2 or 5 times a power of ten that is not below a positive number.
pub(crate) fn rounded_up(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let found = [1.0, 2.0, 5.0].map(|n| n * power).into_iter().find(|n| *n >= x * (1.0 - 1e-9));
    found.unwrap_or(10.0 * power)
}

/// The largest 1, 2 or 5 times a power of ten that is not above a positive number.
pub(crate) fn rounded_down(x: f64) -> f64 {
    let up = rounded_up(x);
    let power = 10f64.powf(x.log10().floor());
    let below = [5.0, 2.0, 1.0].map(|n| n * power).into_iter().find(|n| *n <= x * (1.0 + 1e-9));
    below.unwrap_or(up)
}

/// A multiple of a step with as many digits as the step has; with an exponent beside very small and very
/// large numbers.
pub(crate) fn text(x: f64, step: f64, largest: f64) -> String {
    if x.abs() < step / 2.0 {
        return "0".into();
    }
    let place = (step * (1.0 + 1e-9)).log10().floor();
    if !(1e-4..1e6).contains(&largest.max(step)) {
        let digits = (x.abs().log10().floor() - place).max(0.0) as usize;
        return format!("{x:.digits$e}");
    }
    format!("{x:.*}", (-place).max(0.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(low: f64, high: f64) -> Vec<String> {
        let scale = ColourScale::new(low, high, 0.0).unwrap();
        scale.ticks().into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(texts(-0.2, 0.2), ["-0.2", "-0.1", "0", "0.1", "0.2"]);
        assert_eq!(
            texts(0.0, 1.0),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"].map(|t| if t == "0.0" { "0" } else { t })
        );
        assert_eq!(texts(-3.0, 17.0), ["0", "5", "10", "15"]);
        assert_eq!(texts(-2e-6, 2e-6), ["-2e-6", "-1e-6", "0", "1e-6", "2e-6"]);
        assert_eq!(texts(1e8, 3e8), ["1.0e8", "1.5e8", "2.0e8", "2.5e8", "3.0e8"]);
        for (low, high) in [(-1e-300, 1e-300), (-1e300, 1e300), (1.0, 1.0 + 1e-12), (7.0, 7.3)] {
            let scale = ColourScale::new(low, high, 0.0).unwrap();
            let ticks = scale.ticks();
            assert!((2..=11).contains(&ticks.len()), "{low} {high}: {ticks:?}");
        }
        assert_eq!([0.3, 1.0, 7.0, 2e-5].map(rounded_up), [0.5, 1.0, 10.0, 2e-5]);
        assert_eq!([0.3, 1.0, 7.0, 5e3].map(rounded_down), [0.2, 1.0, 5.0, 5e3]);
    }

    #[test]
    fn colours_diverge_from_the_centre() {
        let scale = ColourScale::new(-1.0, 2.0, 0.0).unwrap();
        assert_eq!(scale.colour(0.0), COLOURS[4]);
        assert_eq!((scale.colour(2.0), scale.colour(9.0)), (COLOURS[8], COLOURS[8]));
        assert_eq!((scale.colour(-1.0), scale.colour(-7.0)), (COLOURS[2], COLOURS[2]));
        assert_eq!(scale.colour(f64::NAN), NONE);
        let apart = ColourScale::new(0.1, 0.2, 0.0).unwrap();
        assert_eq!((apart.colour(0.1), apart.colour(0.2)), (COLOURS[6], COLOURS[8]));
        for [low, high, centre] in [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [0.0, f64::NAN, 0.0]] {
            assert!(ColourScale::new(low, high, centre).is_err());
        }
    }

    #[test]
    fn without_colour_the_map_still_tells_how_far() {
        // Lightness falls on both sides: Rec. 709 luma of the sRGB bytes.
        let luma = |c: [u8; 3]| {
            0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2])
        };
        let lumas = COLOURS.map(luma);
        for n in 0..4 {
            assert!(
                lumas[n] + 20.0 < lumas[n + 1] && lumas[8 - n] + 20.0 < lumas[7 - n],
                "{lumas:?}"
            );
        }
    }
}
