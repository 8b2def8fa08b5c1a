//! Random volumes with their points anywhere, judged by the checks of any mesh.

use shrouds::Grid;
use shrouds::check::{CheckSettings, check, structure};
use shrouds::materials::{Interfaces, Labels, MaterialMesh};
use shrouds::volume::FaceRule;

/// A number below 1 for every seed and index.
fn uniform(seed: u64, index: u64) -> f64 {
    let mut z =
        seed.wrapping_mul(0xd129_0d3b_3b7f_4c15) ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    for _ in 0..2 {
        z = (z ^ (z >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    (z >> 11) as f64 / (1u64 << 53) as f64
}

/// Random labels, 2 to 8 of them, on 3 to 8 lattice points along each axis.
fn volume(seed: u64) -> (Labels, FaceRule) {
    let number = |n: u64, below: usize| (uniform(seed, n) * below as f64) as usize;
    let dims = [0, 1, 2].map(|n| 3 + number(n, 6));
    let count = 2 + number(3, 7);
    let points: usize = dims.iter().product();
    let values: Vec<u8> = (0..points).map(|n| number(10 + n as u64, count) as u8).collect();
    let grid = Grid::new(dims, [1.0, 1.0, 1.0 + uniform(seed, 4)]).unwrap();
    let rule = if number(5, 2) == 0 { FaceRule::Separate } else { FaceRule::Join };
    (Labels::new(&grid, &values).unwrap(), rule)
}

/// The mesh with its points anywhere, and the labels.
fn random_mesh(seed: u64) -> (MaterialMesh, Labels) {
    let (labels, rule) = volume(seed);
    let interfaces = Interfaces::extract(labels.clone(), rule).unwrap();
    let (crossings, junctions) = (interfaces.crossings().len(), interfaces.junctions().len());
    let place = |n: usize| 0.002 + 0.996 * uniform(!seed, n as u64);
    let unknowns: Vec<f64> = (0..crossings + 2 * junctions).map(place).collect();
    let slope = |v: usize, n: u64| 4.0 * uniform(!seed, (n << 40) + v as u64) as f32 - 2.0;
    let slopes: Vec<[f32; 2]> = (0..crossings).map(|v| [slope(v, 1), slope(v, 2)]).collect();
    (MaterialMesh::span(&interfaces, &unknowns, &slopes), labels)
}

/// Every label of some random volumes is closed, oriented and a manifold, and keeps its lattice points.
/// Returns how many pairs of triangles cross, of how many triangles.
fn judge(seeds: std::ops::Range<u64>) -> [u64; 2] {
    let (mut crossing, mut triangles) = (0, 0);
    for seed in seeds {
        let (mesh, labels) = random_mesh(seed);
        triangles += mesh.surface.triangles.len() as u64;
        let volumes: Vec<_> =
            labels.values()[1..].iter().zip(labels.occupancies().unwrap()).collect();
        for (label, own) in mesh.closed_meshes() {
            assert_eq!(own, mesh.closed_mesh(label));
            let found = structure(&own).unwrap();
            let faults = [
                found.boundary_edges.count,
                found.non_manifold_edges.count,
                found.inconsistent_edges.count,
                found.non_manifold_vertices.count,
            ];
            assert_eq!(faults, [0; 4], "seed {seed} label {label}");
            let Some((_, volume)) = volumes.iter().find(|(l, _)| **l == label) else { continue };
            let settings = CheckSettings { all_axes: true, ..CheckSettings::default() };
            let report = check(&own, volume, &settings).unwrap();
            let wrong = &report.separation;
            assert_eq!(
                [wrong.wrong_side.count, wrong.odd_winding.count],
                [0; 2],
                "seed {seed} label {label}"
            );
            let pairs = report.self_intersections.unwrap();
            for pair in &pairs.first {
                let place = |t: u32| own.corners(own.triangles[t as usize]);
                println!("seed {seed} label {label}: {:?}", pair.map(place));
            }
            crossing += pairs.count;
        }
    }
    [crossing, triangles]
}

#[test]
fn every_label_is_a_closed_manifold_that_keeps_its_lattice_points_wherever_the_points_are() {
    let [crossing, triangles] = judge(0..80);
    assert!(triangles > 100_000, "{triangles}");
    // Wherever the points are, seldom no direction sees the whole border of a region in its cell.
    assert!(20_000 * crossing < triangles, "{crossing} pairs of {triangles} triangles cross");
}

/// Takes minutes; the numbers stand in docs/materials.md.
#[test]
#[ignore = "minutes"]
fn the_same_of_many_volumes() {
    let [crossing, triangles] = judge(80..3000);
    println!("{crossing} pairs of {triangles} triangles cross");
}

#[test]
fn every_interface_is_there_once() {
    for seed in 0..60 {
        let (mesh, _) = random_mesh(seed);
        let sorted = |mut corners: Vec<u32>| {
            corners.sort_unstable();
            corners
        };
        let triangles = &mesh.surface.triangles;
        let mut all: Vec<Vec<u32>> = triangles.iter().map(|t| sorted(t.to_vec())).collect();
        all.sort_unstable();
        assert!(all.windows(2).all(|two| two[0] != two[1]), "seed {seed}: a triangle twice");
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let mut sides: Vec<Vec<u32>> = sides.map(|side| sorted(side.to_vec())).collect();
        sides.sort_unstable();
        // Two triangles at an edge inside an interface, more at a junction line and at no other.
        let mut junctions = Vec::new();
        for same in sides.chunk_by(|a, b| a == b) {
            assert!(same.len() >= 2, "seed {seed}: edge {:?} has one triangle", same[0]);
            if same.len() > 2 {
                junctions.push(same[0].clone());
            }
        }
        let mut lines: Vec<Vec<u32>> =
            mesh.lines.iter().map(|line| sorted(line.to_vec())).collect();
        lines.sort_unstable();
        assert_eq!(lines, junctions, "seed {seed}");
    }
}
