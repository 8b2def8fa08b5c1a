//! Measures bit planes: bytes, CPU time and the error of the surface that is made within them, and of the
//! places that the planes' own predictor ends at.
//!
//! ```sh
//! cargo run --release -p shrouds-codec --example geometry -- [--true-surface PLY] --like VOLUME MESH
//! cargo run --release -p shrouds-codec --example geometry -- [--true-surface PLY] VOLUME LEVEL
//! ```
//!
//! With `--like` a mesh is voxelised on the lattice of a volume, else values are cut at a level. A line of JSON
//! for each number of planes, after those of the library's shrouds. Errors are root mean squares in units of the
//! index; the normal error is the one along the grid edge times the cosine between it and the normal of the true
//! surface. `--true-surface` writes that one, which `xtask/python/mesh_coders.py` packs.

use std::env;
use std::error::Error;
use std::ops::ControlFlow;

use cpu_time::ThreadTime;
use serde_json::json;
use shrouds::mesh::{MeshKind, Triangles, network_normals, place_vertices};
use shrouds::network::Network;
use shrouds::optimize::{self, Preset, optimize};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::voxelize::{Rule, deltas};
use shrouds::{Occupancy, Select, TriMesh, shroud, voxelize};
use shrouds_codec::{Settings, geometry, pack};
use shrouds_io::{MeshOptions, Precision, Values, Volume, VolumeOptions};
use shrouds_io::{read_contents, read_mesh, read_volume, write_mesh};

/// A volume and the surface that it was made of.
struct Truth {
    volume: Occupancy,
    surface: Surface,
    delta: Vec<f64>,
    normals: Vec<[f32; 3]>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = env::args().skip(1).collect();
    let written = match &arguments[..] {
        [option, path, ..] if option == "--true-surface" => Some(path.clone()),
        _ => None,
    };
    if written.is_some() {
        arguments.drain(..2);
    }
    let truth = match &arguments[..] {
        [option, like, mesh] if option == "--like" => of_mesh(like, mesh)?,
        [volume, level] => of_values(volume, level.parse()?)?,
        _ => return Err("give --like VOLUME MESH, or VOLUME LEVEL".into()),
    };
    if let Some(path) = written {
        let points = place_vertices(&truth.surface, &truth.delta);
        let (kind, normals) = (MeshKind::Primal, truth.normals.clone());
        let mesh = TriMesh::span(&truth.surface, points, normals, kind, Triangles::Fixed);
        let options = MeshOptions { precision: Precision::Double, ..Default::default() };
        write_mesh(path, &mesh, &options)?;
    }
    let mut file = Vec::new();
    let topology = 8 * pack(&truth.volume, &Settings::default(), &mut file)?.bytes;
    truth.shrouds()?;
    truth.planes(topology as f64)
}

/// A mesh on the lattice of a volume.
fn of_mesh(like: &str, mesh: &str) -> Result<Truth, Box<dyn Error>> {
    let (grid, _, _) = read_contents(like, &VolumeOptions::default())?;
    let mesh = read_mesh(mesh)?;
    Truth::new(voxelize(&mesh, &grid, Rule::NonZero)?.volume, |surface| {
        Ok(deltas(&mesh, surface)?.delta)
    })
}

/// Grey values above a level.
fn of_values(volume: &str, level: f64) -> Result<Truth, Box<dyn Error>> {
    let read = read_volume(volume, &VolumeOptions::default())?;
    Truth::new(read.occupancy(&Select::Above(level))?, |surface| isosurface(&read, level, surface))
}

impl Truth {
    fn new(
        volume: Occupancy,
        delta: impl FnOnce(&Surface) -> Result<Vec<f64>, Box<dyn Error>>,
    ) -> Result<Self, Box<dyn Error>> {
        let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed)?;
        let delta = delta(&surface)?;
        let points = place_vertices(&surface, &delta);
        let normals = network_normals(&surface, &Network::trace(&surface), &points);
        Ok(Self { volume, surface, delta, normals })
    }

    fn vertices(&self) -> f64 {
        self.surface.vertex_count() as f64
    }

    /// Errors along the grid edges and along the normals.
    fn errors(&self, delta: &[f64]) -> [f64; 2] {
        let (mut edge, mut normal) = (0.0, 0.0);
        let vertices = self.surface.crossings().zip(&self.normals);
        for ((crossing, n), (delta, truth)) in vertices.zip(delta.iter().zip(&self.delta)) {
            let off = delta - truth;
            edge += off * off;
            normal += (off * f64::from(n[crossing.axis()])).powi(2);
        }
        [edge, normal].map(|sum| (sum / self.vertices()).sqrt())
    }

    /// What the library makes of the volume alone.
    fn shrouds(&self) -> Result<(), Box<dyn Error>> {
        for preset in [Preset::Fast, Preset::Default, Preset::Exact] {
            let optimize = optimize::Settings { preset, ..Default::default() };
            let settings = shrouds::Settings { optimize, ..Default::default() };
            let [edge, normal] = self.errors(&shroud(&self.volume, &settings)?.delta);
            let preset = format!("{preset:?}");
            let line = json!({"preset": preset, "vertices": self.vertices(), "edge": edge, "normal": normal});
            println!("{line}");
        }
        Ok(())
    }

    /// What the planes make of it; `topology` in bits.
    fn planes(&self, topology: f64) -> Result<(), Box<dyn Error>> {
        let vertices = self.vertices();
        let start = ThreadTime::now();
        let planes = geometry::encode(&self.surface, &self.delta, 8)?;
        let encoding = start.elapsed().as_secs_f64() * 1e6 / vertices;
        let payloads: Vec<(&[u8], u32)> =
            planes.payloads.iter().map(|(p, s)| (&p[..], *s)).collect();
        let mut bits = topology;
        for count in 1..=payloads.len() {
            bits += 8.0 * payloads[count - 1].0.len() as f64;
            let start = ThreadTime::now();
            let places = geometry::decode(&self.surface, &planes.settings, &payloads[..count]);
            let decoding = start.elapsed().as_secs_f64() * 1e6 / vertices;
            let [_, predicted] = self.errors(&places.deltas());
            let settings = optimize::Settings {
                preset: Preset::Exact,
                intervals: Some(places.intervals().collect()),
                ..Default::default()
            };
            let shown = optimize(&self.surface, &settings, &mut |_| ControlFlow::Continue(()))?;
            let [edge, normal] = self.errors(&shown.delta);
            println!(
                "{}",
                json!({
                    "planes": places.planes,
                    "total_per_100k_triangles": bits / vertices * 50_000.0,
                    "edge": edge,
                    "normal": normal,
                    "predicted": predicted,
                    "encode_us": encoding / 8.0,
                    "decode_us": decoding / count as f64,
                })
            );
        }
        Ok(())
    }
}

/// δ of grey values that are bytes or floats.
fn isosurface(read: &Volume, level: f64, surface: &Surface) -> Result<Vec<f64>, Box<dyn Error>> {
    Ok(match &read.values {
        Values::U8(values) => surface.isosurface_deltas(values, level)?,
        Values::F32(values) => surface.isosurface_deltas(values, level)?,
        Values::F64(values) => surface.isosurface_deltas(values, level)?,
        _ => return Err("give values of type u8, f32 or f64".into()),
    })
}
