//! `shrouds render`: a mesh, or the shroud of a volume, into a picture.

use shrouds::measure::contours;
use shrouds::mesh::MeshKind;
use shrouds::{Grid, TriMesh, optimize};
use shrouds_io::read_mesh;
use shrouds_view::{Figure, LineSet};

use crate::args::{Every, Field, FrameChoice, Paint, RenderArgs};
use crate::colouring::{Numbers, Unit};
use crate::console::{Console, grouped, number};
use crate::failure::Failure;
use crate::input::{self, Kind};
use crate::lines;
use crate::output::{check_png, check_targets, write_picture};
use crate::picture::{NETWORK_ON_DUAL, View, network_lines};
use crate::progress::Progress;
use crate::settings::Job;
use crate::work;

/// Contours are this dark, so that they are seen on every colour.
const CONTOURS: [u8; 3] = [46, 42, 44];

/// What is drawn.
struct Subject {
    mesh: TriMesh,
    /// Of the volume.
    lattice: Option<Grid>,
    unit: Unit,
    /// The slice curves, if they are wanted.
    network: Vec<LineSet>,
    /// What is shown as colours, if anything.
    numbers: Option<Numbers>,
    /// How its shroud was made.
    optimization: Option<optimize::Report>,
}

pub(crate) fn run(args: &RenderArgs, console: Console) -> Result<(), Failure> {
    args.volume.refuse_coordinates()?;
    let job = Job::new(&args.shroud, FrameChoice::World)?;
    let kind = input::kind(&args.input)?;
    check_network(args, kind)?;
    check_colours(args, kind)?;
    check_contours(args, kind)?;
    check_png(&args.output)?;
    check_targets(&[&args.output], &[&args.input])?;
    let progress = Progress::new(console.quiet);
    let subject = match kind {
        Kind::Mesh => {
            progress.stage("reading");
            Subject::of_mesh(args, read_mesh(&args.input)?)?
        }
        Kind::Volume => Subject::of_volume(args, &job, console, &progress)?,
    };
    progress.stage("drawing");
    subject.draw(args)?;
    drop(progress);
    match &subject.optimization {
        Some(report) => work::converged(report, &job, console),
        None => Ok(()),
    }
}

fn check_network(args: &RenderArgs, kind: Kind) -> Result<(), Failure> {
    let message = match kind {
        _ if !args.network => return Ok(()),
        Kind::Mesh => "--network needs a volume: a mesh file does not hold the slice curves",
        Kind::Volume if args.shroud.solve.surface == MeshKind::Dual => NETWORK_ON_DUAL,
        Kind::Volume => return Ok(()),
    };
    Err(Failure::Call(message.into()))
}

fn check_colours(args: &RenderArgs, kind: Kind) -> Result<(), Failure> {
    let message = match (args.figure.colour, kind) {
        (Paint::Plain(_), _) if args.figure.range.is_some() => {
            "--range is that of numbers: give --colour mean-curvature, another curvature or delta"
        }
        (Paint::Field(Field::Delta), Kind::Mesh) => {
            "--colour delta needs a volume: a mesh file does not hold the grid edges of its vertices"
        }
        (Paint::Field(Field::Delta), Kind::Volume)
            if args.shroud.solve.surface == MeshKind::Dual =>
        {
            "--colour delta cannot go with --surface dual: its vertices do not lie on grid edges"
        }
        _ => return Ok(()),
    };
    Err(Failure::Call(message.into()))
}

fn check_contours(args: &RenderArgs, kind: Kind) -> Result<(), Failure> {
    match kind {
        Kind::Mesh => {
            args.contours.iter().try_for_each(|every| lines::across(every.axis, None).map(drop))
        }
        Kind::Volume => Ok(()),
    }
}

impl Subject {
    fn of_mesh(args: &RenderArgs, mesh: TriMesh) -> Result<Self, Failure> {
        let unit = Unit::unknown();
        let numbers = match args.figure.colour {
            Paint::Field(field) => Some(Numbers::of_mesh(field, &mesh, &unit)?),
            Paint::Plain(_) => None,
        };
        let (network, optimization) = (Vec::new(), None);
        Ok(Self { mesh, lattice: None, unit, network, numbers, optimization })
    }

    fn of_volume(
        args: &RenderArgs,
        job: &Job,
        console: Console,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        job.warn(console);
        let source = input::source(&args.input, &args.volume, console, progress)?;
        let shroud = work::shroud(&source.occupancy, job, progress)?;
        let unit = Unit::of_volume(&source.frame, &source.lattice);
        let numbers = match (args.figure.colour, args.shroud.solve.surface) {
            (Paint::Plain(_), _) => None,
            (Paint::Field(Field::Delta), _) => Some(Numbers::deltas(&shroud.delta)),
            (Paint::Field(field), MeshKind::Primal) => {
                Some(Numbers::of_primal(field, &shroud, &unit))
            }
            (Paint::Field(field), MeshKind::Dual) => {
                Some(Numbers::of_mesh(field, &shroud.mesh, &unit)?)
            }
        };
        Ok(Self {
            network: if args.network { network_lines(&shroud) } else { Vec::new() },
            numbers,
            unit,
            lattice: Some(source.lattice),
            mesh: shroud.mesh,
            optimization: Some(shroud.report),
        })
    }

    fn draw(&self, args: &RenderArgs) -> Result<(), Failure> {
        let mut lines = self.network.clone();
        for every in &args.contours {
            lines.push(self.contours(*every)?);
        }
        let (colours, legend) = match &self.numbers {
            Some(numbers) => {
                let (colours, legend) = numbers.coloured(args.figure.range)?;
                (Some(colours), Some(legend))
            }
            None => (None, None),
        };
        let figure = Figure {
            legend,
            caption: if args.figure.caption { Some(self.caption(args)?) } else { None },
            scale_bar: args.figure.scale_bar.then(|| self.unit.counted()),
        };
        let view = View::new(&args.view, args.figure.colour);
        let picture = view.draw_figure(&self.mesh, colours.as_deref(), &lines, &figure)?;
        write_picture(&args.output, &picture)
    }

    fn contours(&self, every: Every) -> Result<LineSet, Failure> {
        let planes = lines::across(every.axis, self.lattice.as_ref())?;
        let planes = lines::every(planes, &self.mesh, every.distance, 0.0)?;
        let mut segments = Vec::new();
        for contour in contours(&self.mesh, &planes)? {
            segments.extend(contour.points.windows(2).map(|pair| [pair[0], pair[1]]));
            if let (true, [first, .., last]) = (contour.closed, &contour.points[..]) {
                segments.push([*last, *first]);
            }
        }
        Ok(LineSet::new(segments, CONTOURS))
    }

    fn caption(&self, args: &RenderArgs) -> Result<String, Failure> {
        let name = args.input.file_name().unwrap_or(args.input.as_os_str()).to_string_lossy();
        let triangles = grouped(self.mesh.triangles.len() as u64);
        let fairness = match lines::fairness(&self.mesh, self.lattice.as_ref())? {
            Some(fairness) => format!(" · fairness {}", number(fairness.rounded())),
            None => String::new(),
        };
        Ok(format!("{name} · {triangles} triangles{fairness}"))
    }
}
