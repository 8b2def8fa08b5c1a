use proptest::prelude::*;
use shrouds::check::{CheckReport, CheckSettings, check};
use shrouds::volume::{Border, FaceRule};
use shrouds::{Error, Grid, Occupancy, TriMesh};

use crate::shapes::{cubic, in_world, noise, octahedron, together, voxel_box};

fn judge(mesh: &TriMesh, volume: &Occupancy) -> CheckReport {
    check(mesh, volume, &CheckSettings::default()).expect("a sound mesh")
}

/// A box of points in a volume with room around it, and its surface.
fn box_in_volume(seed: u64) -> (TriMesh, Occupancy) {
    let (low, high) = ([1, 2, 3], [4, 3, 6]);
    let volume = Occupancy::from_fn(cubic(9), |index| {
        (0..3).all(|d| (low[d]..=high[d]).contains(&index[d]))
    });
    let mesh = voxel_box(low, high, |([i, j, k], direction)| {
        0.01 + 0.98 * noise(seed, [i, j, 10 * k + direction])
    });
    (mesh, volume)
}

#[test]
fn boxes_with_any_delta_are_clean() {
    for seed in 0..50 {
        let (mesh, volume) = box_in_volume(seed);
        let report = judge(&mesh, &volume);
        assert!(report.is_clean(), "seed {seed}: {:?}", report.problems());
        assert!(report.notes().is_empty());
    }
}

#[test]
fn the_frame_does_not_matter() {
    let frame = [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];
    let (mesh, bits) = box_in_volume(3);
    let grid = Grid::with_affine([9; 3], frame).unwrap();
    let volume = Occupancy::from_fn(grid.clone(), |index| bits.get(index));
    let report = judge(&in_world(mesh, &grid), &volume);
    assert!(report.is_clean(), "{:?}", report.problems());
    assert!(report.structure.volume > 0.0);
}

#[test]
fn a_removed_triangle_is_a_hole() {
    let (mut mesh, volume) = box_in_volume(1);
    mesh.triangles.pop();
    let report = judge(&mesh, &volume);
    assert_eq!(report.stray_boundary_edges.count, 3);
    assert_eq!(report.structure.euler(), 1);
    assert!(report.problems().iter().any(|p| p.starts_with("3 edges with one triangle; first")));
}

#[test]
fn a_flipped_triangle_is_inconsistent() {
    let (mut mesh, volume) = box_in_volume(1);
    mesh.triangles[0].swap(0, 1);
    let report = judge(&mesh, &volume);
    assert_eq!(report.structure.inconsistent_edges.count, 3);
    assert_eq!(
        report.problems()[0].split(';').next(),
        Some("3 edges whose triangles face opposite sides")
    );
}

#[test]
fn an_inverted_mesh_is_inside_out_and_nothing_else() {
    let (mut mesh, volume) = box_in_volume(1);
    mesh.triangles.iter_mut().for_each(|corners| corners.swap(0, 2));
    let report = judge(&mesh, &volume);
    assert!(report.separation.inverted && report.structure.volume < 0.0);
    assert_eq!(report.problems(), ["the mesh is inside out: its triangles face the inside points"]);
}

#[test]
fn a_duplicated_triangle_is_seen_three_times_over() {
    let (mut mesh, volume) = box_in_volume(1);
    mesh.triangles.push(mesh.triangles[7]);
    let report = judge(&mesh, &volume);
    assert_eq!(report.structure.non_manifold_edges.count, 3);
    let pairs = report.self_intersections.unwrap();
    assert!(pairs.first.contains(&[7, mesh.triangles.len() as u32 - 1]));
}

#[test]
fn a_vertex_moved_past_its_lattice_point_puts_it_on_the_wrong_side() {
    let volume = Occupancy::from_fn(cubic(3), |index| index == [1; 3]);
    let mut mesh = octahedron([1.0; 3], [0.5; 6]);
    mesh.vertices[1][0] = 0.75; // the +x vertex, now left of the point
    let report = judge(&mesh, &volume);
    let wrong = &report.separation.wrong_side;
    assert_eq!((wrong.count, wrong.first[0].index), (1, [1; 3]));
    assert!(wrong.first[0].inside && wrong.first[0].winding == 0);
    assert_eq!(
        report.problems(),
        ["1 lattice points on the wrong side; first: [1, 1, 1], inside, with winding number 0"]
    );

    for x in [1.0, 1.0 + 5e-5, 1.0 - 5e-5] {
        mesh.vertices[1][0] = x;
        let report = judge(&mesh, &volume);
        assert!(report.is_clean(), "{:?}", report.problems());
        assert_eq!(report.separation.touching.first, [[1; 3]]);
        assert_eq!(report.notes(), ["1 lattice points on the surface; first: [1, 1, 1]"]);
    }

    mesh.vertices[1][0] = 2.5; // over the next point
    let wrong = judge(&mesh, &volume).separation.wrong_side;
    assert_eq!((wrong.count, wrong.first[0].index, wrong.first[0].winding), (1, [2, 1, 1], 1));
}

#[test]
fn a_bow_tie_is_no_manifold() {
    let volume = Occupancy::from_fn(cubic(4), |[i, j, k]| j == 1 && k == 1 && (i == 1 || i == 3));
    let mut mesh = together([
        octahedron([1.0; 3], [0.5, 1.0, 0.5, 0.5, 0.5, 0.5]),
        octahedron([3.0, 1.0, 1.0], [1.0, 0.5, 0.5, 0.5, 0.5, 0.5]),
    ]);
    mesh.triangles.iter_mut().flatten().filter(|v| **v == 6).for_each(|v| *v = 1);
    let report = judge(&mesh, &volume);
    assert_eq!(report.structure.non_manifold_vertices.first, [1]);
    assert_eq!(report.problems().len(), 1, "{:?}", report.problems());
    assert_eq!(report.separation.touching.first, [[2, 1, 1]], "where they meet");
}

#[test]
fn the_wrong_topology_is_told() {
    let volume =
        Occupancy::from_fn(cubic(4), |[i, j, k]| k == 1 && (i, j) != (0, 0) && i == j && i < 3);
    let mesh = together([octahedron([1.0; 3], [0.5; 6]), octahedron([2.0, 2.0, 1.0], [0.4; 6])]);
    assert!(judge(&mesh, &volume).is_clean());
    let settings = CheckSettings { faces: FaceRule::Join, ..CheckSettings::default() };
    let report = check(&mesh, &volume, &settings).unwrap();
    assert_eq!(
        report.problems(),
        [
            "the Euler characteristic is 4, the volume's 2",
            "there are 2 components, the volume's are 1"
        ]
    );
}

#[test]
fn nothing_is_clean_only_against_nothing() {
    let empty = Occupancy::empty(cubic(4));
    assert!(judge(&TriMesh::default(), &empty).is_clean());
    let mut volume = empty.clone();
    volume.set([3, 0, 2], true);
    let report = judge(&TriMesh::default(), &volume);
    assert_eq!(report.separation.wrong_side.first[0].index, [3, 0, 2]);
    assert!(!judge(&octahedron([1.0; 3], [0.5; 6]), &empty).is_clean());
    let outside = octahedron([-5.0; 3], [0.5; 6]);
    assert_eq!(judge(&outside, &empty).separation.wrong_side.count, 0);
}

#[test]
fn an_open_border_lets_the_surface_end_there() {
    let open = CheckSettings { border: Border::Open, ..CheckSettings::default() };
    // A corner of the volume cut off by one triangle, as an octahedron's octant.
    let volume = Occupancy::from_fn(cubic(3), |index| index == [0; 3]);
    let corner = |reach: f64| TriMesh {
        vertices: vec![[reach, 0.0, 0.0], [0.0, reach, 0.0], [0.0, 0.0, reach]],
        triangles: vec![[0, 1, 2]],
        normals: vec![],
    };
    let report = check(&corner(0.3), &volume, &open).unwrap();
    assert!(report.is_clean(), "{:?}", report.problems());
    assert_eq!((report.structure.boundary_edges.count, report.expected.euler), (3, 1));
    assert!(!judge(&corner(0.3), &volume).is_clean(), "with a closed border it has a hole");
    assert_eq!(check(&corner(1.3), &volume, &open).unwrap().separation.wrong_side.count, 1);
    let mut lifted = corner(0.3);
    lifted.vertices[2][1] = 0.2;
    let report = check(&lifted, &volume, &open).unwrap();
    assert!(report.stray_boundary_edges.count > 0);
    let flat = Occupancy::empty(Grid::new([3, 3, 1], [1.0; 3]).unwrap());
    assert_eq!(check(&corner(0.3), &flat, &open), Err(Error::NoCells { dims: [3, 3, 1] }));
}

proptest! {
    #[test]
    fn grids_of_octahedra_are_clean(
        seed: u64,
        spacing in prop::array::uniform3(0.1f64..5.0),
        all_axes: bool,
    ) {
        // Every other point in all directions, so that the octahedra keep apart for any δ.
        let grid = Grid::new([7, 5, 6], spacing).unwrap();
        let chosen = |index: [usize; 3]| index.iter().all(|x| x % 2 == 0) && noise(seed, index) < 0.7;
        let volume = Occupancy::from_fn(grid.clone(), chosen);
        let points = (0..7 * 5 * 6).map(|n| [n % 7, n / 7 % 5, n / 35]).filter(|&index| chosen(index));
        let mesh = together(points.map(|index| {
            let reach = [0, 1, 2, 3, 4, 5].map(|d| 0.001 + 0.998 * noise(seed + d, index));
            octahedron(index.map(|x| x as f64), reach)
        }));
        let settings = CheckSettings { all_axes, ..CheckSettings::default() };
        let report = check(&in_world(mesh, &grid), &volume, &settings).unwrap();
        prop_assert!(report.is_clean(), "{:?}", report.problems());
        prop_assert_eq!(report.structure.components.len() as u64, volume.count());
    }
}
