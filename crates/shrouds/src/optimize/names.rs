//! The choices of the optimisation by their names.

use std::fmt;
use std::str::FromStr;

use crate::choice::choice;
use crate::error::Error;
use crate::optimize::settings::{Preset, Solver, Start, VolumeRule};

choice!(Solver, "solver":
    Newton = "newton", "Gauss-Newton on all vertices at once";
    Sweeps = "sweeps", "The paper's method, one vertex after the other: slow";
);

choice!(Preset, "preset":
    Fast = "fast", "One step: smooth to the eye, at the least cost";
    Default = "default", "Three steps: near the minimum on smooth shapes";
    Exact = "exact", "Until it converges";
);

choice!(VolumeRule, "volume":
    Free = "free", "They are";
    Keep = "keep",
        "Every connected component of the surface encloses as many voxel volumes as voxels, where the bounds allow it. Needs the solver newton, a closed border and a primal surface";
);

impl Start {
    /// What can be written.
    pub const NAMES: &'static str =
        "blur, midpoint, inside, outside or random:SEED with a whole number";
}

/// As [`FromStr`] reads it, but for what is given as numbers.
impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Blur => f.write_str("blur"),
            Self::Midpoint => f.write_str("midpoint"),
            Self::Inside => f.write_str("inside"),
            Self::Outside => f.write_str("outside"),
            Self::Random(seed) => write!(f, "random:{seed}"),
            Self::Given(_) => f.write_str("given"),
        }
    }
}

impl FromStr for Start {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let random = || text.strip_prefix("random:").and_then(|seed| seed.parse().ok());
        match text {
            "blur" => Ok(Self::Blur),
            "midpoint" => Ok(Self::Midpoint),
            "inside" => Ok(Self::Inside),
            "outside" => Ok(Self::Outside),
            _ => random().map(Self::Random).ok_or_else(|| Error::Choice {
                setting: "start",
                value: text.into(),
                known: Self::NAMES.into(),
            }),
        }
    }
}
