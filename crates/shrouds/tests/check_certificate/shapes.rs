//! Meshes and volumes made by formula.

use std::collections::BTreeMap;

use shrouds::volume::Border;
use shrouds::{Grid, Occupancy, TriMesh};

/// A number in [0, 1) that depends on the key alone.
pub(crate) fn noise(seed: u64, key: [usize; 3]) -> f64 {
    let mixed = key.iter().fold(seed ^ 0x9e37_79b9_7f4a_7c15, |state, &x| {
        let state = (state ^ x as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state ^ state >> 29
    });
    (mixed >> 11) as f64 / (1u64 << 53) as f64
}

pub(crate) fn cubic(n: usize) -> Grid {
    Grid::new([n; 3], [1.0; 3]).expect("a plain grid")
}

pub(crate) fn random_volume(dims: [usize; 3], seed: u64, density: f64) -> Occupancy {
    let grid = Grid::new(dims, [1.0; 3]).expect("a plain grid");
    Occupancy::from_fn(grid, |index| noise(seed, index) < density)
}

/// All meshes in one.
pub(crate) fn together(meshes: impl IntoIterator<Item = TriMesh>) -> TriMesh {
    let mut all = TriMesh::default();
    for mesh in meshes {
        let first = all.vertices.len() as u32;
        all.vertices.extend(mesh.vertices);
        all.triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|v| v + first)));
    }
    all
}

/// The mesh with its vertices, given in units of the index, in the world of the grid.
pub(crate) fn in_world(mut mesh: TriMesh, grid: &Grid) -> TriMesh {
    mesh.vertices.iter_mut().for_each(|p| *p = grid.point(*p));
    if grid.is_mirrored() {
        mesh.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
    }
    mesh
}

/// An octahedron with vertices at these distances along −x, +x, −y, +y, −z, +z.
pub(crate) fn octahedron(centre: [f64; 3], reach: [f64; 6]) -> TriMesh {
    let vertices = (0..6).map(|n| {
        let mut p = centre;
        p[n / 2] += if n % 2 == 0 { -reach[n] } else { reach[n] };
        p
    });
    let triangles = (0..8u32).map(|n| {
        let [x, y, z] = [n & 1, 2 + (n >> 1 & 1), 4 + (n >> 2)];
        // Each step to the other side mirrors the triangle.
        if n.count_ones() % 2 == 1 { [x, y, z] } else { [y, x, z] }
    });
    TriMesh { vertices: vertices.collect(), triangles: triangles.collect(), normals: vec![] }
}

/// A lattice point and one of the six directions −x, +x, …: a crossing.
type Crossing = ([usize; 3], usize);

/// The separating surface of the box of points `low..=high`; `reach` says how far outside of its
/// point the vertex of a crossing lies.
pub(crate) fn voxel_box(
    low: [usize; 3],
    high: [usize; 3],
    reach: impl Fn(Crossing) -> f64,
) -> TriMesh {
    let mut polygons: Vec<Vec<Crossing>> = Vec::new();
    let end = |direction: usize| [low, high][direction % 2][direction / 2];
    for direction in 0..6 {
        let axis = direction / 2;
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for a in low[u]..high[u] {
            for b in low[v]..high[v] {
                polygons.push(
                    [[0, 0], [1, 0], [1, 1], [0, 1]]
                        .map(|[da, db]| {
                            let mut point = [end(direction); 3];
                            (point[u], point[v]) = (a + da, b + db);
                            (point, direction)
                        })
                        .to_vec(),
                );
            }
        }
        // The edges of the box between this side and those of the next axis.
        for other in [2 * u, 2 * u + 1] {
            for b in low[v]..high[v] {
                let at = |b: usize, direction_: usize| {
                    let mut point = [0; 3];
                    (point[axis], point[u], point[v]) = (end(direction), end(other), b);
                    (point, direction_)
                };
                polygons.push(vec![
                    at(b, direction),
                    at(b + 1, direction),
                    at(b + 1, other),
                    at(b, other),
                ]);
            }
        }
    }
    for corner in 0..8 {
        let directions = [0, 1, 2].map(|d| 2 * d + (corner >> d & 1));
        let point = directions.map(end);
        polygons.push(directions.map(|direction| (point, direction)).to_vec());
    }
    let place = |(point, direction): Crossing, reach: f64| {
        let mut p = point.map(|x| x as f64);
        p[direction / 2] += if direction % 2 == 0 { -reach } else { reach };
        p
    };
    let mut numbers: BTreeMap<Crossing, u32> = BTreeMap::new();
    let mut mesh = TriMesh::default();
    let centre = [0, 1, 2].map(|d| 0.5 * (low[d] + high[d]) as f64);
    for polygon in &mut polygons {
        // The surface with all vertices in the middle is convex: there outward is clear.
        let [a, b, c] = [0, 1, 2].map(|n| place(polygon[n], 0.5));
        if determinant([0, 1, 2].map(|n| [a, b, c][n]).map(|p| minus(p, centre))) < 0.0 {
            polygon.reverse();
        }
        let ids: Vec<u32> = polygon
            .iter()
            .map(|&crossing| {
                *numbers.entry(crossing).or_insert_with(|| {
                    mesh.vertices.push(place(crossing, reach(crossing)));
                    mesh.vertices.len() as u32 - 1
                })
            })
            .collect();
        mesh.triangles.extend((2..ids.len()).map(|n| [ids[0], ids[n - 1], ids[n]]));
    }
    mesh
}

/// The boundary of the cubes around the inside points, with corners moved by less than half a step:
/// it separates all points, though it is no manifold where cubes meet along an edge. With an open
/// border the cubes end at the outermost lattice planes, and their faces there are left out.
pub(crate) fn cubes(volume: &Occupancy, border: Border, seed: u64) -> TriMesh {
    let dims = volume.grid().dims();
    let mut numbers: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    let mut mesh = TriMesh::default();
    let inside = |index: [i64; 3]| {
        let own = index.map(|x| x as usize);
        (0..3).all(|d| index[d] >= 0 && own[d] < dims[d]).then(|| volume.get(own))
    };
    for position in 0..volume.grid().point_count() {
        let index =
            [position % dims[0], position / dims[0] % dims[1], position / dims[0] / dims[1]];
        if !volume.get(index) {
            continue;
        }
        for direction in 0..6 {
            let (axis, up) = (direction / 2, direction % 2);
            let mut next = index.map(|x| x as i64);
            next[axis] += 2 * up as i64 - 1;
            match inside(next) {
                Some(true) => continue,
                None if border == Border::Open => continue,
                _ => {}
            }
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            let mut ids = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
                let mut corner = index;
                corner[axis] += up;
                corner[u] += du;
                corner[v] += dv;
                *numbers.entry(corner).or_insert_with(|| {
                    mesh.vertices.push([0, 1, 2].map(|d| {
                        let x = corner[d] as f64 - 0.99 + 0.98 * noise(seed + d as u64, corner);
                        let at_end = corner[d] == 0 || corner[d] == dims[d];
                        if border == Border::Open && at_end {
                            corner[d] as f64 - f64::from(u8::from(corner[d] > 0))
                        } else {
                            x
                        }
                    }));
                    mesh.vertices.len() as u32 - 1
                })
            });
            if up == 0 {
                ids.reverse();
            }
            mesh.triangles.extend([[ids[0], ids[1], ids[2]], [ids[0], ids[2], ids[3]]]);
        }
    }
    mesh
}

/// A torus around z, `n` vertices around the axis and `m` around the tube.
pub(crate) fn torus(n: u32, m: u32, ring: f64, tube: f64) -> TriMesh {
    let angle = |step: u32, of: u32| f64::from(step) * std::f64::consts::TAU / f64::from(of);
    let vertex = |a: u32, b: u32| {
        let ((sa, ca), (sb, cb)) = (angle(a, n).sin_cos(), angle(b, m).sin_cos());
        let r = ring + tube * cb;
        [r * ca, r * sa, tube * sb]
    };
    let id = |a: u32, b: u32| a % n * m + b % m;
    let cells = (0..n).flat_map(|a| (0..m).map(move |b| (a, b)));
    TriMesh {
        vertices: cells.clone().map(|(a, b)| vertex(a, b)).collect(),
        triangles: cells
            .flat_map(|(a, b)| {
                let [p, q, r, s] = [id(a, b), id(a + 1, b), id(a + 1, b + 1), id(a, b + 1)];
                [[p, q, r], [p, r, s]]
            })
            .collect(),
        normals: vec![],
    }
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn determinant([a, b, c]: [[f64; 3]; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}
