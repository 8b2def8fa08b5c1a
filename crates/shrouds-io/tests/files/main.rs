//! Files of every format, sound and damaged, through the public functions.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod common;
mod damage;
mod decode;
mod dicom;
mod meshes;
mod metaimage;
mod nrrd;
mod raw;
mod parts;
mod volumes;
mod zarr;
