//! Figure 5: a statue on 100 × 300 × 100 points, and what a few bits for each vertex make of it.

use shrouds::mesh::{network_normals, place_vertices};
use shrouds::network::Network;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Occupancy, TriMesh};
use shrouds_codec::{Settings, geometry, pack};
use shrouds_view::{Cell, Scene};

use super::data::{Body, Fit};
use super::panel::{Look, exact, midpoint, reach, row, within};
use super::{Claim, Data, Figure, Table, Verdict};
use crate::failure::Failure;

/// The paper's statue is 300 points high, along its second axis; ours stands along z.
const DIMS: [usize; 3] = [100, 100, 300];
/// Bits of the paper per 100 000 triangles: topology alone, with one plane and with two.
const PAPER_KILOBITS: [f64; 3] = [50.0, 150.0, 250.0];

pub(super) fn figure(data: &Data) -> Result<Figure, Failure> {
    let body = data.body("man.ply", DIMS, Fit::Stretched, bust)?;
    let statue = Statue::new(&body)?;
    let look = Look::new(-50.0, 8.0, [250, 560]);
    let shroud = exact(&body.volume)?;
    let frame = reach(&shroud.mesh);
    let (mut cells, mut rows): (Vec<Cell>, Vec<Vec<String>>) = Default::default();
    let mut add = |title: &str, mesh: &TriMesh, kilobits: Option<f64>, error: Option<f64>| {
        let bits = kilobits.map_or("–".into(), |bits| format!("{bits:.1}"));
        let error = error.map_or("–".into(), |error| format!("{error:.3}"));
        let note = if kilobits.is_some() { format!("{bits}K bits") } else { String::new() };
        cells.push(look.panel([title.into(), note], &Scene::new(mesh), frame)?);
        rows.push(vec![title.into(), bits, error]);
        Ok::<_, Failure>(())
    };
    let topology = statue.kilobits(statue.topology);
    add(
        "a: midpoint surface",
        &midpoint(&body.volume)?.mesh,
        None,
        statue.error(&vec![0.5; statue.truth.len()]),
    )?;
    add("a: shroud, 0 bits", &shroud.mesh, Some(topology), statue.error(&shroud.delta))?;
    let planes = geometry::encode(&statue.surface, &statue.truth, 2)?;
    let payloads: Vec<(&[u8], u32)> =
        planes.payloads.iter().map(|(payload, sum)| (&payload[..], *sum)).collect();
    let mut bytes = statue.topology;
    let mut totals = vec![topology];
    for (count, title) in [(1, "b: 1 bit"), (2, "b: 2 bits")] {
        bytes += payloads[count - 1].0.len() as u64;
        let places = geometry::decode(&statue.surface, &planes.settings, &payloads[..count]);
        let shroud = within(&body.volume, places.intervals().collect())?;
        totals.push(statue.kilobits(bytes));
        add(title, &shroud.mesh, totals.last().copied(), statue.error(&shroud.delta))?;
    }
    let claims = [0, 1, 2].map(|n| claim(n, totals[n]));
    Ok(Figure {
        name: "figure5",
        title: "A statue on 100 × 100 × 300 points, with 0, 1 and 2 bits",
        paper: "An enumerated volume of 100 × 300 × 100 points and its optimal shroud; then δ quantised \
                to 1 bit and to 2 bits, and optimised within the intervals.",
        data: format!("{}, stretched to fill the lattice; not the paper's statue", body.source),
        picture: row(&cells)?,
        numbers: Table {
            head: vec!["", "K bits per 100 000 triangles", "normal error RMS, voxels"],
            rows,
        },
        claims: claims.into(),
    })
}

fn claim(planes: usize, kilobits: f64) -> Claim {
    let paper = [
        "100K triangles without a bit of δ take about 50K bits",
        "With 1 bit of δ for each vertex, about 150K bits",
        "With 2 bits, about 250K bits",
    ];
    Claim {
        paper: paper[planes],
        measured: format!("{kilobits:.1}K bits"),
        verdict: Verdict::of(kilobits <= PAPER_KILOBITS[planes]),
    }
}

/// A bust of balls and a shaft, positive inside; up is z.
pub(super) fn bust([x, y, z]: [f64; 3]) -> f64 {
    let ball = |c: [f64; 3], r: [f64; 3]| {
        let away = [x - c[0], y - c[1], z - c[2]];
        1.0 - (0..3).map(|a| (away[a] / r[a]).powi(2)).sum::<f64>().sqrt()
    };
    let parts = [
        ball([0.5, 0.5, 0.72], [0.3, 0.34, 0.22]),
        ball([0.5, 0.14, 0.7], [0.06, 0.08, 0.05]),
        ball([0.5, 0.52, 0.4], [0.16, 0.18, 0.24]),
        ball([0.5, 0.5, 0.16], [0.44, 0.3, 0.13]),
    ];
    parts.into_iter().fold(f64::MIN, f64::max)
}

/// A surface with its true crossings.
struct Statue {
    surface: Surface,
    truth: Vec<f64>,
    normals: Vec<[f32; 3]>,
    /// Bytes of the file with topology alone.
    topology: u64,
}

impl Statue {
    fn new(body: &Body) -> Result<Self, Failure> {
        let surface = Surface::extract(&body.volume, FaceRule::Separate, Border::Closed)?;
        let truth = body.crossings(&surface)?.unwrap_or_else(|| vec![0.5; surface.vertex_count()]);
        let normals =
            network_normals(&surface, &Network::trace(&surface), &place_vertices(&surface, &truth));
        let topology = topology(&body.volume)?;
        Ok(Self { surface, truth, normals, topology })
    }

    /// Per 100 000 triangles, of which there are two for each vertex.
    fn kilobits(&self, bytes: u64) -> f64 {
        8.0 * bytes as f64 / self.truth.len() as f64 * 50.0
    }

    /// Root mean square along the normals.
    fn error(&self, delta: &[f64]) -> Option<f64> {
        let vertices = self.surface.crossings().zip(&self.normals);
        let sum: f64 = vertices
            .zip(delta.iter().zip(&self.truth))
            .map(|((crossing, normal), (delta, truth))| {
                ((delta - truth) * f64::from(normal[crossing.axis()])).powi(2)
            })
            .sum();
        Some((sum / self.truth.len() as f64).sqrt())
    }
}

fn topology(volume: &Occupancy) -> Result<u64, Failure> {
    let mut file = Vec::new();
    Ok(pack(volume, &Settings::default(), &mut file)?.bytes)
}
