//! `shrouds unpack`: a `.shroud` file in, a mesh or a volume out. And what `shrouds info` tells of one.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use shrouds::Occupancy;
use shrouds::volume::{Border, FaceRule};
use shrouds_codec::{
    Content, Header, Kind, Profile, read_header, survey, unpack, unpack_labels, unpack_partial,
};
use shrouds_io::{Frame, mesh_format, write_npy_labels, write_volume, written_format};

use crate::args::{self, InfoArgs, UnpackArgs};
use crate::commands::info::{table, vector};
use crate::console::{Console, grouped, print, print_json};
use crate::failure::Failure;
use crate::input::Source;
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::name;
use crate::selection::list;
use crate::settings::Job;
use crate::work::{Extras, Outputs, produce};

/// Whether the name of a file is that of a packed one.
pub(crate) fn is_packed(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("shroud"))
}

/// What came out, where it is no mesh.
#[derive(Serialize)]
struct Report {
    input: String,
    output: String,
    dims: [usize; 3],
    spacing: [f64; 3],
    affine: [[f64; 4]; 3],
    frame: String,
    unit: String,
    /// Voxels inside; null for labels.
    inside: Option<u64>,
    /// Labels; null for a volume.
    labels: Option<Vec<i64>>,
    /// What the file should hold and does not.
    lost: Option<String>,
}

/// A volume and where it comes from.
struct Volume {
    header: Header,
    occupancy: Occupancy,
    selection: String,
    lost: Option<String>,
}

pub(crate) fn run(args: &UnpackArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let is_mesh = mesh_format(&args.output).is_ok();
    if !is_mesh {
        written_format(&args.output)?;
    }
    check_targets(&[&args.output], &[&args.input])?;
    let progress = Progress::new(console.quiet);
    progress.stage("unpacking");
    let header = open(&args.input, read_header)?;
    let is_map = matches!(header.content, Content::Labels(_));
    if is_map && args.labels.is_empty() {
        return labels(args, is_mesh, console, progress);
    }
    let volume = volume(args, is_map)?;
    if let Some(lost) = &volume.lost {
        console.warn(&format!("{}: {lost}", args.input.display()));
    }
    if is_mesh {
        mesh(args, volume, start, console, progress)
    } else {
        write(args, volume, console, progress)
    }
}

/// Reads a file; failures name it.
fn open<T>(
    path: &Path,
    read: impl FnOnce(BufReader<File>) -> Result<T, shrouds_codec::Error>,
) -> Result<T, Failure> {
    let fail = |problem: String| Failure::Undone(format!("{}: {problem}", path.display()));
    let file = File::open(path)
        .map_err(|cause| fail(format!("cannot read it ({cause}); check the name of the file")))?;
    read(BufReader::new(file)).map_err(|error| {
        use shrouds_codec::Error::{Chunk, Cut};
        let hint = "; --partial takes the layers before";
        fail(format!(
            "{error}{}",
            if matches!(error, Chunk { .. } | Cut { .. }) { hint } else { "" }
        ))
    })
}

fn volume(args: &UnpackArgs, is_map: bool) -> Result<Volume, Failure> {
    if !is_map {
        if !args.labels.is_empty() {
            let message = "--label is for packed labels, and this file holds a volume";
            return Err(Failure::Call(format!("{}: {message}", args.input.display())));
        }
        let read = |file| if args.partial { unpack_partial(file) } else { unpack(file) };
        let unpacked = open(&args.input, read)?;
        let selection = "all that was packed".into();
        let (header, occupancy, lost) = (unpacked.header, unpacked.volume, unpacked.lost);
        return Ok(Volume { header, occupancy, selection, lost });
    }
    let (header, map) = open(&args.input, unpack_labels)?;
    if let Some(missing) = args.labels.iter().find(|label| !map.labels().contains(label)) {
        let there = list(map.labels().iter().map(i64::to_string));
        let message =
            format!("there is no label {missing}; the labels are {there}: change --label");
        return Err(Failure::Undone(format!("{}: {message}", args.input.display())));
    }
    let mut occupancy = Occupancy::empty(map.grid().clone());
    args.labels.iter().for_each(|&label| occupancy.unite(&map.occupancy(label)));
    let selection = list(args.labels.iter().map(i64::to_string));
    Ok(Volume { header, occupancy, selection, lost: None })
}

/// Shrouds the volume with the conventions that were packed with it.
fn mesh(
    args: &UnpackArgs,
    volume: Volume,
    start: Instant,
    console: Console,
    progress: Progress,
) -> Result<(), Failure> {
    let job = job(args, &volume.header)?;
    job.warn(console);
    if volume.occupancy.count() == 0 {
        let message = "nothing is inside: there is no surface; write the volume instead";
        return Err(Failure::Undone(format!("{}: {message}", args.input.display())));
    }
    let source = Source {
        path: args.input.clone(),
        selection: volume.selection,
        lattice: volume.occupancy.grid().clone(),
        occupancy: volume.occupancy,
        frame: frame(&volume.header),
        truth: [None; 2],
        seconds: start.elapsed().as_secs_f64(),
    };
    let outputs = Outputs { mesh: &args.output, picture: None, report: None };
    let done = produce(&source, &job, &outputs, &Extras::default(), start, console, &progress)?;
    drop(progress);
    if args.json {
        print_json(&done.report)?;
    } else {
        let topology = &done.report.topology;
        console.message(&format!(
            "{}: {} vertices, {} triangles, {:.2} s",
            args.output.display(),
            grouped(topology.vertices),
            grouped(topology.triangles),
            done.report.times.total
        ));
    }
    done.verdict(&job, console)
}

/// The settings of the shroud, with the conventions of the file.
fn job(args: &UnpackArgs, header: &Header) -> Result<Job, Failure> {
    let mut shroud = args.shroud.clone();
    let (faces, border) = (faces(header), border(header));
    let solve = &mut shroud.solve;
    let is_asked = |differs: bool, is_usual: bool| differs && !is_usual;
    if is_asked(solve.faces != faces, solve.faces == args::Faces::Separate)
        || is_asked(solve.border != border, solve.border == args::Border::Closed)
    {
        let message = "--faces and --border are those the file was packed with; leave them out";
        return Err(Failure::Call(format!("{}: {message}", args.input.display())));
    }
    (solve.faces, solve.border) = (faces, border);
    Job::new(&shroud, args.frame.frame)
}

fn faces(header: &Header) -> args::Faces {
    match header.faces {
        FaceRule::Separate => args::Faces::Separate,
        FaceRule::Join => args::Faces::Join,
    }
}

fn border(header: &Header) -> args::Border {
    match header.border {
        Border::Closed => args::Border::Closed,
        Border::Open => args::Border::Open,
    }
}

fn write(
    args: &UnpackArgs,
    volume: Volume,
    console: Console,
    progress: Progress,
) -> Result<(), Failure> {
    progress.stage("writing");
    write_volume(&args.output, &volume.occupancy, &frame(&volume.header))?;
    drop(progress);
    let mut report = Report::new(args, &volume.header);
    report.dims = volume.occupancy.grid().dims();
    (report.inside, report.lost) = (Some(volume.occupancy.count()), volume.lost);
    report.tell(args, console)
}

/// Writes all labels.
fn labels(
    args: &UnpackArgs,
    is_mesh: bool,
    console: Console,
    progress: Progress,
) -> Result<(), Failure> {
    let is_npy = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy"));
    if is_mesh || !is_npy {
        let message = "the file holds labels: choose with --label, or write them all to .npy";
        return Err(Failure::Call(format!("{}: {message}", args.input.display())));
    }
    let (header, map) = open(&args.input, unpack_labels)?;
    progress.stage("writing");
    write_npy_labels(&args.output, map.grid().dims(), map.values())?;
    drop(progress);
    let mut report = Report::new(args, &header);
    report.labels = Some(map.labels().to_vec());
    report.tell(args, console)
}

fn frame(header: &Header) -> Frame {
    Frame { name: header.space.clone(), unit: header.unit.clone(), source: "packed" }
}

impl Report {
    fn new(args: &UnpackArgs, header: &Header) -> Self {
        Self {
            input: name(&args.input),
            output: name(&args.output),
            dims: header.grid.dims(),
            spacing: header.grid.spacing(),
            affine: header.grid.affine(),
            frame: header.space.clone(),
            unit: header.unit.clone(),
            inside: None,
            labels: None,
            lost: None,
        }
    }

    fn tell(&self, args: &UnpackArgs, console: Console) -> Result<(), Failure> {
        if args.json {
            return print_json(self);
        }
        let [nx, ny, nz] = self.dims;
        let what = match (&self.labels, self.inside) {
            (Some(labels), _) => format!("{} labels", grouped(labels.len() as u64)),
            (None, inside) => format!("{} inside", grouped(inside.unwrap_or(0))),
        };
        console.message(&format!("{}: {nx} × {ny} × {nz} voxels, {what}", args.output.display()));
        Ok(())
    }
}

/// What a packed file holds.
#[derive(Serialize)]
struct Info {
    kind: &'static str,
    file: String,
    dims: [usize; 3],
    spacing: [f64; 3],
    affine: [[f64; 4]; 3],
    frame: String,
    unit: String,
    /// Null for a volume.
    labels: Option<Vec<i64>>,
    profile: args::Profile,
    faces: args::Faces,
    border: args::Border,
    /// Layers in a slab, and whether each is coded by itself.
    slab: usize,
    independent: bool,
    /// Bit planes of the places of the vertices.
    planes: u8,
    /// Bytes of topology or labels, and of planes.
    topology_bytes: u64,
    plane_bytes: u64,
    chunks: usize,
}

/// `shrouds info` of a packed file.
pub(crate) fn info(args: &InfoArgs, _: Console) -> Result<(), Failure> {
    let (header, chunks) = open(&args.file, survey)?;
    let bytes = |plane: bool| -> u64 {
        let parts = chunks.iter().filter(|part| (part.kind == Kind::Plane) == plane);
        parts.map(|part| part.bytes).sum()
    };
    let info = Info {
        kind: "packed",
        file: name(&args.file),
        dims: header.grid.dims(),
        spacing: header.grid.spacing(),
        affine: header.grid.affine(),
        frame: header.space.clone(),
        unit: header.unit.clone(),
        profile: match header.profile {
            Profile::Fast => args::Profile::Fast,
            Profile::Dense => args::Profile::Dense,
        },
        faces: faces(&header),
        border: border(&header),
        slab: header.slab_height,
        independent: header.independent,
        planes: header.planes,
        topology_bytes: bytes(false),
        plane_bytes: bytes(true),
        chunks: chunks.len(),
        labels: match header.content {
            Content::Labels(labels) => Some(labels),
            Content::Volume => None,
        },
    };
    if args.json { print_json(&info) } else { print(&info.in_words()) }
}

impl Info {
    fn in_words(&self) -> String {
        let [nx, ny, nz] = self.dims;
        let points = grouped((nx * ny * nz) as u64);
        let labels = match &self.labels {
            Some(labels) => list(labels.iter().map(i64::to_string)),
            None => "none: a binary volume".into(),
        };
        let kind =
            if self.independent { "each coded by itself" } else { "each after the one before" };
        let slabs = format!("{} layers, {kind}", self.slab);
        table(&[
            ("packed", self.file.clone()),
            ("dims", format!("{nx} × {ny} × {nz} = {points}")),
            ("spacing", format!("{} (unit: {})", vector(self.spacing), self.unit)),
            ("frame", self.frame.clone()),
            ("labels", labels),
            ("profile", format!("{:?}", self.profile).to_lowercase()),
            ("slabs", slabs),
            ("topology", format!("{} bytes", grouped(self.topology_bytes))),
            ("planes", format!("{}, {} bytes", self.planes, grouped(self.plane_bytes))),
        ])
    }
}
