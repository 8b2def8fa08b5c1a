//! Meshes with holes, turned and repeated triangles, and worse.

use proptest::prelude::*;
use shrouds::volume::phantom;
use shrouds::voxelize::{Method, Rule, VoxelizeReport};
use shrouds::{Grid, Occupancy, Settings, TriMesh, shroud, voxelize};

use crate::shapes::{
    Point, cubic, cuboid, generalized_winding, lattice, mesh, midpoints, noise, points,
    random_volume, soup, sphere, together, turned,
};

/// Voxelises and compares every point with the sum of all solid angles; `skip` names points that have
/// none.
fn compared(
    mesh: &TriMesh,
    grid: &Grid,
    skip: impl Fn(Point) -> bool,
) -> (Occupancy, VoxelizeReport) {
    let found = voxelize(mesh, grid, Rule::NonZero).unwrap();
    let mut doubtful = [0, 0];
    for index in points(grid) {
        let point = grid.point(index.map(|n| n as f64));
        if skip(point) {
            continue;
        }
        // A point on the mesh lies a little further along x, y and z.
        let shift = grid.vector([1e-6, 1e-8, 1e-10]);
        let winding = generalized_winding(mesh, [0, 1, 2].map(|d| point[d] + shift[d])).abs();
        let inside = found.volume.get(index);
        assert!(inside == (winding > 0.5) || (winding - 0.5).abs() < 1e-2, "{index:?} {winding}");
        let near = (winding - 0.5).abs();
        doubtful[0] += u64::from(near < 0.09);
        doubtful[1] += u64::from(near < 0.11);
    }
    let count = found.report.doubtful.count;
    assert!(doubtful[0] <= count, "{count} {doubtful:?}");
    let skipped = points(grid).filter(|index| skip(grid.point(index.map(|n| n as f64)))).count();
    assert!(count <= doubtful[1] + skipped as u64, "{count} {doubtful:?}");
    (found.volume, found.report)
}

/// Without the triangles that fall under the share.
fn without(mesh: &TriMesh, share: f64, seed: u64) -> TriMesh {
    let mut left = mesh.clone();
    let mut t = 0;
    left.triangles.retain(|_| {
        t += 1;
        noise(&[seed, t]) >= share
    });
    left
}

fn differing(a: &Occupancy, b: &Occupancy) -> usize {
    points(a.grid()).filter(|&point| a.get(point) != b.get(point)).count()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn any_triangles_have_the_sum_of_their_solid_angles(seed in any::<u64>()) {
        let corner = |n: u64| [0, 1, 2].map(|d| 9.0 * noise(&[seed, n, d]));
        let vertices = 4 + (9.0 * noise(&[seed])) as u64;
        let pick = |t: u64, c: u64| (vertices as f64 * noise(&[seed, t, c, 9])) as u32;
        let triangles = (0..3 * vertices).map(|t| [0, 1, 2].map(|c| pick(t, c)));
        // Those that are repeated or turned are tested by themselves.
        let mut proper: Vec<[u32; 3]> = Vec::new();
        for [a, b, c] in triangles.filter(|[a, b, c]| a != b && b != c && c != a) {
            let faces_alike = |[x, y, z]: &[u32; 3]| {
                let edges = [[*x, *y], [*y, *z], [*z, *x]];
                [[a, b], [b, c], [c, a]].iter().any(|edge| edges.contains(edge))
            };
            if !proper.iter().any(faces_alike) {
                proper.push([a, b, c]);
            }
        }
        let mesh = mesh((0..vertices).map(corner).collect(), proper);
        compared(&mesh, &cubic(10), |_| false);
    }

    #[test]
    fn missing_triangles_are_filled_in(seed in any::<u64>(), share in 0.01..0.5f64) {
        let volume = random_volume(cubic(7), seed, 0.4);
        let whole = shroud(&volume, &Settings::default()).unwrap().mesh;
        compared(&without(&whole, share, seed), volume.grid(), |_| false);
    }

    #[test]
    fn turned_triangles_are_turned_back(seed in any::<u64>(), share in 0.01..0.3f64) {
        let volume = phantom::linked_tori(16).unwrap();
        let mut mesh = midpoints(&volume);
        let mut count = 0;
        for (t, triangle) in (0..).zip(&mut mesh.triangles) {
            if noise(&[seed, t]) < share {
                triangle.swap(0, 2);
                count += 1;
            }
        }
        let found = voxelize(&mesh, volume.grid(), Rule::NonZero).unwrap();
        prop_assert!(found.volume == volume);
        prop_assert_eq!(found.report.turned_triangles, count);
        prop_assert_eq!(found.report.method, Method::Exact);
        prop_assert_eq!(found.report.inconsistent_edges.is_empty(), count == 0);
    }
}

#[test]
fn few_points_change_when_triangles_are_missing() {
    let volume = phantom::sphere(20).unwrap();
    let whole = shroud(&volume, &Settings::default()).unwrap().mesh;
    for (share, most) in [(0.01, 0), (0.05, 0), (0.2, 20)] {
        let broken = without(&whole, share, 5);
        let (found, report) = compared(&broken, volume.grid(), |_| false);
        let lost = whole.triangles.len() - broken.triangles.len();
        assert!(lost > 0 && report.boundary_edges.count as usize > lost);
        assert!(differing(&found, &volume) <= most, "{share}: {}", differing(&found, &volume));
        assert!((report.enclosed_volume / whole.volume() - 1.0).abs() < 0.02);
    }
}

#[test]
fn open_boxes_of_any_side_with_points_on_all_of_them() {
    let whole = cuboid([1.0; 3], [7.0; 3]);
    let on_rim = |p: Point| p.iter().filter(|&&x| x == 1.0 || x == 7.0).count() >= 2;
    for side in 0..6 {
        let mut open = whole.clone();
        open.triangles.drain(2 * side..2 * side + 2);
        for step in [1.0, 0.5, -0.5] {
            let n = (8.0 / f64::abs(step)) as usize + 1;
            let grid = lattice([n; 3], step, if step > 0.0 { [0.0; 3] } else { [8.0; 3] });
            let (_, report) = compared(&open, &grid, on_rim);
            assert_eq!((report.boundary_edges.count, report.method), (4, Method::Generalized));
            assert_eq!(report.notes().len(), 2, "{:?}", report.notes());
        }
    }
}

#[test]
fn half_a_ball_ends_near_its_rim() {
    let mut half = sphere([10.0; 3], 7.3, 4);
    let vertices = half.vertices.clone();
    half.triangles.retain(|triangle| triangle.iter().all(|&v| vertices[v as usize][2] > 8.5));
    let (volume, report) = compared(&half, &cubic(21), |_| false);
    let counts = [report.doubtful.count, report.boundary_edges.count];
    assert!(counts[0] > 100 && counts[1] > 50, "{counts:?}");
    assert!(volume.get([10, 10, 11]) && !volume.get([10, 10, 4]));
    assert!((report.enclosed_volume - volume.count() as f64).abs() < 0.1 * report.enclosed_volume);
}

#[test]
fn several_bodies_some_of_them_broken() {
    let bodies = [
        cuboid([1.5, 1.5, 1.5], [8.5, 8.5, 8.5]),
        without(&sphere([16.0, 6.0, 6.0], 4.6, 3), 0.1, 1),
        without(&sphere([6.0, 16.0, 6.0], 4.6, 3), 0.3, 2),
    ];
    let grid = Grid::new([22, 22, 12], [1.0; 3]).unwrap();
    let (volume, report) =
        compared(&together(&[&bodies[0], &bodies[1], &bodies[2]]), &grid, |_| false);
    assert!(volume.get([5, 5, 5]) && volume.get([16, 6, 6]) && volume.get([6, 16, 6]));
    assert!(!volume.get([16, 16, 6]) && report.enclosed_volume > 0.0);
}

#[test]
fn repeated_triangles_count_once() {
    let volume = random_volume(cubic(8), 4, 0.3);
    let mut mesh = midpoints(&volume);
    let again: Vec<_> = mesh.triangles.iter().step_by(3).map(|&[a, b, c]| [c, a, b]).collect();
    mesh.triangles.extend(&again);
    let found = voxelize(&mesh, volume.grid(), Rule::Odd).unwrap();
    assert_eq!(found.volume, volume);
    assert_eq!(found.report.repeated_triangles, again.len() as u64);
    assert_eq!(found.report.joined_vertices, 0);
    assert!(found.report.non_manifold_edges.count > 0);
    assert_eq!(found.report.method, Method::Exact);
}

#[test]
fn what_has_one_side_only_is_left_as_it_is() {
    // A Möbius strip of some turns around a ring, in twelve steps.
    let count = 12;
    let vertices = (0..2 * count).map(|n| {
        let (step, side) = (n / 2, if n % 2 == 0 { -1.0 } else { 1.0 });
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(count);
        let (out, up) = (side * (angle / 2.0).cos(), side * (angle / 2.0).sin());
        [6.1 + (4.0 + out) * angle.cos(), 6.2 + (4.0 + out) * angle.sin(), 3.3 + up]
    });
    let triangles = (0..count as u32).flat_map(|n| {
        let [a, b] = [2 * n, 2 * n + 1];
        let [c, d] = if n + 1 < 12 { [a + 2, b + 2] } else { [1, 0] };
        [[a, b, c], [c, b, d]]
    });
    let strip = mesh(vertices.collect(), triangles.collect());
    let grid = Grid::new([13, 13, 7], [1.0; 3]).unwrap();
    let (_, report) = compared(&strip, &grid, |_| false);
    assert_eq!((report.turned_triangles, report.inconsistent_edges.count), (0, 1));
}

#[test]
fn inside_out_with_holes() {
    let mesh = without(&turned(&sphere([6.0; 3], 4.5, 3)), 0.05, 7);
    let (volume, report) = compared(&mesh, &cubic(13), |_| false);
    assert!(report.inside_out);
    assert_eq!(voxelize(&mesh, &cubic(13), Rule::Positive).unwrap().volume, volume);
}

#[test]
fn triangles_with_gaps_all_around() {
    let ball = sphere([8.1, 7.9, 8.3], 6.1, 3);
    let apart = soup(ball.triangles.iter().map(|&triangle| {
        let corners = ball.corners(triangle);
        let middle = [0, 1, 2].map(|d| corners.iter().map(|p| p[d]).sum::<f64>() / 3.0);
        corners.map(|p| [0, 1, 2].map(|d| middle[d] + 0.95 * (p[d] - middle[d])))
    }));
    let (volume, report) = compared(&apart, &cubic(17), |_| false);
    assert_eq!(report.boundary_edges.count, 3 * apart.triangles.len() as u64);
    let whole = voxelize(&ball, &cubic(17), Rule::NonZero).unwrap().volume;
    assert!(differing(&volume, &whole) <= 12, "{}", differing(&volume, &whole));
}
