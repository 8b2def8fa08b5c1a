//! The measures that go by a name: one list for parser, help texts and tables.

use crate::energy::{Bending, Curvature, Energy, Linear, Parameter, Variation};

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
    /// Whether parts one voxel thin keep between half and 1.3 times the volume of their voxels.
    pub keeps_thin_parts: bool,
    pub(super) build: Build,
}

/// What makes an energy of the arguments of an entry, or says what is wrong with them.
type Build = fn(&[&str]) -> Result<Energy, String>;

/// All measures that go by a name.
pub fn catalogue() -> &'static [Entry] {
    &ENTRIES
}

const ENTRIES: [Entry; 4] = [
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
        summary: "squared change of curvature along the curve; nothing for circles",
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
