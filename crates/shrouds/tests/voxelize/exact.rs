//! Closed meshes: every lattice point on the side it is on.

use proptest::prelude::*;
use shrouds::volume::phantom;
use shrouds::voxelize::{Fit, Method, Rule, grid_for};
use shrouds::{Grid, Occupancy, Settings, TriMesh, shroud, voxelize};

use crate::shapes::{
    cubic, cuboid, lattice, mesh, midpoints, noise, points, random_volume, sphere, together,
    turned, whole_winding,
};

/// The volume of a mesh that must be decided exactly.
fn exact(mesh: &TriMesh, grid: &Grid, rule: Rule) -> Occupancy {
    let voxelized = voxelize(mesh, grid, rule).unwrap();
    assert_eq!(voxelized.report.method, Method::Exact);
    assert!(voxelized.report.doubtful.is_empty());
    voxelized.volume
}

/// Any frame with axes that are not too flat, half of them mirrored.
fn affine(seed: u64) -> [[f64; 4]; 3] {
    [0, 1, 2].map(|r| {
        [0, 1, 2, 3].map(|c| {
            let x = 2.0 * noise(&[seed, r, c]) - 1.0;
            let long = if noise(&[seed]) < 0.5 { -1.5 } else { 1.5 };
            match c {
                3 => 100.0 * x,
                _ if c != r => 0.4 * x,
                0 => long + 0.4 * x,
                _ => 1.5 + 0.8 * x,
            }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn a_shroud_gives_its_volume_back_in_any_frame(seed in any::<u64>(), density in 0.05..0.95f64) {
        let dims = [1, 2, 3].map(|d| 1 + (9.0 * noise(&[seed, d])) as usize);
        let dims = if seed % 4 == 0 { [dims[0] + 60, dims[1], dims[2]] } else { dims };
        let volume = random_volume(Grid::with_affine(dims, affine(seed)).unwrap(), seed, density);
        let mesh = shroud(&volume, &Settings::default()).unwrap().mesh;
        for rule in [Rule::NonZero, Rule::Positive, Rule::Odd] {
            prop_assert!(exact(&mesh, volume.grid(), rule) == volume);
        }
        prop_assert!(exact(&turned(&mesh), volume.grid(), Rule::Positive) == volume);
    }

    #[test]
    fn points_on_vertices_edges_and_faces_follow_the_rule(seed in any::<u64>()) {
        let volume = random_volume(cubic(4), seed, 0.4);
        let mesh = midpoints(&volume);
        // Indices of the vertices are whole on each of these, and most points lie on the mesh.
        let shift = [1, 2, 3].map(|d| (4.0 * noise(&[seed, d])).floor() * 0.25);
        for (step, first) in [(0.5, [-0.5; 3]), (-0.5, [4.0; 3]), (0.25, shift)] {
            let grid = lattice([9, 10, 11], step, first);
            let expected =
                Occupancy::from_fn(grid.clone(), |point| whole_winding(&mesh, &grid, point) != 0);
            prop_assert!(exact(&mesh, &grid, Rule::NonZero) == expected);
        }
    }

    #[test]
    fn closed_meshes_that_cross_themselves_wind_as_often_as_they_do(seed in any::<u64>()) {
        // A fan closed with its mirror image: triangles n of random whole corners around two apices.
        let corner = |n: u64| [0, 1, 2].map(|d| (9.0 * noise(&[seed, n, d])).floor());
        let count = 4 + (8.0 * noise(&[seed])) as u32;
        let vertices = (0..u64::from(count) + 2).map(corner).collect();
        let triangles = (0..count).flat_map(|n| {
            let m = (n + 1) % count;
            [[n, m, count], [m, n, count + 1]]
        });
        let mesh = mesh(vertices, triangles.collect());
        let grid = cubic(9);
        for (rule, inside) in [
            (Rule::NonZero, (|winding| winding != 0) as fn(i64) -> bool),
            (Rule::Odd, |winding| winding % 2 != 0),
        ] {
            let expected =
                Occupancy::from_fn(grid.clone(), |point| inside(whole_winding(&mesh, &grid, point)));
            let found = voxelize(&mesh, &grid, rule).unwrap();
            prop_assert!(found.volume == expected, "{:?}", found.report);
        }
    }
}

#[test]
fn a_body_and_the_rest_of_a_box_share_the_points() {
    let volume = random_volume(cubic(6), 3, 0.5);
    let body = midpoints(&volume);
    let outer = cuboid([-2.0; 3], [8.0; 3]);
    let rest = together(&[&outer, &turned(&body)]);
    // On vertices and faces of both, and where few points are.
    let oblique = [[0.31, 0.1, -0.02, -3.0], [-0.07, 0.29, 0.04, -2.5], [0.05, 0.02, -0.33, 9.0]];
    for grid in [
        lattice([25; 3], 0.5, [-3.0; 3]),
        lattice([25; 3], -0.5, [9.0; 3]),
        Grid::with_affine([45; 3], oblique).unwrap(),
    ] {
        let [body, outer, rest] =
            [&body, &outer, &rest].map(|mesh| exact(mesh, &grid, Rule::NonZero));
        for point in points(&grid) {
            let [body, outer, rest] = [&body, &outer, &rest].map(|volume| volume.get(point));
            assert!(!(body && rest) && (body || rest) == outer, "{point:?}");
        }
    }
}

#[test]
fn a_ball_and_what_surrounds_it_share_the_points() {
    let ball = sphere([0.1, -0.2, 0.3], 3.7, 4);
    let rest = together(&[&cuboid([-5.0; 3], [5.0; 3]), &turned(&ball)]);
    let grid = lattice([103; 3], 0.1, [-5.05; 3]);
    let [ball_points, rest] = [&ball, &rest].map(|mesh| exact(mesh, &grid, Rule::NonZero));
    assert_eq!(ball_points.count() + rest.count(), 100 * 100 * 100);
    assert!(points(&grid).all(|point| !(ball_points.get(point) && rest.get(point))));
    let volume = ball_points.count() as f64 * grid.voxel_volume();
    let expected = ball_volume(&ball);
    assert!((volume / expected - 1.0).abs() < 2e-3, "{volume} {expected}");
}

fn ball_volume(ball: &TriMesh) -> f64 {
    let report = voxelize(ball, &cubic(1), Rule::NonZero).unwrap().report;
    assert!(
        (report.enclosed_volume / (4.0 / 3.0 * std::f64::consts::PI * 3.7f64.powi(3)) - 1.0).abs()
            < 0.01
    );
    report.enclosed_volume
}

#[test]
fn a_box_takes_the_faces_it_begins_with() {
    let grid = lattice([6, 6, 6], 1.0, [0.0; 3]);
    let count = |low, high| exact(&cuboid(low, high), &grid, Rule::NonZero).count();
    assert_eq!(count([0.0; 3], [1.0; 3]), 1);
    assert_eq!(count([0.0; 3], [5.0; 3]), 125);
    assert_eq!(count([-1.0; 3], [7.0; 3]), 216);
    assert_eq!(count([7.0; 3], [9.0; 3]), 0);
    assert_eq!(count([0.2; 3], [0.9; 3]), 0);
}

#[test]
fn rules_say_what_overlaps_and_cavities_are() {
    let grid = cubic(12);
    let (outer, inner) = (cuboid([0.5; 3], [10.5; 3]), cuboid([3.5; 3], [6.5; 3]));
    let count = |mesh: &TriMesh| {
        [Rule::NonZero, Rule::Positive, Rule::Odd].map(|rule| exact(mesh, &grid, rule).count())
    };
    assert_eq!(count(&together(&[&outer, &inner])), [1000, 1000, 1000 - 27]);
    assert_eq!(count(&together(&[&outer, &turned(&inner)])), [1000 - 27; 3]);
    assert_eq!(count(&together(&[&turned(&outer), &inner])), [1000 - 27; 3]);
    let beside = cuboid([7.5, 7.5, 7.5], [11.5; 3]);
    assert_eq!(count(&together(&[&outer, &beside])), [1064 - 27, 1064 - 27, 1064 - 54]);
    let away = cuboid([10.6; 3], [11.5; 3]);
    assert_eq!(count(&together(&[&outer, &turned(&away)])), [1001, 1000, 1001]);
    let report = voxelize(&turned(&outer), &grid, Rule::NonZero).unwrap().report;
    assert!(
        report.inside_out
            && (report.enclosed_volume + 1000.0).abs() < 1e-9
            && report.notes().len() == 1
    );
}

#[test]
fn an_edge_of_four_triangles_is_no_hole() {
    // Two boxes with an edge in common.
    let mut mesh =
        together(&[&cuboid([0.5; 3], [2.5; 3]), &cuboid([2.5, 2.5, 0.5], [4.5, 4.5, 2.5])]);
    let found = voxelize(&mesh, &cubic(6), Rule::Positive).unwrap();
    assert_eq!((found.volume.count(), found.report.is_closed()), (16, true));
    for corner in mesh.triangles.iter_mut().flatten() {
        *corner = match *corner {
            8 => 3,
            12 => 7,
            v => v,
        };
    }
    let found = voxelize(&mesh, &cubic(6), Rule::Positive).unwrap();
    assert_eq!((found.volume.count(), found.report.method), (16, Method::Exact));
    assert_eq!(found.report.non_manifold_edges.first, [[3, 7]]);
    assert!(!found.report.is_closed() && found.report.boundary_edges.is_empty());
}

#[test]
fn triangles_that_share_places_but_no_vertices_are_closed() {
    let ball = sphere([5.0; 3], 4.0, 3);
    let report = voxelize(&ball, &cubic(11), Rule::NonZero).unwrap().report;
    assert!(report.is_closed() && report.method == Method::Exact, "{report:?}");
    // 512 triangles with three vertices each, in 258 places.
    assert_eq!((report.turned_triangles, report.joined_vertices), (0, 1536 - 258));
}

#[test]
fn triangles_without_area_change_nothing() {
    let mut mesh = midpoints(&random_volume(cubic(6), 8, 0.4));
    let clean = exact(&mesh, &lattice([13; 3], 0.5, [-0.5; 3]), Rule::NonZero);
    let [a, b, c] = mesh.triangles[0];
    let far = mesh.vertices.len() as u32;
    mesh.vertices.push([f64::MAX.sqrt() / 1e80, 0.0, 0.0]);
    mesh.triangles.extend([[a, a, b], [c, c, c], [a, far, a]]);
    assert_eq!(exact(&mesh, clean.grid(), Rule::NonZero), clean);
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let body = shroud(&phantom::gyroid(24).unwrap(), &Settings::default()).unwrap().mesh;
    let mut holes = body.clone();
    let mut t = 0;
    holes.triangles.retain(|_| {
        t += 1;
        noise(&[t]) > 0.02
    });
    let grid = grid_for(&body, Fit::Size(70), 2).unwrap();
    for mesh in [&body, &holes] {
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| voxelize(mesh, &grid, Rule::NonZero).unwrap())
        });
        assert_eq!(one, three);
    }
}
