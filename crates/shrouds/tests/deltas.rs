//! δ of what is known: meshes and grey values against formulas.

use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::voxelize::{Rule, deltas};
use shrouds::{Error, Grid, Occupancy, Select, TriMesh, voxelize};

/// An octahedron |x| + |y| + |z| = r around a centre.
fn octahedron(r: f64, centre: [f64; 3]) -> TriMesh {
    let mut vertices = Vec::new();
    for d in 0..3 {
        for sign in [1.0, -1.0] {
            let mut point = centre;
            point[d] += sign * r;
            vertices.push(point);
        }
    }
    let mut triangles = Vec::new();
    for (x, y, z) in (0..8).map(|n| (n & 1, 2 + (n >> 1 & 1), 4 + (n >> 2))) {
        let odd = (x + y + z) % 2 == 1;
        triangles.push(if odd { [x, z, y] } else { [x, y, z] });
    }
    TriMesh { vertices, triangles, normals: vec![] }
}

const CENTRE: [f64; 3] = [5.1, 9.3, 7.7];
const RADIUS: f64 = 4.613;

fn distance(p: [f64; 3]) -> f64 {
    (0..3).map(|d| (p[d] - CENTRE[d]).abs()).sum::<f64>() - RADIUS
}

#[test]
fn a_mesh_is_crossed_where_its_formula_says() {
    let mesh = octahedron(RADIUS, CENTRE);
    let grid = Grid::new([12, 18, 30], [1.0, 1.0, 0.5]).unwrap();
    let volume = voxelize(&mesh, &grid, Rule::NonZero).unwrap().volume;
    for border in [Border::Closed, Border::Open] {
        let surface = Surface::extract(&volume, FaceRule::Separate, border).unwrap();
        let found = deltas(&mesh, &surface).unwrap();
        assert!(surface.vertex_count() > 300 && found.missing == 0);
        for (crossing, delta) in surface.crossings().zip(found.delta) {
            let place = surface.grid().point(crossing.position(delta));
            assert!(distance(place).abs() < 1e-9, "{crossing:?} {delta}");
        }
    }
}

#[test]
fn a_damaged_mesh_is_refused() {
    let grid = Grid::new([4; 3], [1.0; 3]).unwrap();
    let surface =
        Surface::extract(&Occupancy::empty(grid), FaceRule::Separate, Border::Closed).unwrap();
    let mesh = TriMesh { vertices: vec![], triangles: vec![[0, 1, 2]], normals: vec![] };
    assert!(matches!(deltas(&mesh, &surface), Err(Error::Mesh(_))));
}

#[test]
fn linear_grey_values_are_crossed_where_they_pass_the_level() {
    let dims = [9, 8, 7];
    let value = |i: usize, j: usize, k: usize| 3.0 * i as f64 - 2.0 * j as f64 + 1.7 * k as f64;
    let values: Vec<f64> = (0..9 * 8 * 7).map(|n| value(n % 9, n / 9 % 8, n / 72)).collect();
    let grid = Grid::new(dims, [1.0; 3]).unwrap();
    let volume = Occupancy::from_values(grid, &values, &Select::Above(7.2)).unwrap();
    for border in [Border::Closed, Border::Open] {
        let surface = Surface::extract(&volume, FaceRule::Separate, border).unwrap();
        let delta = surface.isosurface_deltas(&values, 7.2).unwrap();
        for (crossing, delta) in surface.crossings().zip(delta) {
            let [x, y, z] = surface.grid().point(crossing.position(delta));
            let on_plane = (3.0 * x - 2.0 * y + 1.7 * z - 7.2).abs() < 1e-9;
            assert!(on_plane || border == Border::Closed && delta == 0.5, "{crossing:?} {delta}");
        }
    }
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Open).unwrap();
    assert!(matches!(surface.isosurface_deltas(&values[1..], 0.0), Err(Error::Length { .. })));
}
