//! Area, volume, centroid and principal axes against formulas.

use std::f64::consts::PI;

use shrouds::measure::{Integrals, integrals};
use shrouds::volume::phantom;
use shrouds::{Grid, Occupancy, Settings, TriMesh, shroud};

/// A box with a corner at `corner` and edges along three vectors at right angles, right-handed.
fn cuboid(corner: [f64; 3], edges: [[f64; 3]; 3]) -> TriMesh {
    let place = |n: usize| {
        std::array::from_fn(|k| {
            corner[k] + (0..3).map(|e| edges[e][k] * (n >> e & 1) as f64).sum::<f64>()
        })
    };
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { vertices: (0..8).map(place).collect(), triangles, normals: vec![] }
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found} for {expected}");
}

#[test]
fn a_turned_box_far_away_has_its_formulas() {
    let turn = phantom::rotation([1.0, 2.0, 3.0], 0.7).unwrap();
    let sides: [f64; 3] = [2.0, 3.0, 7.0];
    let edges = std::array::from_fn(|e| std::array::from_fn(|k| sides[e] * turn[k][e]));
    let corner = [1000.0, -2000.0, 500.0];
    let found = integrals(&cuboid(corner, edges)).unwrap();
    near(found.volume, 42.0, 1e-9);
    near(found.area, 2.0 * (6.0 + 21.0 + 14.0), 1e-9);
    near(found.surface_to_volume(), 82.0 / 42.0, 1e-9);
    near(found.sphericity(), (36.0 * PI * 42.0 * 42.0).cbrt() / 82.0, 1e-9);
    for k in 0..3 {
        let middle = corner[k] + (0..3).map(|e| edges[e][k]).sum::<f64>() / 2.0;
        near(found.centroid[k], middle, 1e-12);
    }
    let axes = found.principal_axes();
    for (n, side) in [2, 1, 0].into_iter().enumerate() {
        // Of a side s the mean of x² is s²/12.
        near(axes.lengths[n], 2.0 * sides[side] * (5.0f64 / 12.0).sqrt(), 1e-6);
        let along = (0..3).map(|k| axes.directions[n][k] * turn[k][side]).sum::<f64>();
        near(along.abs(), 1.0, 1e-9);
    }
}

#[test]
fn mirrored_scaled_and_permuted_bodies_keep_what_they_should() {
    let corner = [0.3, -0.2, 5.0];
    let mesh = cuboid(corner, [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]]);
    let of = |mesh: &TriMesh| integrals(mesh).unwrap();
    let (plain, mut scaled, mut cycled, mut mirrored) =
        (of(&mesh), mesh.clone(), mesh.clone(), mesh);
    scaled.vertices.iter_mut().flatten().for_each(|x| *x *= 3.0);
    near(of(&scaled).volume, 27.0 * plain.volume, 1e-12);
    near(of(&scaled).area, 9.0 * plain.area, 1e-12);
    cycled.vertices.iter_mut().for_each(|v| *v = [v[1], v[2], v[0]]);
    near(of(&cycled).volume, plain.volume, 1e-12);
    mirrored.vertices.iter_mut().for_each(|v| v[0] = -v[0]);
    near(of(&mirrored).volume, -plain.volume, 1e-12);
    near(of(&mirrored).centroid[0], -plain.centroid[0], 1e-12);
    near(of(&mirrored).sphericity(), plain.sphericity(), 1e-12);
    for (n, length) in of(&cycled).principal_axes().lengths.into_iter().enumerate() {
        near(length, plain.principal_axes().lengths[n], 1e-12);
    }
}

#[test]
fn a_shroud_of_an_ellipsoid_has_its_axes() {
    let grid = Grid::new([56; 3], [1.0; 3]).unwrap();
    let turn = phantom::rotation([0.3, -1.0, 0.5], 1.1).unwrap();
    let (centre, half) = ([27.3, 27.9, 28.2], [20.0, 15.0, 10.0]);
    let volume = phantom::ellipsoid(&grid, centre, half, &turn).unwrap();
    let found = integrals(&shroud(&volume, &Settings::default()).unwrap().mesh).unwrap();
    near(found.volume, 4.0 / 3.0 * PI * 3000.0, 0.01);
    for (length, half) in found.principal_axes().lengths.into_iter().zip(half) {
        near(length, 2.0 * half, 0.01);
    }
    for (found, true_centre) in found.centroid.into_iter().zip(centre) {
        assert!((found - true_centre).abs() < 0.05);
    }
}

#[test]
fn nothing_flat_and_damaged_meshes_are_told_apart() {
    assert_eq!(integrals(&TriMesh::default()), Ok(Integrals::default()));
    let mut flat = cuboid([1.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]]);
    let found = integrals(&flat).unwrap();
    assert_eq!((found.volume, found.centroid), (0.0, [1.5, 1.5, 1.0]));
    assert_eq!(found.covariance, [[0.0; 3]; 3]);
    flat.vertices[3][1] = f64::NAN;
    assert!(integrals(&flat).unwrap_err().to_string().contains("vertex 3"));
    flat.vertices.pop();
    flat.triangles.truncate(2);
    flat.triangles[1][2] = 7;
    assert!(integrals(&flat).is_err());
    let one = Occupancy::from_fn(Grid::new([3; 3], [1.0; 3]).unwrap(), |index| index == [1; 3]);
    let found = integrals(&shroud(&one, &Settings::default()).unwrap().mesh).unwrap();
    assert!(found.volume > 0.0 && found.centroid.iter().all(|x| (x - 1.0).abs() < 0.1));
}
