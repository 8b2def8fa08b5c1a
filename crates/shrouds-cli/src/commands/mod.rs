//! What each verb does.

mod check;
mod check_materials;
pub(crate) mod compare;
mod contain;
mod contours;
mod demo;
mod edit;
mod figures;
mod info;
mod measure;
pub(crate) mod mesh;
mod network;
mod pack;
mod polygon;
mod render;
mod unpack;
mod view;
mod voxelize;

use crate::args::{Cli, Verb};
use crate::console::Console;
use crate::failure::Failure;

/// Runs the verb that was called.
pub(crate) fn run(cli: &Cli) -> Result<(), Failure> {
    let console = Console { quiet: cli.common.quiet };
    match &cli.verb {
        Verb::Demo(args) => demo::run(args, console),
        Verb::Mesh(args) => mesh::run(args, console),
        Verb::Check(args) => check::run(args, console),
        Verb::Info(args) => info::run(args, console),
        Verb::Render(args) => render::run(args, console),
        Verb::Compare(args) => compare::run(args, console),
        Verb::Measure(args) => measure::run(args, console),
        Verb::Network(args) => network::run(args, console),
        Verb::Contours(args) => contours::run(args, console),
        Verb::Polygon(args) => polygon::run(args, console),
        Verb::Combine(args) => edit::combine(args, console),
        Verb::Offset(args) => edit::offset(args, console),
        Verb::Crop(args) => edit::crop(args, console),
        Verb::Resample(args) => edit::resample(args, console),
        Verb::Clean(args) => edit::clean(args, console),
        Verb::Voxelize(args) => voxelize::run(args, console),
        Verb::Pack(args) => pack::run(args, console),
        Verb::Unpack(args) => unpack::run(args, console),
        Verb::Contain(args) => contain::run(args, console),
        Verb::View(args) => view::run(args, cli.common.threads),
    }
}
