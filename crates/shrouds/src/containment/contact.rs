//! What was heard.

use crate::containment::track::Array;

/// The way of the sound from the target to the array.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Path {
    /// Through water alone.
    #[default]
    Direct,
    /// By one reflection at the sea floor, and none at the surface.
    Bounce,
    /// One of the two; which one is not known.
    Either,
}

/// Sound from the target in a beam of the array.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// When, in seconds.
    pub time: f64,
    /// Angle between the array's axis and the direction from which the sound arrives, in degrees: 0 from
    /// ahead, 180 from astern.
    pub bearing: f64,
    /// How far the angle can be from the bearing, in degrees.
    pub half_width: f64,
    /// The way of the sound.
    pub path: Path,
    /// Least and greatest horizontal distance of the target from the array in metres, where known.
    pub range: Option<[f64; 2]>,
}

/// A contact where the array was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heard {
    pub(super) array: Array,
    /// Least and greatest cosine of the angle between axis and direction.
    pub(super) cosines: [f64; 2],
    pub(super) range: [f64; 2],
    pub(super) path: Path,
}

impl Path {
    pub(super) fn has_direct(self) -> bool {
        self != Self::Bounce
    }

    pub(super) fn has_bounce(self) -> bool {
        self != Self::Direct
    }
}

impl Contact {
    pub(super) fn heard(&self, array: Array) -> Heard {
        let cosine = |angle: f64| angle.clamp(0.0, 180.0).to_radians().cos();
        Heard {
            array,
            cosines: [1.0, -1.0].map(|side| cosine(self.bearing + side * self.half_width)),
            range: self.range.unwrap_or([0.0, f64::INFINITY]),
            path: self.path,
        }
    }

    /// What is wrong with it, if anything.
    pub(super) fn problem(&self) -> Option<String> {
        let Self { time, bearing, half_width, range, .. } = *self;
        let least = range.map_or(0.0, |[least, _]| least);
        let most = range.map_or(0.0, |[_, most]| most);
        let problem = if !time.is_finite() {
            format!("its time is {time}: give a number of seconds")
        } else if !(0.0..=180.0).contains(&bearing) {
            format!("its bearing is {bearing}, but must be between 0 and 180 degrees")
        } else if !(half_width > 0.0 && half_width <= 180.0) {
            format!("its half width is {half_width}, but must be above 0 and at most 180 degrees")
        } else if !(least >= 0.0 && least <= most) {
            format!("its range {range:?} must ascend from 0 or more")
        } else {
            return None;
        };
        Some(problem)
    }
}
