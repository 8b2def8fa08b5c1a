//! The spline through a whole polygon against a dense solution, finite differences and the circle.

#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use proptest::prelude::*;
use shrouds::energy::{Curvature, CurveEnergy, Parameter, Point2, spline_energy};
use shrouds::mesh::place_vertices;
use shrouds::network::{Curve, Network};
use shrouds::volume::phantom;
use shrouds::{Settings, shroud};

fn minus(a: Point2, b: Point2) -> Point2 {
    [a[0] - b[0], a[1] - b[1]]
}

/// Steps of the parameter, straight from their definitions.
fn steps(points: &[Point2], is_closed: bool, parameter: Parameter) -> Vec<f64> {
    let n = points.len();
    let count = if is_closed { n } else { n - 1 };
    let chord = |i: usize| minus(points[(i + 1) % n], points[i % n]);
    let length = |i: usize| chord(i)[0].hypot(chord(i)[1]);
    match parameter {
        Parameter::Uniform => vec![1.0; count],
        Parameter::Chord => (0..count).map(length).collect(),
        Parameter::Centripetal => (0..count).map(|i| length(i).sqrt()).collect(),
        Parameter::Affine => {
            let mean = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n as f64);
            let squared = |v: Point2| {
                let other = |p: &Point2| {
                    let q = minus(*p, mean);
                    let cross = v[0] * q[1] - v[1] * q[0];
                    let ordinary = (v[0] * v[0] + v[1] * v[1]) * (q[0] * q[0] + q[1] * q[1]);
                    cross * cross + 1e-4 * ordinary
                };
                points.iter().map(other).sum::<f64>()
            };
            let lengths: Vec<f64> = (0..count).map(|i| squared(chord(i)).sqrt()).collect();
            let mean = lengths.iter().sum::<f64>() / count as f64;
            lengths.iter().map(|l| l / mean).collect()
        }
        Parameter::Foley => {
            let turning = |i: usize, j: usize| {
                let (u, v) = (chord(i), chord(j));
                (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]).abs().min(PI / 2.0)
            };
            let gain = |own: usize, at: [usize; 2]| {
                let other = if at[0] == own { at[1] } else { at[0] };
                1.5 * turning(at[0], at[1]) * length(other) / (length(own) + length(other))
            };
            let step = |i: usize| {
                let before = if is_closed || i > 0 { gain(i, [(i + n - 1) % n, i]) } else { 0.0 };
                let after =
                    if is_closed || i + 1 < count { gain(i, [i, (i + 1) % n]) } else { 0.0 };
                length(i) * (1.0 + before + after)
            };
            (0..count).map(step).collect()
        }
    }
}

/// The solution of dense equations, by elimination with pivots.
fn solve(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for i in 0..n {
        let best = (i..n).max_by(|&a, &b| rows[a][i].abs().total_cmp(&rows[b][i].abs())).unwrap();
        rows.swap(i, best);
        for j in 0..n {
            if j != i {
                let factor = rows[j][i] / rows[i][i];
                let pivot = rows[i].clone();
                rows[j].iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
            }
        }
    }
    (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
}

/// The energy from the coefficients of all cubics `a + b·s + c·s² + d·s³`, found from what makes a
/// spline: values, first and second derivatives.
fn dense_energy(points: &[Point2], is_closed: bool, parameter: Parameter) -> f64 {
    let h = steps(points, is_closed, parameter);
    let (m, n) = (h.len(), points.len());
    let one = |k: usize| {
        let mut rows = Vec::new();
        let mut row = |entries: &[(usize, f64)], right: f64| {
            let mut row = vec![0.0; 4 * m + 1];
            entries.iter().for_each(|&(at, x)| row[at] += x);
            row[4 * m] = right;
            rows.push(row);
        };
        for i in 0..m {
            let s = h[i];
            row(&[(4 * i, 1.0)], points[i][k]);
            let end = [(4 * i, 1.0), (4 * i + 1, s), (4 * i + 2, s * s), (4 * i + 3, s * s * s)];
            row(&end, points[(i + 1) % n][k]);
            if is_closed || i + 1 < m {
                let j = 4 * ((i + 1) % m);
                let first = [(4 * i + 1, 1.0), (4 * i + 2, 2.0 * s), (4 * i + 3, 3.0 * s * s)];
                row(&[&first[..], &[(j + 1, -1.0)]].concat(), 0.0);
                row(&[(4 * i + 2, 2.0), (4 * i + 3, 6.0 * s), (j + 2, -2.0)], 0.0);
            }
        }
        if !is_closed {
            row(&[(2, 2.0)], 0.0);
            row(&[(4 * m - 2, 2.0), (4 * m - 1, 6.0 * h[m - 1])], 0.0);
        }
        let x = solve(rows);
        let integral = |i: usize| {
            let (c, d, s) = (x[4 * i + 2], x[4 * i + 3], h[i]);
            4.0 * c * c * s + 12.0 * c * d * s * s + 12.0 * d * d * s * s * s
        };
        (0..m).map(integral).sum::<f64>()
    };
    one(0) + one(1)
}

/// A polygon that goes round once with irregular steps, no turning at a kink of Foley's.
fn polygons() -> impl Strategy<Value = Vec<Point2>> {
    proptest::collection::vec((0.3..1.0f64, 1.0..3.0f64), 3..9).prop_map(|steps| {
        let total: f64 = steps.iter().map(|(a, _)| a).sum();
        let mut angle = 0.0;
        let place = |(a, r): (f64, f64)| {
            angle += a / total * 2.0 * PI;
            [r * angle.cos() + 0.3, 0.7 * r * angle.sin()]
        };
        steps.into_iter().map(place).collect()
    })
}

fn turnings(points: &[Point2]) -> Vec<f64> {
    let n = points.len();
    let chord = |i: usize| minus(points[(i + 1) % n], points[i % n]);
    let turning = |i: usize| {
        let (u, v) = (chord(i), chord(i + 1));
        (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]).abs()
    };
    (0..n).map(turning).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn it_is_the_integral_over_the_spline_that_dense_equations_give(points in polygons()) {
        for parameter in Parameter::ALL {
            for is_closed in [false, true] {
                let value = spline_energy(&points, is_closed, parameter).value;
                let expected = dense_energy(&points, is_closed, parameter);
                let error = (value - expected).abs();
                prop_assert!(error <= 1e-8 * expected, "{parameter} {value} {expected}");
            }
        }
    }

    #[test]
    fn its_gradient_agrees_with_finite_differences(points in polygons()) {
        let near = |t: &f64| [0.0, PI / 2.0, PI].iter().any(|kink| (t - kink).abs() < 1e-3);
        prop_assume!(!turnings(&points).iter().any(near));
        for parameter in Parameter::ALL {
            for is_closed in [false, true] {
                let energy = spline_energy(&points, is_closed, parameter);
                let size = energy.gradient.iter().flatten().fold(0.0, |m: f64, g| m.max(g.abs()));
                for v in 0..points.len() {
                    for k in 0..2 {
                        let at = |step: f64| {
                            let mut moved = points.clone();
                            moved[v][k] += step;
                            spline_energy(&moved, is_closed, parameter).value
                        };
                        let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
                        let error = (difference - energy.gradient[v][k]).abs();
                        prop_assert!(
                            error < 1e-5 * (1.0 + size),
                            "{parameter} {is_closed} {v}: {difference} {}", energy.gradient[v][k]
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn it_follows_a_power_of_scale_and_no_rotation(
        points in polygons(), angle in 0.0..6.3f64, scale in 0.2..5.0f64
    ) {
        let (s, c) = angle.sin_cos();
        let turn = |[x, y]: Point2| [scale * (c * x - s * y) + 1.0, scale * (s * x + c * y) - 2.0];
        let image: Vec<Point2> = points.iter().map(|&p| turn(p)).collect();
        for parameter in Parameter::ALL {
            let power = match parameter {
                Parameter::Uniform | Parameter::Affine => 2.0,
                Parameter::Chord | Parameter::Foley => -1.0,
                Parameter::Centripetal => 0.5,
            };
            for is_closed in [false, true] {
                let of = |points: &[Point2]| spline_energy(points, is_closed, parameter).value;
                let expected = of(&points) * scale.powf(power);
                prop_assert!((of(&image) - expected).abs() <= 1e-9 * expected, "{parameter}");
            }
        }
    }
}

fn circle(radius: f64, n: usize) -> Vec<Point2> {
    let angle = |i: usize| 2.0 * PI * i as f64 / n as f64;
    (0..n).map(|i| [radius * angle(i).cos(), radius * angle(i).sin()]).collect()
}

#[test]
fn on_a_circle_it_is_the_integral_of_squared_curvature() {
    let errors = [16, 32, 64].map(|n| {
        let energy = spline_energy(&circle(5.0, n), true, Parameter::Chord);
        energy.value * 5.0 / (2.0 * PI) - 1.0
    });
    // Chord lengths are short of arcs by a part of second order.
    for pair in errors.windows(2) {
        assert!((3.5..4.5).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    assert!(errors[2].abs() < 1e-2, "{errors:?}");
    // The local quadratic has the curvature of the circle to the same order.
    let points = circle(5.0, 64);
    let local = Curvature::default().rho(&[points[0], points[1], points[2], points[3]]);
    assert!((local * 25.0 - 1.0).abs() < 1e-2);
}

#[test]
fn straight_lines_and_too_few_vertices_have_none() {
    let line: Vec<Point2> = [0.0, 0.5, 2.0, 2.1, 4.0].map(|t| [3.0 * t, 1.0 - t]).into();
    for parameter in [Parameter::Chord, Parameter::Foley, Parameter::Affine] {
        let energy = spline_energy(&line, false, parameter);
        assert!(energy.value < 1e-18, "{parameter} {}", energy.value);
    }
    for is_closed in [false, true] {
        for n in 0..3 {
            let energy = spline_energy(&line[..n], is_closed, Parameter::Chord);
            assert_eq!((energy.value, energy.gradient.len()), (0.0, n));
        }
    }
}

#[test]
fn vertices_in_one_place_give_finite_numbers() {
    let (o, x) = ([0.0, 0.0], [1.0, 0.0]);
    for points in
        [vec![o; 4], vec![o, o, x, [1.0, 1.0]], vec![o, x, x, o, [0.0, 1.0]], vec![o, x, o, x]]
    {
        for parameter in Parameter::ALL {
            for is_closed in [false, true] {
                let energy = spline_energy(&points, is_closed, parameter);
                assert!(energy.value.is_finite(), "{parameter} {points:?}");
                let mut all = energy.gradient.iter().flatten();
                assert!(all.all(|g| g.is_finite()), "{parameter} {points:?} {energy:?}");
            }
        }
    }
}

#[test]
fn it_judges_the_curves_of_a_network() {
    let volume = phantom::sphere(32).unwrap();
    let shroud = shroud(&volume, &Settings::default()).unwrap();
    let midpoints = place_vertices(&shroud.surface, &vec![0.5; shroud.delta.len()]);
    let network = Network::trace(&shroud.surface);
    // The energy of all curves, each of which costs at least as much as a circle of its length.
    let judge = |vertices: &[[f64; 3]]| -> f64 {
        let of_curve = |curve: Curve| {
            let axes = [(curve.axis + 1) % 3, (curve.axis + 2) % 3];
            let place = |&v: &u32| axes.map(|axis| vertices[v as usize][axis]);
            let points: Vec<Point2> = curve.vertices.iter().map(place).collect();
            let n = points.len();
            let chord = |i: usize| minus(points[(i + 1) % n], points[i]);
            let length: f64 = (0..n).map(|i| chord(i)[0].hypot(chord(i)[1])).sum();
            let energy = spline_energy(&points, curve.closed, Parameter::Chord).value;
            assert!(energy * length >= 0.99 * 4.0 * PI * PI, "{energy} for length {length}");
            energy
        };
        network.curves().map(of_curve).sum()
    };
    let (smooth, rough) = (judge(&shroud.mesh.vertices), judge(&midpoints));
    assert!(smooth < 0.5 * rough, "{smooth} against {rough}");
}
