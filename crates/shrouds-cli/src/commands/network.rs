//! `shrouds network`: the planar curves of a volume's shroud as lines.

use std::time::Instant;

use serde::Serialize;
use shrouds::Grid;
use shrouds::measure::{Contour, network_contours};
use shrouds::mesh::MeshKind;
use shrouds::network::Network;

use crate::args::{FrameChoice, NetworkArgs};
use crate::console::{Console, grouped, number, plural, print_json};
use crate::failure::Failure;
use crate::frame;
use crate::input;
use crate::lines;
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::{Input, SolverReport};
use crate::settings::{Job, SettingsReport};
use crate::work;

#[derive(Serialize)]
struct Report {
    input: Input,
    settings: SettingsReport,
    solver: SolverReport,
    /// Curves across the axes of the lattice.
    families: Vec<Family>,
    /// Seconds.
    time: f64,
    version: &'static str,
}

#[derive(Serialize)]
struct Family {
    axis: &'static str,
    /// Slices that have curves.
    slices: usize,
    curves: usize,
    /// Those that an open border ends.
    open: usize,
    vertices: usize,
    length: f64,
}

pub(crate) fn run(args: &NetworkArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    if args.shroud.solve.surface == MeshKind::Dual {
        let message = "the network is part of the primal mesh only: leave --surface dual out";
        return Err(Failure::Call(message.into()));
    }
    let job = Job::new(&args.shroud, args.volume.coordinates())?;
    shrouds_io::volume_format(&args.input)?;
    lines::check_format(&args.output)?;
    check_targets(&[&args.output], &[&args.input])?;
    job.warn(console);
    let progress = Progress::new(console.quiet);
    let source = input::source(&args.input, &args.volume, console, &progress)?;
    let mut shroud = work::shroud(&source.occupancy, &job, &progress)?;
    progress.stage("following the curves");
    let network = Network::trace(&shroud.surface);
    let mut grid = source.occupancy.grid().clone();
    if job.frame == FrameChoice::Index {
        frame::to_index(&mut shroud.mesh, &grid);
        grid = Grid::new(grid.dims(), [1.0; 3])?;
    }
    let families = network_contours(&shroud.surface, &network, &shroud.mesh.vertices, &grid);
    progress.stage("writing");
    let curves: Vec<(usize, &Contour)> = families
        .iter()
        .enumerate()
        .flat_map(|(axis, family)| family.iter().map(move |contour| (axis, contour)))
        .collect();
    lines::write(&args.output, &curves, "slice", Some(frame::name(job.frame, &source.frame)))?;
    let report = Report {
        input: Input::new(&source),
        settings: job.report.clone(),
        solver: SolverReport::new(&shroud.report),
        families: families.iter().enumerate().map(|(axis, f)| Family::new(axis, f)).collect(),
        time: start.elapsed().as_secs_f64(),
        version: env!("CARGO_PKG_VERSION"),
    };
    drop(progress);
    if args.json {
        print_json(&report)?;
    } else {
        let families: Vec<String> = report.families.iter().map(Family::in_words).collect();
        let (path, families) = (args.output.display(), families.join(", "));
        let vertices = grouped(shroud.mesh.vertices.len() as u64);
        console.message(&format!(
            "{path}: {families}, through {vertices} vertices, {:.2} s",
            report.time
        ));
    }
    work::converged(&shroud.report, &job, console)
}

impl Family {
    fn new(axis: usize, curves: &[Contour]) -> Self {
        let mut slices: Vec<i64> = curves.iter().map(|curve| curve.position as i64).collect();
        slices.sort_unstable();
        slices.dedup();
        Self {
            axis: ["i", "j", "k"][axis],
            slices: slices.len(),
            curves: curves.len(),
            open: curves.iter().filter(|curve| !curve.closed).count(),
            vertices: curves.iter().map(|curve| curve.points.len()).sum(),
            length: curves.iter().map(|curve| curve.length).sum(),
        }
    }

    fn in_words(&self) -> String {
        let Self { axis, slices, curves, length, .. } = self;
        let (curves, slices) = (plural(*curves, "curve"), plural(*slices, "slice"));
        format!("{curves} across {axis} in {slices} (length {})", number(*length))
    }
}
