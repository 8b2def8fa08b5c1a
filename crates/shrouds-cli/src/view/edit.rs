//! Changes of a volume by hand, and the way back.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::json;
use shrouds::Occupancy;

use super::request::{Slot, ViewNumber};
use super::volumes::{Data, Name};
use super::worker::{Ended, Worker};
use crate::failure::Failure;

/// Largest brush, in voxels.
const LARGEST: f64 = 256.0;
/// Voxels of all changes that can be taken back.
const REMEMBERED: usize = 1 << 24;

/// What was changed, the newest last, and what was taken back.
#[derive(Default)]
pub(super) struct Edits {
    done: Vec<Edit>,
    undone: Vec<Edit>,
}

/// Voxels that changed sides.
struct Edit(Vec<[u32; 3]>);

impl Edits {
    pub(super) fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    pub(super) fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Remembers a change, and forgets the oldest ones if there are too many.
    fn push(&mut self, edit: Edit) {
        self.undone.clear();
        self.done.push(edit);
        let mut voxels: usize = self.done.iter().map(|edit| edit.0.len()).sum();
        while voxels > REMEMBERED {
            voxels -= self.done.remove(0).0.len();
        }
    }
}

impl Edit {
    /// The voxels of a ball that are on the other side.
    fn ball(volume: &Occupancy, add: bool, centre: [f64; 3], radius: f64) -> Self {
        let dims = volume.grid().dims();
        // Casts saturate, and the dimensions bound what is left.
        let ranges: [std::ops::Range<usize>; 3] = std::array::from_fn(|d| {
            let low = (centre[d] - radius).ceil().max(0.0) as usize;
            low..((centre[d] + radius).floor() + 1.0).clamp(0.0, dims[d] as f64) as usize
        });
        let [x, y, z] = ranges;
        let mut changed = Vec::new();
        for k in z {
            for j in y.clone() {
                for i in x.clone() {
                    let steps =
                        [i, j, k].into_iter().zip(centre).map(|(n, c)| (n as f64 - c).powi(2));
                    if steps.sum::<f64>() <= radius * radius && volume.get([i, j, k]) != add {
                        changed.push([i, j, k].map(|n| n as u32));
                    }
                }
            }
        }
        Self(changed)
    }

    /// Puts its voxels on their other sides.
    fn turn(&self, volume: &mut Occupancy) {
        for voxel in &self.0 {
            let point = voxel.map(|n| n as usize);
            volume.set(point, !volume.get(point));
        }
    }
}

impl Data {
    /// Turns the voxels of an edit. Surfaces keep what they were made of.
    fn turn(&mut self, edit: &Edit) {
        let source = Arc::make_mut(&mut self.source);
        edit.turn(&mut source.occupancy);
        source.truth = [None; 2];
        if !matches!(self.name, Name::Made(_)) {
            let name = format!("{} (edited)", self.name.text());
            source.path = PathBuf::from(&name);
            source.selection = "all but 0".into();
            (self.name, self.words) = (Name::Made(name), Vec::new());
        }
    }
}

impl Worker {
    pub(super) fn brush(
        &mut self,
        id: u64,
        slot: Slot,
        add: bool,
        centre: [f64; 3],
        radius: f64,
    ) -> Result<(), Ended> {
        if !(0.0..=LARGEST).contains(&radius) || !centre.iter().all(|x| x.is_finite()) {
            let message = format!("a brush has a centre and a radius of at most {LARGEST} voxels");
            return Err(Failure::Call(message).into());
        }
        let data = self.data_mut(slot)?;
        let edit = Edit::ball(&data.source.occupancy, add, centre, radius);
        let changed = edit.0.len();
        if changed > 0 {
            data.turn(&edit);
            data.edits.push(edit);
        }
        self.changed(id, slot, changed)
    }

    pub(super) fn undo(&mut self, id: u64, slot: Slot) -> Result<(), Ended> {
        let data = self.data_mut(slot)?;
        let edit = data.edits.done.pop().ok_or_else(nothing)?;
        data.turn(&edit);
        let changed = edit.0.len();
        data.edits.undone.push(edit);
        self.changed(id, slot, changed)
    }

    pub(super) fn redo(&mut self, id: u64, slot: Slot) -> Result<(), Ended> {
        let data = self.data_mut(slot)?;
        let edit = data.edits.undone.pop().ok_or_else(nothing)?;
        data.turn(&edit);
        let changed = edit.0.len();
        data.edits.done.push(edit);
        self.changed(id, slot, changed)
    }

    /// Tells what a change came to, and lets the surfaces of the volume follow.
    fn changed(&mut self, id: u64, slot: Slot, changed: usize) -> Result<(), Ended> {
        let views: Vec<ViewNumber> = if changed > 0 { self.views_on(slot) } else { Vec::new() };
        let mut surfaces = Vec::new();
        for view in views {
            surfaces.push(self.begin_again(view)?);
        }
        let about: Vec<_> =
            surfaces.iter().map(|surface| surface.about()["surface"].clone()).collect();
        let volume = self.data(slot)?.about(slot);
        self.answer(id, &json!({ "changed": changed, "volume": volume, "surfaces": about }))?;
        for surface in surfaces {
            surface.send_start(&self.page).map_err(|_| Ended::Closed)?;
            self.solve(surface);
        }
        Ok(())
    }
}

fn nothing() -> Failure {
    Failure::Call("there is no change to go back to".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shrouds::Grid;

    #[test]
    fn edits_go_back_and_forth() {
        let mut volume = Occupancy::empty(Grid::new([9, 8, 7], [1.0; 3]).unwrap());
        let before = volume.clone();
        let edit = Edit::ball(&volume, true, [4.0, 3.5, 0.0], 2.0);
        let inside = |[i, j, k]: [f64; 3]| (i - 4.0).powi(2) + (j - 3.5).powi(2) + k.powi(2) <= 4.0;
        edit.turn(&mut volume);
        let expected = Occupancy::from_fn(before.grid().clone(), |p| inside(p.map(|n| n as f64)));
        assert_eq!(volume, expected);
        assert_eq!(Edit::ball(&volume, true, [4.0, 3.5, 0.0], 2.0).0.len(), 0);
        edit.turn(&mut volume);
        assert_eq!(volume, before);
        for centre in [[-1e300, 0.0, 0.0], [1e300; 3], [100.0, 3.0, 3.0]] {
            assert_eq!(Edit::ball(&volume, true, centre, 256.0).0.len() % 504, 0);
        }
    }
}
