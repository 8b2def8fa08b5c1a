//! The real program, run on files: what it writes, says and returns.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod common;

mod bad_calls;
mod bad_input;
mod certificate;
mod chunked;
mod check;
mod compare;
mod contain;
mod edit;
mod figures;
mod gallery;
mod labels;
mod lines;
mod materials;
mod measure;
mod mesh;
mod pack;
mod polygon;
mod verbs;
mod view;
