//! Weighted sums of measures.

use std::ops::{Add, Mul};
use std::sync::Arc;

use crate::energy::{CurveEnergy, Support};

/// What the curves minimise: a weighted sum of measures.
///
/// ```
/// use shrouds::energy::{Bending, Energy, Variation};
///
/// let energy = Energy::from(Bending) + 0.3 * Energy::from(Variation);
/// assert_eq!(energy.parts().len(), 2);
/// ```
#[derive(Clone)]
pub struct Energy {
    parts: Vec<Part>,
}

/// One measure of an [`Energy`].
#[derive(Clone)]
pub struct Part {
    /// What is measured.
    pub measure: Arc<dyn CurveEnergy>,
    /// By what ρ is multiplied, not below 0.
    pub weight: f64,
    /// By what ρ is multiplied beside that at every single vertex; everywhere 1 if there is none.
    pub factors: Option<Arc<[f32]>>,
}

impl Energy {
    /// Its measures.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The same energy, multiplied at every vertex by a factor, not below 0: 0 switches it off there.
    /// The order is that of the vertices of the surface.
    #[must_use]
    pub fn with_factors(mut self, factors: &Arc<[f32]>) -> Self {
        for part in &mut self.parts {
            part.factors = Some(match &part.factors {
                None => Arc::clone(factors),
                Some(old) => old.iter().zip(&**factors).map(|(a, b)| a * b).collect(),
            });
        }
        self
    }

    /// The largest support of its measures.
    pub fn support(&self) -> Support {
        let supports = self.parts.iter().map(|part| part.measure.support());
        supports.max().unwrap_or(Support::Neighbours)
    }

    /// Whether it is a convex function of the positions, its weights taken as they are.
    pub fn is_convex(&self) -> bool {
        self.parts.iter().all(|part| part.measure.is_convex())
    }

    /// Whether any of its measures has Meusnier weights.
    pub(crate) fn has_meusnier_weights(&self) -> bool {
        self.parts.iter().any(|part| part.measure.meusnier_exponent() != 0.0)
    }

    /// The strength of its barrier: the largest of those of its measures.
    pub(crate) fn barrier(&self) -> f64 {
        self.parts.iter().map(|part| part.measure.barrier()).fold(0.0, f64::max)
    }
}

impl<E: CurveEnergy + 'static> From<E> for Energy {
    fn from(measure: E) -> Self {
        Self { parts: vec![Part { measure: Arc::new(measure), weight: 1.0, factors: None }] }
    }
}

impl Add for Energy {
    type Output = Self;
    fn add(mut self, mut other: Self) -> Self {
        self.parts.append(&mut other.parts);
        self
    }
}

impl Mul<Energy> for f64 {
    type Output = Energy;
    fn mul(self, mut energy: Energy) -> Energy {
        energy.parts.iter_mut().for_each(|part| part.weight *= self);
        energy
    }
}
