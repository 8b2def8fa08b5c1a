//! How fast sound is at which depth.

use crate::error::Error;

/// The speed of sound as a function of depth: straight between knots, constant above the first and below
/// the last one.
///
/// Where the speed grows by g per metre of depth, a ray is an arc of a circle of radius c / (g cos ε), ε
/// being its angle to the horizon and c the speed where it is: Snell's law keeps cos ε / c.
#[derive(Debug, Clone, PartialEq)]
pub struct SoundSpeed {
    layers: Vec<Layer>,
}

/// Water in which the speed is a linear function of depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Layer {
    pub(super) top: f64,
    pub(super) bottom: f64,
    /// Speed and its growth per metre of depth, from a depth within the layer.
    from: f64,
    speed: f64,
    pub(super) gradient: f64,
}

impl Layer {
    pub(super) fn speed_at(&self, depth: f64) -> f64 {
        self.speed + self.gradient * (depth - self.from)
    }
}

impl SoundSpeed {
    /// The same speed everywhere, in m/s.
    ///
    /// # Errors
    /// [`Error::Scene`] unless it is positive and finite.
    pub fn constant(speed: f64) -> Result<Self, Error> {
        Self::profile(&[[0.0, speed]])
    }

    /// Knots of depth (m) and speed (m/s), from the surface downwards.
    ///
    /// # Errors
    /// [`Error::Scene`] unless there are knots, their depths ascend and their speeds are positive and all
    /// are finite.
    pub fn profile(knots: &[[f64; 2]]) -> Result<Self, Error> {
        let wrong = |problem: String| Error::Scene { part: "the speed of sound".into(), problem };
        let (Some(&first), Some(&last)) = (knots.first(), knots.last()) else {
            return Err(wrong("it needs a knot of depth and speed at least".into()));
        };
        if let Some([depth, speed]) =
            knots.iter().find(|[depth, speed]| !(depth.is_finite() && *speed > 0.0 && *speed < 1e6))
        {
            return Err(wrong(format!(
                "it cannot be {speed} at {depth}: give a finite depth and a speed above 0"
            )));
        }
        if let Some(pair) = knots.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
            return Err(wrong(format!(
                "the depth {} follows {}: let depths ascend",
                pair[1][0], pair[0][0]
            )));
        }
        let still = |[from, speed]: [f64; 2], top, bottom| Layer {
            top,
            bottom,
            from,
            speed,
            gradient: 0.0,
        };
        let mut layers = vec![still(first, f64::NEG_INFINITY, first[0])];
        layers.extend(knots.windows(2).map(|pair| {
            let [[top, speed], [bottom, next]] = [pair[0], pair[1]];
            Layer { top, bottom, from: top, speed, gradient: (next - speed) / (bottom - top) }
        }));
        layers.push(still(last, last[0], f64::INFINITY));
        if layers.iter().all(|layer| layer.gradient == 0.0) {
            layers = vec![still(first, f64::NEG_INFINITY, f64::INFINITY)];
        }
        Ok(Self { layers })
    }

    /// The speed at a depth.
    pub fn at(&self, depth: f64) -> f64 {
        self.layers[self.index(depth)].speed_at(depth)
    }

    /// Whether rays are straight.
    pub fn is_constant(&self) -> bool {
        self.layers.len() == 1
    }

    /// The layer that holds a depth.
    pub(super) fn index(&self, depth: f64) -> usize {
        self.layers.partition_point(|layer| layer.bottom < depth).min(self.layers.len() - 1)
    }

    pub(super) fn layers(&self) -> &[Layer] {
        &self.layers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_are_joined_by_straight_lines() {
        let sound =
            SoundSpeed::profile(&[[0.0, 1500.0], [100.0, 1480.0], [300.0, 1490.0]]).unwrap();
        for (depth, speed) in [(-5.0, 1500.0), (50.0, 1490.0), (200.0, 1485.0), (900.0, 1490.0)] {
            assert_eq!(sound.at(depth), speed);
        }
        assert!(!sound.is_constant() && SoundSpeed::constant(1500.0).unwrap().is_constant());
        for wrong in [&[][..], &[[0.0, 0.0]], &[[0.0, f64::NAN]], &[[5.0, 1500.0], [5.0, 1510.0]]] {
            assert!(matches!(SoundSpeed::profile(wrong), Err(Error::Scene { .. })), "{wrong:?}");
        }
    }
}
