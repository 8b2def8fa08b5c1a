//! The presets that are measured, here and by `cargo xtask bench`: this list is the only one.

use shrouds::Settings;

/// Name and settings of every preset, the fastest first.
pub(crate) fn presets() -> Vec<(&'static str, Settings)> {
    vec![("default", Settings::default())]
}
