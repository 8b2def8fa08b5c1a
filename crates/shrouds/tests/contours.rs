//! Contours against formulas, brute force and the voxels themselves; fairness against its integral.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use shrouds::measure::{Contour, Planes, contours, fairness, network_contours};
use shrouds::mesh::{MeshKind, place_vertices};
use shrouds::network::Network;
use shrouds::optimize;
use shrouds::volume::{Border, phantom};
use shrouds::{Error, Grid, Occupancy, Settings, Shroud, TriMesh, shroud};

const OBLIQUE: [[f64; 4]; 3] =
    [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A volume of noise and a separating surface with random δ.
fn rough(grid: Grid, kind: MeshKind, border: Border) -> (Occupancy, Shroud) {
    let volume = phantom::noise(&grid, 0.4, 7).unwrap();
    let optimize = optimize::Settings {
        start: optimize::Start::Random(3),
        max_iterations: Some(0),
        preset: optimize::Preset::Exact,
        ..optimize::Settings::default()
    };
    let settings = Settings { optimize, mesh: kind, border, ..Settings::default() };
    let shroud = shroud(&volume, &settings).unwrap();
    (volume, shroud)
}

fn at(mesh: &TriMesh, axis: usize, position: f64) -> Vec<Contour> {
    contours(mesh, &Planes::across(axis, vec![position])).unwrap()
}

fn length_of(contours: &[Contour]) -> f64 {
    contours.iter().map(|contour| contour.length).sum()
}

/// A torus around z with n × m quadrilaterals.
fn torus(ring: f64, tube: f64, n: u32, m: u32) -> TriMesh {
    let point = |i: u32, j: u32| {
        let (u, v) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m));
        let away = ring + tube * v.cos();
        [away * u.cos(), away * u.sin(), tube * v.sin()]
    };
    let vertices = (0..n).flat_map(|i| (0..m).map(move |j| point(i, j))).collect();
    let number = |i: u32, j: u32| i % n * m + j % m;
    let quad = |i, j| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|i| (0..m).flat_map(move |j| quad(i, j))).collect();
    TriMesh { vertices, triangles, normals: vec![] }
}

fn cube() -> TriMesh {
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    TriMesh {
        vertices: (0..8u32).map(|n| [n & 1, n >> 1 & 1, n >> 2].map(f64::from)).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        normals: vec![],
    }
}

#[test]
fn sections_of_a_torus_are_circles() {
    let (ring, tube) = (5.0, 2.0);
    let mesh = torus(ring, tube, 400, 200);
    for height in [-1.5, 0.0, 0.3, 1.9] {
        let half = f64::sqrt(tube * tube - height * height);
        let [inner, outer] = [ring - half, ring + half];
        let mut found = at(&mesh, 2, height);
        found.sort_by(|a, b| a.area.total_cmp(&b.area));
        let [hole, around] = &found[..] else { panic!("{} contours", found.len()) };
        for (contour, radius, sign) in [(hole, inner, -1.0), (around, outer, 1.0)] {
            assert!(contour.closed && contour.position == height);
            assert!((contour.length / (TAU * radius) - 1.0).abs() < 2e-3, "{height}");
            assert!((contour.area / (sign * PI * radius * radius) - 1.0).abs() < 4e-3, "{height}");
            assert!(contour.points.iter().all(|p| p[2] == height), "exactly in the plane");
        }
    }
    // Through the hole of the ring, and beside it.
    assert_eq!(at(&mesh, 0, 0.1).len(), 2);
    assert_eq!(at(&mesh, 0, 3.5).len(), 1);
    assert!(at(&mesh, 0, 7.1).is_empty());
}

/// Between two heights without a vertex in between the area of a section is quadratic, and Gauss'
/// rule with two points exact.
#[test]
fn the_areas_of_sections_add_up_to_the_volume() {
    for kind in [MeshKind::Primal, MeshKind::Dual] {
        let grid = Grid::with_affine([6, 5, 4], OBLIQUE).unwrap();
        let mesh = rough(grid, kind, Border::Closed).1.mesh;
        for axis in 0..3 {
            let mut heights: Vec<f64> = mesh.vertices.iter().map(|p| p[axis]).collect();
            heights.sort_by(f64::total_cmp);
            let slabs = || heights.windows(2).filter(|pair| pair[1] - pair[0] > 1e-9);
            let points = slabs().flat_map(|pair| {
                let (middle, half) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
                [-1.0, 1.0].map(|sign| (middle + sign * half / f64::sqrt(3.0), half))
            });
            let points: Vec<(f64, f64)> = points.collect();
            let planes = Planes::across(axis, points.iter().map(|(place, _)| *place).collect());
            let weight =
                |position: f64| points[points.partition_point(|(place, _)| *place < position)].1;
            let found = contours(&mesh, &planes).unwrap();
            assert!(found.iter().all(|contour| contour.closed), "{kind:?} {axis}");
            let volume: f64 = found.iter().map(|c| c.area * weight(c.position)).sum();
            assert!((volume / mesh.volume() - 1.0).abs() < 1e-7, "{kind:?} {axis}: {volume}");
        }
    }
}

/// How often contours of one plane wind around a point, in two of its coordinates.
fn winding(contours: &[Contour], point: [f64; 3], axis: usize) -> i64 {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let mut winding = 0;
    for contour in contours {
        let count = contour.points.len();
        for n in 0..count {
            let [a, b] = [n, (n + 1) % count].map(|n| contour.points[n]);
            if (a[v] <= point[v]) != (b[v] <= point[v]) {
                let t = (point[v] - a[v]) / (b[v] - a[v]);
                if a[u] + t * (b[u] - a[u]) > point[u] {
                    winding += if b[v] > a[v] { 1 } else { -1 };
                }
            }
        }
    }
    winding
}

/// Lattice planes pass through most of the vertices there are, and what they cut separates the
/// lattice points in them.
#[test]
fn contours_in_lattice_planes_separate_the_voxels() {
    for kind in [MeshKind::Primal, MeshKind::Dual] {
        let (volume, shroud) = rough(Grid::new([9, 8, 7], [1.0; 3]).unwrap(), kind, Border::Closed);
        let dims = volume.grid().dims();
        for axis in 0..3 {
            for slice in 0..dims[axis] {
                let found = at(&shroud.mesh, axis, slice as f64);
                assert!(found.iter().all(|contour| contour.closed));
                for n in 0..volume.grid().point_count() {
                    let index = [n % dims[0], n / dims[0] % dims[1], n / dims[0] / dims[1]];
                    if index[axis] == slice {
                        let expected = i64::from(volume.get(index));
                        let point = index.map(|i| i as f64);
                        let found = winding(&found, point, axis);
                        assert_eq!(found, expected, "{kind:?} {axis} {index:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_network_is_what_lattice_planes_cut() {
    for mirror in [1.0, -1.0] {
        for border in [Border::Closed, Border::Open] {
            let affine = OBLIQUE.map(|[a, b, c, d]| [mirror * a, b, c, d]);
            let grid = Grid::with_affine([7, 6, 5], affine).unwrap();
            let (volume, shroud) = rough(grid, MeshKind::Primal, border);
            let network = Network::trace(&shroud.surface);
            let vertices = place_vertices(&shroud.surface, &shroud.delta);
            let families = network_contours(&shroud.surface, &network, &vertices, volume.grid());
            let count: usize = families.iter().map(Vec::len).sum();
            assert_eq!(count, network.curves().count());
            for (axis, family) in families.iter().enumerate() {
                let slices = (0..volume.grid().dims()[axis]).map(|n| n as f64).collect();
                let planes = Planes::across_lattice(volume.grid(), axis, slices);
                let cut = contours(&shroud.mesh, &planes).unwrap();
                for &position in planes.positions() {
                    let sums = |all: &[Contour]| {
                        let here = || all.iter().filter(|c| c.position == position);
                        assert!(border == Border::Open || here().all(|c| c.closed));
                        let open = here().filter(|c| !c.closed).count();
                        let area: f64 = here().map(|c| c.area).sum();
                        (open, area, here().map(|c| c.length).sum::<f64>())
                    };
                    let [a, b] = [sums(family), sums(&cut)];
                    // In the outermost planes of an open border there is only the edge of the mesh.
                    let last = planes.positions().len() as f64 - 1.0;
                    if border == Border::Closed || (position > 0.0 && position < last) {
                        assert_eq!(a.0, b.0, "{axis} {position}");
                        assert!((a.1 - b.1).abs() < 1e-6, "{axis} {position}: {a:?} {b:?}");
                        assert!((a.2 - b.2).abs() < 1e-6, "{axis} {position}: {a:?} {b:?}");
                    }
                }
            }
        }
    }
}

/// Triangles anywhere: no two need fit, and still nothing is lost.
#[test]
fn the_length_of_a_section_is_that_of_its_triangles() {
    let mut next = random(5);
    for round in 0..200 {
        let mut coordinate = || next() * 4.0;
        let vertices: Vec<[f64; 3]> =
            (0..12).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
        let mut triangles: Vec<[u32; 3]> =
            (0..30).map(|_| [0; 3].map(|_| (next() * 12.0) as u32)).collect();
        // Two on the same corners that face each other enclose nothing, which is no contour.
        let key = |mut t: [u32; 3]| {
            t.sort_unstable();
            t
        };
        triangles.sort_by_key(|&t| key(t));
        triangles.dedup_by_key(|t| key(*t));
        let mesh = TriMesh { vertices, triangles, normals: vec![] };
        let position = next() * 4.0;
        let expected: f64 =
            mesh.triangles.iter().map(|&t| clipped(mesh.corners(t), position)).sum();
        let found = length_of(&at(&mesh, 2, position));
        assert!((found - expected).abs() < 1e-9, "round {round}: {found} {expected}");
    }
}

/// The length of what the plane z = height has of a triangle.
fn clipped(corners: [[f64; 3]; 3], height: f64) -> f64 {
    let mut ends = Vec::new();
    for n in 0..3 {
        let [a, b] = [corners[n], corners[(n + 1) % 3]];
        if (a[2] < height) != (b[2] < height) {
            let t = (height - a[2]) / (b[2] - a[2]);
            ends.push([0, 1].map(|k| a[k] + t * (b[k] - a[k])));
        }
    }
    match ends[..] {
        [p, q] => (p[0] - q[0]).hypot(p[1] - q[1]),
        _ => 0.0,
    }
}

#[test]
fn planes_through_vertices_cut_what_is_below_them() {
    let cube = cube();
    for axis in 0..3 {
        assert!(at(&cube, axis, 0.0).is_empty());
        for position in [0.5, 1.0] {
            let found = at(&cube, axis, position);
            let [square] = &found[..] else { panic!("{found:?}") };
            assert!(square.closed && (square.length, square.area) == (4.0, 1.0), "{square:?}");
        }
        assert!(at(&cube, axis, 1.0 + 1e-15).is_empty());
    }
    // A ridge and a summit touch the plane, and are no contours.
    let roof = TriMesh {
        vertices: vec![
            [0.0; 3],
            [2.0, 0.0, 0.0],
            [2.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
            [0.5, 1.0, 1.0],
            [1.5, 1.0, 1.0],
        ],
        triangles: vec![
            [0, 2, 1],
            [0, 3, 2],
            [0, 1, 5],
            [0, 5, 4],
            [1, 2, 5],
            [2, 3, 4],
            [2, 4, 5],
            [3, 0, 4],
        ],
        normals: vec![],
    };
    assert!(at(&roof, 2, 1.0).is_empty());
    assert_eq!(at(&roof, 2, 1.0 - 1e-6).len(), 1);
}

#[test]
fn a_mesh_with_a_border_has_open_contours_and_opposite_triangles_break_them() {
    let mut mesh = cube();
    mesh.triangles.truncate(10); // no lid across z
    mesh.triangles.remove(0);
    let found = at(&mesh, 2, 0.25);
    assert_eq!(found.iter().map(|c| c.closed).collect::<Vec<_>>(), [false]);
    assert_eq!(found[0].area, 0.0);
    let mut mesh = cube();
    mesh.triangles[0].swap(0, 1);
    assert!((length_of(&at(&mesh, 2, 0.25)) - 4.0).abs() < 1e-12);
    assert!(at(&mesh, 2, 0.25).iter().all(|contour| !contour.closed));
}

#[test]
fn damaged_meshes_are_refused() {
    let planes = Planes::across(0, vec![0.5]);
    let mut mesh = cube();
    mesh.triangles[3][1] = 8;
    assert!(matches!(contours(&mesh, &planes), Err(Error::Mesh(_))));
    for bad in [f64::NAN, f64::INFINITY, 1e91] {
        let mut mesh = cube();
        mesh.vertices[2][1] = bad;
        assert!(matches!(contours(&mesh, &planes), Err(Error::Mesh(_))));
        assert!(fairness(&mesh, 0.1).is_err());
    }
    assert_eq!(contours(&TriMesh::default(), &planes), Ok(vec![]));
    assert_eq!(fairness(&TriMesh::default(), 1.0).unwrap().bending, 0.0);
    assert!(fairness(&cube(), 0.0).is_err() && fairness(&cube(), f64::NAN).is_err());
}

#[test]
fn one_thread_and_two_give_the_same_contours() {
    let grid = Grid::new([40, 40, 40], [1.0, 1.2, 0.7]).unwrap();
    let mesh = rough(grid, MeshKind::Primal, Border::Closed).1.mesh;
    let planes = Planes::across(1, (0..60).map(|n| 0.4 + 0.8 * f64::from(n)).collect());
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (contours(&mesh, &planes).unwrap(), fairness(&mesh, 0.7).unwrap()))
    };
    assert_eq!(run(1), run(2));
}

/// ∫ Σ_p κ_p² s_p⁴ dA over a torus, in spheres, by the rule of rectangles.
fn integral_of_torus(ring: f64, tube: f64) -> f64 {
    let (n, m) = (400, 400);
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..m {
            let [(su, cu), (sv, cv)] =
                [i, j].map(|k| (TAU * (f64::from(k) + 0.5) / f64::from(n)).sin_cos());
            let normal = [cv * cu, cv * su, sv];
            let around = [-su, cu, 0.0];
            let across = [-sv * cu, -sv * su, cv];
            let (kappa, lambda) = (cv / (ring + tube * cv), 1.0 / tube);
            let area = (ring + tube * cv) * tube * TAU * TAU / f64::from(n * m);
            for p in 0..3 {
                // The contour across p runs along n × p, of length s.
                let q: [f64; 3] = std::array::from_fn(|k| if k == p { 1.0 } else { 0.0 });
                let along = [
                    normal[1] * q[2] - normal[2] * q[1],
                    normal[2] * q[0] - normal[0] * q[2],
                    normal[0] * q[1] - normal[1] * q[0],
                ];
                let dot = |a: [f64; 3]| (0..3).map(|k| a[k] * along[k]).sum::<f64>();
                let (x, y) = (dot(around), dot(across));
                // κ_p s² is the second fundamental form of a vector of length s.
                let bend = kappa * x * x + lambda * y * y;
                sum += bend * bend * area;
            }
        }
    }
    sum / (32.0 * PI / 5.0)
}

#[test]
fn fairness_is_the_integral_of_squared_curvatures() {
    for (ring, tube) in [(5.0, 2.0), (8.0, 1.0)] {
        let mesh = torus(ring, tube, 600, 200);
        let expected = integral_of_torus(ring, tube);
        let found = fairness(&mesh, 0.1).unwrap();
        assert_eq!(found.step, 0.1);
        assert!((found.bending / expected - 1.0).abs() < 0.02, "{} {expected}", found.bending);
    }
}

#[test]
fn fairness_knows_no_size_and_adds_up() {
    let ball = shroud(&phantom::sphere(40).unwrap(), &Settings::default()).unwrap().mesh;
    let one = fairness(&ball, 1.0).unwrap().bending;
    assert!((one - 1.0).abs() < 0.03, "{one}");
    let mut large = ball.clone();
    large.vertices.iter_mut().flatten().for_each(|x| *x *= 1024.0);
    assert!((fairness(&large, 1024.0).unwrap().bending / one - 1.0).abs() < 1e-9);
    let mut two = ball.clone();
    let count = ball.vertices.len() as u32;
    two.vertices.extend(ball.vertices.iter().map(|&[x, y, z]| [x + 64.0, y, z]));
    two.triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + count)));
    // The planes across x lie elsewhere.
    assert!((fairness(&two, 1.0).unwrap().bending / (2.0 * one) - 1.0).abs() < 0.01);
    let mut rough = ball.clone();
    let mut next = random(1);
    rough.vertices.iter_mut().flatten().for_each(|x| *x += 0.3 * (next() - 0.5));
    assert!(fairness(&rough, 1.0).unwrap().bending > 1.5 * one);
}
