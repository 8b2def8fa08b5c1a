//! What is said about a shroud in numbers: the report and the measurements, in the words and the order
//! in which the program's JSON and the Python package have them.
//!
//! [`report`](Lattice) holds the parts of the report, [`measure`] the columns of a body, [`looks`] what a
//! mesh looks like.

pub mod looks;
mod materials;
pub mod measure;
mod report;
pub mod vector;

pub use materials::{
    Contact, KeptVolumes, LabelChecks, LabelReport, MaterialSolver, MaterialTopology, Materials,
    contacts, label_reports,
};
pub use report::{
    Checks, FirstLast, FoundExpected, Geometry, Lattice, RmsMax, RoundReport, SolverReport, Times,
    Topology, VolumeReport, peak_memory,
};
