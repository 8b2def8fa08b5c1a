//! Why the program ends without having done what was asked.

use std::process::ExitCode;

/// A failure with the one line that explains it: what, where, and what to do.
#[derive(Debug, PartialEq)]
pub(crate) enum Failure {
    /// It could not be done.
    Undone(String),
    /// The call is wrong.
    Call(String),
    /// The optimisation did not converge, and that was asked for.
    NotConverged(String),
}

impl Failure {
    pub(crate) fn message(&self) -> &str {
        match self {
            Self::Undone(message) | Self::Call(message) | Self::NotConverged(message) => message,
        }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Undone(_) => 1,
            Self::Call(_) => 2,
            Self::NotConverged(_) => 3,
        })
    }
}

impl From<shrouds::Error> for Failure {
    fn from(error: shrouds::Error) -> Self {
        use shrouds::Error::{Energy, NoSlice, Setting, UnknownPhantom};
        match error {
            Energy { .. } | NoSlice { .. } | Setting { .. } | UnknownPhantom { .. } => {
                Self::Call(error.to_string())
            }
            _ => Self::Undone(error.to_string()),
        }
    }
}

impl From<shrouds_io::Error> for Failure {
    fn from(error: shrouds_io::Error) -> Self {
        match error {
            shrouds_io::Error::Extension { .. } => Self::Call(error.to_string()),
            shrouds_io::Error::Choice { .. } => {
                Self::Undone(format!("{error}, with --frame N, --array NAME or --level N"))
            }
            _ => Self::Undone(error.to_string()),
        }
    }
}

impl From<shrouds_codec::Error> for Failure {
    fn from(error: shrouds_codec::Error) -> Self {
        match error {
            shrouds_codec::Error::Setting { .. } => Self::Call(error.to_string()),
            _ => Self::Undone(error.to_string()),
        }
    }
}

impl From<shrouds_view::Error> for Failure {
    fn from(error: shrouds_view::Error) -> Self {
        use shrouds_view::Error::{Setting, Size, TooClose};
        match error {
            Setting { .. } | Size { .. } | TooClose => Self::Call(error.to_string()),
            _ => Self::Undone(error.to_string()),
        }
    }
}
