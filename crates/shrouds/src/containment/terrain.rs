//! Random sea floors.

use crate::containment::floor::{Depths, Floor};
use crate::error::Error;
use crate::random::uniform;

/// A fractal sea floor: waves of noise, each half as long and half as high as the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terrain {
    /// In the mean, in metres.
    pub depth: f64,
    /// How far the depth can be from the mean, in metres.
    pub relief: f64,
    /// Length of the longest wave, in metres.
    pub longest: f64,
    /// Length of the shortest wave, in metres.
    pub shortest: f64,
    /// What the noise is made of: the same seed, the same floor.
    pub seed: u64,
}

impl Terrain {
    /// Most points of the lattice of depths.
    const MOST_POINTS: f64 = 1e7;

    /// The floor of a rectangle, of which the smallest and the largest x and y are given. Places have the same
    /// depth in any rectangle, up to the interpolation between points half a shortest wave apart.
    ///
    /// # Errors
    /// [`Error::Scene`] when a number is not finite, a wave is not longer than 0, the longest is shorter than
    /// the shortest, or the rectangle holds too many of them.
    pub fn floor(&self, [low, high]: [[f64; 2]; 2]) -> Result<Floor, Error> {
        let wrong = |problem: &str| {
            let problem = format!("{problem}, not {self:?}");
            Err(Error::Scene { part: "the fractal sea floor".into(), problem })
        };
        let Self { depth, relief, longest, shortest, .. } = *self;
        if ![depth, relief, longest].iter().all(|x| x.is_finite()) {
            return wrong("its numbers must be finite");
        }
        if shortest.is_nan() || shortest <= 0.0 || longest < shortest {
            return wrong("its shortest wave must be above 0 and no longer than the longest");
        }
        let step = shortest / 2.0;
        // The lattice begins at a multiple of its step, so that it is part of one for all places.
        let first = low.map(|x| (x / step).floor());
        let counts: [f64; 2] = std::array::from_fn(|d| (high[d] / step).ceil() - first[d] + 1.0);
        if !(counts[0] * counts[1] <= Self::MOST_POINTS && counts[0] >= 1.0 && counts[1] >= 1.0) {
            return wrong("its waves must be longer, the area holds too many of them");
        }
        let dims = counts.map(|count| count as usize);
        let place = |n: usize| {
            [first[0] + (n % dims[0]) as f64, first[1] + (n / dims[0]) as f64].map(|x| x * step)
        };
        let depths = (0..dims[0] * dims[1]).map(|n| self.depth(place(n))).collect();
        Ok(Floor::Grid(Depths::new(first.map(|x| x * step), [step; 2], dims, depths)?))
    }

    fn depth(&self, place: [f64; 2]) -> f64 {
        let (mut length, mut height, mut octave) = (self.longest, 1.0, 0);
        let [mut sum, mut total] = [0.0; 2];
        while length >= self.shortest && octave < 32 {
            sum += height * self.noise(octave, place.map(|x| x / length));
            total += height;
            (length, height, octave) = (length / 2.0, height / 2.0, octave + 1);
        }
        self.depth + self.relief * sum / total
    }

    /// Smooth noise within ±1, from random numbers at the points with whole coordinates.
    fn noise(&self, octave: u64, place: [f64; 2]) -> f64 {
        let low = place.map(f64::floor);
        let [u, v] = [0, 1].map(|d: usize| {
            let t = place[d] - low[d];
            t * t * (3.0 - 2.0 * t)
        });
        let value = |i: f64, j: f64| {
            // Lattice coordinates beyond 28 bits come again.
            let [i, j] = [low[0] + i, low[1] + j].map(|x| (x as i64 as u64) & 0x0fff_ffff);
            2.0 * uniform(self.seed, octave << 56 | j << 28 | i) - 1.0
        };
        let row = |j| value(0.0, j) + u * (value(1.0, j) - value(0.0, j));
        row(0.0) + v * (row(1.0) - row(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_floor_is_the_same_in_every_rectangle_and_within_its_relief() {
        let terrain =
            Terrain { depth: 2000.0, relief: 300.0, longest: 4000.0, shortest: 400.0, seed: 5 };
        let whole = terrain.floor([[-5000.0; 2], [5000.0; 2]]).unwrap();
        let part = terrain.floor([[130.0, -777.0], [900.0, 333.0]]).unwrap();
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for n in 0..400 {
            let place = [130.0 + 770.0 * uniform(1, n), -777.0 + 1110.0 * uniform(2, n)];
            assert!((whole.depth(place) - part.depth(place)).abs() < 1e-9);
            let far = whole.depth([0, 1].map(|d| 1e4 * uniform(9 + d, n) - 5e3));
            range = [range[0].min(far), range[1].max(far)];
        }
        assert!(
            range[0] >= 1700.0 && range[1] <= 2300.0 && range[1] - range[0] > 200.0,
            "{range:?}"
        );
        let other = Terrain { seed: 6, ..terrain }.floor([[-5000.0; 2], [5000.0; 2]]).unwrap();
        assert_ne!(whole, other);
    }

    #[test]
    fn unusable_terrain_is_refused() {
        let good = Terrain { depth: 9.0, relief: 3.0, longest: 40.0, shortest: 5.0, seed: 5 };
        let area = [[0.0; 2], [100.0; 2]];
        assert!(good.floor(area).is_ok());
        for wrong in [
            Terrain { shortest: 0.0, ..good },
            Terrain { shortest: 50.0, ..good },
            Terrain { relief: f64::NAN, ..good },
            Terrain { shortest: 1e-6, ..good },
        ] {
            assert!(matches!(wrong.floor(area), Err(Error::Scene { .. })), "{wrong:?}");
        }
    }
}
