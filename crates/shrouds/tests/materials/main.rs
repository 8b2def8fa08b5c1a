//! Several materials, through the public interface.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod kept;
mod random;
mod shapes;
mod two_labels;
