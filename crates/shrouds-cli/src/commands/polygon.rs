//! `shrouds polygon`: an image in, its optimal separating polygons out.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::optimize::{Preset, Solver, VolumeRule};
use shrouds::polygon::{Polygon, Separation, place, separate_observed};
use shrouds::volume::Border;
use shrouds::{Grid, Occupancy};
use shrouds_io::{
    Attribute, Line, MeshOptions, Precision, volume_format, write_atomically, write_lines_with,
};
use shrouds_view::Plan;

use crate::args::{FrameChoice, PolygonArgs, Slice, SolveArgs};
use crate::console::{Console, grouped, number, plural, print_json};
use crate::failure::Failure;
use crate::frame;
use crate::input::{self, Source};
use crate::output::{check_targets, write_json};
use crate::progress::Progress;
use crate::report::{Input, SolverReport};
use crate::settings::{Job, SettingsReport};
use crate::work;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Format {
    Svg,
    Lines,
    Json,
}

/// Everything about the polygons but their points.
#[derive(Debug, Clone, Serialize)]
struct Report {
    input: Input,
    /// The axis across the image and its index, as typed.
    slice: String,
    settings: SettingsReport,
    solver: SolverReport,
    geometry: Geometry,
    /// Seconds.
    times: Times,
    version: &'static str,
}

/// In world units.
#[derive(Debug, Clone, Copy, Serialize)]
struct Geometry {
    vertices: usize,
    /// Polygons around inside points, around holes, and open ones, which an open border ends.
    around: usize,
    holes: usize,
    open: usize,
    /// Inside area, unless there are open polygons.
    area: Option<f64>,
    length: f64,
    /// Inside points times the area of one pixel.
    pixel_area: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Times {
    read: f64,
    optimize: f64,
    total: f64,
}

/// The file with everything.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    report: &'a Report,
    polygons: Vec<PolygonReport<'a>>,
}

#[derive(Serialize)]
struct PolygonReport<'a> {
    closed: bool,
    /// Negative for a hole.
    area: f64,
    length: f64,
    points: &'a [[f64; 3]],
    delta: &'a [f64],
}

pub(crate) fn run(args: &PolygonArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let job = job(args)?;
    let format = format(&args.output)?;
    volume_format(&args.input)?;
    check_targets(&[&args.output], &[&args.input])?;
    let progress = Progress::new(console.quiet);
    let source = input::source(&args.input, &args.volume, console, &progress)?;
    let slice = slice(args.slice, source.occupancy.grid())?;
    let image = image(&source, slice, &job)?;

    progress.stage("finding the polygons");
    let optimizing = Instant::now();
    let mut found = separate_observed(&image, &job.settings, &mut |now| {
        progress.optimize(now);
        ControlFlow::Continue(())
    })?;
    let mut report = Report {
        input: Input::new(&source),
        slice: slice.to_string(),
        settings: job.report.clone(),
        solver: SolverReport::new(&found.report),
        geometry: Geometry::new(&image, &found.polygons),
        times: Times {
            read: source.seconds,
            optimize: optimizing.elapsed().as_secs_f64(),
            total: 0.0,
        },
        version: env!("CARGO_PKG_VERSION"),
    };

    progress.stage("writing");
    if format != Format::Svg && job.frame == FrameChoice::Index {
        to_index(&mut found.polygons, image.grid(), source.occupancy.grid());
    }
    report.times.total = start.elapsed().as_secs_f64();
    match format {
        Format::Svg => write_svg(&args.output, &image, &found)?,
        Format::Lines => write_polygons(&args.output, &found.polygons, &source, job.frame)?,
        Format::Json => {
            let polygons = found.polygons.iter().map(PolygonReport::new).collect();
            write_json(&args.output, &Document { report: &report, polygons })?;
        }
    }
    drop(progress);
    if args.json {
        print_json(&report)?;
    } else {
        console.message(&summary(&args.output, slice, &image, &report));
    }
    work::converged(&found.report, &job, console)
}

/// Checked settings; an image has no triangles to choose, and takes so little time that it is worked
/// on until it converges.
fn job(args: &PolygonArgs) -> Result<Job, Failure> {
    let refused = match &args.shroud.solve {
        SolveArgs { surface: MeshKind::Dual, .. } => Some("--surface dual"),
        SolveArgs { triangles: Triangles::Fixed, .. } => Some("--triangles fixed"),
        SolveArgs { volume: VolumeRule::Keep, .. } => Some("--volume keep"),
        _ => None,
    };
    if let Some(option) = refused {
        let message = "has no meaning for polygons, which are no mesh: leave it out";
        return Err(Failure::Call(format!("{option} {message}")));
    }
    let mut shroud = args.shroud.clone();
    if shroud.solve.solver == Solver::Newton && shroud.crease.is_none() {
        shroud.solve.preset = shroud.solve.preset.or(Some(Preset::Exact));
    }
    Job::new(&shroud, args.volume.coordinates())
}

fn format(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "svg" => Ok(Format::Svg),
        "obj" | "vtp" => Ok(Format::Lines),
        "json" => Ok(Format::Json),
        _ => {
            let message = "not a known kind of file by its name; polygons are written to .svg, .obj, .vtp and .json";
            Err(Failure::Call(format!("{}: {message}", path.display())))
        }
    }
}

/// The slice that was asked for, or the only one there is.
fn slice(asked: Option<Slice>, grid: &Grid) -> Result<Slice, Failure> {
    let dims = grid.dims();
    if let Some(slice) = asked {
        return Ok(slice);
    }
    let single = [2, 1, 0].into_iter().find(|&axis| dims[axis] == 1);
    single.map(|axis| Slice { axis, index: 0 }).ok_or_else(|| {
        let [nx, ny, nz] = dims;
        Failure::Call(format!(
            "the volume has {nx} × {ny} × {nz} voxels, no single slice; choose one, such as --slice z={}",
            nz / 2
        ))
    })
}

/// The image in a slice, which must have something to separate.
fn image(source: &Source, slice: Slice, job: &Job) -> Result<Occupancy, Failure> {
    let volume = &source.occupancy;
    let image = volume.slice(slice.axis, slice.index)?;
    let count = image.count();
    if count == 0 {
        let is_filled =
            |&index: &usize| volume.slice(slice.axis, index).is_ok_and(|image| image.count() > 0);
        let mut filled = (0..volume.grid().dims()[slice.axis]).filter(is_filled);
        let first = filled.next().unwrap_or_default();
        let [first, last] =
            [first, filled.next_back().unwrap_or(first)].map(|index| Slice { index, ..slice });
        return Err(Failure::Undone(format!(
            "{}: nothing is inside on slice {slice}; there is something between {first} and {last}",
            source.path.display()
        )));
    }
    if job.settings.border == Border::Open && count == image.grid().point_count() as u64 {
        let message = "there is no polygon: every voxel of the slice is inside and the border is open; use --border closed or select less";
        return Err(Failure::Undone(message.into()));
    }
    Ok(image)
}

/// Puts the points in voxel indices of the whole volume.
fn to_index(polygons: &mut [Polygon], image: &Grid, volume: &Grid) {
    let inverse = volume.inverse_affine();
    for polygon in polygons {
        for (point, &[i, j]) in polygon.points.iter_mut().zip(&polygon.index) {
            let p = image.point([i, j, 0.0]);
            *point = inverse.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
        }
    }
}

fn write_svg(path: &Path, image: &Occupancy, found: &Separation) -> Result<(), Failure> {
    let middle = place(image, &found.surface, &vec![0.5; found.delta.len()]);
    let svg = Plan::svg(&[Plan::new(image).thin(&middle).bold(&found.polygons)]);
    Ok(write_atomically(path, |writer| writer.write_all(svg.as_bytes()))?)
}

fn write_polygons(
    path: &Path,
    polygons: &[Polygon],
    source: &Source,
    choice: FrameChoice,
) -> Result<(), Failure> {
    let lines: Vec<Line> =
        polygons.iter().map(|p| Line { points: &p.points, closed: p.closed }).collect();
    let numbers = |of: fn(&Polygon) -> f64| -> Vec<f32> {
        polygons.iter().map(|polygon| of(polygon) as f32).collect()
    };
    let columns = [("length", numbers(|p| p.length)), ("area", numbers(|p| p.area))];
    let attributes: Vec<Attribute> =
        columns.iter().map(|(name, values)| Attribute { name, values }).collect();
    let frame = Some(frame::name(choice, &source.frame));
    let options = MeshOptions { precision: Precision::Double, frame };
    Ok(write_lines_with(path, &lines, &attributes, &options)?)
}

impl Geometry {
    fn new(image: &Occupancy, polygons: &[Polygon]) -> Self {
        let count = |is: fn(&&Polygon) -> bool| polygons.iter().filter(is).count();
        let grid = image.grid();
        let open = count(|polygon| !polygon.closed);
        Self {
            vertices: polygons.iter().map(|polygon| polygon.points.len()).sum(),
            around: count(|polygon| polygon.closed && polygon.area > 0.0),
            holes: count(|polygon| polygon.closed && polygon.area <= 0.0),
            open,
            area: (open == 0).then(|| polygons.iter().map(|polygon| polygon.area).sum()),
            length: polygons.iter().map(|polygon| polygon.length).sum(),
            // The third axis of an image is normal to it.
            pixel_area: image.count() as f64 * grid.voxel_volume() / grid.spacing()[2],
        }
    }
}

impl<'a> PolygonReport<'a> {
    fn new(polygon: &'a Polygon) -> Self {
        let Polygon { points, delta, closed, area, length, .. } = polygon;
        Self { closed: *closed, area: *area, length: *length, points, delta }
    }
}

fn summary(output: &Path, slice: Slice, image: &Occupancy, report: &Report) -> String {
    let Geometry { vertices, around, holes, open, area, length, pixel_area } = report.geometry;
    let [nx, ny, _] = image.grid().dims();
    let area = area.map_or(String::new(), |area| {
        format!("area {} ({} by voxel count), ", number(area), number(pixel_area))
    });
    let counts = [(around, "polygon"), (holes, "hole"), (open, "open line")];
    let counts = counts.iter().filter(|(count, _)| *count > 0);
    let counts: Vec<String> = counts.map(|(count, noun)| plural(*count, noun)).collect();
    format!(
        "{}: slice {slice} of {nx} × {ny} voxels: {}, {} vertices, {area}length {}, {} after {}, {:.2} s",
        output.display(),
        counts.join(", "),
        grouped(vertices as u64),
        number(length),
        report.solver.status,
        plural(report.solver.iterations, "iteration"),
        report.times.total,
    )
}
