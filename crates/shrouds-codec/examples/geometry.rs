//! Measures bit planes: bytes, CPU time and the error of the surface they give back.
//!
//! ```sh
//! cargo run --release -p shrouds-codec --example geometry -- [--like VOLUME] MESH | VOLUME LEVEL
//! ```
//!
//! With `--like` a mesh is voxelised on the lattice of a volume, else values are cut at a level. A line of JSON
//! for each number of planes, 0 being the library's shroud. Errors are root mean squares in units of the
//! index; the normal error is the one along the grid edge times the cosine between it and the normal of the true
//! surface. The variable `TRUE_SURFACE` names a PLY for the true surface, which `xtask/python/draco.py` packs.

use std::env;
use std::error::Error;

use cpu_time::ThreadTime;
use serde_json::json;
use shrouds::mesh::{MeshKind, Triangles, network_normals, place_vertices};
use shrouds::network::Network;
use shrouds::optimize::Preset;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::voxelize::{Rule, deltas};
use shrouds::{Select, TriMesh, optimize, shroud, voxelize};
use shrouds_codec::{Settings, geometry, pack};
use shrouds_io::{MeshOptions, Precision, Values, Volume, VolumeOptions};
use shrouds_io::{read_contents, read_mesh, read_volume, write_mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let options = VolumeOptions::default();
    let (volume, values, name) = match &arguments[..] {
        [like, volume, mesh] if like == "--like" => {
            let (grid, _, _) = read_contents(volume, &options)?;
            let mesh_read = read_mesh(mesh)?;
            (voxelize(&mesh_read, &grid, Rule::NonZero)?.volume, Err(mesh_read), mesh.clone())
        }
        [volume, level] => {
            let read = read_volume(volume, &options)?;
            let level: f64 = level.parse()?;
            let occupancy = read.occupancy(&Select::Above(level))?;
            (occupancy, Ok((read, level)), volume.clone())
        }
        _ => return Err("give --like VOLUME MESH, or VOLUME LEVEL".into()),
    };
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed)?;
    let truth = match &values {
        Err(mesh) => deltas(mesh, &surface)?.delta,
        Ok((read, level)) => isosurface(read, *level, &surface)?,
    };
    let normals =
        network_normals(&surface, &Network::trace(&surface), &place_vertices(&surface, &truth));
    if let Ok(out) = env::var("TRUE_SURFACE") {
        let mesh = TriMesh::span(
            &surface,
            place_vertices(&surface, &truth),
            normals.clone(),
            MeshKind::Primal,
            Triangles::Fixed,
        );
        write_mesh(
            out,
            &mesh,
            &MeshOptions { precision: Precision::Double, ..Default::default() },
        )?;
    }
    let mut file = Vec::new();
    let topology = pack(&volume, &Settings::default(), &mut file)?.bytes * 8;
    let vertices = surface.vertex_count() as f64;
    let error = |delta: &[f64]| {
        let (mut edge, mut normal) = (0.0, 0.0);
        for (((crossing, n), delta), truth) in
            surface.crossings().zip(&normals).zip(delta).zip(&truth)
        {
            let off = delta - truth;
            edge += off * off;
            normal += (off * f64::from(n[crossing.axis()])).powi(2);
        }
        ((edge / vertices).sqrt(), (normal / vertices).sqrt())
    };
    for preset in [Preset::Fast, Preset::Default, Preset::Exact] {
        let optimize = optimize::Settings { preset, ..Default::default() };
        let settings = shrouds::Settings { optimize, ..Default::default() };
        let (edge, normal) = error(&shroud(&volume, &settings)?.delta);
        println!(
            "{}",
            json!({"mesh": name, "preset": format!("{preset:?}"), "vertices": vertices, "edge": edge, "normal": normal, "topology": topology as f64 / vertices})
        );
    }
    let start = ThreadTime::now();
    let planes = geometry::encode(&surface, &truth, 8)?;
    let encoding = start.elapsed().as_secs_f64() * 1e6 / vertices;
    let payloads: Vec<(&[u8], u32)> = planes.payloads.iter().map(|(p, s)| (&p[..], *s)).collect();
    let mut bits = 0.0;
    for count in 1..=8 {
        bits += 8.0 * payloads[count - 1].0.len() as f64;
        let start = ThreadTime::now();
        let places = geometry::decode(&surface, &planes.settings, &payloads[..count]);
        let decoding = start.elapsed().as_secs_f64() * 1e6 / vertices;
        let (edge, normal) = error(&places.deltas());
        println!(
            "{}",
            json!({"planes": places.planes, "hints": planes.settings[7 * (count - 1)..7 * count], "bits": bits / vertices, "total_per_100k_triangles": (bits + topology as f64) / vertices * 50.0, "edge": edge, "normal": normal, "encode_us": encoding / 8.0, "decode_us": decoding / count as f64})
        );
    }
    Ok(())
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
