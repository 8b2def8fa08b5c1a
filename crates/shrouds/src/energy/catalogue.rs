//! The measures that go by a name: one list for parser, help texts and tables.

use crate::energy::syntax::not_negative;
use crate::energy::{
    Angle, Bending, Curvature, Energy, Length, Linear, Parameter, Stretch, Variation, tension,
};

/// The tension where none is said.
const USUAL_TENSION: f64 = 0.5;

/// A measure as help texts show it and as the syntax of [`Energy`] knows it.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// How it is called, `curvature`. Alone it stands for the measure with its usual arguments.
    pub name: &'static str,
    /// What may follow in parentheses, `[parameter]`; nothing if empty. Brackets mean that it may
    /// be left out.
    pub arguments: &'static str,
    /// One line on what it measures.
    pub summary: &'static str,
    /// Whether a single voxel, and rods, plates, chains and stairs one voxel thin, all live on with
    /// between half and 1.3 times the volume of their voxels, at the minimum.
    /// Found by trying, with the usual arguments.
    pub keeps_thin_parts: bool,
    pub(super) build: Build,
}

/// What makes an energy of the arguments of an entry, or says what is wrong with them.
type Build = fn(&[&str]) -> Result<Energy, String>;

/// All measures that go by a name.
pub fn catalogue() -> &'static [Entry] {
    &ENTRIES
}

const ENTRIES: [Entry; 8] = [
    Entry {
        name: "bending",
        arguments: "",
        summary: "squared curvature integrated along the curve; the default",
        keeps_thin_parts: true,
        build: |arguments| no_arguments(arguments, Bending),
    },
    Entry {
        name: "variation",
        arguments: "",
        summary: "squared change of curvature along the curve; nothing for circles; starts from the minimum of bending",
        keeps_thin_parts: true,
        build: |arguments| no_arguments(arguments, Variation),
    },
    Entry {
        name: "curvature",
        arguments: "[parameter]",
        summary: "squared curvature of the local quadratic (equation 6); chord length if not said",
        keeps_thin_parts: false,
        build: |arguments| {
            Ok(Curvature { parameter: parameter(arguments, Parameter::Chord)? }.into())
        },
    },
    Entry {
        name: "linear",
        arguments: "[parameter]",
        summary: "squared second derivative of the local quadratic (equation 7); uniform, and then convex, if not said",
        keeps_thin_parts: false,
        build: |arguments| {
            Ok(Linear { parameter: parameter(arguments, Parameter::Uniform)? }.into())
        },
    },
    Entry {
        name: "tension",
        arguments: "[nu[, parameter]]",
        summary: "linear + nu*stretch: splines in tension; nu 0.5 and uniform if not said",
        keeps_thin_parts: false,
        build: |arguments| {
            let (nu, rest) =
                arguments.split_first().map_or((None, arguments), |(nu, rest)| (Some(nu), rest));
            let nu = nu.map_or(Ok(USUAL_TENSION), |nu| not_negative(nu))?;
            Ok(tension(nu, parameter(rest, Parameter::Uniform)?))
        },
    },
    Entry {
        name: "stretch",
        arguments: "[parameter]",
        summary: "squared first derivative of the local quadratic; for sums, blind to zigzag alone",
        keeps_thin_parts: false,
        build: |arguments| {
            Ok(Stretch { parameter: parameter(arguments, Parameter::Uniform)? }.into())
        },
    },
    Entry {
        name: "angle",
        arguments: "[squared|cosine]",
        summary: "squared turning angle, or 1 + cosine of the interior angle",
        keeps_thin_parts: false,
        build: |arguments| match arguments {
            [] | ["squared"] => Ok(Angle::Squared.into()),
            ["cosine"] => Ok(Angle::Cosine.into()),
            _ => Err(format!("{:?} is neither squared nor cosine", arguments.join(", "))),
        },
    },
    Entry {
        name: "length",
        arguments: "",
        summary: "length of the curves, so the area of the surface",
        keeps_thin_parts: false,
        build: |arguments| no_arguments(arguments, Length),
    },
];

fn no_arguments(arguments: &[&str], measure: impl Into<Energy>) -> Result<Energy, String> {
    match arguments {
        [] => Ok(measure.into()),
        [first, ..] => Err(format!("this measure takes no arguments, such as {first:?}")),
    }
}

fn parameter(arguments: &[&str], otherwise: Parameter) -> Result<Parameter, String> {
    match arguments {
        [] => Ok(otherwise),
        [name] => Parameter::from_name(name).ok_or_else(|| {
            let known = Parameter::ALL.map(Parameter::name).join(", ");
            format!("there is no parametrisation {name:?}, but {known}")
        }),
        [_, second, ..] => Err(format!("{second:?} is one argument too many")),
    }
}
