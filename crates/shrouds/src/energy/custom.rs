//! A measure given by a closure.

use crate::energy::{CurveEnergy, LANES, Lanes, Point2, Slope, Stencil, Support, Term};

/// A measure of one's own as a function: two numbers the sum of whose squares is ρ at the second of
/// four successive vertices. The numbers it reckons with carry their derivatives.
///
/// It is evaluated vertex by vertex and in double precision. [`CurveFormula`](crate::energy::CurveFormula)
/// is the faster way.
///
/// ```
/// use shrouds::energy::{Custom, Energy, Scalar, Slope, Support};
///
/// // How far a vertex lies from the middle of its neighbours.
/// let midpoint = Custom::new("midpoint", Support::Neighbours, |[a, b, c, _]| {
///     [0, 1].map(|k| b[k] - Slope::constant(0.5) * (a[k] + c[k]))
/// });
/// let energy = Energy::from(midpoint) + 0.1 * "bending".parse::<Energy>()?;
/// assert_eq!(energy.to_string(), "midpoint+0.1*bending");
/// let rho = energy.parts()[0].measure.rho(&[[0.0, 0.0], [1.0, 0.5], [2.0, 0.0], [3.0, 0.0]]);
/// assert_eq!(rho, 0.25);
/// # Ok::<(), shrouds::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Custom<F> {
    name: String,
    support: Support,
    residual: F,
    meusnier_exponent: f64,
    barrier: f64,
}

impl<F: Fn([Point2<Slope>; 4]) -> [Slope; 2] + Send + Sync> Custom<F> {
    /// A measure with neither Meusnier weights nor barrier. What it returns must not depend on the
    /// last vertex unless `support` says so.
    pub fn new(name: impl Into<String>, support: Support, residual: F) -> Self {
        Self { name: name.into(), support, residual, meusnier_exponent: 0.0, barrier: 0.0 }
    }

    /// The same with another exponent, see
    /// [`CurveFormula::meusnier_exponent`](crate::energy::CurveFormula::meusnier_exponent).
    #[must_use]
    pub fn with_meusnier_exponent(mut self, exponent: f64) -> Self {
        self.meusnier_exponent = exponent;
        self
    }

    /// The same with another barrier, see
    /// [`CurveFormula::barrier`](crate::energy::CurveFormula::barrier).
    #[must_use]
    pub fn with_barrier(mut self, strength: f64) -> Self {
        self.barrier = strength;
        self
    }
}

impl<F: Fn([Point2<Slope>; 4]) -> [Slope; 2] + Send + Sync> CurveEnergy for Custom<F> {
    fn term(&self, stencil: &Stencil) -> Term {
        let residual = (self.residual)(stencil.with_slopes());
        Term { residual: residual.map(|r| r.value), slope: residual.map(|r| r.slope) }
    }

    fn rho(&self, points: &[Point2; 4]) -> f64 {
        let stencil = Stencil { points: *points, moves: [[0.0; 2]; 4] };
        let [a, b] = self.term(&stencil).residual;
        a * a + b * b
    }

    fn support(&self) -> Support {
        self.support
    }

    fn name(&self) -> String {
        self.name.clone()
    }

    fn terms_single(&self, stencils: &Stencil<Lanes<f32>>) -> Term<Lanes<f32>> {
        let double = stencils.map(|lanes| lanes.map(f64::from));
        self.terms_double(&double).map(|lanes| lanes.map(|x| x as f32))
    }

    fn terms_double(&self, stencils: &Stencil<Lanes<f64>>) -> Term<Lanes<f64>> {
        let zeros = [0.0; LANES];
        let mut terms = Term { residual: [zeros; 2], slope: [[zeros; 4]; 2] };
        for lane in 0..LANES {
            let term = self.term(&stencils.map(|lanes| lanes[lane]));
            for r in 0..2 {
                terms.residual[r][lane] = term.residual[r];
                for n in 0..4 {
                    terms.slope[r][n][lane] = term.slope[r][n];
                }
            }
        }
        terms
    }

    fn is_convex(&self) -> bool {
        false
    }

    fn meusnier_exponent(&self) -> f64 {
        self.meusnier_exponent
    }

    fn barrier(&self) -> f64 {
        self.barrier
    }
}
