//! Several materials, through the public interface.

mod random;
mod shapes;
mod two_labels;
