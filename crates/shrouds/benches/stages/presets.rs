//! The presets that are measured, here and by `cargo xtask bench`: this list is the only one.

use shrouds::Settings;
use shrouds::optimize::Preset;

/// Name and settings of every preset, the fastest first.
pub(crate) fn presets() -> Vec<(&'static str, Settings)> {
    let with = |preset| {
        let mut settings = Settings::default();
        settings.optimize.preset = preset;
        settings
    };
    [("fast", Preset::Fast), ("default", Preset::Default), ("exact", Preset::Exact)]
        .map(|(name, preset)| (name, with(preset)))
        .into()
}
