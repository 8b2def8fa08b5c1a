//! Files of every format, sound and damaged, through the public functions.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod archives;
mod common;
mod damage;
mod decode;
mod dicom;
mod meshes;
mod metaimage;
mod nrrd;
mod parts;
mod raw;
mod tiff;
mod volumes;
mod vti;
mod written;
mod zarr;
