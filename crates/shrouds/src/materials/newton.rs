//! Steps on all unknowns at once: the model of the curves as the binary solver has it, with what junctions
//! add to it.

use crate::energy::CurveEnergy;
use crate::materials::ends::Ends;
use crate::materials::interfaces::{Interfaces, Junction};
use crate::materials::lines::JunctionLines;
use crate::materials::network::Curves;
use crate::materials::rows::{add_image, add_slopes};
use crate::materials::window::Window;
use crate::optimize::{
    CellGrid, Effort, Gathered, MeanEnergy, Model, Problem, Real, Room, Workspace, scanned, stepped,
};
use crate::surface::Crossing;

/// A step covers at most this part of the way to a bound.
const MOST_OF_THE_WAY: f32 = 0.95;
/// Chords shorter than this part of the smallest spacing, and turns with a cosine below, are looked at
/// crossing by crossing: there the model is worth little.
const SHORT_CHORD: f32 = 0.2;
const SHARP_TURN: f32 = 0.3;
/// What counts of a move at most, when the moves are judged.
const FAR: f64 = 0.01;

/// What the work with one measure is about.
#[derive(Clone, Copy)]
pub(super) struct Stage<'a> {
    pub(super) measure: &'a dyn CurveEnergy,
    /// See [`JunctionLines`].
    pub(super) weight_of_lines: f64,
    /// Whether it is to converge; the barrier follows the energies around every crossing then.
    pub(super) converges: bool,
}

/// The working state of a solver with one measure.
pub(super) struct Newton<'a, R> {
    interfaces: &'a Interfaces,
    curves: &'a Curves,
    stage: Stage<'a>,
    model: Model<R>,
    ends: Ends<R>,
    lines: JunctionLines<'a>,
    /// The crossings beside junctions.
    tips: Vec<Window>,
    /// Whether the energy at a crossing depends on a junction.
    is_near_junction: Vec<bool>,
    workspace: Workspace,
    spacing: [R; 3],
}

/// A step that lowered the energy to this, and the root mean square of the moves.
pub(super) struct Step {
    pub(super) energy: f64,
    pub(super) moved: f64,
}

impl<'a, R: Real> Newton<'a, R> {
    pub(super) fn new(
        interfaces: &'a Interfaces,
        curves: &'a Curves,
        stage: Stage<'a>,
        spacing: [f64; 3],
    ) -> Self {
        let ends = Ends::new(curves, stage.measure.support(), spacing);
        let mut is_near_junction = vec![false; curves.unknown_count()];
        for unknown in ends.rows.iter().flat_map(|row| row.unknowns) {
            is_near_junction[unknown as usize] = true;
        }
        Self {
            interfaces,
            curves,
            stage,
            model: Model::new(&curves.network),
            ends,
            lines: JunctionLines::trace(interfaces, spacing, stage.weight_of_lines),
            tips: Window::all(curves, 3),
            is_near_junction,
            workspace: Workspace::new(&curves.network),
            spacing: spacing.map(R::from_f64),
        }
    }

    /// The slopes of both planar curves of every crossing over its grid edge.
    pub(super) fn slopes(&self, problem: &Problem<R>, x: &[R]) -> Vec<[f32; 2]> {
        let mut slopes = problem.slopes_of(&self.place_slopes(problem, x));
        slopes.truncate(self.curves.crossings);
        slopes
    }

    fn place_slopes(&self, problem: &Problem<R>, x: &[R]) -> Vec<R> {
        let mut slopes = problem.place_slopes(x);
        for tip in &self.tips {
            slopes[tip.place as usize] = tip.slope(&self.spacing, x);
        }
        slopes
    }

    /// Freezes weights and barrier for the interfaces at `x`, where the model is linearised then. Returns
    /// the energy.
    pub(super) fn freeze(&mut self, problem: &mut Problem<R>, x: &[R]) -> f64 {
        let shares = problem.weigh(x, &self.place_slopes(problem, x));
        self.ends.weigh(self.curves, self.stage.measure, &shares);
        let energy = self.look(problem, x);
        problem.follow(self.means(problem));
        problem.set_barrier(|place| self.model.energy_at(place));
        energy + self.gather(problem, x)
    }

    /// What the barrier follows at every unknown.
    fn means(&self, problem: &Problem<R>) -> Vec<f32> {
        let (interfaces, crossings) = (self.interfaces, self.interfaces.crossings());
        let energy = |place| self.model.energy_at(place);
        let mean = if self.stage.converges {
            let of = |(v, crossing): (usize, &Crossing)| {
                (crossing.low(), problem.energy_of_vertex(v, energy))
            };
            let cells = CellGrid::of(crossings.iter().map(|crossing| crossing.low()));
            let gathered = Gathered::new(cells, crossings.iter().enumerate().map(of));
            MeanEnergy::around(cells, &gathered)
        } else {
            MeanEnergy::OfAll(problem.sum_over_own_vertices(energy) / crossings.len().max(1) as f64)
        };
        let corner = |junction: &Junction| [junction.low.map(|index| index as usize); 2];
        let of_junctions = interfaces.junctions().iter().flat_map(corner);
        let points = crossings.iter().map(|crossing| crossing.low()).chain(of_junctions);
        mean.at(self.curves.unknown_count(), points)
    }

    /// Linearises the model. Returns the energy.
    fn linearise(&mut self, problem: &Problem<R>, x: &[R]) -> f64 {
        self.look(problem, x) + self.gather(problem, x)
    }

    /// Takes the state `x`. Returns the energy but for the barrier.
    fn look(&mut self, problem: &Problem<R>, x: &[R]) -> f64 {
        let mut energy = self.model.linearise_curves(problem, x).all;
        energy += self.ends.linearise(self.stage.measure, x);
        let model = &mut self.model;
        self.ends.for_each_energy(|place, energy| model.add_energy(place, energy));
        energy + self.lines.linearise(x)
    }

    /// Gradient and diagonal where the model looks. Returns the barrier.
    fn gather(&mut self, problem: &Problem<R>, x: &[R]) -> f64 {
        self.model.gather(problem, x);
        add_slopes(&self.ends.rows, &mut self.model);
        add_slopes(&self.lines.rows, &mut self.model);
        problem.barrier_value(x).all
    }

    /// One step from `x`, where the model was linearised and has this energy; none if it would not
    /// lower it. The model is linearised where `x` is then.
    pub(super) fn step(
        &mut self,
        problem: &Problem<R>,
        x: &mut Vec<R>,
        energy: f64,
        effort: &Effort,
    ) -> Option<Step> {
        self.solve(problem, x, effort);
        let [low, high] = problem.bounds.all.map(R::to_f64);
        for &part in effort.parts {
            let moved = |(x, &step): (&R, &f32)| {
                R::from_f64((x.to_f64() + part * f64::from(step)).clamp(low, high))
            };
            let mut new: Vec<R> = x.iter().zip(self.workspace.steps()).map(moved).collect();
            if effort.repairs {
                self.repair(problem, &mut new);
            }
            let found = self.linearise(problem, &new);
            if found < energy {
                let square = |(a, b): (&R, &R)| (a.to_f64() - b.to_f64()).abs().min(FAR).powi(2);
                let moved: f64 = x.iter().zip(&new).map(square).sum();
                *x = new;
                return Some(Step { energy: found, moved: (moved / x.len() as f64).sqrt() });
            }
        }
        self.linearise(problem, x);
        None
    }

    /// Minimises the model over the steps, approximately, and cuts the step to the room there is.
    fn solve(&mut self, problem: &Problem<R>, x: &[R], effort: &Effort) {
        let room =
            Room { x, bounds: &problem.bounds, part: MOST_OF_THE_WAY, is_fixed: &problem.is_fixed };
        let further = |direction: &[f32], image: &mut [f32]| {
            add_image(&self.ends.rows, direction, image)
                + add_image(&self.lines.rows, direction, image)
        };
        self.workspace.solve(&self.model, &self.curves.network, &room, effort, &further);
    }

    /// Moves crossings with short chords or sharp turns alone, in order.
    fn repair(&self, problem: &Problem<R>, x: &mut [R]) {
        let mark = |squared_length: f32, cosine: f32| {
            u8::from(squared_length < SHORT_CHORD * SHORT_CHORD)
                | u8::from(cosine < SHARP_TURN) << 1
        };
        let mut marks = problem.mark_places(x, mark);
        for tip in &self.tips {
            let [a, b] = tip.chords(&self.spacing, x).map(|chord| chord.map(|k| k.to_f64() as f32));
            let (l, m) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
            let cosine = (a[0] * b[0] + a[1] * b[1]) / (l * m).sqrt();
            marks[tip.place as usize] = mark(l.min(m), cosine);
        }
        let marks = self.curves.network.at_vertices(0..self.curves.crossings, &marks);
        for (v, mark) in marks.map(|[a, b]| a | b).enumerate().filter(|(_, mark)| *mark != 0) {
            let at = self.moved_alone(problem, v as u32, mark & 2 != 0, x);
            x[v] = at;
        }
    }

    /// Where the energy of a crossing is lower if it moves alone.
    fn moved_alone(&self, problem: &Problem<R>, v: u32, is_sharp: bool, x: &mut [R]) -> R {
        let own = v as usize;
        let (old, bounds) = (x[own], problem.bounds.all);
        let mut around = problem.around(x, v);
        let places = self.curves.network.places()[own];
        let rows = match self.is_near_junction[own] {
            true => self.ends.of_crossing(&self.curves.network, v, places),
            false => Vec::new(),
        };
        let mut energy = |at: R| {
            x[own] = at;
            let of_rows = rows.iter().map(|&n| self.ends.along(n, v, self.stage.measure, x));
            of_rows.fold(around.at(at), |sum, term| sum + term)
        };
        let start = if is_sharp { scanned(&mut energy, old, bounds) } else { old };
        stepped(energy, start, bounds)
    }
}
