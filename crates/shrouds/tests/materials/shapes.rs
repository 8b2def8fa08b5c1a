//! Bodies whose interfaces are known.

use shrouds::Grid;
use shrouds::materials::{Labels, Settings, Shrouds, shrouds};
use shrouds::optimize::Preset;

type Point = [f64; 3];

/// The labels of a cube of lattice points by a function of the place.
fn labels(size: usize, label: impl Fn(Point) -> u8) -> Labels {
    let grid = Grid::new([size; 3], [1.0; 3]).unwrap();
    let place = |n: usize| [n % size, n / size % size, n / size / size].map(|x| x as f64);
    let values: Vec<u8> = (0..size.pow(3)).map(|n| label(place(n))).collect();
    Labels::new(&grid, &values).unwrap()
}

fn exact(labels: Labels) -> Shrouds {
    shrouds(labels, &Settings { preset: Preset::Exact, ..Settings::default() }).unwrap()
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    f64::sqrt(sum / count)
}

#[test]
fn a_double_bubble_has_its_spheres_its_disc_and_its_rim() {
    let centres = [[11.1, 15.9, 15.8], [20.5, 14.7, 16.3]];
    let radius: f64 = 9.5;
    let from = |p: Point, c: Point| (0..3).map(|a| (p[a] - c[a]).powi(2)).sum::<f64>().sqrt();
    let found = exact(labels(32, |p| {
        let distances = centres.map(|c| from(p, c));
        match distances {
            [a, b] if a.min(b) > radius => 0,
            [a, b] => 1 + u8::from(b < a),
        }
    }));
    let mesh = &found.mesh;
    let pairs: Vec<[i64; 2]> = mesh.contacts().into_keys().collect();
    assert_eq!(pairs, [[1, 0], [1, 2], [2, 0]]);
    let to_sphere = |label: usize| {
        let sphere = mesh.interface([label as i64, 0]);
        rms(sphere.vertices.into_iter().map(|p| from(p, centres[label - 1]) - radius))
    };
    let between = from(centres[0], centres[1]);
    let to_disc =
        |p: Point| (from(p, centres[0]).powi(2) - from(p, centres[1]).powi(2)) / (2.0 * between);
    let disc = rms(mesh.interface([1, 2]).vertices.into_iter().map(to_disc));
    let errors = [to_sphere(1), to_sphere(2), disc];
    assert!(errors.iter().all(|&error| error < 0.1), "{errors:?}");
    // The rim is a circle: so far from the disc, and from both centres.
    let ends = mesh.lines.iter().flatten().map(|&v| mesh.surface.vertices[v as usize]);
    let off = |p: Point| to_disc(p).hypot(from(p, centres[0]) - radius);
    let rim = rms(ends.map(off));
    assert!(rim < 0.15, "{rim}");
    // The shared triangles are the same on both sides.
    let area = mesh.contacts()[&[1, 2]].1;
    let expected = std::f64::consts::PI * (radius.powi(2) - (between / 2.0).powi(2));
    assert!((area / expected - 1.0).abs() < 0.02, "{area} {expected}");
}

#[test]
fn three_planes_meet_in_a_straight_line() {
    // Through a point; u and v are across it.
    let through = [16.2, 15.7, 15.9];
    let (u, v) = ([0.8, -0.6, 0.0], [0.48, 0.64, -0.6]);
    let across = |p: Point| {
        let along = |axis: Point| (0..3).map(|a| (p[a] - through[a]) * axis[a]).sum::<f64>();
        [along(u), along(v)]
    };
    let third = std::f64::consts::TAU / 3.0;
    let mesh = exact(labels(32, |p| {
        let [a, b] = across(p);
        1 + ((b.atan2(a) + third * 1.5) / third).min(2.9) as u8
    }))
    .mesh;
    let inner = |p: &Point| p.iter().all(|&x| x > 4.0 && x < 27.0);
    let ends = mesh.lines.iter().flatten().map(|&v| mesh.surface.vertices[v as usize]);
    let line = rms(ends.filter(inner).map(|p| f64::hypot(across(p)[0], across(p)[1])));
    assert!(line < 0.15, "{line}");
}

#[test]
fn results_are_the_same_on_any_number_of_threads() {
    let labels = labels(24, |[x, y, z]| {
        let turned = [0.9 * x + 0.2 * y - 0.3 * z, 0.8 * y + 0.4 * z - 0.1 * x];
        1 + u8::from(turned[0] > 9.3) + 2 * u8::from(turned[1] > 13.1)
    });
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| shrouds(labels.clone(), &Settings::default()).unwrap())
    });
    assert_eq!((one.mesh, one.report), (three.mesh, three.report));
    assert!(one.junctions > 20);
}

#[test]
fn rods_of_labels_beside_a_larger_one_keep_their_thickness() {
    // Rods of labels 1 and 2, label 3 far away.
    let rod = |p: Point, x: f64| p[0] == x && p[1] == 4.0 && (4.0..24.0).contains(&p[2]);
    let found = exact(labels(28, |p| match p {
        p if rod(p, 4.0) => 1,
        p if rod(p, 8.0) => 2,
        [x, y, z] if (x - 18.0).hypot(y - 18.0).hypot(z - 14.0) < 7.0 => 3,
        _ => 0,
    }));
    for label in [1, 2] {
        let share = found.mesh.closed_mesh(label).volume() / 20.0;
        assert!((0.5..1.3).contains(&share), "{label}: {share}");
    }
}
