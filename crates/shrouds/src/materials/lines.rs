//! Junction lines as curves of their own.
//!
//! Where a line passes from face to face its junction points follow each other, and bend as little as
//! they can: `|T⁺ − T⁻|²/l̄` at each, as for planar curves, but in space, with the lengths of the
//! chords taken as they are at the state. It ties together what the planes see one by one.

use std::collections::HashMap;

use crate::materials::cell::Filling;
use crate::materials::interfaces::{Interfaces, Junction, across};
use crate::materials::rows::{Row, UNKNOWNS};
use crate::materials::span::order;
use crate::optimize::Real;
use crate::parallel;
use crate::vector::{length, subtract};

/// Where the square of a chord falls below this, a line near a grid edge of the lattice, its direction
/// tells little and the junction counts less.
const SHORT: f64 = 0.05;
const NONE: u32 = u32::MAX;

/// The bending of all junction lines.
pub(super) struct JunctionLines<'a> {
    junctions: &'a [Junction],
    /// Every junction between two others of its line.
    threes: Vec<[u32; 3]>,
    /// In units of the smallest.
    spacing: [f64; 3],
    /// The first unknown of the first junction.
    first: usize,
    /// What their bending counts for each unit of what planar curves are measured by.
    weight: f64,
    pub(super) rows: Vec<Row<3>>,
}

impl<'a> JunctionLines<'a> {
    pub(super) fn trace(interfaces: &'a Interfaces, spacing: [f64; 3], weight: f64) -> Self {
        let first = interfaces.crossings().len();
        let between = neighbours(interfaces).into_iter().zip(0..);
        let threes: Vec<[u32; 3]> = between
            .filter(|([before, after], _)| *before != NONE && *after != NONE)
            .map(|([before, after], own)| [before, own, after])
            .collect();
        let row = |three: &[u32; 3]| {
            let unknown = |n: usize| (first + 2 * three[n / 2] as usize + n % 2) as u32;
            let unknowns = std::array::from_fn(unknown);
            Row { unknowns, residual: [0.0; 3], slopes: [[0.0; UNKNOWNS]; 3] }
        };
        let rows = threes.iter().map(row).collect();
        Self { junctions: interfaces.junctions(), threes, spacing, first, weight, rows }
    }

    fn place<R: Real>(&self, junction: u32, x: &[R]) -> [f64; 3] {
        let Junction { low, normal } = self.junctions[junction as usize];
        let mut place = low.map(f64::from);
        for (which, axis) in across(normal.into()).into_iter().enumerate() {
            place[axis] += x[self.first + 2 * junction as usize + which].to_f64();
        }
        [0, 1, 2].map(|axis| place[axis] * self.spacing[axis])
    }

    /// Takes the state `x`. Returns the energy.
    pub(super) fn linearise<R: Real>(&mut self, x: &[R]) -> f64 {
        let mut rows = std::mem::take(&mut self.rows);
        let weight = self.weight;
        let energy = parallel::update_sum(&mut rows, |n, row| {
            let three = self.threes[n];
            let [a, b, c] = three.map(|junction| self.place(junction, x));
            let (before, after) = (subtract(b, a), subtract(c, b));
            let (l0, l1) = (length(before).max(1e-6), length(after).max(1e-6));
            let shorter = l0.min(l1).powi(2);
            let root = (4.0 * weight / (l0 + l1) * shorter / (shorter + SHORT)).sqrt();
            let residual = [0, 1, 2].map(|k| root * (after[k] / l1 - before[k] / l0));
            row.residual = residual.map(|r| r as f32);
            let factors = [root / l0, -root / l0 - root / l1, root / l1];
            for (n, factor) in factors.into_iter().enumerate() {
                let axes = self.junctions[three[n] as usize].axes();
                for (which, axis) in axes.into_iter().enumerate() {
                    row.slopes[axis][2 * n + which] = (factor * self.spacing[axis]) as f32;
                }
            }
            0.5 * residual.iter().map(|r| r * r).sum::<f64>()
        });
        self.rows = rows;
        energy
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
