//! Placed meshes, primal and dual, judged by the independent check.

#![allow(clippy::unwrap_used)]

mod common;

use common::{CONVENTIONS, volumes};
use proptest::prelude::*;
use shrouds::check::{CheckSettings, check, structure};
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::network::Network;
use shrouds::optimize::Start;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Grid, Occupancy, Settings, TriMesh, shroud};

/// Reproducible numbers in [margin, 1 − margin]; some sit at the margin itself.
fn deltas(count: usize, seed: u64, margin: f64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    (0..count).map(|_| (1.4 * next() - 0.2).clamp(margin, 1.0 - margin)).collect()
}

fn judge(
    mesh: &TriMesh,
    volume: &Occupancy,
    faces: FaceRule,
    border: Border,
) -> Result<(), TestCaseError> {
    judge_with(mesh, volume, faces, border, true)
}

fn judge_with(
    mesh: &TriMesh,
    volume: &Occupancy,
    faces: FaceRule,
    border: Border,
    self_intersections: bool,
) -> Result<(), TestCaseError> {
    let settings = CheckSettings { border, faces, all_axes: true, self_intersections };
    let report = check(mesh, volume, &settings).unwrap();
    prop_assert!(report.is_clean(), "{:?} {:?}: {:?}", faces, border, report.problems());
    prop_assert_eq!(report.separation.touching.count, 0);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_lattice_point_is_on_its_side_for_random_delta(
        volume in volumes(), seed in any::<u64>()
    ) {
        for (rule, border) in CONVENTIONS {
            let surface = Surface::extract(&volume, rule, border).unwrap();
            let network = Network::trace(&surface);
            let delta = deltas(surface.vertex_count(), seed, 0.002);
            for triangles in [Triangles::Fitted, Triangles::Fixed] {
                let mesh =
                    TriMesh::place(&surface, &network, &delta, MeshKind::Primal, triangles);
                judge(&mesh, &volume, rule, border)?;
            }
        }
    }

    #[test]
    fn every_lattice_point_is_on_its_side_after_optimisation(
        volume in volumes(), seed in any::<u64>()
    ) {
        for (faces, border) in CONVENTIONS {
            for mesh in [MeshKind::Primal, MeshKind::Dual] {
                if mesh == MeshKind::Dual && border == Border::Open {
                    continue;
                }
                let mut settings = Settings { faces, border, mesh, ..Settings::default() };
                settings.optimize.start = Start::Random(seed);
                let shroud = shroud(&volume, &settings).unwrap();
                judge(&shroud.mesh, &volume, faces, border)?;
            }
        }
    }

    #[test]
    fn the_dual_is_a_manifold_that_separates(volume in volumes(), seed in any::<u64>()) {
        for rule in [FaceRule::Separate, FaceRule::Join] {
            let surface = Surface::extract(&volume, rule, Border::Closed).unwrap();
            let network = Network::trace(&surface);
            let delta = deltas(surface.vertex_count(), seed, 0.002);
            for triangles in [Triangles::Fitted, Triangles::Fixed] {
                let mesh = TriMesh::place(&surface, &network, &delta, MeshKind::Dual, triangles);
                // For any δ at all its quads may fold over each other; after optimisation they
                // do not, as the test above shows.
                judge_with(&mesh, &volume, rule, Border::Closed, false)?;
            }
        }
    }

    #[test]
    fn the_midpoint_mesh_is_what_placing_makes_of_one_half(volume in volumes()) {
        let mut affine = volume.grid().affine();
        affine[0][0] *= -1.0;
        let mirrored = Grid::with_affine(volume.grid().dims(), affine).unwrap();
        let mirrored = Occupancy::from_fn(mirrored, |point| volume.get(point));
        let volumes = CONVENTIONS.iter().flat_map(|c| [(c, &volume), (c, &mirrored)]);
        for (&(rule, border), volume) in volumes {
            let surface = Surface::extract(volume, rule, border).unwrap();
            let network = Network::trace(&surface);
            let delta = vec![0.5; surface.vertex_count()];
            let placed =
                TriMesh::place(&surface, &network, &delta, MeshKind::Primal, Triangles::Fixed);
            let midpoint = TriMesh::midpoint(&surface);
            prop_assert!(midpoint.vertices == placed.vertices);
            prop_assert!(midpoint.triangles == placed.triangles);
        }
    }

    #[test]
    fn patches_and_fixed_triangles_do_not_depend_on_delta(
        volume in volumes(), seed in any::<u64>()
    ) {
        let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
        let network = Network::trace(&surface);
        for kind in [MeshKind::Primal, MeshKind::Dual] {
            let triangles = |delta: &[f64]| {
                TriMesh::place(&surface, &network, delta, kind, Triangles::Fixed).triangles
            };
            let middle = vec![0.5; surface.vertex_count()];
            let other = deltas(surface.vertex_count(), seed, 0.002);
            prop_assert_eq!(triangles(&middle), triangles(&other));
        }
    }
}

#[test]
fn noise_of_every_density_gives_manifolds() {
    for (n, density) in [0.1, 0.3, 0.5, 0.7, 0.9].into_iter().enumerate() {
        let grid = Grid::new([24, 20, 18], [1.0; 3]).unwrap();
        let volume = phantom::noise(&grid, density, n as u64).unwrap();
        for faces in [FaceRule::Separate, FaceRule::Join] {
            for mesh in [MeshKind::Primal, MeshKind::Dual] {
                let mut settings = Settings { faces, mesh, ..Settings::default() };
                settings.optimize.max_iterations = Some(5);
                let shroud = shroud(&volume, &settings).unwrap();
                judge(&shroud.mesh, &volume, faces, Border::Closed).unwrap();
            }
        }
    }
}

#[test]
fn mirrored_axes_keep_normals_outside() {
    let ball = |mirror: f64| {
        let affine = [[mirror, 0.0, 0.0, 4.0], [0.0, 0.3, 1.9, 0.0], [0.0, 1.1, -0.5, -7.0]];
        let grid = Grid::with_affine([14, 16, 13], affine).unwrap();
        let centre = grid.point([6.5, 7.3, 6.1]);
        phantom::ball(&grid, centre, 5.0).unwrap()
    };
    for mirror in [1.0, -1.0] {
        let volume = ball(mirror);
        for mesh in [MeshKind::Primal, MeshKind::Dual] {
            let shroud = shroud(&volume, &Settings { mesh, ..Settings::default() }).unwrap();
            judge(&shroud.mesh, &volume, FaceRule::Separate, Border::Closed).unwrap();
            assert!(structure(&shroud.mesh).unwrap().volume > 0.0);
            let centre = volume.grid().point([6.5, 7.3, 6.1]);
            for (p, n) in shroud.mesh.vertices.iter().zip(&shroud.mesh.normals) {
                let outwards: f64 = (0..3).map(|k| f64::from(n[k]) * (p[k] - centre[k])).sum();
                assert!(outwards > 0.0);
            }
        }
    }
}

/// Root mean square angle in degrees between given normals of a ball and the radii.
fn rms_angle(centre: [f64; 3], pairs: impl Iterator<Item = ([f64; 3], [f64; 3], f64)>) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (p, n, weight) in pairs {
        let r: [f64; 3] = std::array::from_fn(|k| p[k] - centre[k]);
        let dot: f64 = (0..3).map(|k| n[k] * r[k]).sum();
        let lengths = [n, r].map(|a| a.iter().map(|x| x * x).sum::<f64>().sqrt());
        let angle = (dot / lengths[0] / lengths[1]).clamp(-1.0, 1.0).acos().to_degrees();
        sum += weight * angle * angle;
        weights += weight;
    }
    (sum / weights).sqrt()
}

/// A ball with its vertices exactly on it.
fn exact_ball() -> (TriMesh, [f64; 3]) {
    let (centre, radius) = ([15.637, 15.571, 15.407], 12.8);
    let volume = phantom::sphere(32).unwrap();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    let network = Network::trace(&surface);
    let outside =
        |p: [f64; 3]| (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f64>().sqrt() - radius;
    let exact = |crossing: shrouds::surface::Crossing| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let inside = outside(surface.grid().point(crossing.position(middle))) <= 0.0;
            if inside { high = middle } else { low = middle }
        }
        high
    };
    let delta: Vec<f64> = surface.crossings().map(exact).collect();
    let mesh = TriMesh::place(&surface, &network, &delta, MeshKind::Primal, Triangles::Fitted);
    (mesh, centre)
}

#[test]
fn network_normals_of_a_ball_point_along_the_radius() {
    // Slices of a ball are circles, and the tangent of the circle through three of its points is
    // exact, so the network normals are.
    let (mesh, centre) = exact_ball();
    let pairs = mesh.vertices.iter().zip(&mesh.normals).map(|(&p, &n)| (p, n.map(f64::from), 1.0));
    let angle = rms_angle(centre, pairs);
    assert!(angle < 1e-4, "{angle} degrees");
}

#[test]
fn fitted_triangles_fit_the_true_normals_better_than_fixed() {
    let volume = phantom::linked_tori(24).unwrap();
    let angle = |triangles| {
        let mesh = shroud(&volume, &Settings { triangles, ..Settings::default() }).unwrap().mesh;
        let mut worst = Vec::new();
        for t in &mesh.triangles {
            let [a, b, c] = mesh.corners(*t);
            let (u, v): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
            let n =
                [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let middle: [f64; 3] = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
            worst.push((middle, n));
        }
        torus_angle(&worst)
    };
    let (fitted, fixed) = (angle(Triangles::Fitted), angle(Triangles::Fixed));
    assert!(fitted < 0.9 * fixed, "{fitted} against {fixed} degrees");
}

/// Area-weighted root mean square angle between triangle normals and those of the linked tori.
fn torus_angle(triangles: &[([f64; 3], [f64; 3])]) -> f64 {
    let ring = 0.23 * 24.0;
    let middle = [11.5 + 0.137, 11.5 + 0.071, 11.5 - 0.093];
    let true_normal = |p: [f64; 3]| {
        let from = |shift: f64, axis: usize| {
            let q = [p[0] - middle[0] - shift, p[1] - middle[1], p[2] - middle[2]];
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let rho = q[u].hypot(q[v]);
            let mut n = [0.0; 3];
            n[u] = q[u] * (rho - ring) / rho;
            n[v] = q[v] * (rho - ring) / rho;
            n[axis] = q[axis];
            (n[0] * n[0] + n[1] * n[1] + n[2] * n[2], n)
        };
        let (a, b) = (from(-ring / 2.0, 2), from(ring / 2.0, 1));
        if a.0 < b.0 { a.1 } else { b.1 }
    };
    let pairs = triangles.iter().map(|&(p, n)| {
        let area = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        let truth = true_normal(p);
        // `rms_angle` compares with the direction from the centre: the true normal, seen from 0.
        (truth, n, area)
    });
    rms_angle([0.0; 3], pairs)
}

#[test]
fn the_dual_has_no_small_angles_where_the_grid_is_isotropic() {
    for volume in [phantom::sphere(32).unwrap(), phantom::linked_tori(48).unwrap()] {
        let settings = Settings { mesh: MeshKind::Dual, ..Settings::default() };
        let mesh = shroud(&volume, &settings).unwrap().mesh;
        let mut angles: Vec<f64> =
            mesh.triangles.iter().map(|&t| least_angle(mesh.corners(t))).collect();
        angles.sort_by(f64::total_cmp);
        let fifth_percentile = angles[angles.len() / 20];
        assert!(fifth_percentile > 29.0, "{fifth_percentile} degrees");
    }
}

fn least_angle(corners: [[f64; 3]; 3]) -> f64 {
    let angle = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        let (u, v): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
        let dot = |p: [f64; 3], q: [f64; 3]| (0..3).map(|k| p[k] * q[k]).sum::<f64>();
        (dot(u, v) / (dot(u, u) * dot(v, v)).sqrt()).acos().to_degrees()
    };
    let [a, b, c] = corners;
    angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b))
}

#[test]
fn scaling_the_spacing_scales_the_mesh() {
    let unit = phantom::linked_tori(24).unwrap();
    let scale = 0.037;
    let grid = Grid::new([24; 3], [scale; 3]).unwrap();
    let small = Occupancy::from_fn(grid, |p| unit.get(p));
    let [a, b] = [&unit, &small].map(|v| shroud(v, &Settings::default()).unwrap());
    assert_eq!(a.mesh.triangles, b.mesh.triangles);
    for (p, q) in a.delta.iter().zip(&b.delta) {
        assert!((p - q).abs() < 1e-6, "{p} {q}");
    }
}
