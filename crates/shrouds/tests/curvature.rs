//! Curvatures of phantoms against their formulas.

#![allow(clippy::unwrap_used)]

use shrouds::measure::{Curvature, curvatures};
use shrouds::mesh::{network_normals, place_vertices};
use shrouds::network::Network;
use shrouds::optimize::{self, Preset};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Grid, Occupancy, Settings, shroud};

const CENTRE: [f64; 3] = [23.637, 23.571, 23.407];
const BALL: f64 = 20.0;
const AXES: [f64; 3] = [20.0, 14.0, 10.0];
const RING: f64 = 16.0;
const TUBE: f64 = 6.0;

fn cube() -> Grid {
    Grid::new([48; 3], [1.0; 3]).unwrap()
}

fn ball() -> Occupancy {
    phantom::ball(&cube(), CENTRE, BALL).unwrap()
}

/// Mean and Gaussian curvature of a shape at a place near its surface, seen from its centre.
type Truth = fn([f64; 3]) -> [f64; 2];

fn of_ball(_: [f64; 3]) -> [f64; 2] {
    [1.0 / BALL, 1.0 / (BALL * BALL)]
}

fn of_ellipsoid(p: [f64; 3]) -> [f64; 2] {
    let level = (0..3).map(|k| (p[k] / AXES[k]).powi(2)).sum::<f64>().sqrt();
    let p = p.map(|x| x / level);
    let w: f64 = (0..3).map(|k| p[k] * p[k] / AXES[k].powi(4)).sum();
    let product = AXES.iter().product::<f64>().powi(2);
    let [squares, radius] = [AXES, p].map(|v| v.iter().map(|x| x * x).sum::<f64>());
    [(squares - radius) / (2.0 * product * w.powf(1.5)), 1.0 / (product * w * w)]
}

fn of_torus(p: [f64; 3]) -> [f64; 2] {
    // The ring lies in the plane of x and y.
    let outwards = p[0].hypot(p[1]) - RING;
    let cosine = outwards / outwards.hypot(p[2]);
    let around = cosine / (RING + TUBE * cosine);
    [0.5 * (1.0 / TUBE + around), around / TUBE]
}

fn torus_level(p: [f64; 3]) -> f64 {
    (p[0].hypot(p[1]) - RING).hypot(p[2]) - TUBE
}

fn from_centre(vertex: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| vertex[k] - CENTRE[k])
}

/// Root mean squares of the errors of mean and Gaussian curvature, over those of the true values.
fn errors(curvatures: &[Curvature], vertices: &[[f64; 3]], truth: Truth) -> [f64; 2] {
    let mut sums = [[0.0; 2]; 2];
    for (curvature, vertex) in curvatures.iter().zip(vertices) {
        let truth = truth(from_centre(*vertex));
        for (k, found) in [curvature.mean(), curvature.gaussian()].into_iter().enumerate() {
            sums[k][0] += (found - truth[k]).powi(2);
            sums[k][1] += truth[k].powi(2);
        }
    }
    sums.map(|[error, size]| (error / size).sqrt())
}

fn of_shroud(volume: &Occupancy, preset: Preset, truth: Truth) -> [f64; 2] {
    let settings = Settings {
        optimize: optimize::Settings { preset, ..Default::default() },
        ..Default::default()
    };
    let shroud = shroud(volume, &settings).unwrap();
    let network = Network::trace(&shroud.surface);
    let found = curvatures(&network, &shroud.mesh.vertices, &shroud.mesh.normals);
    errors(&found, &shroud.mesh.vertices, truth)
}

/// The errors when every vertex lies where the true surface crosses its grid edge.
fn at_the_limit(volume: &Occupancy, level: impl Fn([f64; 3]) -> f64, truth: Truth) -> [f64; 2] {
    let surface = Surface::extract(volume, FaceRule::Separate, Border::Closed).unwrap();
    let count = surface.vertex_count();
    let ends = [0.0, 1.0].map(|delta| place_vertices(&surface, &vec![delta; count]));
    let vertices: Vec<[f64; 3]> = (0..count)
        .map(|v| {
            let [outside, inside] = [ends[0][v], ends[1][v]];
            let place = |delta: f64| {
                std::array::from_fn(|k| delta * inside[k] + (1.0 - delta) * outside[k])
            };
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let is_inside = level(from_centre(place(middle))) <= 0.0;
                (low, high) = if is_inside { (low, middle) } else { (middle, high) };
            }
            place(high)
        })
        .collect();
    let network = Network::trace(&surface);
    let normals = network_normals(&surface, &network, &vertices);
    errors(&curvatures(&network, &vertices, &normals), &vertices, truth)
}

fn below(name: &str, found: [f64; 2], limits: [f64; 2]) {
    let shown = found.map(|error| format!("{:.2} %", 100.0 * error));
    println!("{name}: mean {}, Gaussian {}", shown[0], shown[1]);
    assert!(found[0] < limits[0] && found[1] < limits[1], "{name}: {found:?} against {limits:?}");
}

#[test]
fn true_crossings_give_true_curvatures() {
    let length = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
    below("ball", at_the_limit(&ball(), |p| length(p) - BALL, of_ball), [0.001, 0.002]);
    let ellipsoid = phantom::ellipsoid(&cube(), CENTRE, AXES, &phantom::IDENTITY).unwrap();
    let level = |p: [f64; 3]| (0..3).map(|k| (p[k] / AXES[k]).powi(2)).sum::<f64>() - 1.0;
    below("ellipsoid", at_the_limit(&ellipsoid, level, of_ellipsoid), [0.03, 0.06]);
    let torus = Occupancy::from_fn(cube(), |index| {
        torus_level(from_centre(cube().point(index.map(|x| x as f64)))) <= 0.0
    });
    below("torus", at_the_limit(&torus, torus_level, of_torus), [0.03, 0.06]);
}

#[test]
fn shrouds_have_the_curvatures_of_their_shapes() {
    below("ball", of_shroud(&ball(), Preset::Exact, of_ball), [0.02, 0.04]);
    below("ball, default", of_shroud(&ball(), Preset::Default, of_ball), [0.1, 0.2]);
    let ellipsoid = phantom::ellipsoid(&cube(), CENTRE, AXES, &phantom::IDENTITY).unwrap();
    below("ellipsoid", of_shroud(&ellipsoid, Preset::Exact, of_ellipsoid), [0.05, 0.1]);
    let torus = Occupancy::from_fn(cube(), |index| {
        torus_level(from_centre(cube().point(index.map(|x| x as f64)))) <= 0.0
    });
    below("torus", of_shroud(&torus, Preset::Exact, of_torus), [0.06, 0.1]);
}

/// Curvatures of the vertices of a volume, all in the middles of their grid edges.
fn of_midpoints(volume: &Occupancy, border: Border) -> (Vec<[f64; 3]>, Vec<Curvature>) {
    let surface = Surface::extract(volume, FaceRule::Separate, border).unwrap();
    let network = Network::trace(&surface);
    let vertices = place_vertices(&surface, &vec![0.5; surface.vertex_count()]);
    let normals = network_normals(&surface, &network, &vertices);
    let found = curvatures(&network, &vertices, &normals);
    assert!(found.iter().flat_map(|c| c.principal).all(f64::is_finite));
    (vertices, found)
}

#[test]
fn faces_of_a_box_are_flat_and_its_edges_convex() {
    let volume = phantom::block(&cube(), [8; 3], [20, 20, 20]).unwrap();
    let (vertices, found) = of_midpoints(&volume, Border::Closed);
    let mut flat = 0;
    for (vertex, curvature) in vertices.iter().zip(&found) {
        // The face across the grid edge; along the others, how far from the border.
        let inner = vertex.iter().filter(|x| (11.0..=24.0).contains(*x)).count();
        if inner == 2 {
            assert!(curvature.principal.iter().all(|k| k.abs() < 1e-6), "{vertex:?} {curvature:?}");
            flat += 1;
        } else {
            assert!(curvature.principal[0] > -1e-6);
        }
    }
    assert_eq!(flat, 6 * 14 * 14);
    assert!(found.iter().any(|c| c.mean() > 0.1));
    // Outside and inside exchanged, everything is concave.
    let hollow = Occupancy::from_fn(cube(), |index| !volume.get(index));
    let (_, hollow) = of_midpoints(&hollow, Border::Open);
    assert_eq!(hollow.len(), found.len());
    for (hollow, solid) in hollow.iter().zip(&found) {
        let [large, small] = solid.principal;
        assert!((hollow.principal[0] + small).abs() < 1e-6);
        assert!((hollow.principal[1] + large).abs() < 1e-6);
    }
}

#[test]
fn open_borders_and_single_voxels_have_finite_curvatures() {
    let cut = phantom::ball(&Grid::new([20; 3], [1.0; 3]).unwrap(), [3.3, 9.7, 15.1], 9.0).unwrap();
    let (_, found) = of_midpoints(&cut, Border::Open);
    let typical = found.iter().filter(|c| (0.05..0.25).contains(&c.mean())).count();
    assert!(2 * typical > found.len(), "{typical} of {}", found.len());
    for counts in [[1; 3], [2, 1, 1]] {
        of_midpoints(&phantom::block(&cube(), [5; 3], counts).unwrap(), Border::Closed);
    }
    of_midpoints(
        &phantom::noise(&Grid::new([9; 3], [1.0; 3]).unwrap(), 0.5, 7).unwrap(),
        Border::Open,
    );
}

#[test]
fn any_frame_of_the_world_will_do() {
    // The same ball in the world, on lattices that are stretched, turned, sheared and mirrored.
    for affine in [
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.5, 0.0, 0.0], [0.0, 0.0, 0.8, 0.0]],
        [[0.8, -0.6, 0.0, 9.0], [0.6, 0.8, 0.0, -9.0], [0.0, 0.0, 1.0, 5.0]],
        [[1.0, 0.3, 0.0, -9.0], [0.0, 1.0, 0.2, -7.0], [0.0, 0.0, 1.0, 0.0]],
        [[-1.0, 0.3, 0.0, 55.0], [0.0, 1.0, 0.2, -7.0], [0.0, 0.0, 1.0, 0.0]],
    ] {
        let grid = Grid::with_affine([96; 3], affine).unwrap();
        let level = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt() - 12.0;
        let volume = Occupancy::from_fn(grid.clone(), |index| {
            level(from_centre(grid.point(index.map(|x| x as f64)))) <= 0.0
        });
        assert!(volume.count() > 5000, "{affine:?}");
        let found = at_the_limit(&volume, level, |_| [1.0 / 12.0, 1.0 / 144.0]);
        below(&format!("{affine:?}"), found, [0.001, 0.002]);
    }
}
