//! `shrouds info`: what a volume or mesh file holds.

use std::path::Path;

use serde::Serialize;
use shrouds::check::structure;
use shrouds::{Select, TriMesh};
use shrouds_io::{Volume, read_mesh};

use crate::args::InfoArgs;
use crate::console::{Console, grouped, number, print, print_json};
use crate::failure::Failure;
use crate::input::{self, Kind, in_words};
use crate::measure::bounds;
use crate::progress::Progress;
use crate::report::name;
use crate::settings::select;

/// Most labels that are shown to people.
const SHOWN: usize = 20;

pub(crate) fn run(args: &InfoArgs, console: Console) -> Result<(), Failure> {
    let kind = input::kind(&args.file)?;
    let progress = Progress::new(console.quiet);
    match kind {
        Kind::Volume => {
            let volume = input::volume(&args.file, &args.volume, &progress)?;
            progress.stage("counting");
            let info = VolumeInfo::new(&args.file, &volume, &select(&args.volume))?;
            drop(progress);
            if args.json { print_json(&info) } else { print(&info.in_words()) }
        }
        Kind::Mesh => {
            progress.stage("reading");
            let mesh = read_mesh(&args.file)?;
            progress.stage("measuring");
            let info = MeshInfo::new(&args.file, &mesh)?;
            drop(progress);
            if args.json { print_json(&info) } else { print(&info.in_words()) }
        }
    }
}

#[derive(Serialize)]
struct VolumeInfo {
    kind: &'static str,
    file: String,
    /// Lattice points along x, y, z.
    dims: [usize; 3],
    spacing: [f64; 3],
    affine: [[f64; 4]; 3],
    frame: String,
    unit: String,
    /// Which part of the file gave the frame.
    frame_source: &'static str,
    /// Type of the values.
    values: &'static str,
    /// Smallest and largest value.
    range: Option<(f64, f64)>,
    /// Null when the values are no labels.
    labels: Option<Vec<Label>>,
    selection: String,
    /// Voxels inside; null when some value is not a number.
    inside: Option<u64>,
    not_a_number: u64,
}

#[derive(Serialize)]
struct Label {
    label: i128,
    voxels: u64,
}

impl VolumeInfo {
    fn new(path: &Path, volume: &Volume, select: &Select) -> Result<Self, Failure> {
        let (inside, not_a_number) = match volume.occupancy(select) {
            Ok(occupancy) => (Some(occupancy.count()), 0),
            Err(shrouds::Error::NotANumber { others, .. }) => (None, others as u64 + 1),
            Err(error) => return Err(error.into()),
        };
        let label = |(label, voxels)| Label { label, voxels };
        Ok(Self {
            kind: "volume",
            file: name(path),
            dims: volume.grid.dims(),
            spacing: volume.grid.spacing(),
            affine: volume.grid.affine(),
            frame: volume.frame.name.clone(),
            unit: volume.frame.unit.clone(),
            frame_source: volume.frame.source,
            values: volume.values.type_name(),
            range: volume.values.range(),
            labels: volume.values.labels().map(|all| all.into_iter().map(label).collect()),
            selection: in_words(select),
            inside,
            not_a_number,
        })
    }

    fn in_words(&self) -> String {
        let [nx, ny, nz] = self.dims;
        let range = match self.range {
            Some((low, high)) => format!("{} to {}", number(low), number(high)),
            None => "no numbers".into(),
        };
        let inside = match self.inside {
            Some(inside) => format!("{} voxels: {}", grouped(inside), self.selection),
            None => format!("unknown: {} values are not a number", grouped(self.not_a_number)),
        };
        let mut rows = vec![
            ("volume", self.file.clone()),
            ("dims", format!("{nx} × {ny} × {nz} = {}", grouped((nx * ny * nz) as u64))),
            ("spacing", format!("{} (unit: {})", vector(self.spacing), self.unit)),
            ("frame", format!("{} (from: {})", self.frame, self.frame_source)),
        ];
        rows.extend(self.affine.iter().enumerate().map(|(r, row)| {
            let cells: Vec<String> = row.iter().map(|x| format!("{:>12}", number(*x))).collect();
            (["affine", "", ""][r], cells.concat())
        }));
        rows.extend([
            ("values", format!("{}, {range}", self.values)),
            ("labels", self.labels_in_words()),
        ]);
        rows.push(("inside", inside));
        table(&rows)
    }

    fn labels_in_words(&self) -> String {
        let Some(labels) = &self.labels else { return "none: the values are no labels".into() };
        let shown: Vec<String> = labels
            .iter()
            .take(SHOWN)
            .map(|Label { label, voxels }| format!("{label} ({})", grouped(*voxels)))
            .collect();
        let more = match labels.len() - shown.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        shown.join(", ") + &more
    }
}

#[derive(Serialize)]
struct MeshInfo {
    kind: &'static str,
    file: String,
    vertices: usize,
    triangles: usize,
    /// Whether every vertex has a normal.
    normals: bool,
    /// Smallest and largest corner; null without vertices.
    bounds: Option<[[f64; 3]; 2]>,
    /// Whether every edge has two triangles that run through it in opposite directions.
    closed: bool,
    components: usize,
    /// Euler characteristic of each component.
    euler: Vec<i64>,
    /// Null unless closed.
    volume: Option<f64>,
    area: f64,
}

impl MeshInfo {
    fn new(path: &Path, mesh: &TriMesh) -> Result<Self, Failure> {
        let structure = structure(mesh)
            .map_err(|error| Failure::Undone(format!("{}: {error}", path.display())))?;
        Ok(Self {
            kind: "mesh",
            file: name(path),
            vertices: mesh.vertices.len(),
            triangles: mesh.triangles.len(),
            normals: !mesh.normals.is_empty(),
            bounds: bounds(mesh.vertices.iter().copied()),
            closed: structure.is_closed(),
            components: structure.components.len(),
            euler: structure.components.iter().map(|component| component.euler).collect(),
            volume: structure.is_closed().then_some(structure.volume),
            area: structure.area,
        })
    }

    fn in_words(&self) -> String {
        let bounds = match self.bounds {
            Some([low, high]) => format!("{} to {}", vector(low), vector(high)),
            None => "none".into(),
        };
        let normals = if self.normals { "with normals" } else { "without normals" };
        let euler: i64 = self.euler.iter().sum();
        let volume = self.volume.map_or("unknown: it is not closed".into(), number);
        table(&[
            ("mesh", self.file.clone()),
            ("vertices", format!("{}, {normals}", grouped(self.vertices as u64))),
            ("triangles", grouped(self.triangles as u64)),
            ("bounds", bounds),
            ("closed", if self.closed { "yes" } else { "no" }.into()),
            ("parts", format!("{}, Euler characteristic {euler}", self.components)),
            ("volume", volume),
            ("area", number(self.area)),
        ])
    }
}

fn vector(v: [f64; 3]) -> String {
    format!("({})", v.map(number).join(", "))
}

fn table(rows: &[(&str, String)]) -> String {
    rows.iter().map(|(key, value)| format!("{key:<11}{value}")).collect::<Vec<_>>().join("\n")
}
