//! `shrouds mesh --materials`: the interfaces of all labels of a volume in one mesh.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use shrouds::materials::{MaterialMesh, Settings, Shrouds, shrouds};
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::optimize::Solver;
use shrouds::volume::Border;
use shrouds::{Grid, TriMesh};
use shrouds_io::{Contents, Frame, MeshFormat, Part, mesh_format, write_materials, write_meshes};
use shrouds_view::{Colours, LineSet, Scene};

use super::check_files;
use super::materials_report::{Given, Report};
use crate::args::{FrameChoice, MeshArgs, ShroudArgs};
use crate::console::{Console, print_json};
use crate::each::Target;
use crate::failure::Failure;
use crate::frame::{mesh_options, name, to_index};
use crate::input;
use crate::materials::labels;
use crate::output::{make_folder, write_json, write_picture};
use crate::picture::View;
use crate::progress::Progress;
use crate::settings::Job;

pub(super) fn run(
    args: &MeshArgs,
    job: &Job,
    start: Instant,
    console: Console,
) -> Result<(), Failure> {
    refuse_other_settings(&args.shroud)?;
    let target = Target { output: &args.output, extension: &args.format, input: &args.input };
    let is_folder = target.is_folder();
    if !is_folder && mesh_format(&args.output)? == MeshFormat::Stl {
        let message =
            "STL has no place for labels; name a folder, or a .ply, .vtp, .glb, .obj or .3mf file";
        return Err(Failure::Call(format!("{}: {message}", args.output.display())));
    }
    let files: &[&Path] = if is_folder { &[] } else { &[&args.output] };
    check_files(args, files)?;
    let progress = Progress::new(console.quiet);
    let (lattice, frame, contents) = input::contents(&args.input, &args.volume, console)?;
    let labels = labels(&args.input, &args.volume, &lattice, &progress)?;
    let read = start.elapsed().as_secs_f64();
    progress.stage("optimising");
    let mut made = shrouds(labels.clone(), &settings(job))?;
    progress.stage("checking");
    let names = names(&contents);
    let given = Given {
        input: &args.input,
        lattice: &lattice,
        frame: &frame,
        labels: &labels,
        names: &names,
    };
    let mut report = Report::new(&given, &made, job)?;
    report.times.read = read;
    progress.stage("writing");
    let writing = Instant::now();
    if let Some(path) = &args.picture {
        draw(path, &made)?;
    }
    if job.frame == FrameChoice::Index {
        to_index(&mut made.mesh.surface, &lattice);
    }
    let out = Out { frame: name(job.frame, &frame), lattice: &lattice, choice: job.frame };
    if is_folder {
        out.write_folder(&made.mesh, &target)?
    } else {
        out.write_file(&made.mesh, &args.output, console)?
    }
    report.finish(writing, start);
    if let Some(path) = &args.report {
        write_json(path, &report)?;
    }
    drop(progress);
    if args.json {
        print_json(&report)?;
    } else {
        console.message(&report.summary(&args.output));
    }
    Ok(())
}

/// The names of labels, where the file has some.
pub(crate) fn names(contents: &Contents) -> BTreeMap<i128, String> {
    contents.segments.iter().map(|segment| (segment.label, segment.name.clone())).collect()
}

/// The settings that interfaces have, too.
pub(crate) const SETTINGS: [&str; 6] =
    ["preset", "tolerance", "max-iterations", "start", "volume", "faces"];

/// The interfaces have an energy and a solver of their own.
pub(crate) fn refuse_other_settings(args: &ShroudArgs) -> Result<(), Failure> {
    let solve = &args.solve;
    let given = [
        (args.energy.is_some(), "--energy"),
        (args.crease.is_some(), "--crease"),
        (args.strict, "--strict"),
        (solve.parameter.is_some(), "--parameter"),
        (solve.solver != Solver::Newton, "--solver sweeps"),
        (solve.border != Border::Closed, "--border open"),
        (solve.surface != MeshKind::Primal, "--surface dual"),
        (solve.triangles != Triangles::Fitted, "--triangles fixed"),
    ];
    match given.into_iter().find(|(is_given, _)| *is_given) {
        None => Ok(()),
        Some((_, flag)) => {
            Err(Failure::Call(format!("--materials cannot go with {flag}; leave one of them out")))
        }
    }
}

/// The settings of a job that interfaces have.
pub(crate) fn settings(job: &Job) -> Settings {
    let own = &job.settings.optimize;
    Settings {
        faces: job.settings.faces,
        preset: own.preset,
        start: own.start.clone(),
        margin: own.margin,
        tolerance: own.tolerance(),
        volume: own.volume,
        max_iterations: own.max_iterations(),
    }
}

/// How meshes are written.
pub(crate) struct Out<'a> {
    /// The one that files name.
    pub(crate) frame: Frame,
    pub(crate) lattice: &'a Grid,
    /// The coordinates that the meshes have.
    pub(crate) choice: FrameChoice,
}

impl Out<'_> {
    fn min_spacing(&self) -> f64 {
        match self.choice {
            FrameChoice::World => self.lattice.min_spacing(),
            FrameChoice::Index => 1.0,
        }
    }

    /// All interfaces in one file.
    pub(crate) fn write_file(
        &self,
        mesh: &MaterialMesh,
        path: &Path,
        console: Console,
    ) -> Result<(), Failure> {
        let (options, warning) = mesh_options(
            &[&mesh.surface],
            mesh_format(path)?,
            self.frame.clone(),
            self.min_spacing(),
        );
        warning.iter().for_each(|warning| console.warn(warning));
        Ok(write_materials(path, mesh, &options)?)
    }

    /// A closed mesh for every label but 0.
    fn write_folder(&self, mesh: &MaterialMesh, target: &Target) -> Result<(), Failure> {
        make_folder(target.output)?;
        for (label, closed) in mesh.closed_meshes().filter(|(label, _)| *label != 0) {
            let path: PathBuf = target.output.join(format!("label-{label}.{}", target.extension));
            let (options, _) = mesh_options(
                &[&closed],
                mesh_format(&path)?,
                self.frame.clone(),
                self.min_spacing(),
            );
            let part = Part { name: "", label: Some(label), mesh: &closed, attributes: &[] };
            write_meshes(&path, &[part], &options)?;
        }
        Ok(())
    }
}

/// Draws the labels as seen from the background, each in its own colour, with the junction lines.
fn draw(path: &Path, made: &Shrouds) -> Result<(), Failure> {
    let mesh = &made.mesh;
    let outer = mesh.surface.triangles.iter().zip(&mesh.pairs).filter(|(_, pair)| pair[1] == 0);
    let (triangles, colours): (Vec<_>, Vec<_>) =
        outer.map(|(triangle, pair)| (*triangle, colour(pair[0]))).unzip();
    let outside =
        TriMesh { triangles, normals: Vec::new(), vertices: mesh.surface.vertices.clone() };
    let ends = |line: &[u32; 2]| line.map(|v| mesh.surface.vertices[v as usize]);
    let lines = LineSet::new(mesh.lines.iter().map(ends).collect(), [20, 20, 20]);
    let scene = Scene::new(&outside).colours(Colours::PerTriangle(&colours)).lines(&lines);
    write_picture(path, &View::usual().draw_scene(&scene)?)
}

/// A colour for a label: hues a golden angle apart.
fn colour(label: i64) -> [u8; 3] {
    let hue = (label as f64 * 0.618_034).rem_euclid(1.0) * 6.0;
    let light = 1.0 - 0.25 * ((label / 5).rem_euclid(3)) as f64 / 2.0;
    [0.0, 4.0, 2.0].map(|shift| {
        let distance = ((hue + shift).rem_euclid(6.0) - 3.0).abs() - 1.0;
        (255.0 * light * (0.35 + 0.65 * distance.clamp(0.0, 1.0))) as u8
    })
}
