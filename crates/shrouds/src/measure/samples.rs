//! Places spread over a mesh by area, and what is to be said of values there.

use crate::error::Error;
use crate::measure::nearest::doubled_area;
use crate::mesh::TriMesh;
use crate::vector::{Vector, add, length, scale, subtract};

/// A triangle is cut into no more than the square of this many pieces.
const MOST_CUTS: f64 = 256.0;

/// The triangles of a mesh, cut into equal similar ones until no edge is longer than `step`.
pub(super) fn pieces(corners: [Vector; 3], step: f64) -> impl Iterator<Item = [Vector; 3]> {
    let [a, b, c] = corners;
    let (u, v) = (subtract(b, a), subtract(c, a));
    let longest = [u, v, subtract(c, b)].map(length).into_iter().fold(0.0, f64::max);
    let cuts = (longest / step).ceil().clamp(1.0, MOST_CUTS) as usize;
    let at = move |i: usize, j: usize| {
        let [s, t] = [i, j].map(|n| n as f64 / cuts as f64);
        add(a, add(scale(u, s), scale(v, t)))
    };
    (0..cuts).flat_map(move |i| {
        (0..cuts - i).flat_map(move |j| {
            let upright = [at(i, j), at(i + 1, j), at(i, j + 1)];
            let other = (i + j + 1 < cuts).then(|| [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            [Some(upright), other].into_iter().flatten()
        })
    })
}

/// Values with the areas they stand for.
#[derive(Default)]
pub(super) struct Samples {
    values: Vec<(f64, f64)>,
}

impl Samples {
    pub(super) fn push(&mut self, value: f64, area: f64) {
        self.values.push((value, area));
    }

    pub(super) fn extend(&mut self, other: Self) {
        self.values.extend(other.values);
    }

    /// Puts the values in order, which shares need.
    pub(super) fn sort(&mut self) {
        self.values.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// All areas together.
    pub(super) fn area(&self) -> f64 {
        self.values.iter().map(|(_, area)| area).sum()
    }

    /// Sum of `f` of the values times their areas.
    pub(super) fn integral(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.values.iter().map(|(value, area)| f(*value) * area).sum()
    }

    /// The least value that this share of the area does not exceed; they must be in order.
    pub(super) fn quantile(&self, share: f64) -> f64 {
        let wanted = share * self.area();
        let mut sum = 0.0;
        let reached = |(_, area): &&(f64, f64)| {
            sum += area;
            sum >= wanted
        };
        self.values.iter().find(reached).or(self.values.last()).map_or(0.0, |(value, _)| *value)
    }

    /// The largest value; they must be in order.
    pub(super) fn largest(&self) -> f64 {
        self.values.last().map_or(0.0, |(value, _)| *value)
    }
}

/// Fails unless the mesh has area and all its vertices can be used; `step` must be positive.
pub(super) fn refuse_damage(mesh: &TriMesh, step: f64) -> Result<(), Error> {
    crate::measure::integrals::bounds(mesh)?;
    if !(step > 0.0 && step.is_finite()) {
        let value = step.to_string();
        return Err(Error::Setting { name: "the step", value, range: "a positive number" });
    }
    if mesh.triangles.iter().all(|&t| length(doubled_area(mesh.corners(t))) == 0.0) {
        return Err(Error::Mesh("it has no triangle with an area, so there is no surface".into()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_small_and_keep_the_area_and_its_side() {
        let corners = [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [1.0, 3.0, 1.0]];
        for step in [10.0, 2.0, 0.7] {
            let all: Vec<_> = pieces(corners, step).collect();
            let sum = all.iter().map(|&t| doubled_area(t)[2]).sum::<f64>();
            assert!((sum - 12.0).abs() < 1e-9, "{step}: {sum}");
            for &[a, b, c] in &all {
                assert!(doubled_area([a, b, c])[2] > 0.0);
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    assert!(length(subtract(p, q)) <= step.max(4.3), "{step}");
                    assert!(step > 5.0 || length(subtract(p, q)) <= step + 1e-12);
                }
            }
        }
    }

    #[test]
    fn quantiles_go_by_area() {
        let mut samples = Samples::default();
        [(3.0, 1.0), (1.0, 6.0), (2.0, 3.0)].iter().for_each(|&(x, a)| samples.push(x, a));
        samples.sort();
        assert_eq!(
            [0.0, 0.5, 0.7, 0.95, 1.0].map(|q| samples.quantile(q)),
            [1.0, 1.0, 2.0, 3.0, 3.0]
        );
        assert_eq!((samples.area(), samples.integral(|x| x), samples.largest()), (10.0, 15.0, 3.0));
        assert_eq!(Samples::default().quantile(0.5), 0.0);
    }
}
