//! The figures of the paper, made again: `shrouds demo figure3`, or `figures` for all and their page.
//!
//! One file a figure, each a function from the data that are there to a [`Figure`]; `page` writes them up.

mod bone;
mod brain;
mod data;
mod letters;
mod network;
mod page;
mod panel;
mod plan;
mod polygon;
mod sonar;
mod spindle;
mod statue;
mod tori;

use shrouds_view::Picture;

use crate::failure::Failure;

pub(crate) use data::Data;
pub(crate) use page::page;

/// A figure and what it shows.
pub(crate) struct Figure {
    /// What it is called here.
    pub(crate) name: &'static str,
    /// What is seen.
    pub(crate) title: &'static str,
    /// What the figure of the paper shows.
    pub(crate) paper: &'static str,
    /// What ours is made of.
    pub(crate) data: String,
    pub(crate) picture: Picture,
    pub(crate) numbers: Table,
    pub(crate) claims: Vec<Claim>,
}

/// Numbers under a figure: a line for each thing that is compared.
pub(crate) struct Table {
    pub(crate) head: Vec<&'static str>,
    pub(crate) rows: Vec<Vec<String>>,
}

/// What the paper says, what we find, and whether that agrees.
pub(crate) struct Claim {
    /// In our words.
    pub(crate) paper: &'static str,
    pub(crate) measured: String,
    pub(crate) verdict: Verdict,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Holds,
    InPart,
    No,
}

impl Verdict {
    /// Whether a measured fact is what was claimed.
    fn of(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::No }
    }

    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::InPart => "holds in part",
            Self::No => "does not hold",
        }
    }
}

type Maker = fn(&Data) -> Result<Figure, Failure>;

/// The figures in the order of the paper.
pub(crate) const FIGURES: [(&str, Maker); 11] = [
    ("figure1", polygon::figure),
    ("figure2", network::figure),
    ("figure3", tori::figure),
    ("figure4", letters::figure),
    ("figure5", statue::figure),
    ("figure6", bone::figure),
    ("figure7", spindle::figure),
    ("figure8", brain::figure),
    ("figure9", sonar::figure_9),
    ("figure10", sonar::figure_10),
    ("figure11", sonar::figure_11),
];
