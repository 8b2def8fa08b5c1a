//! The Gauss–Newton model of the energy at one state: rows of derivatives and what follows from them.

use crate::materials::interfaces::Interfaces;
use crate::materials::lines::JunctionLines;
use crate::materials::network::Network;
use crate::materials::problem::{Problem, Row};
use crate::parallel::{self, NONE};

/// Rows at every place, and second ones where a junction is in a stencil.
pub(super) struct Model {
    rows: Vec<Row>,
    /// See [`Problem::linearise_touches`].
    seconds: Vec<[f32; 2]>,
    lines: JunctionLines,
    /// The product of every row with a direction.
    products: Vec<[f32; 2]>,
    /// Half the derivatives of the energy, barrier included.
    pub(super) gradient: Vec<f32>,
    /// Half the second derivatives of the model.
    pub(super) diagonal: Vec<f32>,
    /// The barrier's part of the diagonal.
    stiffness: Vec<f32>,
    /// Strengths of the barrier.
    strengths: Vec<f32>,
}

/// The largest strength of the barrier that all unknowns share, see the binary solver.
const SHARED_CAP: f64 = 0.01;
/// Strength for each unit of the energy at the crossing itself.
const OWN_SHARE: f32 = 0.4;

impl Model {
    pub(super) fn new(interfaces: &Interfaces, network: &Network) -> Self {
        let zeros = || vec![0.0; network.unknown_count()];
        Self {
            rows: vec![Row::default(); network.beside.len()],
            seconds: vec![[0.0; 2]; network.touches.len()],
            lines: JunctionLines::trace(interfaces),
            products: vec![[0.0; 2]; network.beside.len()],
            gradient: zeros(),
            diagonal: zeros(),
            stiffness: zeros(),
            strengths: zeros(),
        }
    }

    /// Takes the state `x`. Returns the energy with the barrier.
    pub(super) fn linearise(&mut self, problem: &Problem, x: &[f64]) -> f64 {
        let energy = problem.linearise(x, &mut self.rows);
        problem.linearise_touches(x, &mut self.seconds);
        energy + self.lines.linearise(x) + self.barrier(x)
    }

    /// Sets the strengths of the barrier by the energies in the rows: every unknown has a share of the
    /// mean, and crossings where curves bend sharply more.
    pub(super) fn set_barrier(&mut self, problem: &Problem, x: &[f64]) -> f64 {
        let (network, rows) = (problem.network, &self.rows);
        let count = network.crossing_count().max(1);
        // On a thin ribbon only the rims bend: each place counts with what its neighbours have.
        let near = |place: usize| {
            let around = network.stencils_of(place).into_iter().take(3).flatten();
            around.map(|(place, _)| rows[place].energy()).fold(0.0, f32::max)
        };
        let mut energies = vec![0.0f32; network.crossing_count()];
        parallel::fill(&mut energies, |v| near(2 * v) + near(2 * v + 1));
        let total = parallel::sum_blocks(energies.len(), |range| {
            energies[range].iter().map(|&energy| f64::from(energy)).sum::<f64>()
        });
        let mean = total / count as f64;
        let shared = (problem.measure().barrier() * mean).min(SHARED_CAP) as f32;
        parallel::fill(&mut self.strengths, |i| match energies.get(i) {
            Some(&energy) => shared + OWN_SHARE * energy * energy.min(1.0),
            None => shared,
        });
        let energy = parallel::sum_blocks(self.rows.len(), |range| {
            self.rows[range].iter().map(|row| f64::from(row.energy())).sum::<f64>()
        });
        energy + self.lines.linearise(x) + self.barrier(x)
    }

    fn barrier(&self, x: &[f64]) -> f64 {
        parallel::sum_blocks(x.len(), |range| range.map(|i| self.barrier_of(i, x[i])).sum::<f64>())
    }

    /// The barrier of one unknown.
    pub(super) fn barrier_of(&self, unknown: usize, x: f64) -> f64 {
        -f64::from(self.strengths[unknown]) * (4.0 * x * (1.0 - x)).ln()
    }

    /// Half the gradient and the diagonal at the state of the rows.
    pub(super) fn differentiate(&mut self, network: &Network, x: &[f64]) {
        let mut gradient = std::mem::take(&mut self.gradient);
        let mut diagonal = std::mem::take(&mut self.diagonal);
        let mut stiffness = std::mem::take(&mut self.stiffness);
        let others = [&mut diagonal[..], &mut stiffness];
        parallel::update_blocks(&mut gradient, others, |first, gradient, [diagonal, stiffness]| {
            for n in 0..gradient.len() {
                let i = first + n;
                let [mut slope, mut square] = self.lines.slopes(i);
                self.for_each_derivative(network, i, |place, [a, b]| {
                    let [r, s] = self.rows[place].residual;
                    slope += a * r + b * s;
                    square += a * a + b * b;
                });
                let strength = 0.5 * f64::from(self.strengths[i]);
                let (low, high) = (1.0 / x[i], 1.0 / (1.0 - x[i]));
                gradient[n] = slope + (strength * (high - low)) as f32;
                stiffness[n] = (strength * (low * low + high * high)) as f32;
                diagonal[n] = square + stiffness[n];
            }
            0.0
        });
        (self.gradient, self.diagonal, self.stiffness) = (gradient, diagonal, stiffness);
    }

    /// Calls `f` with every place whose residuals depend on an unknown, and their derivatives.
    #[inline(always)]
    fn for_each_derivative(
        &self,
        network: &Network,
        unknown: usize,
        mut f: impl FnMut(usize, [f32; 2]),
    ) {
        let crossings = network.crossing_count();
        if unknown < crossings {
            for own in [2 * unknown, 2 * unknown + 1] {
                for (place, slot) in network.stencils_of(own).into_iter().flatten() {
                    f(place, self.rows[place].slope.map(|slope| slope[slot]));
                }
            }
            return;
        }
        let (junction, which) = ((unknown - crossings) / 2, (unknown - crossings) % 2);
        for &n in network.touches_of(junction) {
            let touch = network.touches[n as usize];
            let place = touch.place as usize;
            let derivative = match which {
                0 => self.rows[place].slope.map(|slope| slope[usize::from(touch.slot)]),
                _ => self.seconds[n as usize],
            };
            f(place, derivative);
        }
    }

    /// The matrix of the model times a direction. Returns the product of both.
    pub(super) fn image(&mut self, network: &Network, direction: &[f32], image: &mut [f32]) -> f64 {
        let rows = &self.rows;
        parallel::update_blocks(&mut self.products, NONE, |first, products, []| {
            for (n, product) in products.iter_mut().enumerate() {
                let row = &rows[first + n];
                let along =
                    network.stencil(first + n).map(|point| direction[network.unknown(point)]);
                *product = row.slope.map(|slope| {
                    slope[0] * along[0]
                        + slope[1] * along[1]
                        + slope[2] * along[2]
                        + slope[3] * along[3]
                });
            }
            0.0
        });
        for (touch, slope) in network.touches.iter().zip(&self.seconds) {
            let unknown = network.crossing_count() + 2 * touch.junction as usize + 1;
            let product = &mut self.products[touch.place as usize];
            *product = [0, 1].map(|r| product[r] + slope[r] * direction[unknown]);
        }
        self.lines.multiply(direction);
        let model = &*self;
        parallel::update_blocks(image, NONE, |first, image, []| {
            let mut sum = 0.0;
            for (n, image) in image.iter_mut().enumerate() {
                let i = first + n;
                let mut value = model.stiffness[i] * direction[i] + model.lines.image(i);
                model.for_each_derivative(network, i, |place, [a, b]| {
                    let [r, s] = model.products[place];
                    value += a * r + b * s;
                });
                *image = value;
                sum += f64::from(value) * f64::from(direction[i]);
            }
            sum
        })
    }
}
