//! Meshes, and winding numbers the plain way.

use std::f64::consts::PI;

use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy, TriMesh};

pub(crate) type Point = [f64; 3];

/// A number in [0, 1) that depends on the key alone.
pub(crate) fn noise(key: &[u64]) -> f64 {
    let mixed = key.iter().fold(0x9e37_79b9_7f4a_7c15u64, |state, &x| {
        let state = (state ^ x).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (state ^ state >> 29).wrapping_mul(0x94d0_49bb_1331_11eb) ^ state >> 32
    });
    (mixed >> 11) as f64 / (1u64 << 53) as f64
}

pub(crate) fn mesh(vertices: Vec<Point>, triangles: Vec<[u32; 3]>) -> TriMesh {
    TriMesh { vertices, triangles, normals: Vec::new() }
}

/// The box between two corners.
pub(crate) fn cuboid(low: Point, high: Point) -> TriMesh {
    let vertices = (0..8).map(|n| [0, 1, 2].map(|d| [low, high][n >> d & 1][d])).collect();
    let quads: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh(vertices, triangles)
}

/// A sphere of `8 · 4ⁿ` triangles.
pub(crate) fn sphere(centre: Point, radius: f64, n: u32) -> TriMesh {
    let unit = |p: Point| {
        let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        p.map(|x| x / length)
    };
    let mut corners: Vec<[Point; 3]> = (0..8)
        .map(|n| {
            let axis = |d: usize| {
                let mut p = [0.0; 3];
                p[d] = if n >> d & 1 == 0 { 1.0 } else { -1.0 };
                p
            };
            let order = if (n as u32).count_ones() & 1 == 0 { [0, 1, 2] } else { [0, 2, 1] };
            order.map(axis)
        })
        .collect();
    for _ in 0..n {
        let middle = |a: Point, b: Point| unit([0, 1, 2].map(|d| a[d] + b[d]));
        corners = corners
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let place = |p: Point| [0, 1, 2].map(|d| centre[d] + radius * p[d]);
    soup(corners.iter().map(|triangle| triangle.map(place)))
}

/// Triangles with vertices of their own.
pub(crate) fn soup(triangles: impl IntoIterator<Item = [Point; 3]>) -> TriMesh {
    let vertices: Vec<Point> = triangles.into_iter().flatten().collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    let triangles = triangles.collect();
    mesh(vertices, triangles)
}

pub(crate) fn together(meshes: &[&TriMesh]) -> TriMesh {
    let mut all = TriMesh::default();
    for mesh in meshes {
        let first = all.vertices.len() as u32;
        all.vertices.extend(&mesh.vertices);
        all.triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|v| v + first)));
    }
    all
}

pub(crate) fn turned(mesh: &TriMesh) -> TriMesh {
    let mut turned = mesh.clone();
    turned.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    turned
}

pub(crate) fn random_volume(grid: Grid, seed: u64, density: f64) -> Occupancy {
    Occupancy::from_fn(grid, |[i, j, k]| noise(&[seed, i as u64, j as u64, k as u64]) < density)
}

/// The separating surface through the middles of the grid edges: all its coordinates are halves.
pub(crate) fn midpoints(volume: &Occupancy) -> TriMesh {
    TriMesh::midpoint(&Surface::extract(volume, FaceRule::Separate, Border::Closed).unwrap())
}

pub(crate) fn cubic(n: usize) -> Grid {
    Grid::new([n; 3], [1.0; 3]).unwrap()
}

/// A lattice of steps along the axes with its first point somewhere.
pub(crate) fn lattice(dims: [usize; 3], step: f64, first: Point) -> Grid {
    let affine = [0, 1, 2].map(|r| {
        [0, 1, 2, 3].map(|c| {
            if c == 3 {
                first[r]
            } else if c == r {
                step
            } else {
                0.0
            }
        })
    });
    Grid::with_affine(dims, affine).unwrap()
}

pub(crate) fn points(grid: &Grid) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = grid.dims();
    (0..nx * ny * nz).map(move |n| [n % nx, n / nx % ny, n / nx / ny])
}

/// How often the mesh winds around the lattice point, shifted by (1/K, 1/K², 1/K³) of a step, exactly
/// and along z. The vertices must lie at small whole indices.
pub(crate) fn whole_winding(mesh: &TriMesh, grid: &Grid, point: [usize; 3]) -> i64 {
    const K: i128 = 256;
    let inverse = grid.inverse_affine();
    let p = [0, 1, 2].map(|d| point[d] as i128 * K.pow(3) + K.pow(2 - d as u32));
    let mut winding = 0;
    for &triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(triangle).map(|q| {
            [0, 1, 2].map(|d| {
                let row = inverse[d];
                let index = row[0] * q[0] + row[1] * q[1] + row[2] * q[2] + row[3];
                assert_eq!(index, index.round(), "whole indices");
                index as i128 * K.pow(3) - p[d]
            })
        });
        let area = |a: [i128; 3], b: [i128; 3]| (a[0] * b[1] - a[1] * b[0]).signum();
        let sides = [area(a, b), area(b, c), area(c, a)];
        if sides[0] == 0 || sides.iter().any(|&side| side != sides[0]) {
            continue;
        }
        let volume = (a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))
            .signum();
        // Crossed upwards above the point.
        if volume == sides[0] {
            winding += sides[0] as i64;
        }
    }
    if grid.is_mirrored() { -winding } else { winding }
}

/// The generalized winding number of a mesh around a point.
pub(crate) fn generalized_winding(mesh: &TriMesh, point: Point) -> f64 {
    let angles = mesh.triangles.iter().map(|&triangle| {
        let [a, b, c] = mesh.corners(triangle).map(|q| [0, 1, 2].map(|d| q[d] - point[d]));
        let dot = |u: Point, v: Point| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let [x, y, z] = [a, b, c].map(|u| dot(u, u).sqrt());
        let volume = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        volume.atan2(x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y)
    });
    angles.sum::<f64>() / (2.0 * PI)
}
