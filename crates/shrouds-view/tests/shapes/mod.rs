//! Meshes by formula, for the tests and the example.
#![allow(dead_code, unreachable_pub)]

use std::f64::consts::TAU;

use shrouds::TriMesh;

/// A closed sheet of `n × m` vertices, both parameters in turns: a torus for instance.
fn wrapped(n: usize, m: usize, place: impl Fn(f64, f64) -> [f64; 3]) -> TriMesh {
    let mut mesh = TriMesh::default();
    for i in 0..n {
        for j in 0..m {
            mesh.vertices.push(place(i as f64 / n as f64, j as f64 / m as f64));
            let index = |i, j| ((i % n) * m + j % m) as u32;
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A torus about the z axis.
pub fn torus(large: f64, small: f64, n: usize, m: usize) -> TriMesh {
    wrapped(n, m, |u, v| {
        let ((su, cu), (sv, cv)) = ((u * TAU).sin_cos(), (v * TAU).sin_cos());
        [(large + small * cv) * cu, (large + small * cv) * su, small * sv]
    })
}

/// Two linked tori, one in the xy plane and one in the xz plane.
pub fn linked_tori(n: usize) -> TriMesh {
    let mut both = torus(1.0, 0.4, 2 * n, n);
    // A quarter turn about x keeps the winding.
    let other = moved(&both, |[x, y, z]| [x + 1.0, -z, y]);
    append(&mut both, &other);
    both
}

/// The sphere of radius 1 as a mesh with poles on the z axis, its vertices on the sphere.
pub fn sphere(n: usize) -> TriMesh {
    let rings = n / 2;
    let mut mesh = TriMesh { vertices: vec![[0.0, 0.0, -1.0]], ..TriMesh::default() };
    for ring in 1..rings {
        let (s, c) = (TAU * ring as f64 / (2 * rings) as f64).sin_cos();
        for j in 0..n {
            let (y, x) = (TAU * j as f64 / n as f64).sin_cos();
            mesh.vertices.push([s * x, s * y, -c]);
        }
    }
    mesh.vertices.push([0.0, 0.0, 1.0]);
    let top = mesh.vertices.len() as u32 - 1;
    let index = |ring: usize, j: usize| (1 + (ring - 1) * n + j % n) as u32;
    for j in 0..n {
        mesh.triangles.push([0, index(1, j + 1), index(1, j)]);
        for ring in 1..rings - 1 {
            let [a, b] = [index(ring, j), index(ring, j + 1)];
            let [c, d] = [index(ring + 1, j + 1), index(ring + 1, j)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        mesh.triangles.push([top, index(rings - 1, j), index(rings - 1, j + 1)]);
    }
    mesh
}

/// The cube from −1 to 1.
pub fn cube() -> TriMesh {
    let vertices =
        (0..8).map(|c| [0, 1, 2].map(|i| if c >> i & 1 == 0 { -1.0 } else { 1.0 })).collect();
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { vertices, triangles, normals: vec![] }
}

/// The mesh with its vertices moved; normals are dropped.
pub fn moved(mesh: &TriMesh, to: impl Fn([f64; 3]) -> [f64; 3]) -> TriMesh {
    let vertices = mesh.vertices.iter().map(|&p| to(p)).collect();
    TriMesh { vertices, triangles: mesh.triangles.clone(), normals: vec![] }
}

/// Adds the triangles of one mesh to another.
pub fn append(mesh: &mut TriMesh, other: &TriMesh) {
    let shift = mesh.vertices.len() as u32;
    mesh.vertices.extend(&other.vertices);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|vertex| vertex + shift)));
}

/// Where the mesh meets the planes that are whole multiples of `step` along an axis.
pub fn slices(mesh: &TriMesh, axis: usize, step: f64) -> Vec<[[f64; 3]; 2]> {
    let mut segments = Vec::new();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| mesh.vertices[vertex as usize]);
        let heights = corners.map(|p| p[axis] / step);
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min).ceil() as i64;
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max).floor() as i64;
        for plane in low..=high {
            let mut ends = Vec::new();
            for k in 0..3 {
                let (from, to) = (heights[k] - plane as f64, heights[(k + 1) % 3] - plane as f64);
                if (from < 0.0) != (to < 0.0) {
                    let t = from / (from - to);
                    let (p, q) = (corners[k], corners[(k + 1) % 3]);
                    ends.push(std::array::from_fn(|i| p[i] + t * (q[i] - p[i])));
                }
            }
            if let [a, b] = ends[..] {
                segments.push([a, b]);
            }
        }
    }
    segments
}
