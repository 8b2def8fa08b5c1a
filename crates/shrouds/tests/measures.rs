//! Area, volume and curvature of shrouds against formulas, and what is said of their errors.

#![allow(clippy::unwrap_used)]

#[path = "common/bodies.rs"]
mod bodies;
#[path = "common/random_bodies.rs"]
mod random_bodies;

use bodies::{BODIES, Body, Random, Shape};
use shrouds::measure::{
    Curvature, Integrals, curvature_areas, curvatures, flat_threshold, integrals, mesh_curvatures,
    smooth_integrals, uncertainty,
};
use shrouds::mesh::MeshKind;
use shrouds::network::Network;
use shrouds::optimize::{self, Preset};
use shrouds::{Grid, Occupancy, Settings, Shroud, TriMesh, shroud};

const UNIT: [f64; 3] = [1.0; 3];

fn exact(volume: &Occupancy, mesh: MeshKind) -> Shroud {
    let optimize = optimize::Settings { preset: Preset::Exact, ..Default::default() };
    shroud(volume, &Settings { optimize, mesh, ..Default::default() }).unwrap()
}

fn smooth(volume: &Occupancy) -> Integrals {
    smooth_integrals(&exact(volume, MeshKind::Primal).mesh).unwrap()
}

fn within(name: &str, found: f64, truth: f64, tolerance: f64) {
    let error = found / truth - 1.0;
    println!("{name}: {:+.3} %", 100.0 * error);
    assert!(error.abs() <= tolerance, "{name}: {error:+.5} beyond {tolerance}");
}

#[test]
fn quadrature_finds_what_formulas_say() {
    use std::f64::consts::PI;
    let oblate = Shape::Ellipsoid([2.0, 2.0, 1.0]).truth();
    let e = 0.75f64.sqrt();
    within("area", oblate.area, 8.0 * PI * (1.0 + 0.25 / e * e.atanh()), 1e-8);
    within("volume", oblate.volume, 16.0 / 3.0 * PI, 1e-8);
    let power = Shape::Superellipsoid { axes: [2.0, 2.0, 1.0], power: 2.0 }.truth();
    within("area", power.area, oblate.area, 1e-8);
    // A shifted ball, to the first order of its shift, has waves of degree 1.
    let waves = vec![([0.0, 0.6, 0.8], 1, 1e-4)];
    let shifted = Shape::Wavy { radius: 3.0, waves }.truth();
    within("area", shifted.area, 36.0 * PI, 1e-7);
    within("volume", shifted.volume, 36.0 * PI, 1e-7);
    // Of a wave of degree 2 and height a the volume is r³·∫(1 + a·P₂)³/3, ∫P₂² = 4π/5, ∫P₂³ = 8π/35.
    let wave = Shape::Wavy { radius: 1.0, waves: vec![([1.0, 0.0, 0.0], 2, 0.3)] }.truth();
    let volume = 4.0 / 3.0 * PI + 0.09 * 4.0 * PI / 5.0 + 0.027 / 3.0 * 8.0 * PI / 35.0;
    within("volume", wave.volume, volume, 1e-8);
}

/// Areas within 1, 0.3 and 0.1 %, volumes within 1.5, 0.4 and 0.15 %.
#[test]
fn bodies_of_radius_5_10_and_20_have_their_area_and_volume() {
    for (radius, area, volume, positions) in
        [(5.0, 0.01, 0.015, 5), (10.0, 0.003, 0.004, 3), (20.0, 0.001, 0.0015, 1)]
    {
        for (name, shape) in BODIES {
            let truth = shape(radius).truth();
            for seed in 0..positions {
                let (_, voxels) = Body::random(shape(radius), UNIT, &mut Random(1000 * seed + 7));
                let found = smooth(&voxels);
                let name = format!("{name} {radius}, {seed}");
                within(&format!("area of {name}"), found.area, truth.area, area);
                within(&format!("volume of {name}"), found.volume, truth.volume, volume);
            }
        }
    }
}

#[test]
fn bodies_on_long_voxels_have_three_times_the_tolerance() {
    for (name, shape) in BODIES {
        let truth = shape(20.0).truth();
        let (_, voxels) = Body::random(shape(20.0), [1.0, 1.0, 3.0], &mut Random(7));
        let found = smooth(&voxels);
        within(&format!("area of {name}"), found.area, truth.area, 0.003);
        within(&format!("volume of {name}"), found.volume, truth.volume, 0.0045);
    }
}

#[test]
fn areas_of_both_signs_of_gaussian_curvature() {
    for (name, shape) in &BODIES[1..] {
        let (body, voxels) = Body::random(shape(10.0), UNIT, &mut Random(3));
        let [positive, negative] = body.shape.truth().signs.unwrap();
        let of = |shroud: &Shroud, curvatures: &[Curvature]| {
            let found = curvature_areas(&shroud.mesh, curvatures, flat_threshold(UNIT)).unwrap();
            let sum = |signs: shrouds::measure::SignAreas| {
                signs.positive + signs.negative + signs.near_zero
            };
            let area = smooth_integrals(&shroud.mesh).unwrap().area;
            within("sum of the signs", sum(found.gaussian), area, 1e-9);
            within("sum of the signs", sum(found.mean), area, 1e-9);
            within(&format!("positive, {name}"), found.gaussian.positive, positive, 0.03);
            if negative > 0.0 {
                within(&format!("negative, {name}"), found.gaussian.negative, negative, 0.03);
            } else {
                assert_eq!(found.gaussian.negative, 0.0);
                within("convex", found.mean.positive, area, 1e-9);
            }
        };
        let primal = exact(&voxels, MeshKind::Primal);
        let network = Network::trace(&primal.surface);
        of(&primal, &curvatures(&network, &primal.mesh.vertices, &primal.mesh.normals));
        of(&primal, &mesh_curvatures(&primal.mesh).unwrap());
        let dual = exact(&voxels, MeshKind::Dual);
        of(&dual, &mesh_curvatures(&dual.mesh).unwrap());
    }
}

/// Median and 95th percentile of the errors of both principal curvatures, over the larger one.
fn curvature_errors(body: &Body, mesh: &TriMesh, found: &[Curvature]) -> [f64; 2] {
    let errors = found.iter().zip(&mesh.vertices).flat_map(|(curvature, &vertex)| {
        let truth = body.shape.principal(body.own(vertex)).unwrap();
        [0, 1].map(|n| (curvature.principal[n] - truth[n]).abs() / truth[0])
    });
    let mut errors: Vec<f64> = errors.collect();
    errors.sort_by(f64::total_cmp);
    [errors[errors.len() / 2], errors[errors.len() * 95 / 100]]
}

#[test]
fn principal_curvatures_of_ball_and_torus() {
    for shape in [Shape::ball(20.0), Shape::torus(20.0)] {
        let (body, voxels) = Body::random(shape, UNIT, &mut Random(11));
        let Shroud { surface, mut mesh, .. } = exact(&voxels, MeshKind::Primal);
        let of_network = curvatures(&Network::trace(&surface), &mesh.vertices, &mesh.normals);
        let dual = exact(&voxels, MeshKind::Dual).mesh;
        let (of_mesh, of_dual) = (mesh_curvatures(&mesh).unwrap(), mesh_curvatures(&dual).unwrap());
        let of_shroud = [(&mesh, of_network), (&mesh, of_mesh), (&dual, of_dual)];
        for (mesh, found) in of_shroud {
            let [median, most] = curvature_errors(&body, mesh, &found);
            println!("{median:.4} {most:.4}");
            assert!(median <= 0.03 && most <= 0.15, "{median} {most}");
        }
        // As from a file without normals.
        mesh.normals.clear();
        let [median, most] = curvature_errors(&body, &mesh, &mesh_curvatures(&mesh).unwrap());
        println!("{median:.4} {most:.4} without normals");
        assert!(median <= 0.06 && most <= 0.3, "{median} {most}");
    }
}

#[test]
fn moved_scaled_and_turned_over_meshes_keep_what_they_should() {
    let (_, voxels) = Body::random(Shape::ball(6.0), UNIT, &mut Random(5));
    let mesh = exact(&voxels, MeshKind::Primal).mesh;
    let plain = smooth_integrals(&mesh).unwrap();
    let turn = Random(8).turn();
    let turned = |p: [f64; 3]| turn.map(|row| (0..3).map(|k| row[k] * p[k]).sum::<f64>());
    let mut moved = mesh.clone();
    moved.vertices.iter_mut().for_each(|p| *p = turned(*p).map(|x| 3.0 * x - 40.0));
    moved.normals.iter_mut().for_each(|n| *n = turned(n.map(f64::from)).map(|x| x as f32));
    let found = smooth_integrals(&moved).unwrap();
    within("area", found.area, 9.0 * plain.area, 1e-7);
    within("volume", found.volume, 27.0 * plain.volume, 1e-7);
    let [few, many] = [&mesh, &moved].map(|mesh| mesh_curvatures(mesh).unwrap());
    for (one, other) in few.iter().zip(&many) {
        assert!((one.mean() - 3.0 * other.mean()).abs() < 1e-4 * one.mean().abs());
    }
    // Inside and outside exchanged.
    let mut over = mesh;
    over.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    over.normals.iter_mut().for_each(|n| *n = n.map(|x| -x));
    let found = smooth_integrals(&over).unwrap();
    within("area", found.area, plain.area, 1e-12);
    within("volume", found.volume, -plain.volume, 1e-12);
}

#[test]
fn a_body_has_its_measures_in_any_frame_of_the_world() {
    let shape = Shape::ball(9.0);
    for affine in [
        [[0.8, -0.6, 0.0, 9.0], [0.6, 0.8, 0.0, -9.0], [0.0, 0.0, 1.0, 5.0]],
        [[-1.0, 0.3, 0.0, 19.0], [0.0, 1.0, 0.2, -7.0], [0.0, 0.0, 1.0, -3.0]],
    ] {
        let grid = Grid::with_affine([44; 3], affine).unwrap();
        let centre = grid.point([21.7, 22.1, 21.3]);
        let body = Body { shape: shape.clone(), turn: Random(1).turn(), centre };
        let shroud = exact(&body.volume(&grid), MeshKind::Primal);
        let (found, truth) = (smooth_integrals(&shroud.mesh).unwrap(), shape.truth());
        within("area", found.area, truth.area, 0.006);
        within("volume", found.volume, truth.volume, 0.008);
        let known = uncertainty(&shroud.surface, &found);
        assert!(known.volume.low < truth.volume && truth.volume < known.volume.high);
        assert!(known.area.low < truth.area && truth.area < known.area.high);
    }
}

#[test]
fn creases_and_single_voxels_keep_the_measures_of_their_triangles() {
    let voxel = Occupancy::from_fn(Grid::new([3; 3], UNIT).unwrap(), |index| index == [1; 3]);
    let mut mesh = exact(&voxel, MeshKind::Primal).mesh;
    assert_eq!(smooth_integrals(&mesh), integrals(&mesh));
    // Stretched and without normals, the corners of an octahedron still turn by more than 60°.
    mesh.normals.clear();
    mesh.vertices.iter_mut().for_each(|p| p[2] *= 1.2);
    assert_eq!(smooth_integrals(&mesh), integrals(&mesh));
    mesh.normals.push([0.0; 3]);
    assert!(smooth_integrals(&mesh).is_err() && mesh_curvatures(&mesh).is_err());
    assert!(mesh_curvatures(&TriMesh::default()).unwrap().is_empty());
}

#[test]
fn the_error_holds_the_truth_of_bodies_it_was_not_fitted_to() {
    let (mut holds, mut ratios) = (0, Vec::new());
    for seed in 0..20 {
        let mut random = Random(77_000 + seed);
        let (_, shape, spacing) = random_bodies::judged(&mut random, 12.0);
        let (body, voxels) = Body::random(shape, spacing, &mut random);
        let shroud = exact(&voxels, MeshKind::Primal);
        let (found, truth) = (smooth_integrals(&shroud.mesh).unwrap(), body.shape.truth());
        let known = uncertainty(&shroud.surface, &found);
        for (span, value, truth) in
            [(known.volume, found.volume, truth.volume), (known.area, found.area, truth.area)]
        {
            assert!(span.low <= value && value <= span.high && span.low <= truth);
            assert!(truth <= span.high);
            holds += usize::from((value - truth).abs() <= span.error);
            ratios.push(span.error / (value - truth).abs());
        }
    }
    ratios.sort_by(f64::total_cmp);
    // One in twenty may be missed, of 40 by chance a few more.
    assert!(holds >= 36, "{holds} of 40");
    assert!(ratios[20] <= 5.0, "{} times too wide", ratios[20]);
}
