//! `shrouds demo`: a phantom, its shroud, a picture and the numbers.

use std::path::{Path, PathBuf};
use std::time::Instant;

use shrouds::mesh::MeshKind;
use shrouds_io::{write_labels, write_npy};

use crate::args::DemoArgs;
use crate::commands::figures;
use crate::console::{Console, grouped, number, plural, print_json};
use crate::failure::Failure;
use crate::output::{check_targets, make_folder};
use crate::phantom;
use crate::picture::NETWORK_ON_DUAL;
use crate::progress::Progress;
use crate::report::Report;
use crate::settings::Job;
use crate::work::{Extras, Outputs, produce};

const VOLUME: &str = "volume.npy";

/// The files of a demo, in their folder.
struct Files {
    volume: PathBuf,
    mesh: PathBuf,
    picture: PathBuf,
    report: PathBuf,
}

pub(crate) fn run(args: &DemoArgs, console: Console) -> Result<(), Failure> {
    if figures::is_figure(&args.name) {
        return figures::run(args, console);
    }
    let start = Instant::now();
    let job = Job::new(&args.shroud, args.frame.frame)?;
    if args.network && args.shroud.solve.surface == MeshKind::Dual {
        return Err(Failure::Call(NETWORK_ON_DUAL.into()));
    }
    job.warn(console);
    let progress = Progress::new(console.quiet);
    progress.stage("building the phantom");
    let size = phantom::size(&args.name, args.size);
    let (source, labels) = phantom::labelled(&args.name, size, args.output.join(VOLUME), start)?;
    let files = Files::in_folder(&args.output)?;
    match labels {
        Some(labels) => {
            let labels = labels.iter().map(|&label| label.into());
            write_labels(&files.volume, &source.lattice, labels, &source.frame)?;
        }
        None => write_npy(&files.volume, &source.occupancy)?,
    }
    let outputs =
        Outputs { mesh: &files.mesh, picture: Some(&files.picture), report: Some(&files.report) };
    let extras = Extras { network: args.network, ..Extras::default() };
    let done = produce(&source, &job, &outputs, &extras, start, console, &progress)?;
    drop(progress);
    if args.json {
        print_json(&done.report)?;
    } else {
        console.result(&numbers(&args.name, &done.report))?;
        console.result(&files.list())?;
    }
    done.verdict(&job, console)
}

impl Files {
    /// Makes the folder and finds out whether the files can appear in it.
    fn in_folder(folder: &Path) -> Result<Self, Failure> {
        make_folder(folder)?;
        let files = Self {
            volume: folder.join(VOLUME),
            mesh: folder.join("mesh.ply"),
            picture: folder.join("picture.png"),
            report: folder.join("report.json"),
        };
        let Self { volume, mesh, picture, report } = &files;
        check_targets(&[volume, mesh, picture, report], &[])?;
        Ok(files)
    }

    fn list(&self) -> String {
        let Self { volume, mesh, picture, report } = self;
        let about = [
            (picture, "look at it first"),
            (mesh, "the surface"),
            (report, "these numbers and more"),
            (volume, "the voxels: try `shrouds mesh` on them"),
        ];
        let width = about.iter().map(|(path, _)| path.display().to_string().chars().count()).max();
        let width = width.unwrap_or(0);
        let lines =
            about.map(|(path, about)| format!("  {:<width$}  {about}", path.display().to_string()));
        format!("\nFiles\n{}", lines.join("\n"))
    }
}

/// The numbers as a table for people.
fn numbers(name: &str, report: &Report) -> String {
    let Report { input, topology, solver, geometry, checks, times, .. } = report;
    let [nx, ny, nz] = input.lattice.dims;
    let points = grouped((nx * ny * nz) as u64);
    let against = |value: f64, truth: Option<f64>| match truth {
        Some(truth) => {
            let error = 100.0 * (value / truth - 1.0);
            format!("{}  (truth {}: {error:+.2} %)", number(value), number(truth))
        }
        None => number(value),
    };
    let mut rows = vec![
        ("voxels", format!("{} inside, of {nx} × {ny} × {nz}", grouped(input.inside))),
        (
            "surface",
            format!(
                "{} vertices, {} triangles, {}",
                grouped(topology.vertices),
                grouped(topology.triangles),
                plural(topology.components, "component"),
            ),
        ),
        ("volume", against(geometry.volume, geometry.true_volume)),
        ("area", against(geometry.area, geometry.true_area)),
        (
            "energy",
            format!(
                "{} at the start, {} in the end: {} after {}",
                number(solver.energy.first),
                number(solver.energy.last),
                solver.status,
                plural(solver.iterations, "iteration"),
            ),
        ),
        ("wrong side", format!("{} of {points} voxels", checks.wrong_side)),
        ("time", format!("{:.2} s, of which {:.2} s to optimise", times.total, times.optimize)),
    ];
    rows.extend(report.shortfall().map(|text| ("convergence", text)));
    let lines: Vec<String> =
        rows.into_iter().map(|(key, value)| format!("  {key:<12}{value}")).collect();
    format!("Shroud of the phantom '{name}'\n{}", lines.join("\n"))
}
