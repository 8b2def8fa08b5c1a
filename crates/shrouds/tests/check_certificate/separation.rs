use proptest::prelude::*;
use shrouds::check::{CheckSettings, Separation, check};
use shrouds::volume::Border;
use shrouds::{Grid, Occupancy, TriMesh};

use crate::shapes::{cubes, determinant, in_world, minus, noise, random_volume};

const OBLIQUE: [[f64; 4]; 3] =
    [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];

fn separation(mesh: &TriMesh, volume: &Occupancy, border: Border, all_axes: bool) -> Separation {
    let settings =
        CheckSettings { border, all_axes, self_intersections: false, ..CheckSettings::default() };
    check(mesh, volume, &settings).expect("a sound mesh").separation
}

fn clean(separation: &Separation) -> bool {
    !separation.inverted && separation.wrong_side.is_empty() && separation.odd_winding.is_empty()
}

/// How often the mesh winds around a point, by solid angles.
fn winding(mesh: &TriMesh, point: [f64; 3]) -> i64 {
    let total: f64 = mesh
        .triangles
        .iter()
        .map(|corners| {
            let [a, b, c] = corners.map(|v| minus(mesh.vertices[v as usize], point));
            let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
            let [la, lb, lc] = [a, b, c].map(|p| dot(p, p).sqrt());
            let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
            2.0 * determinant([a, b, c]).atan2(below)
        })
        .sum();
    let turns = total / (4.0 * std::f64::consts::PI);
    assert!((turns - turns.round()).abs() < 1e-6, "{turns} at {point:?}");
    turns.round() as i64
}

/// Whether a point lies on a triangle, all coordinates in whole numbers.
fn touches(triangle: [[i64; 3]; 3], p: [i64; 3]) -> bool {
    let sub = |a: [i64; 3], b: [i64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |u: [i64; 3], v: [i64; 3]| {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    };
    let dot = |u: [i64; 3], v: [i64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let [a, b, c] = triangle;
    let n = cross(sub(b, a), sub(c, a));
    dot(n, sub(p, a)) == 0
        && [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| dot(cross(sub(b, a), sub(p, a)), n) >= 0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Tetrahedra with corners on points, edges and faces of the lattice and of its refinement.
    #[test]
    fn winding_numbers_agree_with_solid_angles(
        bodies in prop::collection::vec(prop::array::uniform4([-3i64..12, -3i64..12, -3i64..12]), 1..5),
        flips in 0u32..16,
        all_axes: bool,
    ) {
        let mut mesh = TriMesh::default();
        let mut halves = Vec::new();
        for (n, body) in bodies.iter().enumerate() {
            let p = body.map(|p| p.map(|x| x as f64 / 2.0));
            let volume = determinant([1, 2, 3].map(|n| minus(p[n], p[0])));
            if volume == 0.0 {
                continue;
            }
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(p);
            // Mostly outward, now and then turned over.
            let turn = (volume < 0.0) != (n > 0 && flips >> n & 1 == 1);
            for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
                let [a, b, c] = if turn { [face[1], face[0], face[2]] } else { face };
                mesh.triangles.push([a, b, c].map(|v| v + first));
                halves.push([a, b, c].map(|v| body[v as usize]));
            }
        }
        let grid = Grid::new([5, 4, 6], [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid, |index| {
            winding_or_zero(&mesh, &halves, index) > 0 && noise(1, index) < 0.9
        });
        let found = separation(&mesh, &volume, Border::Closed, all_axes);
        let orientation = if found.inverted { -1 } else { 1 };
        let (mut wrong, mut odd, mut touching) = (0, 0, 0);
        for n in 0..5 * 4 * 6 {
            let index = [n % 5, n / 5 % 4, n / 20];
            if halves.iter().any(|&t| touches(t, index.map(|x| 2 * x as i64))) {
                touching += 1;
                continue;
            }
            let w = orientation * winding(&mesh, index.map(|x| x as f64));
            wrong += u64::from((w > 0) != volume.get(index));
            odd += u64::from(w != 0 && w != 1);
            let listed = found.wrong_side.first.iter().find(|point| point.index == index);
            prop_assert!(listed.is_none_or(|point| point.winding == w && point.position == n));
        }
        prop_assert_eq!(found.touching.count, touching);
        // Lines along which nothing disagrees are not walked: a winding number of 2 needs a
        // disagreement of its line, and so does a wrong side.
        prop_assert_eq!((found.wrong_side.count, found.odd_winding.count), (wrong, odd));
    }

    #[test]
    fn cubes_separate_every_volume(
        dims in [1usize..7, 1usize..7, 1usize..7],
        seed: u64,
        density in 0.0..1.0,
        all_axes: bool,
    ) {
        let bits = random_volume(dims, seed, density);
        let grid = Grid::with_affine(dims, OBLIQUE).unwrap();
        let volume = Occupancy::from_fn(grid.clone(), |index| bits.get(index));
        let mesh = in_world(cubes(&volume, Border::Closed, seed), &grid);
        let found = separation(&mesh, &volume, Border::Closed, all_axes);
        prop_assert!(clean(&found), "{:?}", found);
        prop_assert_eq!(found.touching.count, 0);
        // One more point on the other side, and it is found.
        let mut other = volume.clone();
        let index = [0, 1, 2].map(|d| (seed as usize >> (8 * d)) % dims[d]);
        other.set(index, !volume.get(index));
        if volume.count() > 0 {
            let found = separation(&mesh, &other, Border::Closed, all_axes);
            prop_assert_eq!(found.wrong_side.count, if found.inverted { volume.count() } else { 1 });
            if !found.inverted {
                prop_assert_eq!(found.wrong_side.first[0].index, index);
            }
        }
    }

    #[test]
    fn cut_cubes_separate_volumes_with_an_open_border(
        dims in [2usize..70, 2usize..6, 2usize..6],
        seed: u64,
        density in 0.0..1.0,
    ) {
        let bits = random_volume(dims, seed, density);
        let grid = Grid::with_affine(dims, OBLIQUE).unwrap();
        let volume = Occupancy::from_fn(grid.clone(), |index| bits.get(index));
        let mesh = in_world(cubes(&volume, Border::Open, seed), &grid);
        let found = separation(&mesh, &volume, Border::Open, false);
        prop_assert!(clean(&found), "{:?}", found);
        let mut other = volume.clone();
        let index = [0, 1, 2].map(|d| (seed as usize >> (8 * d)) % dims[d]);
        other.set(index, !volume.get(index));
        prop_assert!(!clean(&separation(&mesh, &other, Border::Open, false)));
    }
}

fn winding_or_zero(mesh: &TriMesh, halves: &[[[i64; 3]; 3]], index: [usize; 3]) -> i64 {
    if halves.iter().any(|&t| touches(t, index.map(|x| 2 * x as i64))) {
        return 0;
    }
    winding(mesh, index.map(|x| x as f64))
}

#[test]
fn a_surface_along_the_lines_is_seen_with_an_open_border() {
    // The plane y = 2.5 has no crossing with any line along x, wherever it is.
    let plane = |y: f64| TriMesh {
        vertices: vec![[0.0, y, 0.0], [5.0, y, 0.0], [5.0, y, 4.0], [0.0, y, 4.0]],
        triangles: vec![[0, 2, 1], [0, 3, 2]],
        normals: vec![],
    };
    let grid = Grid::new([6, 6, 5], [1.0; 3]).unwrap();
    let volume = Occupancy::from_fn(grid, |[_, j, _]| j < 3);
    assert!(clean(&separation(&plane(2.5), &volume, Border::Open, false)));
    let found = separation(&plane(3.5), &volume, Border::Open, false);
    assert_eq!((found.axes, found.wrong_side.count), (3, 30), "the 6 × 5 points at y = 3");
    assert_eq!(found.wrong_side.first[0].index, [0, 3, 0]);
    let found = separation(&plane(3.0), &volume, Border::Open, false);
    assert_eq!((found.wrong_side.count, found.touching.count), (0, 30));
}

#[test]
fn a_large_slanted_triangle_is_followed_line_by_line() {
    let mesh = TriMesh {
        vertices: vec![[-1.5, -1.25, -1.75], [300.0, 0.3, 0.1], [0.2, 70.0, 0.4], [0.3, 0.1, 50.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        normals: vec![],
    };
    let grid = Grid::new([40, 40, 40], [1.0; 3]).unwrap();
    let volume = Occupancy::from_fn(grid, |index| winding(&mesh, index.map(|x| x as f64)) == 1);
    assert!(volume.count() > 0 && volume.count() < 64_000);
    assert!(clean(&separation(&mesh, &volume, Border::Closed, true)));
}
