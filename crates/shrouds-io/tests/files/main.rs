//! Files of every format, sound and damaged, through the public functions.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod archives;
mod common;
mod damage;
mod meshes;
mod tiff;
mod volumes;
mod vti;
mod written;
