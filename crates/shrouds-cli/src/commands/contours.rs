//! `shrouds contours`: plane sections of a mesh, or of a volume's shroud, as lines.

use serde::Serialize;
use shrouds::measure::{Contour, Planes, contours};
use shrouds::optimize;
use shrouds::{Grid, TriMesh};
use shrouds_io::{Frame, read_mesh};

use crate::args::{ContoursArgs, FrameChoice, PlaneAxis};
use crate::console::{Console, number, plural, print_json};
use crate::failure::Failure;
use crate::frame;
use crate::input::{self, Kind};
use crate::lines::{self, FairnessReport};
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::name;
use crate::settings::Job;
use crate::work;

/// What is cut.
struct Subject {
    mesh: TriMesh,
    /// Of the volume, in the coordinates of the mesh.
    lattice: Option<Grid>,
    frame: Option<Frame>,
    /// How its shroud was made.
    optimization: Option<optimize::Report>,
}

/// Lengths, areas and volumes are in the unit of the coordinates.
#[derive(Serialize)]
struct Report {
    input: String,
    /// Of coordinates; null for a mesh file, which does not tell.
    unit: Option<String>,
    axis: PlaneAxis,
    every: Option<f64>,
    /// Positions of the planes.
    planes: Vec<f64>,
    totals: Totals,
    contours: Vec<ContourReport>,
    fairness: Option<FairnessReport>,
    version: &'static str,
}

#[derive(Serialize)]
struct Totals {
    contours: usize,
    open: usize,
    length: f64,
    /// Inside, of all planes together; null if a contour is open.
    area: Option<f64>,
    /// The area times the distance of the planes, by Cavalieri's principle.
    volume: Option<f64>,
}

#[derive(Serialize)]
struct ContourReport {
    position: f64,
    closed: bool,
    points: usize,
    length: f64,
    /// Negative for a hole, 0 if it is open.
    area: f64,
}

pub(crate) fn run(args: &ContoursArgs, console: Console) -> Result<(), Failure> {
    let job = Job::new(&args.shroud, args.volume.coordinates())?;
    let kind = input::kind(&args.input)?;
    lines::check_format(&args.output)?;
    check_targets(&[&args.output], &[&args.input])?;
    if kind == Kind::Mesh {
        lines::across(args.axis, None)?;
        args.volume.refuse_coordinates()?;
    }
    let progress = Progress::new(console.quiet);
    let subject = match kind {
        Kind::Mesh => {
            progress.stage("reading");
            let mesh = read_mesh(&args.input)?;
            Subject { mesh, lattice: None, frame: None, optimization: None }
        }
        Kind::Volume => Subject::of_volume(args, &job, console, &progress)?,
    };
    progress.stage("cutting");
    let planes = planes(args, &subject)?;
    let found = contours(&subject.mesh, &planes)?;
    progress.stage("writing");
    let axis = args.axis.index();
    let curves: Vec<(usize, &Contour)> = found.iter().map(|contour| (axis, contour)).collect();
    lines::write(&args.output, &curves, "position", subject.frame.clone())?;
    drop(progress);
    let totals = Totals::new(&found, args.every.map(|every| every * thickness(args, &subject)));
    if args.json {
        print_json(&Report::new(args, &subject, &planes, &found, totals)?)?;
    } else {
        let count = planes.positions().len();
        console.message(&format!("{}: {}", args.output.display(), totals.in_words(args, count)));
    }
    match &subject.optimization {
        Some(report) => work::converged(report, &job, console),
        None => Ok(()),
    }
}

impl Subject {
    fn of_volume(
        args: &ContoursArgs,
        job: &Job,
        console: Console,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        job.warn(console);
        let source = input::source(&args.input, &args.volume, console, progress)?;
        let shroud = work::shroud(&source.occupancy, job, progress)?;
        let (mut mesh, mut grid) = (shroud.mesh, source.occupancy.grid().clone());
        if job.frame == FrameChoice::Index {
            frame::to_index(&mut mesh, &grid);
            grid = Grid::new(grid.dims(), [1.0; 3])?;
        }
        let frame = Some(frame::name(job.frame, &source.frame));
        Ok(Self { mesh, lattice: Some(grid), frame, optimization: Some(shroud.report) })
    }
}

fn planes(args: &ContoursArgs, subject: &Subject) -> Result<Planes, Failure> {
    let planes = lines::across(args.axis, subject.lattice.as_ref())?;
    match args.every {
        Some(every) => lines::every(planes, &subject.mesh, every, args.offset),
        None => Ok(planes.at(args.at.clone())),
    }
}

/// Distance of planes whose positions differ by 1.
fn thickness(args: &ContoursArgs, subject: &Subject) -> f64 {
    match &subject.lattice {
        Some(grid) if args.axis.is_of_lattice() => {
            let [x, y, z, _] = grid.inverse_affine()[args.axis.index()];
            (x * x + y * y + z * z).sqrt().recip()
        }
        _ => 1.0,
    }
}

impl Totals {
    /// `distance` is that of neighbouring planes, where it is always the same.
    fn new(contours: &[Contour], distance: Option<f64>) -> Self {
        let open = contours.iter().filter(|contour| !contour.closed).count();
        let area = contours.iter().map(|contour| contour.area).sum();
        let area = (open == 0).then_some(area);
        Self {
            contours: contours.len(),
            open,
            length: contours.iter().map(|contour| contour.length).sum(),
            area,
            volume: area.zip(distance).map(|(area, distance)| area * distance),
        }
    }

    fn in_words(&self, args: &ContoursArgs, planes: usize) -> String {
        let open =
            if self.open > 0 { format!(", {} of them open", self.open) } else { String::new() };
        let volume = self
            .volume
            .map_or(String::new(), |volume| format!(", volume by sections {}", number(volume)));
        format!(
            "{} across {}, {}{open}, length {}{volume}",
            plural(planes, "plane"),
            args.axis.name(),
            plural(self.contours, "contour"),
            number(self.length)
        )
    }
}

impl Report {
    fn new(
        args: &ContoursArgs,
        subject: &Subject,
        planes: &Planes,
        contours: &[Contour],
        totals: Totals,
    ) -> Result<Self, Failure> {
        let row = |contour: &Contour| ContourReport {
            position: contour.position,
            closed: contour.closed,
            points: contour.points.len(),
            length: contour.length,
            area: contour.area,
        };
        Ok(Self {
            input: name(&args.input),
            unit: subject.frame.as_ref().map(|frame| frame.unit.clone()),
            axis: args.axis,
            every: args.every,
            planes: planes.positions().to_vec(),
            totals,
            contours: contours.iter().map(row).collect(),
            fairness: lines::fairness(&subject.mesh, subject.lattice.as_ref())?,
            version: env!("CARGO_PKG_VERSION"),
        })
    }
}
