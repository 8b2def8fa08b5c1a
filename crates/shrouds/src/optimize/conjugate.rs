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

/// What conjugate gradients keep of one vertex.
#[derive(Clone, Copy, Default)]
struct State {
    step: f64,
    residual: f64,
    /// The matrix times the direction.
    image: f64,
    /// Inverse of the damped diagonal; 0 for a fixed vertex.
    inverse: f64,
}

/// Working vectors, kept between steps.
pub(super) struct Workspace {
    states: Vec<State>,
    direction: Vec<f64>,
}

impl Workspace {
    pub(super) fn new(count: usize) -> Self {
        Self { states: vec![State::default(); count], direction: vec![0.0; count] }
    }

    /// The step of vertex `v` that the last call of [`Workspace::solve`] found.
    pub(super) fn step(&self, v: usize) -> f64 {
        self.states[v].step
    }

    /// Minimises the model over steps within the room, approximately.
    ///
    /// Long runs of conjugate gradients leave the box along its almost flat valleys, and cutting the
    /// step at the end would spoil it; so it is cut after every short segment, the vertices that were
    /// cut stay where they are, and the next segment starts from the corrected residual.
    pub(super) fn solve(&mut self, model: &Model, room: &Room, damping: &[f64], effort: &Effort) {
        let mut norm = self.start(model, room, damping);
        let goal = norm * effort.reduction * effort.reduction;
        for segment in 0..effort.segments {
            if norm <= goal {
                return;
            }
            norm = self.segment(model, damping, effort.segment, norm, goal);
            let cut = self.cut_to(room);
            if cut && segment + 1 < effort.segments {
                norm = self.recompute_residual(model, damping);
            }
        }
    }

    /// Starts from no step at all. Returns the squared norm of the residual in the metric of the
    /// preconditioner, as the functions below do.
    fn start(&mut self, model: &Model, room: &Room, damping: &[f64]) -> f64 {
        parallel::update_sum(&mut self.states, |v, state| {
            let gradient = model.gradient(v);
            let held =
                (room.low[v] >= 0.0 && gradient > 0.0) || (room.high[v] <= 0.0 && gradient < 0.0);
            let diagonal = model.diagonal(v) * (1.0 + damping[v]);
            let free = !held && diagonal > 0.0;
            *state = State::default();
            if free {
                state.inverse = 1.0 / diagonal;
                state.residual = -gradient;
            }
            state.residual * state.residual * state.inverse
        })
    }

    /// Conjugate gradients from the current residual.
    fn segment(
        &mut self,
        model: &Model,
        damping: &[f64],
        iterations: usize,
        mut norm: f64,
        goal: f64,
    ) -> f64 {
        let states = &self.states;
        parallel::fill(&mut self.direction, |v| states[v].inverse * states[v].residual);
        for _ in 0..iterations {
            let direction = &self.direction;
            let curvature = parallel::update_sum(&mut self.states, |v, state| {
                let free = state.inverse > 0.0;
                state.image = if free { model.product(v, direction, damping[v]) } else { 0.0 };
                state.image * direction[v]
            });
            if curvature <= 0.0 {
                break;
            }
            let length = norm / curvature;
            let next = parallel::update_sum(&mut self.states, |v, state| {
                state.step += length * direction[v];
                state.residual -= length * state.image;
                state.residual * state.residual * state.inverse
            });
            let ratio = next / norm;
            norm = next;
            if norm <= goal {
                break;
            }
            let states = &self.states;
            parallel::update(&mut self.direction, |v, direction| {
                *direction = states[v].inverse * states[v].residual + ratio * *direction;
            });
        }
        norm
    }

    /// Cuts the step to the room and fixes the vertices that were cut; whether there were any.
    fn cut_to(&mut self, room: &Room) -> bool {
        let cuts = parallel::update_sum(&mut self.states, |v, state| {
            let cut = state.step.clamp(room.low[v], room.high[v]);
            if cut == state.step {
                return 0.0;
            }
            *state = State { step: cut, ..State::default() };
            1.0
        });
        cuts > 0.0
    }

    fn recompute_residual(&mut self, model: &Model, damping: &[f64]) -> f64 {
        let states = &self.states;
        parallel::fill(&mut self.direction, |v| states[v].step);
        let step = &self.direction;
        parallel::update_sum(&mut self.states, |v, state| {
            if state.inverse > 0.0 {
                state.residual = -model.gradient(v) - model.product(v, step, damping[v]);
            }
            state.residual * state.residual * state.inverse
        })
    }
}
