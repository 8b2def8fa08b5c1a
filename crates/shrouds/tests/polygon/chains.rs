//! The convex energy of polygons, written anew.

use shrouds::energy::CurveEnergy;
use shrouds::polygon::Separation;

/// The neighbours along polygons of every vertex of the surface, and how it moves with its position.
pub(crate) struct Chains {
    pub(crate) neighbours: Vec<[usize; 2]>,
    low: Vec<[f64; 2]>,
    pub(crate) moves: Vec<[f64; 2]>,
    /// Whether δ grows with the position.
    grows: Vec<bool>,
}

impl Chains {
    pub(crate) fn new(found: &Separation) -> Self {
        let count = found.delta.len();
        let mut neighbours = vec![[0; 2]; count];
        for polygon in &found.polygons {
            let around = polygon.vertices.iter().cycle();
            for (n, &v) in polygon.vertices.iter().enumerate() {
                let last = around.clone().nth(n + polygon.vertices.len() - 1).unwrap();
                let next = around.clone().nth(n + 1).unwrap();
                neighbours[v as usize] = [*last as usize, *next as usize];
            }
        }
        let crossings: Vec<_> = found.surface.crossings().collect();
        let low = crossings.iter().map(|c| [c.low()[0] as f64, c.low()[1] as f64]).collect();
        let moves = crossings.iter().map(|c| [[1.0, 0.0], [0.0, 1.0]][c.axis()]).collect();
        Self { neighbours, low, moves, grows: crossings.iter().map(|c| !c.inside_low()).collect() }
    }

    pub(crate) fn point(&self, x: &[f64], v: usize) -> [f64; 2] {
        [0, 1].map(|k| self.low[v][k] + x[v] * self.moves[v][k])
    }

    /// The sum of ρ over all vertices.
    pub(crate) fn energy(&self, measure: &dyn CurveEnergy, x: &[f64]) -> f64 {
        let rho = |v: usize| {
            let [a, c] = self.neighbours[v];
            let [a, b, c] = [a, v, c].map(|v| self.point(x, v));
            measure.rho(&[a, b, c, c])
        };
        (0..x.len()).map(rho).sum()
    }

    /// P₀ − 2·P₁ + P₂ at a vertex.
    pub(crate) fn second(&self, x: &[f64], v: usize) -> [f64; 2] {
        let [a, c] = self.neighbours[v];
        let [a, b, c] = [a, v, c].map(|v| self.point(x, v));
        [0, 1].map(|k| a[k] - 2.0 * b[k] + c[k])
    }

    pub(crate) fn delta(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.grows).map(|(&x, &grows)| if grows { x } else { 1.0 - x }).collect()
    }
}
