//! Random volumes and places, judged by the checks of any mesh.

use super::*;
use crate::check::{CheckSettings, check, structure};
use crate::grid::Grid;
use crate::materials::Labels;
use crate::random::uniform;
use crate::volume::FaceRule;

/// Random labels below `count`, as many as a seed makes on 3 to 8 lattice points along each axis.
fn volume(seed: u64) -> (Labels, FaceRule) {
    let number = |n: u64, below: usize| (uniform(seed, n) * below as f64) as usize;
    let dims = [0, 1, 2].map(|n| 3 + number(n, 6));
    let count = 2 + number(3, 7);
    let values: Vec<u8> =
        (0..dims.iter().product()).map(|n: usize| number(10 + n as u64, count) as u8).collect();
    let grid = Grid::new(dims, [1.0, 1.0, 1.0 + uniform(seed, 4)]).unwrap();
    let rule = if number(5, 2) == 0 { FaceRule::Separate } else { FaceRule::Join };
    (Labels::new(&grid, &values).unwrap(), rule)
}

/// The mesh with its points anywhere, and the labels.
fn random_mesh(seed: u64, margin: f64) -> (MaterialMesh, Labels) {
    let (labels, rule) = volume(seed);
    let interfaces = Interfaces::extract(labels.clone(), rule).unwrap();
    let (crossings, junctions) = (interfaces.crossings().len(), interfaces.junctions().len());
    let place = |n: usize| margin + (1.0 - 2.0 * margin) * uniform(!seed, n as u64);
    let unknowns: Vec<f64> = (0..crossings + 2 * junctions).map(place).collect();
    let slopes: Vec<[f32; 2]> = (0..crossings)
        .map(|v| [1, 2].map(|n| 4.0 * uniform(!seed, (n << 40) + v as u64) as f32 - 2.0))
        .collect();
    (span(&interfaces, &unknowns, &slopes), labels)
}

#[test]
fn every_label_of_random_volumes_is_closed_and_keeps_its_lattice_points_wherever_the_points_are() {
    let mut crossing_pairs = 0;
    for seed in 0..150 {
        let (mesh, labels) = random_mesh(seed, 0.002);
        for (rank, &label) in labels.values().iter().enumerate() {
            let own = mesh.closed_mesh(label);
            let found = structure(&own).unwrap();
            assert_eq!(found.boundary_edges.count, 0, "seed {seed} label {label}");
            assert_eq!(found.non_manifold_edges.count, 0, "seed {seed} label {label}");
            assert_eq!(found.inconsistent_edges.count, 0, "seed {seed} label {label}");
            assert_eq!(found.non_manifold_vertices.count, 0, "seed {seed} label {label}");
            if rank > 0 {
                let volume = labels.occupancy(rank as u32).unwrap();
                let settings = CheckSettings { all_axes: true, ..CheckSettings::default() };
                let report = check(&own, &volume, &settings).unwrap();
                assert_eq!(report.separation.wrong_side.count, 0, "seed {seed} label {label}");
                assert_eq!(report.separation.odd_winding.count, 0, "seed {seed} label {label}");
                crossing_pairs += report.self_intersections.unwrap().count;
            }
        }
    }
    assert_eq!(crossing_pairs, 0);
}

#[test]
fn every_interface_is_there_once() {
    for seed in 0..100 {
        let (mesh, _) = random_mesh(seed, 0.002);
        let mut corners: Vec<[u32; 3]> = mesh
            .triangles
            .iter()
            .map(|t| {
                let mut t = *t;
                t.sort_unstable();
                t
            })
            .collect();
        corners.sort_unstable();
        assert!(corners.windows(2).all(|two| two[0] != two[1]), "seed {seed}: a triangle twice");
        let mut lines = mesh.lines.clone();
        lines.iter_mut().for_each(|line| line.sort_unstable());
        let mut sides: Vec<[u32; 2]> = mesh
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        sides.sort_unstable();
        // Two triangles at an edge inside an interface, more at a junction line and at no other.
        let mut junctions: Vec<[u32; 2]> = Vec::new();
        for same in sides.chunk_by(|a, b| a == b) {
            assert!(same.len() >= 2, "seed {seed}: edge {:?} has one triangle", same[0]);
            if same.len() > 2 {
                junctions.push(same[0]);
            }
        }
        lines.sort_unstable();
        assert_eq!(lines, junctions, "seed {seed}");
    }
}
