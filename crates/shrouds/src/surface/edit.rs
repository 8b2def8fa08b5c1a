//! A surface after some lattice points changed their side.

use std::ops::Range;

use crate::error::Error;
use crate::surface::Surface;
use crate::surface::{cell, extract};
use crate::volume::{Border, Flips, Occupancy};

/// How the numbers of the vertices change with an edit: stretches of vertices that give way to others;
/// those between keep their order.
pub(crate) struct Renumbering {
    /// Old numbers and new ones, ascending.
    stretches: Vec<[Range<usize>; 2]>,
}

impl Renumbering {
    /// From the first to the last vertex that gives way, in old numbers and in new ones. All after them
    /// move up or down together.
    pub(crate) fn hull(&self) -> [Range<usize>; 2] {
        match (self.stretches.first(), self.stretches.last()) {
            (Some([old, new]), Some([last_old, last_new])) => {
                [old.start..last_old.end, new.start..last_new.end]
            }
            _ => [0..0, 0..0],
        }
    }

    /// Brings numbers of the vertices to the new order, with `blank` for each new vertex.
    pub(crate) fn splice<T: Copy>(&self, values: &mut Vec<T>, blank: T) {
        let [old, new] = self.hull();
        let (mut hull, mut next) = (Vec::with_capacity(new.len()), old.start);
        for [gone, come] in &self.stretches {
            hull.extend_from_slice(&values[next..gone.start]);
            hull.resize(hull.len() + come.len(), blank);
            next = gone.end;
        }
        values.splice(old, hull);
    }
}

impl Surface {
    /// Whether a volume lies on the lattice of the one that this is the surface of.
    ///
    /// # Errors
    /// [`Error::DifferentLattices`] when it does not.
    pub(crate) fn check_volume(&self, volume: &Occupancy) -> Result<(), Error> {
        let margin = self.margin();
        let grid = volume.grid().padded(margin)?;
        self.grid().check_same_lattice(&grid)
    }

    /// Layers of outside points that a closed border puts around a volume.
    fn margin(&self) -> usize {
        match self.border {
            Border::Closed => 1,
            Border::Open => 0,
        }
    }

    /// What has to flip within `region`, a box of the lattice points of `volume`, for this to be its
    /// surface there.
    pub(crate) fn flips_to(&self, volume: &Occupancy, region: [Range<usize>; 3]) -> Option<Flips> {
        let margin = self.margin();
        let region = region.map(|range| range.start + margin..range.end + margin);
        self.volume.flips_to(&region, volume, margin)
    }

    /// Flips lattice points; the surface is then that of the new volume.
    ///
    /// # Errors
    /// [`Error::TooManyVertices`], and nothing is changed.
    pub(crate) fn flip(&mut self, flips: &Flips) -> Result<Renumbering, Error> {
        let [_, ny, _] = self.grid().dims();
        // Grid edges to the points start one row and one slice before.
        let slices = flips.points[2].start.saturating_sub(1)..flips.points[2].end;
        let rows = slices.start * ny..slices.end * ny;
        let before = self.rows[rows.start..=rows.end].to_vec();
        let all = self.vertex_count() as u64;
        self.volume.flip(flips);
        let mut next = u64::from(before[0][0]);
        for k in slices.clone() {
            let rows = &mut self.rows[k * ny..(k + 1) * ny];
            let count = extract::number_rows(&self.volume, k, rows);
            rows.as_flattened_mut().iter_mut().for_each(|first| *first += next as u32);
            next += count;
        }
        let end = before[before.len() - 1][0];
        let vertices = all - u64::from(end) + next;
        if vertices > Self::MAX_VERTICES {
            self.volume.flip(flips);
            self.rows[rows.start..=rows.end].copy_from_slice(&before);
            return Err(Error::TooManyVertices { vertices, limit: Self::MAX_VERTICES });
        }
        let shift = (next as u32).wrapping_sub(end);
        for first in self.rows[rows.end..].as_flattened_mut() {
            *first = first.wrapping_add(shift);
        }
        self.recount_layers(slices);
        Ok(Renumbering { stretches: self.stretches(flips, &before) })
    }

    /// The vertices that give way in every row, given the numbers before from the first row of the slice
    /// before the flipped points on.
    fn stretches(&self, flips: &Flips, before: &[[u32; 3]]) -> Vec<[Range<usize>; 2]> {
        let [_, ny, _] = self.grid().dims();
        let [x, y, z] = &flips.points;
        let (first_j, first_k) = (y.start.saturating_sub(1), z.start.saturating_sub(1));
        let mut found = Vec::new();
        for (j, k) in (first_k..z.end).flat_map(|k| (first_j..y.end).map(move |j| (j, k))) {
            for axis in 0..3 {
                let first = if axis == 0 { x.start.saturating_sub(1) } else { x.start };
                let all = self.row_vertices(axis, j, k);
                let Range { start, end } = self.span_vertices(axis, &(first..x.end), j, k);
                let stream = 3 * ((k - first_k) * ny + j) + axis;
                let [old_start, old_end] =
                    [stream, stream + 1].map(|n| before.as_flattened()[n] as usize);
                let old = old_start + (start - all.start)..old_end - (all.end - end);
                if !old.is_empty() || start != end {
                    found.push([old, start..end]);
                }
            }
        }
        found
    }

    /// Counts the patches around some slices again, where they were counted before.
    fn recount_layers(&mut self, slices: Range<usize>) {
        let changed = slices.start..slices.end.min(self.layer_count());
        let Some(layers) = self.layers.get_mut() else { return };
        let table = cell::table(self.face_rule);
        let end = layers[changed.end];
        for layer in changed.clone() {
            let (patches, triangles) = extract::count_patches(&self.volume, layer, table);
            layers[layer + 1] = (layers[layer].0 + patches, layers[layer].1 + triangles);
        }
        let now = layers[changed.end];
        for later in &mut layers[changed.end + 1..] {
            *later = (later.0 - end.0 + now.0, later.1 - end.1 + now.1);
        }
    }
}
