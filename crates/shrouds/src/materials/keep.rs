//! Volume keeping: the mesh of every label encloses as many voxel volumes as the label has voxels.
//!
//! The interface of two labels moves as evenly as its grid edges allow, by the difference of two numbers, one
//! of each label and none of the background: the larger a label's number, the larger the label. Newton's method finds them;
//! its matrix is that of a graph whose nodes are labels and whose edges are interfaces. Junction points stay.

use std::collections::BTreeMap;

use crate::materials::interfaces::Interfaces;
use crate::materials::mesh::MaterialMesh;
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// The part of a volume that it may be off at the end.
const EXACTLY: f64 = 1e-11;
const MOST_STEPS: usize = 60;
/// The farthest that numbers change in a step, in the smallest spacing.
const LONGEST_STEP: f64 = 0.5;
/// All crossings are at a bound then.
const FARTHEST: f64 = 10.0;
/// Between what the way of a crossing along its grid edge is kept, for a move of the interface by 1.
const OFFSETS: [f64; 2] = [0.1, 3.0];
/// Of the inner iteration: a part of the right side, and a number.
const REDUCTION: f64 = 1e-13;
const MOST_ITERATIONS: usize = 1000;

/// What the boundary of a label encloses, in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LabelVolume {
    /// The label.
    pub label: i64,
    /// The number of its voxels times the volume of one.
    pub target: f64,
    /// What it came to.
    pub reached: f64,
    /// Whether the bounds on δ keep it from its target.
    pub is_held: bool,
}

/// Moves the crossings of a mesh along their grid edges until every label encloses its voxels, as far as
/// the bounds on the unknowns allow. Triangles stay.
pub(super) fn keep_volumes(
    interfaces: &Interfaces,
    bounds: [f64; 2],
    unknowns: &[f64],
    mesh: &mut MaterialMesh,
) -> Vec<LabelVolume> {
    let crossings = interfaces.crossings().len();
    let keeper = Keeper::new(interfaces, bounds, &unknowns[..crossings], mesh);
    let mut steps = vec![0.0; keeper.targets.len()];
    let mut volumes = keeper.go(&steps, mesh);
    for _ in 0..MOST_STEPS {
        let missing: Vec<f64> =
            keeper.targets.iter().zip(&volumes).map(|(target, volume)| target - volume).collect();
        if missing.iter().zip(&keeper.targets).all(|(m, t)| m.abs() <= EXACTLY * t) {
            break;
        }
        let change = keeper.solve(&keeper.responses(&steps, &missing, mesh), &missing);
        for (step, change) in steps.iter_mut().zip(change) {
            let change = change.clamp(-LONGEST_STEP, LONGEST_STEP);
            *step = (*step + change).clamp(-FARTHEST, FARTHEST);
        }
        volumes = keeper.go(&steps, mesh);
    }
    let of_label = |rank: usize| {
        let (target, reached) = (keeper.targets[rank], volumes[rank]);
        let is_held = (reached - target).abs() > 10.0 * EXACTLY * target;
        LabelVolume { label: interfaces.labels().values()[rank], target, reached, is_held }
    };
    (1..keeper.targets.len()).map(of_label).collect()
}

struct Keeper<'a> {
    interfaces: &'a Interfaces,
    bounds: [f64; 2],
    start: &'a [f64],
    /// By rank; nothing is asked of the background.
    targets: Vec<f64>,
    /// The ranks of the labels on both sides, by triangle and by crossing.
    of_triangles: Vec<[u32; 2]>,
    of_crossings: Vec<[u32; 2]>,
    /// Grid edges as vectors in the world.
    edges: [Vector; 3],
    /// Where volumes are measured from: near the mesh, for the sake of rounding.
    origin: Vector,
    /// See [`OFFSETS`]; positive towards the high end.
    offsets: Vec<f64>,
}

impl<'a> Keeper<'a> {
    fn new(
        interfaces: &'a Interfaces,
        bounds: [f64; 2],
        start: &'a [f64],
        mesh: &MaterialMesh,
    ) -> Self {
        let (labels, grid) = (interfaces.labels(), interfaces.grid());
        let voxel = grid.voxel_volume();
        let rank = |label: &i64| labels.values().iter().position(|value| value == label);
        let mut ranks: BTreeMap<i64, u32> = BTreeMap::new();
        for label in mesh.pairs.as_flattened() {
            ranks.entry(*label).or_insert_with(|| rank(label).unwrap_or_default() as u32);
        }
        let mut targets: Vec<f64> = labels.counts().iter().map(|&n| n as f64 * voxel).collect();
        targets[0] = 0.0;
        let mut keeper = Self {
            interfaces,
            bounds,
            start,
            targets,
            of_triangles: mesh.pairs.iter().map(|pair| pair.map(|label| ranks[&label])).collect(),
            of_crossings: interfaces.crossings().iter().map(|&c| interfaces.labels_at(c)).collect(),
            edges: [0, 1, 2].map(|axis| {
                let mut step = [0.0; 3];
                step[axis] = 1.0;
                grid.vector(step)
            }),
            origin: grid.point(grid.dims().map(|points| points as f64 / 2.0)),
            offsets: Vec::new(),
        };
        keeper.offsets = keeper.even_offsets(mesh);
        keeper
    }

    /// Where the steps of all labels would bring a crossing without bounds.
    fn wish(&self, steps: &[f64], v: usize) -> f64 {
        let ([low, high], start) = (self.bounds, self.start[v]);
        let [first, second] = self.of_crossings[v].map(|rank| steps[rank as usize]);
        // In single precision the start can lie beyond the bounds.
        start.clamp(low, high) + (first - second) * self.offsets[v]
    }

    /// Brings the crossings of the mesh to where these steps of all labels lead from the start. Returns what the
    /// labels enclose then.
    fn go(&self, steps: &[f64], mesh: &mut MaterialMesh) -> Vec<f64> {
        let ([low, high], grid) = (self.bounds, self.interfaces.grid());
        let places = mesh.surface.vertices.iter_mut().zip(self.interfaces.crossings());
        for (v, (place, crossing)) in places.enumerate() {
            let mut index = crossing.low().map(|index| index as f64);
            index[crossing.axis()] += self.wish(steps, v).clamp(low, high);
            *place = grid.point(index);
        }
        let mut volumes = vec![0.0; self.targets.len()];
        for (n, pair) in self.of_triangles.iter().enumerate() {
            let [a, b, c] = self.corners(mesh, n);
            let volume = dot(a, cross(b, c)) / 6.0;
            volumes[pair[0] as usize] += volume;
            volumes[pair[1] as usize] -= volume;
        }
        volumes[0] = 0.0;
        volumes
    }

    fn corners(&self, mesh: &MaterialMesh, triangle: usize) -> [Vector; 3] {
        mesh.surface.corners(mesh.surface.triangles[triangle]).map(|p| subtract(p, self.origin))
    }

    /// How the volume of a crossing's first label changes with its place in the world: a third of the areas of
    /// the triangles around it, as vectors.
    fn pulls(&self, mesh: &MaterialMesh) -> Vec<Vector> {
        let mut pulls = vec![[0.0; 3]; self.start.len()];
        for (n, triangle) in mesh.surface.triangles.iter().enumerate() {
            let corners = self.corners(mesh, n);
            for (k, &v) in triangle.iter().enumerate() {
                if let Some(pull) = pulls.get_mut(v as usize) {
                    let area = cross(corners[(k + 1) % 3], corners[(k + 2) % 3]);
                    *pull = add(*pull, scale(area, 1.0 / 6.0));
                }
            }
        }
        pulls
    }

    /// How every crossing moves along its grid edge when its interface moves by the smallest spacing
    /// towards the second label.
    fn even_offsets(&self, mesh: &MaterialMesh) -> Vec<f64> {
        let unit = self.interfaces.grid().min_spacing();
        let [least, most] = OFFSETS;
        let offset = |(pull, crossing): (Vector, &crate::surface::Crossing)| {
            let along = dot(pull, self.edges[crossing.axis()]).abs();
            let outwards = if crossing.inside_low() { 1.0 } else { -1.0 };
            // Without any area there is no normal: `max` takes the other number then.
            outwards * (unit * length(pull) / along).max(least).min(most)
        };
        self.pulls(mesh).into_iter().zip(self.interfaces.crossings()).map(offset).collect()
    }

    /// How fast the volumes on both sides of every interface change with the difference of their steps. A crossing
    /// that a bound cuts off has a part in it only where what is missing would bring it back.
    fn responses(
        &self,
        steps: &[f64],
        missing: &[f64],
        mesh: &MaterialMesh,
    ) -> BTreeMap<[u32; 2], f64> {
        let [low, high] = self.bounds;
        let mut responses = BTreeMap::new();
        let crossings = self.pulls(mesh).into_iter().zip(self.interfaces.crossings());
        for (v, (pull, crossing)) in crossings.enumerate() {
            let [first, second] = self.of_crossings[v].map(|rank| missing[rank as usize]);
            let wish = self.wish(steps, v);
            let is_free = match () {
                () if (low..=high).contains(&wish) => true,
                // Cut off on the second label's side, or on the first one's.
                () if (wish > high) == (self.offsets[v] > 0.0) => first < 0.0 || second > 0.0,
                () => first > 0.0 || second < 0.0,
            };
            if is_free {
                let slope = dot(pull, self.edges[crossing.axis()]) * self.offsets[v];
                *responses.entry(self.of_crossings[v]).or_insert(0.0) += slope.max(0.0);
            }
        }
        responses
    }

    /// The change of steps that makes up for what is missing, were volumes linear: conjugate gradients
    /// on the graph of labels. A label that nothing can change has no part in it.
    fn solve(&self, responses: &BTreeMap<[u32; 2], f64>, missing: &[f64]) -> Vec<f64> {
        let mut diagonal = vec![0.0; missing.len()];
        for (pair, response) in responses {
            pair.iter().for_each(|&rank| diagonal[rank as usize] += response);
        }
        diagonal[0] = 0.0;
        let inverse = |rank: usize| if diagonal[rank] > 0.0 { 1.0 / diagonal[rank] } else { 0.0 };
        let inverse: Vec<f64> = (0..missing.len()).map(inverse).collect();
        let product = |direction: &[f64]| {
            let mut image = vec![0.0; direction.len()];
            for (&[a, b], response) in responses {
                let flow = response * (direction[a as usize] - direction[b as usize]);
                image[a as usize] += flow;
                image[b as usize] -= flow;
            }
            image
        };
        let inner = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let conditioned = |residual: &[f64]| -> Vec<f64> {
            residual.iter().zip(&inverse).map(|(r, inverse)| r * inverse).collect()
        };
        let mut change = vec![0.0; missing.len()];
        let mut residual = missing.to_vec();
        let mut direction = conditioned(&residual);
        let mut norm = inner(&residual, &direction);
        let goal = norm * REDUCTION * REDUCTION;
        for _ in 0..MOST_ITERATIONS {
            let image = product(&direction);
            let curvature = inner(&direction, &image);
            if norm <= goal || curvature <= 0.0 {
                break;
            }
            let length = norm / curvature;
            for n in 0..change.len() {
                change[n] += length * direction[n];
                residual[n] -= length * image[n];
            }
            let next = conditioned(&residual);
            let found = inner(&residual, &next);
            for (direction, next) in direction.iter_mut().zip(next) {
                *direction = next + found / norm * *direction;
            }
            norm = found;
        }
        change
    }
}
