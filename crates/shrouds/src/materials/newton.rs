//! Steps on all unknowns at once: Gauss–Newton with conjugate gradients, within the box.

use crate::materials::interfaces::Interfaces;
use crate::materials::model::Model;
use crate::materials::network::{JUNCTION, Network};
use crate::materials::problem::Problem;
use crate::parallel::{self, NONE};

/// A step covers at most this part of the way to a bound.
const MOST_OF_THE_WAY: f32 = 0.95;
/// Chords shorter than this part of the smallest spacing, and turns with a cosine below, are looked at
/// crossing by crossing: there the model is worth little.
const SHORT_CHORD: f64 = 0.1;
const SHARP_TURN: f64 = 0.3;
/// What counts of a move at most, when the moves are judged.
const FAR: f64 = 0.01;

/// How much goes into a step.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    pub(super) iterations: usize,
    /// Stop when the preconditioned residual has fallen to this part.
    pub(super) reduction: f64,
}

/// Vectors of the conjugate gradients.
pub(super) struct Newton {
    pub(super) model: Model,
    bounds: [f64; 2],
    step: Vec<f32>,
    residual: Vec<f32>,
    direction: Vec<f32>,
    image: Vec<f32>,
    /// Inverse of the diagonal; 0 for what a bound holds.
    inverse: Vec<f32>,
}

/// A step that lowered the energy to this, and the root mean square of the moves.
pub(super) struct Step {
    pub(super) energy: f64,
    pub(super) moved: f64,
}

impl Newton {
    pub(super) fn new(interfaces: &Interfaces, network: &Network, bounds: [f64; 2]) -> Self {
        let zeros = || vec![0.0; network.unknown_count()];
        Self {
            model: Model::new(interfaces, network),
            bounds,
            step: zeros(),
            residual: zeros(),
            direction: zeros(),
            image: zeros(),
            inverse: zeros(),
        }
    }

    /// One step from `x`, where the model was linearised and has this energy; none if it would not
    /// lower it. The model is linearised where `x` is then.
    pub(super) fn step(
        &mut self,
        problem: &Problem,
        x: &mut Vec<f64>,
        energy: f64,
        effort: &Effort,
    ) -> Option<Step> {
        self.model.differentiate(problem.network, x);
        self.solve(problem.network, x, effort);
        let [low, high] = self.bounds;
        for part in [1.0, 0.3, 0.1, 0.0] {
            let mut new = x.clone();
            parallel::update(&mut new, |i, x| {
                *x = (*x + part * f64::from(self.step[i])).clamp(low, high);
            });
            self.repair(problem, &mut new);
            let found = self.model.linearise(problem, &new);
            if found < energy {
                let square = |(a, b): (&f64, &f64)| (a - b).abs().min(FAR).powi(2);
                let moved: f64 = x.iter().zip(&new).map(square).sum();
                *x = new;
                return Some(Step { energy: found, moved: (moved / x.len() as f64).sqrt() });
            }
        }
        self.model.linearise(problem, x);
        None
    }

    /// Minimises the model over the steps, approximately, and cuts the step to the room there is.
    fn solve(&mut self, network: &Network, x: &[f64], effort: &Effort) {
        let mut norm = self.start(x);
        let goal = norm * effort.reduction * effort.reduction;
        for _ in 0..effort.iterations {
            if norm <= goal {
                break;
            }
            let curvature = self.model.image(network, &self.direction, &mut self.image);
            if curvature <= 0.0 {
                break;
            }
            let next = self.advance((norm / curvature) as f32);
            let ratio = (next / norm) as f32;
            norm = next;
            let (inverse, residual) = (&self.inverse, &self.residual);
            parallel::update_blocks(&mut self.direction, NONE, |first, direction, []| {
                for (n, direction) in direction.iter_mut().enumerate() {
                    *direction = inverse[first + n] * residual[first + n] + ratio * *direction;
                }
                0.0
            });
        }
        let bounds = self.bounds;
        parallel::update(&mut self.step, |i, step| {
            let [low, high] = bounds.map(|bound| MOST_OF_THE_WAY * (bound - x[i]) as f32);
            *step = step.clamp(low.min(0.0), high.max(0.0));
        });
    }

    /// Starts from no step. Returns the squared norm of the residual as the preconditioner sees it.
    fn start(&mut self, x: &[f64]) -> f64 {
        let (model, bounds) = (&self.model, self.bounds);
        parallel::fill(&mut self.inverse, |i| {
            let (gradient, diagonal) = (model.gradient[i], model.diagonal[i]);
            let held = x[i] <= bounds[0] && gradient > 0.0 || x[i] >= bounds[1] && gradient < 0.0;
            if held || diagonal <= 0.0 { 0.0 } else { 1.0 / diagonal }
        });
        self.step.fill(0.0);
        let inverse = &self.inverse;
        let others = [&mut self.direction[..]];
        parallel::update_blocks(&mut self.residual, others, |first, residual, [direction]| {
            let mut norm = 0.0;
            for n in 0..residual.len() {
                let inverse = inverse[first + n];
                residual[n] = if inverse > 0.0 { -model.gradient[first + n] } else { 0.0 };
                direction[n] = inverse * residual[n];
                norm += f64::from(direction[n]) * f64::from(residual[n]);
            }
            norm
        })
    }

    /// Goes along the direction. Returns the new squared norm.
    fn advance(&mut self, length: f32) -> f64 {
        let (direction, image, inverse) = (&self.direction, &self.image, &self.inverse);
        let others = [&mut self.residual[..]];
        parallel::update_blocks(&mut self.step, others, |first, step, [residual]| {
            let mut norm = 0.0;
            for n in 0..step.len() {
                let i = first + n;
                step[n] += length * direction[i];
                residual[n] -= if inverse[i] > 0.0 { length * image[i] } else { 0.0 };
                norm += f64::from(residual[n]) * f64::from(residual[n]) * f64::from(inverse[i]);
            }
            norm
        })
    }

    /// Moves crossings with short chords or sharp turns alone, in order.
    fn repair(&self, problem: &Problem, x: &mut [f64]) {
        let network = problem.network;
        let awkward = |place: usize| {
            let [a, b] = problem.chords(place, x);
            let squared = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
            let (l, m) = (squared(a), squared(b));
            l.min(m) < SHORT_CHORD * SHORT_CHORD
                || a[0] * b[0] + a[1] * b[1] < SHARP_TURN * (l * m).sqrt()
        };
        let blocks = parallel::blocks(network.crossing_count(), 4096, |range| {
            range.filter(|&v| awkward(2 * v) || awkward(2 * v + 1)).collect::<Vec<_>>()
        });
        for v in blocks.into_iter().flatten() {
            self.move_alone(problem, v, x);
        }
    }

    /// Moves one crossing to a lower energy, by steps that shrink.
    fn move_alone(&self, problem: &Problem, v: usize, x: &mut [f64]) {
        let [low, high] = self.bounds;
        let energy = |x: &mut [f64], at: f64| {
            x[v] = at;
            problem.energy_around(v, x) + self.model.barrier_of(v, at)
        };
        let mut place = x[v];
        let mut least = energy(x, place);
        for step in [0.2, 0.07, 0.02, 0.005] {
            for at in [place - step, place + step].map(|at| at.clamp(low, high)) {
                let found = energy(x, at);
                if found < least {
                    (place, least) = (at, found);
                }
            }
        }
        x[v] = place;
    }
}

/// Where junctions start: at the mean of the crossings around them.
pub(super) fn place_junctions(problem: &Problem, bounds: [f64; 2], x: &mut [f64]) {
    let network = problem.network;
    for junction in 0..network.junction_count() {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for &n in network.touches_of(junction) {
            let touch = network.touches[n as usize];
            if touch.slot == 0 || touch.slot == 2 {
                let place = problem.in_face(touch.place as usize, junction, x);
                sum = [sum[0] + place[0], sum[1] + place[1]];
                count += 1.0;
            }
        }
        let first = network.unknown(junction as u32 | JUNCTION);
        for (n, sum) in sum.into_iter().enumerate() {
            x[first + n] = (sum / count).clamp(bounds[0], bounds[1]);
        }
    }
}
