//! Regions that contain a target: against formulas, and against a target that is simulated by other means.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod formulas;
mod generator;
mod steps;
mod targets;
mod tracer;
