//! The parametrisations: each against its definition and the invariance it promises.

use std::f64::consts::FRAC_PI_2;

use proptest::prelude::*;
use shrouds::energy::{Parameter, Point2};

fn four_points() -> impl Strategy<Value = [Point2; 4]> {
    proptest::array::uniform4(proptest::array::uniform2(-3.0..3.0f64))
}

fn distance(a: Point2, b: Point2) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Second moments about the mean.
fn moments(points: &[Point2; 4]) -> [f64; 3] {
    let mean = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / 4.0);
    let product = |i: usize, j: usize| {
        points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>()
    };
    [product(0, 0), product(0, 1), product(1, 1)]
}

/// How far t may be from that of the metric alone: the ordinary one is mixed in with 1e-4.
fn affine_tolerance(points: &[Point2; 4]) -> f64 {
    let [xx, xy, yy] = moments(points);
    1e-4 * (xx + yy).powi(2) / (xx * yy - xy * xy) + 1e-12
}

/// Chords no shorter than a margin allows.
fn apart(points: &[Point2; 4]) -> bool {
    points.windows(2).all(|pair| distance(pair[0], pair[1]) > 0.003)
}

proptest! {
    #[test]
    fn turning_scaling_and_reflecting_leave_every_parameter(
        points in four_points(), angle in 0.0..6.3f64, scale in 0.2..5.0f64
    ) {
        prop_assume!(apart(&points));
        let (s, c) = angle.sin_cos();
        let images = [
            points.map(|[x, y]| [scale * (c * x - s * y) + 3.0, scale * (s * x + c * y) - 1.0]),
            points.map(|[x, y]| [c * x + s * y, s * x - c * y]),
        ];
        for parameter in Parameter::ALL {
            let t = parameter.of_middle(points);
            prop_assert!(t > 0.0 && t < 1.0, "{parameter} {t}");
            for image in images {
                let error = (parameter.of_middle(image) - t).abs();
                prop_assert!(error < 1e-9, "{parameter} {error:e}");
            }
        }
    }

    #[test]
    fn the_other_way_round_t_is_the_rest(points in four_points()) {
        prop_assume!(apart(&points));
        let [a, b, c, d] = points;
        for parameter in Parameter::ALL.into_iter().filter(|&p| p != Parameter::Affine) {
            let sum = parameter.of_middle(points) + parameter.of_middle([c, b, a, d]);
            prop_assert!((sum - 1.0).abs() < 1e-12, "{parameter} {sum}");
        }
    }

    #[test]
    fn affine_maps_leave_the_affine_parameter_and_change_the_lengths(
        points in four_points(), map in proptest::array::uniform4(-2.0..2.0f64)
    ) {
        let [a, b, c, d] = map;
        prop_assume!((a * d - b * c).abs() > 0.05);
        let image = points.map(|[x, y]| [a * x + b * y + 0.7, c * x + d * y - 4.0]);
        let tolerance = affine_tolerance(&points) + affine_tolerance(&image);
        prop_assume!(tolerance < 0.03 && apart(&points) && apart(&image));
        let change = |p: Parameter| (p.of_middle(image) - p.of_middle(points)).abs();
        prop_assert!(change(Parameter::Affine) <= tolerance, "{:e}", change(Parameter::Affine));
        prop_assert_eq!(change(Parameter::Uniform), 0.0);
    }

    #[test]
    fn the_affine_parameter_is_that_of_the_inverse_covariance(points in four_points()) {
        let tolerance = affine_tolerance(&points);
        prop_assume!(tolerance < 0.03 && apart(&points));
        let [xx, xy, yy] = moments(&points);
        let determinant = xx * yy - xy * xy;
        let length = |a: Point2, b: Point2| {
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            ((x * (yy * x - xy * y) + y * (xx * y - xy * x)) / determinant).sqrt()
        };
        let (before, after) = (length(points[0], points[1]), length(points[1], points[2]));
        let expected = before / (before + after);
        prop_assert!((Parameter::Affine.of_middle(points) - expected).abs() <= tolerance);
    }

    #[test]
    fn on_a_straight_line_all_that_follow_lengths_agree(
        steps in proptest::array::uniform3(0.01..2.0f64), angle in 0.0..6.3f64
    ) {
        let along = [0.0, steps[0], steps[0] + steps[1], steps.iter().sum()];
        let points = along.map(|l| [l * angle.cos(), l * angle.sin()]);
        let expected = steps[0] / (steps[0] + steps[1]);
        for parameter in [Parameter::Chord, Parameter::Affine, Parameter::Foley] {
            prop_assert!((parameter.of_middle(points) - expected).abs() < 1e-6, "{parameter}");
        }
    }
}

#[test]
fn stretching_an_axis_changes_chord_centripetal_and_foley() {
    let points: [Point2; 4] = [[0.0, 0.0], [1.0, 0.2], [1.4, 1.0], [1.0, 2.0]];
    let stretched = points.map(|[x, y]| [x, 3.0 * y]);
    for parameter in [Parameter::Chord, Parameter::Centripetal, Parameter::Foley] {
        let change = parameter.of_middle(stretched) - parameter.of_middle(points);
        assert!(change.abs() > 0.02, "{parameter} {change}");
    }
    let change = Parameter::Affine.of_middle(stretched) - Parameter::Affine.of_middle(points);
    assert!(change.abs() < 2e-3, "{change}");
}

#[test]
fn values_at_a_right_angle() {
    // Chords of lengths 1 and 3.
    let points: [Point2; 4] = [[0.0, 1.0], [0.0, 0.0], [3.0, 0.0], [4.0, 1.0]];
    let root = 3.0f64.sqrt();
    let (short, long) = (1.0 + 1.5 * FRAC_PI_2 * 0.75, 3.0 * (1.0 + 1.5 * FRAC_PI_2 * 0.25));
    for (parameter, expected) in [
        (Parameter::Uniform, 0.5),
        (Parameter::Chord, 0.25),
        (Parameter::Centripetal, 1.0 / (1.0 + root)),
        (Parameter::Foley, short / (short + long)),
    ] {
        assert!((parameter.of_middle(points) - expected).abs() < 1e-14, "{parameter}");
    }
    // A sharper turn counts as a right angle.
    let sharper: [Point2; 4] = [[0.6, 0.8], [0.0, 0.0], [3.0, 0.0], [4.0, 1.0]];
    let t = Parameter::Foley.of_middle(sharper);
    assert!((t - Parameter::Foley.of_middle(points)).abs() < 1e-14);
}
