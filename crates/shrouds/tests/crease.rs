//! Creases against the analytic boxes they come from.

#![allow(clippy::unwrap_used)]

mod common;

use std::sync::Arc;

use common::volumes;
use proptest::prelude::*;
use shrouds::check::{CheckSettings, check};
use shrouds::optimize::{self, Crease, Preset, Solver, Status};
use shrouds::volume::phantom::{self, IDENTITY, Rotation};
use shrouds::{Error, Grid, Occupancy, Settings, Shroud, shroud};

fn settings(crease: bool) -> Settings {
    let crease = crease.then(Crease::default);
    Settings { optimize: optimize::Settings { crease, ..Default::default() }, ..Default::default() }
}

/// A box with these half sides, its middle and how it is turned.
struct Cuboid {
    half: [f64; 3],
    centre: [f64; 3],
    turn: Rotation,
}

impl Cuboid {
    fn tilted() -> Self {
        let turn = phantom::rotation([1.0, -2.0, 0.6], 0.9).unwrap();
        Self { half: [15.0, 10.0, 7.5], centre: [21.6, 21.3, 21.9], turn }
    }

    /// Along the grid, with faces in the middle between two slices.
    fn aligned() -> Self {
        Self { half: [15.0, 10.0, 7.0], centre: [21.5; 3], turn: IDENTITY }
    }

    fn volume(&self) -> f64 {
        8.0 * self.half.iter().product::<f64>()
    }

    fn occupancy(&self) -> Occupancy {
        let grid = Grid::new([44; 3], [1.0; 3]).unwrap();
        let sides = self.half.map(|half| 2.0 * half);
        phantom::cuboid(&grid, self.centre, sides, &self.turn).unwrap()
    }

    /// The angle in degrees between triangles and the face that is next to them, root mean square by
    /// area, for triangles more than 3 voxels from any edge.
    fn flatness(&self, shroud: &Shroud) -> f64 {
        let (mut squares, mut area) = (0.0, 0.0);
        for &triangle in &shroud.mesh.triangles {
            let corners = shroud.mesh.corners(triangle).map(|p| self.local(p));
            let [a, b, c] = corners;
            let normal = cross(minus(b, a), minus(c, a));
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            let middle = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
            let gaps = [0, 1, 2].map(|k| (middle[k].abs() - self.half[k]).abs());
            let mut axes = [0, 1, 2];
            axes.sort_by(|&p, &q| gaps[p].total_cmp(&gaps[q]));
            if gaps[axes[1]] <= 3.0 || length < 1e-9 {
                continue;
            }
            let along = normal[axes[0]] * middle[axes[0]].signum() / length;
            squares += length * along.clamp(-1.0, 1.0).acos().to_degrees().powi(2);
            area += length;
        }
        assert!(area > 0.0);
        (squares / area).sqrt()
    }

    /// The mean distance from the middles of the edges, in world units, to the nearest point of the
    /// mesh, found by walking along the diagonals across the edges.
    fn gap(&self, shroud: &Shroud) -> f64 {
        let mut distances = Vec::new();
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for signs in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                let end = self.half[axis] - 3.0;
                for n in 0..=(2.0 * end) as usize {
                    let mut point = [0.0; 3];
                    point[axis] = n as f64 - end;
                    point[u] = signs[0] * self.half[u];
                    point[v] = signs[1] * self.half[v];
                    distances.push(self.distance(shroud, point));
                }
            }
        }
        distances.iter().sum::<f64>() / distances.len() as f64
    }

    /// From a point to the mesh, by points sampled on the triangles near it.
    fn distance(&self, shroud: &Shroud, point: [f64; 3]) -> f64 {
        let mut least = f64::MAX;
        for &triangle in &shroud.mesh.triangles {
            let corners = shroud.mesh.corners(triangle).map(|p| minus(self.local(p), point));
            if corners[0].iter().any(|x| x.abs() > 3.0) {
                continue;
            }
            for (i, j) in (0..=8).flat_map(|i| (0..=8 - i).map(move |j| (i, j))) {
                let weights = [i, j, 8 - i - j].map(|w| f64::from(w) / 8.0);
                let at = |k: usize| (0..3).map(|c| weights[c] * corners[c][k]).sum::<f64>();
                least = least.min((0..3).map(|k| at(k).powi(2)).sum::<f64>());
            }
        }
        least.sqrt()
    }

    fn local(&self, point: [f64; 3]) -> [f64; 3] {
        let moved = minus(point, self.centre);
        [0, 1, 2].map(|k| (0..3).map(|row| self.turn[row][k] * moved[row]).sum())
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let [m, n] = [(k + 1) % 3, (k + 2) % 3];
        a[m] * b[n] - a[n] * b[m]
    })
}

fn wrong_side(shroud: &Shroud, volume: &Occupancy) -> u64 {
    check(&shroud.mesh, volume, &CheckSettings::default()).unwrap().separation.wrong_side.count
}

/// The mesh at the crossings of a tilted box itself has a gap of 0.26, as faces cut off the edges; of
/// a box along the grid 0.35.
#[test]
fn faces_are_flat_and_edges_sharp() {
    for (cuboid, exact_gap) in [(Cuboid::tilted(), 0.26), (Cuboid::aligned(), 0.354)] {
        let volume = cuboid.occupancy();
        let creased = shroud(&volume, &settings(true)).unwrap();
        let [flat, gap] = [cuboid.flatness(&creased), cuboid.gap(&creased)];
        assert!(flat < 1.1, "{flat} degrees");
        assert!(gap < 1.3 * exact_gap, "gap {gap}");
        let error = creased.mesh.volume() / cuboid.volume() - 1.0;
        assert!(error.abs() < 0.01, "volume {error}");
        assert_eq!(wrong_side(&creased, &volume), 0);
        assert_eq!(creased.report.status, Status::Preset);
    }
    let smooth = shroud(&Cuboid::tilted().occupancy(), &settings(false)).unwrap();
    let [flat, gap] = [Cuboid::tilted().flatness(&smooth), Cuboid::tilted().gap(&smooth)];
    assert!(flat > 1.5 && gap > 0.36, "the smooth box is as good: {flat}, {gap}");
}

#[test]
fn thin_parts_stay_alive() {
    let grid = Grid::new([24; 3], [1.0; 3]).unwrap();
    let chain =
        Occupancy::from_fn(grid.clone(), |[i, j, k]| i == j && k == 10 && (4..20).contains(&i));
    let block = |counts| phantom::block(&grid, [4; 3], counts).unwrap();
    let parts = [block([1; 3]), block([16, 1, 1]), block([16, 16, 1]), block([16, 2, 2]), chain];
    for volume in parts {
        let creased = shroud(&volume, &settings(true)).unwrap();
        let share = creased.mesh.volume() / volume.count() as f64;
        assert!((0.5..1.3).contains(&share), "{share} of the voxels");
        assert_eq!(wrong_side(&creased, &volume), 0);
    }
}

/// The price, and why creases are asked for: where nothing is sharp, facets appear.
#[test]
fn smooth_shapes_become_faceted() {
    let volume = phantom::sphere(32).unwrap();
    let centre = [15.637, 15.571, 15.407];
    let roughness = |shroud: &Shroud| {
        let (mut squares, mut area) = (0.0, 0.0);
        for &triangle in &shroud.mesh.triangles {
            let [a, b, c] = shroud.mesh.corners(triangle);
            let normal = cross(minus(b, a), minus(c, a));
            let out = minus([0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0), centre);
            let dot = |u: [f64; 3], v: [f64; 3]| (0..3).map(|k| u[k] * v[k]).sum::<f64>();
            let length = dot(normal, normal).sqrt();
            let cosine = dot(normal, out) / (length.max(1e-12) * dot(out, out).sqrt());
            squares += length * cosine.clamp(-1.0, 1.0).acos().powi(2);
            area += length;
        }
        (squares / area).sqrt().to_degrees()
    };
    let [smooth, faceted] =
        [false, true].map(|crease| roughness(&shroud(&volume, &settings(crease)).unwrap()));
    assert!(faceted > 3.0 * smooth, "{smooth} and {faceted} degrees");
}

#[test]
fn nothing_is_smooth_where_it_is_not_asked_to_be() {
    let volume = Cuboid::tilted().occupancy();
    let with = |rough: Option<Occupancy>| {
        let mut settings = settings(false);
        settings.optimize.rough = rough.map(Arc::new);
        shroud(&volume, &settings)
    };
    let unmarked = with(Some(Occupancy::empty(volume.grid().clone()))).unwrap();
    assert_eq!(unmarked.delta, with(None).unwrap().delta);

    // Where all is marked nothing moves from the start.
    let everywhere = Occupancy::from_fn(volume.grid().clone(), |_| true);
    let mut start = settings(false);
    start.optimize.max_iterations = Some(0);
    assert_eq!(with(Some(everywhere)).unwrap().delta, shroud(&volume, &start).unwrap().delta);

    // Marked along its edges, the box keeps them sharper.
    let cuboid = Cuboid::tilted();
    let edges = Occupancy::from_fn(volume.grid().clone(), |point| {
        let point = cuboid.local(point.map(|x| x as f64));
        let near = (0..3).filter(|&k| (point[k].abs() - cuboid.half[k]).abs() < 2.0).count();
        near >= 2
    });
    let marked = with(Some(edges)).unwrap();
    assert!(cuboid.gap(&marked) < cuboid.gap(&unmarked));
    assert_eq!(wrong_side(&marked, &volume), 0);

    let other = Occupancy::empty(Grid::new([43, 44, 44], [1.0; 3]).unwrap());
    assert!(matches!(with(Some(other)), Err(Error::Setting { .. })));
}

#[test]
fn creases_need_a_sensible_angle_and_a_preset_that_does_not_converge() {
    let volume = phantom::sphere(8).unwrap();
    let fails = |change: &dyn Fn(&mut optimize::Settings)| {
        let mut settings = settings(true);
        change(&mut settings.optimize);
        matches!(shroud(&volume, &settings), Err(Error::Setting { .. }))
    };
    assert!(!fails(&|_| {}));
    assert!(!fails(&|settings| settings.preset = Preset::Fast));
    assert!(fails(&|settings| settings.preset = Preset::Exact));
    assert!(fails(&|settings| settings.solver = Solver::Sweeps));
    for angle in [0.0, -1.0, 2.0, f64::NAN, f64::INFINITY] {
        assert!(fails(&|settings| settings.crease = Some(Crease { angle })), "{angle}");
    }
}

#[test]
fn an_empty_volume_has_no_creases() {
    let empty = Occupancy::empty(Grid::new([5, 4, 3], [1.0; 3]).unwrap());
    let creased = shroud(&empty, &settings(true)).unwrap();
    assert_eq!((creased.delta.len(), creased.report.status), (0, Status::Empty));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn noise_stays_on_its_side(volume in volumes()) {
        let creased = shroud(&volume, &settings(true)).unwrap();
        prop_assert!(creased.delta.iter().all(|delta| (0.0019..=0.9981).contains(delta)));
        prop_assert_eq!(wrong_side(&creased, &volume), 0);
    }
}
