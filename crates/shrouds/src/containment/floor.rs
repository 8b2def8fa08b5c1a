//! How deep the sea is where.

use std::ops::Range;

use crate::error::Error;
use crate::vector::dot;

/// The depth of the sea floor as a function of x and y.
#[derive(Debug, Clone, PartialEq)]
pub enum Floor {
    /// A plane: the depth at x = y = 0, and how much deeper it is a metre to the east and to the north.
    Plane {
        /// In metres.
        depth: f64,
        /// Growth of the depth along x and y, in metres per metre.
        slope: [f64; 2],
    },
    /// A straight ridge on level ground, with the cross-section of a bell:
    /// depth − height · exp(−(distance / width)²).
    Ridge {
        /// Of the level ground, in metres.
        depth: f64,
        /// Of the ridge above it, in metres; negative for a trench.
        height: f64,
        /// Distance from its middle where it has lost all but 1/e of its height, in metres.
        width: f64,
        /// x and y of a point on its middle line.
        through: [f64; 2],
        /// Course of its middle line, in degrees.
        course: f64,
    },
    /// Depths on a lattice of their own.
    Grid(Depths),
}

/// Depths at the points of a rectangular lattice: bilinear between its points, and beyond them as deep as at the
/// nearest place on its border.
#[derive(Debug, Clone, PartialEq)]
pub struct Depths {
    from: [f64; 2],
    spacing: [f64; 2],
    dims: [usize; 2],
    depths: Vec<f64>,
}

impl Floor {
    /// Level ground.
    pub fn flat(depth: f64) -> Self {
        Self::Plane { depth, slope: [0.0; 2] }
    }

    /// The depth below a place, in metres; not above 0 where there is land.
    pub fn depth(&self, place: [f64; 2]) -> f64 {
        match self {
            Self::Plane { depth, slope } => depth + dot(*slope, place),
            Self::Ridge { depth, height, width, .. } => {
                depth - height * (-(self.distance_to_middle(place) / width).powi(2)).exp()
            }
            Self::Grid(depths) => depths.at(place),
        }
    }

    /// The least and the greatest depth in a rectangle, of which the smallest and the largest x and y are
    /// given.
    pub(super) fn depths(&self, [low, high]: [[f64; 2]; 2]) -> [f64; 2] {
        let corners = [low, [high[0], low[1]], [low[0], high[1]], high];
        let mut places = corners.to_vec();
        match self {
            Self::Plane { .. } => {}
            Self::Ridge { .. } => {
                // Depth falls or rises with the distance from the middle, which is 0 if signs differ.
                let sides = corners.map(|corner| self.distance_to_middle(corner));
                let [first, ..] = sides;
                if sides.iter().any(|side| side * first <= 0.0) {
                    places.extend(self.middle());
                }
            }
            Self::Grid(depths) => places = depths.places_in([low, high]),
        }
        let depths = places.into_iter().map(|place| self.depth(place));
        depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], depth| {
            [least.min(depth), most.max(depth)]
        })
    }

    /// The depth where the floor is level everywhere.
    pub(super) fn level(&self) -> Option<f64> {
        match self {
            Self::Plane { depth, slope: [0.0, 0.0] } => Some(*depth),
            _ => None,
        }
    }

    /// The signed distance from the middle line of a ridge.
    fn distance_to_middle(&self, place: [f64; 2]) -> f64 {
        match self {
            Self::Ridge { through, course, .. } => {
                let (sin, cos) = course.to_radians().sin_cos();
                (place[0] - through[0]) * cos - (place[1] - through[1]) * sin
            }
            _ => 0.0,
        }
    }

    /// A place on the middle line of a ridge.
    fn middle(&self) -> Option<[f64; 2]> {
        match self {
            Self::Ridge { through, .. } => Some(*through),
            _ => None,
        }
    }

    /// Refuses numbers that make no floor.
    ///
    /// # Errors
    /// [`Error::Scene`].
    pub(super) fn check(&self) -> Result<(), Error> {
        let (numbers, positive) = match self {
            Self::Plane { depth, slope } => (vec![*depth, slope[0], slope[1]], 1.0),
            Self::Ridge { depth, height, width, through, course } => {
                (vec![*depth, *height, through[0], through[1], *course], *width)
            }
            Self::Grid(_) => return Ok(()),
        };
        if numbers.iter().all(|x| x.is_finite()) && positive > 0.0 && positive.is_finite() {
            return Ok(());
        }
        let problem = format!("{self:?} has a number that is not finite, or a width not above 0");
        Err(Error::Scene { part: "the sea floor".into(), problem })
    }
}

impl Depths {
    /// Depths in metres at `dims` points along x and y, x fastest, from a point in steps of `spacing`.
    ///
    /// # Errors
    /// [`Error::Scene`] unless there are as many depths as points, all finite, and spacings are positive.
    pub fn new(
        from: [f64; 2],
        spacing: [f64; 2],
        dims: [usize; 2],
        depths: Vec<f64>,
    ) -> Result<Self, Error> {
        let wrong =
            |problem: String| Err(Error::Scene { part: "the grid of depths".into(), problem });
        if dims.contains(&0) || dims[0].checked_mul(dims[1]) != Some(depths.len()) {
            return wrong(format!("{} depths do not fill {dims:?} points", depths.len()));
        }
        if spacing.iter().any(|step| !(*step > 0.0 && step.is_finite()))
            || from.iter().any(|x| !x.is_finite())
        {
            return wrong(format!("it cannot begin at {from:?} in steps of {spacing:?}"));
        }
        if let Some(n) = depths.iter().position(|depth| !depth.is_finite()) {
            return wrong(format!(
                "the depth at point {:?} is not finite",
                [n % dims[0], n / dims[0]]
            ));
        }
        Ok(Self { from, spacing, dims, depths })
    }

    fn at(&self, place: [f64; 2]) -> f64 {
        let [(i, u), (j, v)] = [0, 1].map(|d| {
            let last = self.dims[d] - 1;
            let at = ((place[d] - self.from[d]) / self.spacing[d]).clamp(0.0, last as f64);
            let low = (at as usize).min(last.saturating_sub(1));
            (low, at - low as f64)
        });
        let value = |i: usize, j: usize| {
            let [nx, ny] = self.dims;
            self.depths[j.min(ny - 1) * nx + i.min(nx - 1)]
        };
        let row = |j| value(i, j) + u * (value(i + 1, j) - value(i, j));
        row(j) + v * (row(j + 1) - row(j))
    }

    /// Places in a rectangle that include those of the least and of the greatest depth: a bilinear function
    /// has them in corners.
    fn places_in(&self, [low, high]: [[f64; 2]; 2]) -> Vec<[f64; 2]> {
        let [xs, ys] = [0, 1].map(|d| {
            let index = |x: f64| (x - self.from[d]) / self.spacing[d];
            let last = (self.dims[d] - 1) as f64;
            // Casts saturate.
            let inner: Range<usize> = index(low[d]).ceil().clamp(0.0, last) as usize
                ..(index(high[d]).floor().clamp(0.0, last) as usize).saturating_add(1);
            let lines = inner.map(|n| self.from[d] + n as f64 * self.spacing[d]);
            let lines = lines.filter(|x| (low[d]..=high[d]).contains(x));
            [low[d], high[d]].into_iter().chain(lines).collect::<Vec<f64>>()
        });
        xs.iter().flat_map(|&x| ys.iter().map(move |&y| [x, y])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::uniform;

    #[test]
    fn the_range_of_depths_in_a_rectangle_holds_every_depth_and_no_more() {
        let depths = (0..30).map(|n| 1000.0 + 400.0 * uniform(3, n)).collect();
        let grid = Depths::new([-250.0, -200.0], [100.0, 70.0], [6, 5], depths).unwrap();
        let through = [40.0, -30.0];
        let ridge =
            Floor::Ridge { depth: 900.0, height: 300.0, width: 80.0, through, course: 33.0 };
        let plane = Floor::Plane { depth: 700.0, slope: [0.1, -0.3] };
        for (number, floor) in [Floor::Grid(grid), ridge, plane].iter().enumerate() {
            for seed in 0..200 {
                let u = |n| 600.0 * uniform(seed, n) - 300.0;
                let low = [u(0).min(u(1)), u(2).min(u(3))];
                let high = [u(0).max(u(1)), u(2).max(u(3))];
                let [least, most] = floor.depths([low, high]);
                let mut found = [f64::INFINITY, f64::NEG_INFINITY];
                for n in 0..=40 {
                    for m in 0..=40 {
                        let place = [(n, 0), (m, 1)].map(|(n, d): (i32, usize)| {
                            low[d] + f64::from(n) / 40.0 * (high[d] - low[d])
                        });
                        let depth = floor.depth(place);
                        assert!(depth >= least - 1e-9 && depth <= most + 1e-9, "{number} {seed}");
                        found = [found[0].min(depth), found[1].max(depth)];
                    }
                }
                let width = (most - least) - (found[1] - found[0]);
                assert!(width < 0.25 * (most - least) + 1e-9, "{number} {seed}: {width}");
            }
        }
    }

    #[test]
    fn depths_go_on_beyond_their_border() {
        let grid = Depths::new([0.0; 2], [10.0; 2], [2, 1], vec![100.0, 200.0]).unwrap();
        let depth = |x, y| grid.at([x, y]);
        assert_eq!([depth(-5.0, 3.0), depth(5.0, -3.0), depth(99.0, 0.0)], [100.0, 150.0, 200.0]);
        assert!(Depths::new([0.0; 2], [10.0; 2], [2, 2], vec![1.0; 3]).is_err());
        assert!(Depths::new([0.0; 2], [10.0, 0.0], [1, 1], vec![1.0]).is_err());
        assert!(Depths::new([0.0; 2], [10.0; 2], [1, 1], vec![f64::NAN]).is_err());
    }
}
