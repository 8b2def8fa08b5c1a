//! Squared first derivative of the local quadratic: what tension adds to bending.

use crate::energy::{CurveFormula, Energy, Linear, Parameter, Point2, Scalar, Support};

/// ρ = ẋ² + ẏ² of the parametric quadratic through three vertices.
///
/// It pulls curves tight; alone it does not see zigzag. Added to [`Linear`] it makes splines in tension,
/// see [`tension`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stretch {
    /// How the quadratic is parametrised.
    pub parameter: Parameter,
}

impl Default for Stretch {
    fn default() -> Self {
        Self { parameter: Parameter::Uniform }
    }
}

impl CurveFormula for Stretch {
    #[inline]
    fn residual<S: Scalar>(&self, points: [Point2<S>; 4]) -> [S; 2] {
        let [first, _] = self.parameter.derivatives(points);
        first
    }

    fn support(&self) -> Support {
        self.parameter.support()
    }

    fn name(&self) -> String {
        format!("stretch({})", self.parameter)
    }

    fn is_convex(&self) -> bool {
        self.parameter == Parameter::Uniform
    }
}

/// Splines in tension (paper, section 5): [`Linear`] + `nu`·[`Stretch`]. `nu` has no unit and is not
/// below 0.
///
/// For a tension that differs from vertex to vertex, give the second its factors:
///
/// ```
/// use std::sync::Arc;
/// use shrouds::energy::{Energy, Linear, Stretch};
///
/// let nu: Arc<[f32]> = vec![0.1, 0.5, 0.0].into();
/// let energy = Energy::from(Linear::default()) + Energy::from(Stretch::default()).with_factors(&nu);
/// # assert_eq!(energy.parts().len(), 2);
/// ```
pub fn tension(nu: f64, parameter: Parameter) -> Energy {
    Energy::from(Linear { parameter }) + nu * Energy::from(Stretch { parameter })
}
