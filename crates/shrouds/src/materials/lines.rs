//! Junction lines as curves of their own.
//!
//! Where a line passes from face to face its junction points follow each other, and bend as little as
//! they can: `|T⁺ − T⁻|²/l̄` at each, as for planar curves, but in space, with the lengths of the
//! chords taken as they are at the state. It ties together what the planes see one by one.

use std::collections::HashMap;

use crate::materials::cell::Filling;
use crate::materials::interfaces::Interfaces;
use crate::materials::span::order;
use crate::parallel;

/// What the bending of lines counts for each unit of that of planar curves.
const WEIGHT: f64 = 1.0;
/// Where the square of a chord falls below this, a line near a grid edge of the lattice, its direction
/// tells little and the junction counts less.
const SHORT: f64 = 0.05;
const NONE: u32 = u32::MAX;

/// The junctions before and after each on its line.
#[derive(Debug)]
pub(super) struct JunctionLines {
    beside: Vec<[u32; 2]>,
    /// Lowest corners and axes of the faces, lengths in units of the smallest spacing.
    corners: Vec<[f64; 3]>,
    axes: Vec<[usize; 2]>,
    spacing: [f64; 3],
    /// The first unknown of the first junction.
    first: usize,
    rows: Vec<Row>,
    products: Vec<[f32; 3]>,
}

/// The residual at a junction, and what it gains when the junction before, its own or the next moves.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    residual: [f32; 3],
    factors: [f32; 3],
}

impl JunctionLines {
    pub(super) fn trace(interfaces: &Interfaces) -> Self {
        let unit = interfaces.grid().min_spacing();
        let spacing = interfaces.grid().spacing().map(|spacing| spacing / unit);
        let junctions = interfaces.junctions();
        let corner =
            |n: usize| std::array::from_fn(|a| f64::from(junctions[n].low[a]) * spacing[a]);
        Self {
            beside: neighbours(interfaces),
            corners: (0..junctions.len()).map(corner).collect(),
            axes: junctions.iter().map(|junction| junction.axes()).collect(),
            spacing,
            first: interfaces.crossings().len(),
            rows: vec![Row::default(); junctions.len()],
            products: vec![[0.0; 3]; junctions.len()],
        }
    }

    fn place(&self, junction: usize, x: &[f64]) -> [f64; 3] {
        let mut place = self.corners[junction];
        for (which, axis) in self.axes[junction].into_iter().enumerate() {
            place[axis] += x[self.first + 2 * junction + which] * self.spacing[axis];
        }
        place
    }

    /// The junctions of a row: the one before, its own and the next.
    fn of_row(&self, junction: usize) -> Option<[usize; 3]> {
        let [before, after] = self.beside[junction];
        (before != NONE && after != NONE).then_some([before as usize, junction, after as usize])
    }

    /// Takes the state `x`. Returns the energy.
    pub(super) fn linearise(&mut self, x: &[f64]) -> f64 {
        let mut rows = std::mem::take(&mut self.rows);
        let energy = parallel::update_sum(&mut rows, |junction, row| {
            *row = Row::default();
            let Some(three) = self.of_row(junction) else { return 0.0 };
            let [a, b, c] = three.map(|junction| self.place(junction, x));
            let chord = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|k| to[k] - from[k]);
            let (before, after) = (chord(a, b), chord(b, c));
            let length = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + 1e-12).sqrt();
            let (l0, l1) = (length(before), length(after));
            let shorter = l0.min(l1).powi(2);
            let root = (2.0 * WEIGHT / (l0 + l1) * shorter / (shorter + SHORT)).sqrt();
            let residual = [0, 1, 2].map(|k| root * (after[k] / l1 - before[k] / l0));
            row.residual = residual.map(|r| r as f32);
            row.factors = [root / l0, -root / l0 - root / l1, root / l1].map(|f| f as f32);
            residual.iter().map(|r| r * r).sum()
        });
        self.rows = rows;
        energy
    }

    /// Calls `f` with every row that depends on an unknown, the number of the residual, and the
    /// derivative.
    #[inline]
    fn for_each_derivative(&self, unknown: usize, mut f: impl FnMut(usize, usize, f32)) {
        let Some(number) = unknown.checked_sub(self.first) else { return };
        let (junction, axis) = (number / 2, self.axes[number / 2][number % 2]);
        let step = self.spacing[axis] as f32;
        f(junction, axis, step * self.rows[junction].factors[1]);
        for near in self.beside[junction].into_iter().filter(|&near| near != NONE) {
            let near = near as usize;
            let slot = if self.beside[near][0] as usize == junction { 0 } else { 2 };
            f(near, axis, step * self.rows[near].factors[slot]);
        }
    }

    /// Half the slope and half the curvature of the energy along an unknown.
    pub(super) fn slopes(&self, unknown: usize) -> [f32; 2] {
        let mut sums = [0.0; 2];
        self.for_each_derivative(unknown, |row, axis, derivative| {
            sums[0] += derivative * self.rows[row].residual[axis];
            sums[1] += derivative * derivative;
        });
        sums
    }

    /// Takes a direction.
    pub(super) fn multiply(&mut self, direction: &[f32]) {
        let mut products = std::mem::take(&mut self.products);
        parallel::update(&mut products, |junction, product| {
            *product = [0.0; 3];
            let Some(three) = self.of_row(junction) else { return };
            for (near, factor) in three.into_iter().zip(self.rows[junction].factors) {
                for (which, axis) in self.axes[near].into_iter().enumerate() {
                    let step = direction[self.first + 2 * near + which];
                    product[axis] += factor * self.spacing[axis] as f32 * step;
                }
            }
        });
        self.products = products;
    }

    /// The image of the direction at an unknown.
    pub(super) fn image(&self, unknown: usize) -> f32 {
        let mut sum = 0.0;
        self.for_each_derivative(unknown, |row, axis, derivative| {
            sum += derivative * self.products[row][axis];
        });
        sum
    }
}

/// The junctions beside each: those that share a cell point with it alone.
fn neighbours(interfaces: &Interfaces) -> Vec<[u32; 2]> {
    let first = interfaces.crossings().len() as u32;
    let layers = interfaces.grid().dims()[2] - 1;
    let pairs = parallel::blocks(layers, 8, |range| {
        let (mut fillings, mut pairs) = (HashMap::new(), Vec::new());
        for layer in range {
            interfaces.for_each_cell(layer, |low, labels| {
                let first_label = labels[0];
                let other = labels.into_iter().find(|&label| label != first_label);
                if labels.iter().all(|&l| l == first_label || Some(l) == other) {
                    return;
                }
                let digits = order(labels).0;
                let new = || Filling::new(digits.map(u32::from), interfaces.face_rule());
                let filling = fillings.entry(digits).or_insert_with(new);
                let ends = filling.inner.iter().filter_map(|inner| inner.line());
                pairs.extend(
                    ends.map(|faces| faces.map(|face| interfaces.cell_junction(low, face) - first)),
                );
            });
        }
        pairs
    });
    let mut beside = vec![[NONE; 2]; interfaces.junctions().len()];
    for [a, b] in pairs.into_iter().flatten() {
        for (own, other) in [(a, b), (b, a)] {
            let slots = &mut beside[own as usize];
            slots[usize::from(slots[0] != NONE)] = other;
        }
    }
    beside
}
