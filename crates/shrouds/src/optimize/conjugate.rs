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

/// What conjugate gradients keep of one vertex. In single precision, which halves the memory that
/// every iteration moves; the gradient of the next step makes up for it.
#[derive(Clone, Copy, Default)]
struct State {
    step: f32,
    residual: f32,
    /// The matrix times the direction.
    image: f32,
    /// Inverse of the diagonal; 0 for a fixed vertex.
    inverse: f32,
}

impl State {
    /// Squared residual in the metric of the preconditioner.
    fn norm_squared(&self) -> f64 {
        f64::from(self.residual * self.residual * self.inverse)
    }
}

/// Working vectors, kept between steps.
pub(super) struct Workspace {
    states: Vec<State>,
    direction: Vec<f32>,
}

impl Workspace {
    pub(super) fn new(count: usize) -> Self {
        Self { states: vec![State::default(); count], direction: vec![0.0; count] }
    }

    /// The step of vertex `v` that the last call of [`Workspace::solve`] found.
    pub(super) fn step(&self, v: usize) -> f64 {
        f64::from(self.states[v].step)
    }

    /// Minimises the model over steps within the room, approximately.
    ///
    /// Long runs of conjugate gradients leave the box along its almost flat valleys, and cutting the
    /// step at the end would spoil it; so it is cut after every short segment, the vertices that were
    /// cut stay where they are, and the next segment starts from the corrected residual.
    pub(super) fn solve(&mut self, model: &Model, room: &Room, effort: &Effort) {
        let mut norm = self.start(model, room);
        let goal = norm * effort.reduction * effort.reduction;
        for segment in 0..effort.segments {
            if norm <= goal {
                return;
            }
            norm = self.segment(model, effort.segment, norm, goal);
            let cut = self.cut_to(room);
            if cut && segment + 1 < effort.segments {
                norm = self.recompute_residual(model);
            }
        }
    }

    /// Starts from no step at all. Returns the squared norm of the residual in the metric of the
    /// preconditioner, as the functions below do.
    fn start(&mut self, model: &Model, room: &Room) -> f64 {
        parallel::update_sum(&mut self.states, |v, state| {
            let gradient = model.gradient(v);
            let held =
                (room.low[v] >= 0.0 && gradient > 0.0) || (room.high[v] <= 0.0 && gradient < 0.0);
            let diagonal = model.diagonal(v);
            let free = !held && diagonal > 0.0;
            *state = State::default();
            if free {
                state.inverse = (1.0 / diagonal) as f32;
                state.residual = -gradient as f32;
            }
            state.norm_squared()
        })
    }

    /// Conjugate gradients from the current residual.
    fn segment(&mut self, model: &Model, iterations: usize, mut norm: f64, goal: f64) -> f64 {
        let states = &self.states;
        parallel::fill(&mut self.direction, |v| states[v].inverse * states[v].residual);
        for _ in 0..iterations {
            let direction = &self.direction;
            let curvature = parallel::update_sum(&mut self.states, |v, state| {
                let free = state.inverse > 0.0;
                state.image = if free { model.product(v, direction) } else { 0.0 };
                f64::from(state.image * direction[v])
            });
            if curvature <= 0.0 {
                break;
            }
            let length = (norm / curvature) as f32;
            let next = parallel::update_sum(&mut self.states, |v, state| {
                state.step += length * direction[v];
                state.residual -= length * state.image;
                state.norm_squared()
            });
            let ratio = (next / norm) as f32;
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
            let cut = state.step.clamp(room.low[v] as f32, room.high[v] as f32);
            if cut == state.step {
                return 0.0;
            }
            *state = State { step: cut, ..State::default() };
            1.0
        });
        cuts > 0.0
    }

    fn recompute_residual(&mut self, model: &Model) -> f64 {
        let states = &self.states;
        parallel::fill(&mut self.direction, |v| states[v].step);
        let step = &self.direction;
        parallel::update_sum(&mut self.states, |v, state| {
            if state.inverse > 0.0 {
                state.residual = -model.gradient(v) as f32 - model.product(v, step);
            }
            state.norm_squared()
        })
    }
}
