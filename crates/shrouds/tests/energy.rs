//! The energies against formulas: derivatives, circles, lines, and how they scale.

use proptest::prelude::*;
use shrouds::energy::{
    Bending, Curvature, CurveEnergy, LANES, Lanes, Linear, Parameter, Point2, Stencil, Support,
    Variation,
};

const PARAMETERS: [Parameter; 3] = [Parameter::Uniform, Parameter::Chord, Parameter::Centripetal];

/// Every energy with its name and the power of a length scale that ρ follows.
fn energies() -> Vec<(String, Box<dyn CurveEnergy>, i32)> {
    let mut all: Vec<(String, Box<dyn CurveEnergy>, i32)> = vec![
        ("bending".into(), Box::new(Bending), -1),
        ("variation".into(), Box::new(Variation), -1),
    ];
    for parameter in PARAMETERS {
        all.push((format!("curvature {parameter:?}"), Box::new(Curvature { parameter }), -2));
        all.push((format!("linear {parameter:?}"), Box::new(Linear { parameter }), 2));
    }
    all
}

/// Four vertices no two successive ones of which are closer than the margin of δ allows.
fn four_points() -> impl Strategy<Value = [Point2; 4]> {
    let step = || (0.05..1.5f64, -3.1..3.1f64).prop_map(|(l, a)| [l * a.cos(), l * a.sin()]);
    let shifted = |p: Point2, by: Point2| [p[0] + by[0], p[1] + by[1]];
    (-5.0..5.0f64, -5.0..5.0f64, step(), step(), step()).prop_map(move |(x, y, a, b, c)| {
        let first = [x, y];
        let second = shifted(first, a);
        let third = shifted(second, b);
        [first, second, third, shifted(third, c)]
    })
}

/// The direction along a coordinate.
fn along(coordinate: usize) -> Point2 {
    std::array::from_fn(|k| f64::from(u8::from(k == coordinate)))
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs()))
}

proptest! {
    #[test]
    fn derivatives_agree_with_finite_differences(
        points in four_points(), moves in proptest::array::uniform4(0usize..2)
    ) {
        for (name, energy, _) in energies() {
            let term = energy.term(&Stencil { points, moves: moves.map(along) });
            let value = term.residual[0].powi(2) + term.residual[1].powi(2);
            prop_assert!(close(value, energy.rho(&points), 1e-12), "{name}");
            for n in 0..4 {
                let at = |step: f64| {
                    let mut moved = points;
                    moved[n][moves[n]] += step;
                    energy.term(&Stencil { points: moved, moves: moves.map(along) }).residual
                };
                // Richardson's extrapolation of the central difference: error of fourth order.
                let (h, k) = (2e-5, 1e-5);
                for r in 0..2 {
                    let wide = (at(h)[r] - at(-h)[r]) / (2.0 * h);
                    let narrow = (at(k)[r] - at(-k)[r]) / (2.0 * k);
                    let difference = (4.0 * narrow - wide) / 3.0;
                    let scale = 1.0 + term.residual[r].abs() / 0.05;
                    prop_assert!(
                        (difference - term.slope[r][n]).abs() < 1e-5 * scale * (1.0 + difference.abs()),
                        "{name} vertex {n}: {difference} against {}", term.slope[r][n]
                    );
                }
            }
        }
    }

    #[test]
    fn turning_and_shifting_change_nothing_and_scaling_follows_a_power(
        points in four_points(), angle in 0.0..6.3f64, scale in 0.2..5.0f64
    ) {
        let (s, c) = angle.sin_cos();
        let moved = points.map(|[x, y]| [c * x - s * y + 3.0, s * x + c * y - 1.0]);
        let grown = points.map(|p| p.map(|x| x * scale));
        let mirrored = points.map(|[x, y]| [y, x]);
        let reversed = |energy: &dyn CurveEnergy| match energy.support() {
            Support::Neighbours => [points[2], points[1], points[0], points[3]],
            Support::NextTwo => [points[3], points[2], points[1], points[0]],
        };
        for (name, energy, power) in energies() {
            let rho = energy.rho(&points);
            prop_assert!(close(energy.rho(&moved), rho, 1e-9), "{name} turned");
            prop_assert!(close(energy.rho(&mirrored), rho, 1e-9), "{name} mirrored");
            prop_assert!(close(energy.rho(&reversed(energy.as_ref())), rho, 1e-9), "{name} reversed");
            prop_assert!(close(energy.rho(&grown), rho * scale.powi(power), 1e-9), "{name} scaled");
        }
    }

    #[test]
    fn straight_lines_cost_nothing_however_their_vertices_are_spaced(
        angle in 0.0..6.3f64, first in 0.003..1.5f64, second in 0.003..1.5f64
    ) {
        let on_line = [-first, 0.0, second, second + 0.7].map(|l| [l * angle.cos(), l * angle.sin()]);
        for (name, energy, _) in energies() {
            let straight = name != "linear Uniform" && name != "linear Centripetal";
            if straight {
                prop_assert!(energy.rho(&on_line) < 1e-18, "{name}: {}", energy.rho(&on_line));
            } else if (first / second).ln().abs() > 0.1 {
                prop_assert!(energy.rho(&on_line) > 1e-8, "{name} is not blind to the spacing");
            }
        }
    }
}

#[test]
fn samples_of_a_circle_give_its_curvature() {
    for radius in [3.0f64, 20.0] {
        // Even and uneven steps; the error is of second order in them.
        for step in [0.04, 0.02] {
            for ratio in [1.0, 1.7] {
                let at = |a: f64| [radius * a.cos(), radius * a.sin()];
                let angles = [0.0, 1.0, 1.0 + ratio, 2.0 + ratio];
                let points = angles.map(|a| at(0.3 + step * a));
                let size = step * ratio;
                for parameter in PARAMETERS {
                    // Only chord length follows uneven steps to first order.
                    if ratio == 1.0 || parameter == Parameter::Chord {
                        let rho = Curvature { parameter }.rho(&points);
                        assert!(close(rho * radius * radius, 1.0, size * size), "{parameter:?}");
                    }
                }
                let lengths = radius * step * (1.0 + ratio) / 2.0;
                let expected = lengths / (radius * radius);
                assert!(close(Bending.rho(&points) / expected, 1.0, size * size));
            }
        }
    }
}

#[test]
fn linear_with_a_uniform_parameter_is_the_second_difference() {
    let points: [Point2; 4] = [[0.3, 1.0], [0.9, 2.0], [2.0, 2.2], [3.0, 0.1]];
    let second = [0, 1].map(|k: usize| points[0][k] - 2.0 * points[1][k] + points[2][k]);
    let expected = 16.0 * (second[0].powi(2) + second[1].powi(2));
    assert!(close(Linear::default().rho(&points), expected, 1e-14));
}

proptest! {
    #[test]
    fn several_stencils_at_a_time_are_each_as_one_alone(
        all in proptest::collection::vec(four_points(), LANES),
        moves in proptest::array::uniform4(0usize..2)
    ) {
        let moves = moves.map(along);
        let lanes = |n: usize, k: usize| -> Lanes<f64> { std::array::from_fn(|l| all[l][n][k]) };
        let points = [0, 1, 2, 3].map(|n| [0, 1].map(|k| lanes(n, k)));
        let stencils = Stencil { points, moves: moves.map(|m| m.map(|x| [x; LANES])) };
        let single = Stencil {
            points: points.map(|p| p.map(|v| v.map(|x| x as f32))),
            moves: stencils.moves.map(|p| p.map(|v| v.map(|x| x as f32))),
        };
        for (name, energy, _) in energies() {
            let (double, single) = (energy.terms_double(&stencils), energy.terms_single(&single));
            for (l, points) in all.iter().enumerate() {
                let term = energy.term(&Stencil { points: *points, moves });
                for r in 0..2 {
                    prop_assert_eq!(double.residual[r][l], term.residual[r], "{}", name);
                    for n in 0..4 {
                        prop_assert_eq!(double.slope[r][n][l], term.slope[r][n], "{}", name);
                        // Curvature has no bound where a curve turns back.
                        if name.starts_with("curvature") {
                            continue;
                        }
                        let scale = 1.0 + term.slope[r].iter().fold(0.0, |m: f64, s| m.max(s.abs()));
                        let error = (f64::from(single.slope[r][n][l]) - term.slope[r][n]).abs();
                        prop_assert!(error < 2e-2 * scale, "{name}: {error:e} of {scale}");
                    }
                }
            }
        }
    }
}
