//! The energies against formulas: derivatives, circles, lines, and how they scale.

use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;
use shrouds::energy::{
    Angle, Bending, Curvature, CurveEnergy, Custom, LANES, Lanes, Length, Linear, Parameter,
    Point2, Scalar, Slope, Stencil, Stretch, Support, Variation,
};

/// An energy with what should hold for it.
struct Case {
    name: String,
    energy: Box<dyn CurveEnergy>,
    /// The power of a length scale that ρ follows.
    power: i32,
    /// Whether ρ is 0 on straight lines, however the vertices are spaced.
    straight: bool,
    /// Whether ρ is the same for a curve traversed the other way.
    reversible: bool,
}

/// A closure as users write them: the area of the triangle, squared, over its size: Menger's
/// curvature tamed.
fn menger() -> impl CurveEnergy {
    Custom::new("menger", Support::Neighbours, |[a, b, c, _]: [Point2<Slope>; 4]| {
        let chord = |a: Point2<Slope>, b: Point2<Slope>| [b[0] - a[0], b[1] - a[1]];
        let [u, v, w] = [chord(a, b), chord(b, c), chord(a, c)];
        let squared = |u: Point2<Slope>| u[0] * u[0] + u[1] * u[1];
        let area = u[0] * v[1] - u[1] * v[0];
        let size = squared(u) + squared(v) + squared(w) + Slope::constant(1e-24);
        [area / size.sqrt(), Slope::constant(0.0)]
    })
}

fn energies() -> Vec<Case> {
    let case = |energy: Box<dyn CurveEnergy>, power, straight, reversible| Case {
        name: energy.name(),
        energy,
        power,
        straight,
        reversible,
    };
    let mut all = vec![
        case(Box::new(Bending), -1, true, true),
        case(Box::new(Variation), -1, true, true),
        case(Box::new(Angle::Squared), 0, true, true),
        case(Box::new(Angle::Cosine), 0, true, true),
        // The chord after the vertex becomes the one before it.
        case(Box::new(Length), 1, false, false),
        case(Box::new(menger()), 2, true, true),
    ];
    for parameter in Parameter::ALL {
        let keeps_lines = !matches!(parameter, Parameter::Uniform | Parameter::Centripetal);
        let reversible = parameter != Parameter::Affine;
        all.push(case(Box::new(Curvature { parameter }), -2, true, reversible));
        all.push(case(Box::new(Linear { parameter }), 2, keeps_lines, reversible));
        all.push(case(Box::new(Stretch { parameter }), 2, false, reversible));
    }
    all
}

/// The turning angles at the second and third of four vertices.
fn turnings(points: &[Point2; 4]) -> [f64; 2] {
    [0, 1].map(|n| {
        let [a, b, c] = [points[n], points[n + 1], points[n + 2]];
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1])
    })
}

/// Whether no turning is near one at which a formula has a kink or a jump.
fn smooth_at(points: &[Point2; 4]) -> bool {
    let kinks = [0.0, FRAC_PI_2, PI];
    turnings(points).iter().all(|t| kinks.iter().all(|kink| (t.abs() - kink).abs() > 1e-2))
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
        prop_assume!(smooth_at(&points));
        for Case { name, energy, .. } in energies() {
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
        // Where a curve turns back onto itself curvature has a pole, cut off at an absolute height.
        prop_assume!((points[2][0] - points[0][0]).hypot(points[2][1] - points[0][1]) > 0.02);
        prop_assume!(turnings(&points)[0].abs() < PI - 0.1);
        let (s, c) = angle.sin_cos();
        let moved = points.map(|[x, y]| [c * x - s * y + 3.0, s * x + c * y - 1.0]);
        let grown = points.map(|p| p.map(|x| x * scale));
        let mirrored = points.map(|[x, y]| [y, x]);
        let reversed = |energy: &dyn CurveEnergy| match energy.support() {
            Support::Neighbours => [points[2], points[1], points[0], points[3]],
            Support::NextTwo => [points[3], points[2], points[1], points[0]],
        };
        for Case { name, energy, power, reversible, .. } in energies() {
            let rho = energy.rho(&points);
            prop_assert!(close(energy.rho(&moved), rho, 1e-9), "{name} turned");
            prop_assert!(close(energy.rho(&mirrored), rho, 1e-9), "{name} mirrored");
            if reversible {
                let back = energy.rho(&reversed(energy.as_ref()));
                prop_assert!(close(back, rho, 1e-9), "{name} reversed");
            }
            prop_assert!(close(energy.rho(&grown), rho * scale.powi(power), 1e-9), "{name} scaled");
        }
    }

    #[test]
    fn straight_lines_cost_nothing_however_their_vertices_are_spaced(
        angle in 0.0..6.3f64, first in 0.003..1.5f64, second in 0.003..1.5f64
    ) {
        let on_line = [-first, 0.0, second, second + 0.7].map(|l| [l * angle.cos(), l * angle.sin()]);
        for Case { name, energy, straight, .. } in energies() {
            if straight {
                // The affine metric of a line is a small difference.
                let tolerance = if name.contains("affine") { 1e-15 } else { 1e-18 };
                let rho = energy.rho(&on_line);
                prop_assert!(rho < tolerance, "{name}: {rho:e}");
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
                for parameter in Parameter::ALL {
                    // Only chord length follows uneven steps to first order.
                    if ratio == 1.0 && parameter != Parameter::Affine
                        || parameter == Parameter::Chord
                    {
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
        // As single precision has them, so that its arithmetic alone is judged.
        let single = |x: f64| f64::from(x as f32);
        let all: Vec<[Point2; 4]> = all.iter().map(|p| p.map(|p| p.map(single))).collect();
        let lanes = |n: usize, k: usize| -> Lanes<f64> { std::array::from_fn(|l| all[l][n][k]) };
        let points = [0, 1, 2, 3].map(|n| [0, 1].map(|k| lanes(n, k)));
        let stencils = Stencil { points, moves: moves.map(|m| m.map(|x| [x; LANES])) };
        let single = Stencil {
            points: points.map(|p| p.map(|v| v.map(|x| x as f32))),
            moves: stencils.moves.map(|p| p.map(|v| v.map(|x| x as f32))),
        };
        for Case { name, energy, .. } in energies() {
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

#[test]
fn closed_forms() {
    // A right angle between chords of lengths 1 and 3, and then straight on.
    let corner: [Point2; 4] = [[0.0, 1.0], [0.0, 0.0], [3.0, 0.0], [4.0, 0.0]];
    let rho = |energy: &dyn CurveEnergy| energy.rho(&corner);
    assert!(close(rho(&Angle::Squared), FRAC_PI_2 * FRAC_PI_2, 1e-14));
    assert!(close(rho(&Angle::Cosine), 1.0, 1e-14));
    assert!(close(rho(&Length), 3.0, 1e-14));
    // ẋ of the uniform quadratic is P₂ − P₀.
    assert!(close(rho(&Stretch::default()), 10.0, 1e-14));
    // With t = ¼ it is (P₁ − P₀)·3 + (P₂ − P₁)/3.
    assert!(close(rho(&Stretch { parameter: Parameter::Chord }), 9.0 + 1.0, 1e-14));
}

#[test]
fn the_cosine_of_the_interior_angle_is_what_its_name_says() {
    for n in 1..32 {
        let phi = f64::from(n) * PI / 32.0;
        let points = [[2.0, 0.0], [0.0, 0.0], [0.5 * phi.cos(), 0.5 * phi.sin()], [9.0, 9.0]];
        assert!(close(Angle::Cosine.rho(&points), 1.0 + phi.cos(), 1e-14));
        assert!(close(Angle::Squared.rho(&points), (PI - phi).powi(2), 1e-14));
    }
}

#[test]
fn lengths_add_up_to_the_perimeter_and_their_model_lies_above() {
    let polygon: Vec<Point2> =
        (0..7).map(f64::from).map(|t| [(0.9 * t).cos() * (2.0 + t), (0.9 * t).sin()]).collect();
    let at = |n: usize| polygon[n % polygon.len()];
    let distance = |a: Point2, b: Point2| (a[0] - b[0]).hypot(a[1] - b[1]);
    let expected: f64 = (0..7).map(|n| distance(at(n), at(n + 1))).sum();
    let sum: f64 = (0..7).map(|n| Length.rho(&[at(n), at(n + 1), at(n + 2), at(n + 3)])).sum();
    assert!(close(sum, expected, 1e-14));
    // |c + m| never exceeds |r + J·m|².
    let points: [Point2; 4] = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]];
    let moves = [[0.0, 0.0], [0.0, 0.0], [0.6, 0.8], [0.0, 0.0]];
    let term = Length.term(&Stencil { points, moves });
    for n in -20..20 {
        let step = 0.2 * f64::from(n);
        let moved = [points[0], points[1], [2.0 + 0.6 * step, 0.8 * step], points[3]];
        let model: f64 = (0..2).map(|r| (term.residual[r] + term.slope[r][2] * step).powi(2)).sum();
        assert!(Length.rho(&moved) <= model + 1e-12, "step {step}");
    }
}

/// Stencils where something is 0, and what the margin of δ allows at worst.
fn degenerate() -> Vec<[Point2; 4]> {
    let (o, x) = ([0.0, 0.0], [1.0, 0.0]);
    let (near, beside) = ([0.002, 0.0], [0.0, 0.002]);
    vec![
        [o, o, o, o],
        [o, o, x, [2.0, 0.0]],
        [o, x, x, [2.0, 0.0]],
        [o, x, [2.0, 0.0], [2.0, 0.0]],
        [o, o, o, x],
        [x, o, o, o],
        // Back and forth, on the same way and beside it.
        [o, x, o, x],
        [o, x, [0.3, 0.0], x],
        [o, x, beside, x],
        [near, x, o, x],
        // Around a lattice point at the margin.
        [near, beside, [-0.002, 0.0], [0.0, -0.002]],
        [near, beside, [1.0, 0.002], [1.998, 1.0]],
        [[1.0, 0.5], near, beside, [0.5, 1.0]],
        [o, x, [2.0, 0.0], [3.0, 0.0]],
        [o, [1e-9, 0.0], [1e-9, 1e-9], x],
        [[5e3; 2], [5e3 + 0.002, 5e3], [5e3, 5e3 + 0.002], [5e3, 5e3 + 1.0]],
    ]
}

#[test]
fn degenerate_stencils_give_finite_numbers() {
    for points in degenerate() {
        for moves in [[0, 0, 0, 0], [0, 1, 0, 1], [1, 1, 0, 0], [1, 0, 0, 1], [1, 1, 1, 1]] {
            let moves = moves.map(along);
            let single = Stencil {
                points: points.map(|p| p.map(|x| [x as f32; LANES])),
                moves: moves.map(|p| p.map(|x| [x as f32; LANES])),
            };
            for Case { name, energy, .. } in energies() {
                let rho = energy.rho(&points);
                assert!(rho.is_finite() && rho >= 0.0, "{name} {points:?}: {rho}");
                let term = energy.term(&Stencil { points, moves });
                let all = term.residual.iter().chain(term.slope.iter().flatten());
                assert!(all.copied().all(f64::is_finite), "{name} {points:?}: {term:?}");
                let term = energy.terms_single(&single);
                let mut all = term.residual.iter().chain(term.slope.iter().flatten()).flatten();
                assert!(all.all(|x| x.is_finite()), "{name} {points:?}: {term:?}");
            }
        }
    }
}
