//! Conjugate gradients on the Gauss–Newton model, within the box.

use crate::network::Network;
use crate::optimize::bounds::Bounds;
use crate::optimize::model::Model;
use crate::optimize::real::Real;
use crate::parallel::{self, NONE};

/// Room that the positions have for one step.
pub(crate) struct Room<'a, R> {
    pub(crate) x: &'a [R],
    pub(crate) bounds: &'a Bounds<R>,
    /// The largest part of the way to a bound that a step may cover.
    pub(crate) part: f32,
    /// Whether a vertex must stay where it is.
    pub(crate) is_fixed: &'a [bool],
}

impl<R: Real> Room<'_, R> {
    /// Between what the step of a vertex at `x` must stay.
    #[inline(always)]
    fn around(&self, x: R) -> [f32; 2] {
        self.bounds.all.map(|bound| self.part * (bound - x).to_f64() as f32)
    }

    /// Between what the steps of the vertices from `first` on must stay for bounds of their own.
    fn own(&self, first: usize) -> impl Iterator<Item = [f32; 2]> {
        let own = self.bounds.own(first).iter().zip(&self.x[first..]);
        own.map(|(bounds, &x)| bounds.map(|bound| self.part * (bound - x).to_f64() as f32))
    }
}

/// Effort spent on one step.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// The most iterations.
    pub(crate) iterations: usize,
    /// Stop when the preconditioned residual has fallen to this part of its first norm.
    pub(crate) reduction: f64,
    /// Parts of the step that are tried until one lowers the energy.
    pub(crate) parts: &'static [f64],
    /// Whether vertices with short chords or sharp turns are moved alone afterwards.
    pub(crate) repairs: bool,
    /// Whether the step is one of many that go on until they converge.
    pub(crate) converges: bool,
}

/// Working vectors, kept between steps. In single precision, which halves the memory that every
/// iteration moves; the gradient of the next step makes up for it.
pub(crate) struct Workspace {
    step: Vec<f32>,
    residual: Vec<f32>,
    direction: Vec<f32>,
    /// The matrix times the direction.
    image: Vec<f32>,
    /// Inverse of the diagonal; 0 for a fixed vertex.
    inverse: Vec<f32>,
    /// The matrix without its diagonal times the direction, place by place.
    place_images: Vec<f32>,
}

/// See [`Workspace::solve`].
pub(crate) type Further<'a> = dyn Fn(&[f32], &mut [f32]) -> f64 + 'a;

/// Partial sums kept side by side.
const SUMS: usize = 8;

impl Workspace {
    pub(crate) fn new(network: &Network) -> Self {
        let zeros = || vec![0.0; network.vertex_count()];
        Self {
            step: zeros(),
            residual: zeros(),
            direction: zeros(),
            image: zeros(),
            inverse: zeros(),
            place_images: vec![0.0; network.vertices().len()],
        }
    }

    /// The steps of all vertices that the last call of [`Workspace::solve`] found.
    pub(crate) fn steps(&self) -> &[f32] {
        &self.step
    }

    /// Minimises the model over all steps, approximately, and cuts the step to the room. `further` adds
    /// to an image what couples unknowns beyond the curves, and returns its product with the direction.
    pub(crate) fn solve<R: Real>(
        &mut self,
        model: &Model<R>,
        network: &Network,
        room: &Room<R>,
        effort: &Effort,
        further: &Further,
    ) {
        let norm = self.start(model, room);
        let goal = norm * effort.reduction * effort.reduction;
        if norm > goal {
            self.iterate(model, network, effort.iterations, [norm, goal], further);
            self.cut_to(room);
        }
    }

    /// Starts from no step at all. Returns the squared norm of the residual in the metric of the
    /// preconditioner, as the functions below do.
    fn start<R: Real>(&mut self, model: &Model<R>, room: &Room<R>) -> f64 {
        let arrays = [&mut self.residual[..], &mut self.inverse];
        parallel::update_blocks(&mut self.step, arrays, |first, step, [residual, inverse]| {
            let count = step.len();
            let (x, is_fixed) = (&room.x[first..][..count], &room.is_fixed[first..][..count]);
            let gradients = &model.gradients()[first..][..count];
            let diagonals = &model.diagonals()[first..][..count];
            let (residual, inverse) = (&mut residual[..count], &mut inverse[..count]);
            // Without branches, so that several vertices go at a time.
            for n in 0..count {
                let (gradient, diagonal) = (gradients[n].to_f64() as f32, diagonals[n]);
                let [low, high] = room.around(x[n]);
                let held = (low >= 0.0) & (gradient > 0.0) | (high <= 0.0) & (gradient < 0.0);
                let free = !(held | is_fixed[n]) & (diagonal > 0.0);
                step[n] = 0.0;
                inverse[n] = if free { 1.0 / diagonal } else { 0.0 };
                residual[n] = if free { -gradient } else { 0.0 };
            }
            for (n, [low, high]) in room.own(first).take(count).enumerate() {
                if low >= 0.0 && residual[n] < 0.0 || high <= 0.0 && residual[n] > 0.0 {
                    (residual[n], inverse[n]) = (0.0, 0.0);
                }
            }
            norm(residual, inverse)
        })
    }

    /// Conjugate gradients from a residual with a norm until it has fallen to a goal.
    fn iterate<R: Real>(
        &mut self,
        model: &Model<R>,
        network: &Network,
        iterations: usize,
        [mut norm, goal]: [f64; 2],
        further: &Further,
    ) {
        self.redirect(0.0);
        for _ in 0..iterations {
            model.images(network, &self.direction, &mut self.place_images);
            let mut curvature = self.combine(model, network);
            curvature += further(&self.direction, &mut self.image);
            if curvature <= 0.0 {
                return;
            }
            let next = self.advance((norm / curvature) as f32);
            let ratio = (next / norm) as f32;
            norm = next;
            if norm <= goal {
                return;
            }
            self.redirect(ratio);
        }
    }

    /// The next direction: the preconditioned residual and a part of the direction before.
    fn redirect(&mut self, ratio: f32) {
        let (inverse, residual) = (&self.inverse, &self.residual);
        parallel::update_blocks(&mut self.direction, NONE, |first, direction, []| {
            let count = direction.len();
            let (inverse, residual) = (&inverse[first..][..count], &residual[first..][..count]);
            for n in 0..count {
                direction[n] = inverse[n] * residual[n] + ratio * direction[n];
            }
            0.0
        });
    }

    /// Adds the parts of the image at both places of every vertex and on the diagonal. Returns the
    /// product of the image with the direction.
    fn combine<R: Real>(&mut self, model: &Model<R>, network: &Network) -> f64 {
        let (direction, images) = (&self.direction, &self.place_images);
        parallel::update_blocks(&mut self.image, NONE, |first, image, []| {
            let count = image.len();
            let diagonal = &model.diagonals()[first..][..count];
            let direction = &direction[first..][..count];
            let at_vertices = network.at_vertices(first..first + count, images);
            for (n, [a, b]) in at_vertices.enumerate() {
                image[n] = diagonal[n] * direction[n] + (a + b);
            }
            dot(image, direction)
        })
    }

    /// Goes along the direction. Returns the new squared norm.
    fn advance(&mut self, length: f32) -> f64 {
        let (direction, image, inverse) = (&self.direction, &self.image, &self.inverse);
        parallel::update_blocks(&mut self.step, [&mut self.residual], |first, step, [residual]| {
            let count = step.len();
            let direction = &direction[first..][..count];
            let (image, inverse) = (&image[first..][..count], &inverse[first..][..count]);
            for n in 0..count {
                step[n] += length * direction[n];
                residual[n] -= length * image[n];
            }
            norm(residual, inverse)
        })
    }

    /// Cuts the step to the room. A fixed vertex has none.
    fn cut_to<R: Real>(&mut self, room: &Room<R>) {
        let inverse = &self.inverse;
        parallel::update_blocks(&mut self.step, NONE, |first, step, []| {
            let count = step.len();
            let (x, inverse) = (&room.x[first..][..count], &inverse[first..][..count]);
            for n in 0..count {
                let [low, high] = room.around(x[n]);
                let within = step[n].max(low).min(high);
                step[n] = if inverse[n] > 0.0 { within } else { step[n] };
            }
            for (step, [low, high]) in step.iter_mut().zip(room.own(first)) {
                *step = step.max(low).min(high);
            }
            0.0
        });
    }
}

/// Squared residual in the metric of the preconditioner.
fn norm(residual: &[f32], inverse: &[f32]) -> f64 {
    sum_of(residual, inverse, |r, i| f64::from(r * r * i))
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    sum_of(a, b, |a, b| f64::from(a * b))
}

/// The sum of `f` over pairs, in partial sums side by side.
fn sum_of(a: &[f32], b: &[f32], f: impl Fn(f32, f32) -> f64) -> f64 {
    let mut sums = [0.0; SUMS];
    let b = &b[..a.len()];
    let mut pairs = a.chunks_exact(SUMS).zip(b.chunks_exact(SUMS));
    for (a, b) in &mut pairs {
        for (l, sum) in sums.iter_mut().enumerate() {
            *sum += f(a[l], b[l]);
        }
    }
    let rest = a.len() - a.len() % SUMS;
    let tail: f64 = a[rest..].iter().zip(&b[rest..]).map(|(&a, &b)| f(a, b)).sum();
    sums.into_iter().sum::<f64>() + tail
}
