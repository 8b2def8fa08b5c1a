//! Contact areas, distances and thickness against formulas.

use std::f64::consts::PI;

use shrouds::contact::contact_area;
use shrouds::measure::{area_within, surface_distances, thickness};
use shrouds::volume::phantom;
use shrouds::{Error, Grid, Occupancy, Settings, TriMesh, shroud};

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Numbers in [0, 1) from Weyl's sequence.
fn fraction(n: usize, axis: usize) -> f64 {
    ((n + 1) as f64 * [0.819_172_51, 0.671_043_61, 0.549_700_48][axis]).fract()
}

/// The two halves of a ball cut by a plane with this unit normal, so far from its centre.
fn halves(radius: f64, spacing: Vector, centre: Vector, normal: Vector, at: f64) -> [Occupancy; 2] {
    let dims = spacing.map(|s| (2.0 * radius / s) as usize + 5);
    [1.0, -1.0].map(|side| {
        let grid = Grid::new(dims, spacing).expect("a grid");
        Occupancy::from_fn(grid, |index| {
            let p = std::array::from_fn(|k| {
                (index[k] as f64 - 0.5 * dims[k] as f64) * spacing[k] - centre[k]
            });
            dot(p, p) <= radius * radius && side * (dot(p, normal) - at) > 0.0
        })
    })
}

#[test]
fn the_face_of_a_cut_ball_is_a_disc() {
    let mut errors = Vec::new();
    for radius in [10.0, 15.0] {
        for n in 0..12 {
            let centre = [0, 1, 2].map(|k| fraction(n, k));
            let raw: Vector = [0, 1, 2].map(|k| fraction(n + 50, k) - 0.5);
            let normal = raw.map(|x| x / dot(raw, raw).sqrt());
            let at = radius * (1.2 * fraction(n + 90, 0) - 0.6);
            let [a, b] = halves(radius, [1.0; 3], centre, normal, at);
            let area = contact_area(&a, &b, &Settings::default()).unwrap();
            let other = contact_area(&b, &a, &Settings::default()).unwrap();
            assert_eq!(area, other, "the same from both sides");
            let error = area / (PI * (radius * radius - at * at)) - 1.0;
            println!("{radius} {n} {normal:.2?} {at:.2}: {:+.2} %", 100.0 * error);
            errors.push(error);
        }
    }
    assert!(errors.iter().all(|error| error.abs() < 0.02), "{errors:?}");
}

#[test]
fn flat_faces_along_the_lattice_and_thick_slices() {
    // The plane passes half-way between two slices.
    let [a, b] = halves(10.0, [1.0; 3], [0.2, -0.3, 0.0], [0.0, 0.0, 1.0], 0.0);
    let area = contact_area(&a, &b, &Settings::default()).unwrap();
    println!("along: {}", area / (100.0 * PI));
    assert!((area / (100.0 * PI) - 1.0).abs() < 0.02, "{area}");
    for n in 0..4 {
        let raw: Vector = [0, 1, 2].map(|k| fraction(n + 70, k) - 0.5);
        let normal = raw.map(|x| x / dot(raw, raw).sqrt());
        let [a, b] = halves(20.0, [1.0, 1.0, 3.0], [0.3, 0.1, 0.7], normal, 2.0);
        let area = contact_area(&a, &b, &Settings::default()).unwrap();
        println!("thick {n}: {}", area / (396.0 * PI));
        assert!((area / (396.0 * PI) - 1.0).abs() < 0.06, "{area}");
    }
}

#[test]
fn bodies_that_do_not_touch_have_no_face() {
    let at = |x: usize| {
        Occupancy::from_fn(Grid::new([9; 3], [1.0; 3]).unwrap(), move |p| p == [x, 4, 4])
    };
    let settings = Settings::default();
    assert_eq!(contact_area(&at(2), &at(4), &settings), Ok(0.0));
    assert!(contact_area(&at(2), &at(3), &settings).unwrap() > 0.3);
    let empty = Occupancy::empty(Grid::new([9; 3], [1.0; 3]).unwrap());
    assert_eq!(contact_area(&at(2), &empty, &settings), Ok(0.0));
    let elsewhere = Occupancy::empty(Grid::new([8; 3], [1.0; 3]).unwrap());
    let refused = contact_area(&at(2), &elsewhere, &settings);
    assert!(matches!(refused, Err(Error::DifferentLattices { .. })), "{refused:?}");
}

/// A box between two corners.
fn cuboid(low: Vector, high: Vector) -> TriMesh {
    let corner = |n: usize| [0, 1, 2].map(|d| if n >> d & 1 == 1 { high[d] } else { low[d] });
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { vertices: (0..8).map(corner).collect(), triangles, normals: vec![] }
}

#[test]
fn a_plate_within_a_ball_is_a_disc_on_either_side() {
    let ball = shroud(&phantom::sphere(40).unwrap(), &Settings::default()).unwrap().mesh;
    let volume = ball.volume();
    let radius = (0.75 * volume / PI).cbrt();
    // Its rim lies outside, its corners far away.
    let middle = 19.5;
    let plate = cuboid([-5.0, -5.0, middle - 1e-3], [45.0, 45.0, middle + 1e-3]);
    let mut fine = TriMesh::default();
    let n = 50;
    for (i, j) in (0..n * n).map(|m| (m % n, m / n)) {
        let at = |i: usize, j: usize| [i as f64 - 5.0, j as f64 - 5.0, middle];
        let first = fine.vertices.len() as u32;
        fine.vertices.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        fine.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|v| v + first)));
    }
    let area = area_within(&fine, &ball).unwrap();
    assert!((area / (PI * radius * radius) - 1.0).abs() < 0.005, "{area}");
    assert!(area_within(&TriMesh::default(), &plate).is_err());
}

#[test]
fn boxes_are_as_far_apart_and_as_thick_as_they_are() {
    let one = cuboid([0.0; 3], [10.0, 6.0, 2.0]);
    let found = thickness(&one, 0.2).unwrap();
    // Each side counts with the thickness across it.
    let areas = [12.0, 20.0, 60.0];
    let mean = (areas[0] * 10.0 + areas[1] * 6.0 + areas[2] * 2.0) / 92.0;
    assert!((found.mean / mean - 1.0).abs() < 1e-9, "{found:?}");
    assert!((found.median, found.maximum) == (2.0, 10.0) || (found.median - 2.0).abs() < 1e-9);
    assert!((found.share - 1.0).abs() < 1e-9 && (found.maximum - 10.0).abs() < 1e-9);

    let other = cuboid([0.0, 0.0, 3.0], [10.0, 6.0, 5.0]);
    let found = surface_distances(&one, &other, 0.25).unwrap();
    // Bottoms are 3 from the other box, tops 1; along the sides it grows linearly.
    let mean = (60.0 * 3.0 + 60.0 + 64.0 * 2.0) / 184.0;
    assert!((found.forth.mean / mean - 1.0).abs() < 1e-9, "{found:?}");
    assert!((found.forth.maximum - 3.0).abs() < 1e-12);
    let square = (60.0 * 9.0 + 60.0 + 64.0 * (27.0 - 1.0) / 6.0) / 184.0;
    assert!((found.forth.root_mean_square / f64::sqrt(square) - 1.0).abs() < 1e-9, "{found:?}");
    assert!((found.symmetric.mean - found.forth.mean).abs() < 1e-12, "mirror images");
    let itself = surface_distances(&one, &one, 0.25).unwrap().symmetric;
    assert!(itself.maximum < 1e-12);

    let mut open = one.clone();
    open.triangles.truncate(10);
    let found = thickness(&open, 0.2).unwrap();
    assert!(found.share < 0.99 && found.share > 0.1, "{found:?}");
    let damaged = TriMesh { triangles: vec![[0, 1, 9]], ..one.clone() };
    assert!(matches!(surface_distances(&one, &damaged, 1.0), Err(Error::Mesh(_))));
    assert!(matches!(thickness(&TriMesh::default(), 1.0), Err(Error::Mesh(_))));
    assert!(matches!(thickness(&one, 0.0), Err(Error::Setting { .. })));
}

#[test]
fn the_thickness_of_a_tube_and_a_shell() {
    let grid = || Grid::new([44; 3], [1.0; 3]).unwrap();
    let shell = Occupancy::from_fn(grid(), |p| {
        let square: f64 = p.map(|i| (i as f64 - 21.3).powi(2)).iter().sum();
        (225.0..400.0).contains(&square)
    });
    let mesh = shroud(&shell, &Settings::default()).unwrap().mesh;
    let found = thickness(&mesh, 2.0).unwrap();
    assert!((found.median / 5.0 - 1.0).abs() < 0.02, "{found:?}");
    assert!((found.mean / 5.0 - 1.0).abs() < 0.02, "{found:?}");
}
