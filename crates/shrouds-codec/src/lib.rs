//! The compressed `.shroud` file.

pub mod coder;
pub mod counter;
pub mod logistic;
pub mod mixer;
pub mod network;
pub mod topology;
