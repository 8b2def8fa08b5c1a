//! Conjugate gradients on the Gauss–Newton model, within the box.

use crate::optimize::model::Model;
use crate::parallel;

/// Room that the positions have: each step component must stay between these.
pub(super) struct Room {
    pub(super) low: Vec<f64>,
    pub(super) high: Vec<f64>,
}

/// Effort spent on one step.
pub(super) struct Effort {
    /// Iterations before the step is cut to the box and the vertices that left it are fixed.
    pub(super) segment: usize,
    pub(super) segments: usize,
    /// Stop when the preconditioned residual has fallen to this part of its first norm.
    pub(super) reduction: f64,
}

/// Working vectors, kept between steps.
pub(super) struct Workspace {
    pub(super) step: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    /// Inverse of the damped diagonal; 0 for a fixed vertex.
    inverse: Vec<f64>,
}

impl Workspace {
    pub(super) fn new(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        Self {
            step: zeros(),
            residual: zeros(),
            direction: zeros(),
            image: zeros(),
            inverse: zeros(),
        }
    }

    /// Minimises the model over steps within the room, approximately. `self.step` is the result.
    ///
    /// Long runs of conjugate gradients leave the box along its almost flat valleys, and cutting the
    /// step at the end would spoil it; so it is cut after every short segment, the vertices that were
    /// cut stay where they are, and the next segment starts from the corrected residual.
    pub(super) fn solve(&mut self, model: &Model, room: &Room, damping: f64, effort: &Effort) {
        self.start(model, room, damping);
        let first = self.norm_squared();
        let goal = first * effort.reduction * effort.reduction;
        let mut norm = first;
        for segment in 0..effort.segments {
            if norm <= goal {
                return;
            }
            norm = self.segment(model, damping, effort.segment, norm, goal);
            let cut = self.cut_to(room);
            if cut && segment + 1 < effort.segments {
                self.recompute_residual(model, damping);
                norm = self.norm_squared();
            }
        }
    }

    fn start(&mut self, model: &Model, room: &Room, damping: f64) {
        self.step.fill(0.0);
        parallel::fill(&mut self.inverse, |v| {
            let gradient = model.gradient(v);
            let held = (room.low[v] >= 0.0 && gradient > 0.0)
                || (room.high[v] <= 0.0 && gradient < 0.0);
            let diagonal = model.diagonal(v) * (1.0 + damping);
            if held || diagonal <= 0.0 { 0.0 } else { 1.0 / diagonal }
        });
        let inverse = &self.inverse;
        parallel::fill(&mut self.residual, |v| {
            if inverse[v] == 0.0 { 0.0 } else { -model.gradient(v) }
        });
    }

    /// Conjugate gradients from the current residual; returns its new squared norm.
    fn segment(
        &mut self,
        model: &Model,
        damping: f64,
        iterations: usize,
        mut norm: f64,
        goal: f64,
    ) -> f64 {
        let (residual, inverse) = (&self.residual, &self.inverse);
        parallel::fill(&mut self.direction, |v| inverse[v] * residual[v]);
        for _ in 0..iterations {
            let direction = &self.direction;
            let inverse = &self.inverse;
            parallel::fill(&mut self.image, |v| {
                if inverse[v] == 0.0 { 0.0 } else { model.product(v, direction, damping) }
            });
            let image = &self.image;
            let curvature = parallel::sum(image.len(), |v| image[v] * direction[v]);
            if curvature <= 0.0 {
                break;
            }
            let length = norm / curvature;
            parallel::update(&mut self.step, |v, s| *s += length * direction[v]);
            parallel::update(&mut self.residual, |v, r| *r -= length * image[v]);
            let next = self.norm_squared();
            let ratio = next / norm;
            norm = next;
            if norm <= goal {
                break;
            }
            let (residual, inverse) = (&self.residual, &self.inverse);
            parallel::update(&mut self.direction, |v, d| {
                *d = inverse[v] * residual[v] + ratio * *d;
            });
        }
        norm
    }

    /// Squared norm of the residual in the metric of the preconditioner.
    fn norm_squared(&self) -> f64 {
        let (residual, inverse) = (&self.residual, &self.inverse);
        parallel::sum(residual.len(), |v| residual[v] * residual[v] * inverse[v])
    }

    /// Cuts the step to the room and fixes the vertices that were cut; whether there were any.
    fn cut_to(&mut self, room: &Room) -> bool {
        let mut any = false;
        for (v, step) in self.step.iter_mut().enumerate() {
            let cut = step.clamp(room.low[v], room.high[v]);
            if cut != *step {
                *step = cut;
                self.inverse[v] = 0.0;
                any = true;
            }
        }
        any
    }

    fn recompute_residual(&mut self, model: &Model, damping: f64) {
        let (step, inverse) = (&self.step, &self.inverse);
        parallel::fill(&mut self.residual, |v| {
            if inverse[v] == 0.0 {
                0.0
            } else {
                -model.gradient(v) - model.product(v, step, damping)
            }
        });
    }
}
