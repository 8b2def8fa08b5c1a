//! Files of every format, sound and damaged, through the public functions.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod common;
mod damage;
mod dicom;
mod meshes;
mod volumes;
mod zarr;
