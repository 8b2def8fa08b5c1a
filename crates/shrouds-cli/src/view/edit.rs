//! Changes of a volume by hand, and the way back.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::json;
use shrouds::Occupancy;
use shrouds::live::Ranges;

use super::request::Slot;
use super::volumes::{Data, Name};
use super::worker::{Ended, Worker};
use crate::failure::Failure;
use crate::input::Source;

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
struct Edit {
    voxels: Vec<[u32; 3]>,
    /// That of the brush it belongs to.
    stroke: Option<u64>,
}

/// What a brush does where it touches the volume.
pub(super) struct Ball {
    pub(super) add: bool,
    /// In voxels.
    pub(super) centre: [f64; 3],
    pub(super) radius: f64,
}

/// A change that was made.
struct Change {
    /// What the volume was.
    before: Arc<Source>,
    /// It is the same but within this box.
    region: Ranges,
    /// How many voxels changed sides.
    voxels: usize,
}

impl Edits {
    pub(super) fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    pub(super) fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Remembers a change, as a part of the last one if both are of one stroke, and forgets the oldest ones
    /// if there are too many.
    fn push(&mut self, edit: Edit) {
        self.undone.clear();
        match self.done.last_mut() {
            Some(last) if last.stroke.is_some() && last.stroke == edit.stroke => {
                // A voxel that turns twice is where it was.
                last.voxels.extend(edit.voxels);
            }
            _ => self.done.push(edit),
        }
        let mut voxels: usize = self.done.iter().map(|edit| edit.voxels.len()).sum();
        while voxels > REMEMBERED {
            voxels -= self.done.remove(0).voxels.len();
        }
    }
}

impl Edit {
    /// The voxels of a ball that are on the other side.
    fn ball(volume: &Occupancy, &Ball { add, centre, radius }: &Ball) -> Self {
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
        Self { voxels: changed, stroke: None }
    }

    /// A box around its voxels.
    fn region(&self) -> Ranges {
        [0, 1, 2].map(|d| {
            let along = self.voxels.iter().map(|voxel| voxel[d] as usize);
            along.clone().min().unwrap_or(0)..along.max().map_or(0, |last| last + 1)
        })
    }

    /// Puts its voxels on their other sides.
    fn turn(&self, volume: &mut Occupancy) {
        for voxel in &self.voxels {
            let point = voxel.map(|n| n as usize);
            volume.set(point, !volume.get(point));
        }
    }
}

impl Data {
    /// Turns the voxels of an edit. Surfaces keep what they were made of.
    fn turn(&mut self, edit: &Edit) -> Change {
        let (region, voxels) = (edit.region(), edit.voxels.len());
        let change = Change { before: self.source.clone(), region, voxels };
        if voxels == 0 {
            return change;
        }
        let source = Arc::make_mut(&mut self.source);
        edit.turn(&mut source.occupancy);
        source.truth = [None; 2];
        if !matches!(self.name, Name::Made(_)) {
            let name = format!("{} (edited)", self.name.text());
            source.path = PathBuf::from(&name);
            source.selection = "all but 0".into();
            (self.name, self.words) = (Name::Made(name), Vec::new());
        }
        change
    }
}

impl Worker {
    pub(super) fn brush(
        &mut self,
        id: u64,
        slot: Slot,
        follow: bool,
        stroke: Option<u64>,
        ball: &Ball,
    ) -> Result<(), Ended> {
        let is_finite = ball.centre.iter().all(|x| x.is_finite());
        if !(0.0..=LARGEST).contains(&ball.radius) || !is_finite {
            let message = format!("a brush has a centre and a radius of at most {LARGEST} voxels");
            return Err(Failure::Call(message).into());
        }
        self.views_to_change(slot)?;
        let data = self.data_mut(slot)?;
        let edit = Edit { stroke, ..Edit::ball(&data.source.occupancy, ball) };
        let change = data.turn(&edit);
        if !edit.voxels.is_empty() {
            data.edits.push(edit);
        }
        self.changed(id, slot, follow, &change)
    }

    pub(super) fn undo(&mut self, id: u64, slot: Slot, follow: bool) -> Result<(), Ended> {
        self.views_to_change(slot)?;
        let data = self.data_mut(slot)?;
        let edit = data.edits.done.pop().ok_or_else(nothing)?;
        let change = data.turn(&edit);
        data.edits.undone.push(edit);
        self.changed(id, slot, follow, &change)
    }

    pub(super) fn redo(&mut self, id: u64, slot: Slot, follow: bool) -> Result<(), Ended> {
        self.views_to_change(slot)?;
        let data = self.data_mut(slot)?;
        let edit = data.edits.undone.pop().ok_or_else(nothing)?;
        let change = data.turn(&edit);
        data.edits.done.push(edit);
        self.changed(id, slot, follow, &change)
    }

    /// Tells what a change came to, and gives each view of the volume its new surface: one that has followed
    /// the change if that is wished and can be, or else one at its start.
    fn changed(
        &mut self,
        id: u64,
        slot: Slot,
        follow: bool,
        Change { before, region, voxels }: &Change,
    ) -> Result<(), Ended> {
        let views = if *voxels > 0 { self.views_to_change(slot)? } else { Vec::new() };
        let mut about = Vec::new();
        for view in views {
            let followed = if follow { self.follow(view, before, region.clone())? } else { None };
            let surface = match followed {
                Some(surface) => surface,
                None => self.begin_again(view)?,
            };
            about.push(surface.about()["surface"].clone());
            surface.send_start(&self.page).map_err(|_| Ended::Closed)?;
        }
        let volume = self.data(slot)?.about(slot);
        self.answer(id, &json!({ "changed": voxels, "volume": volume, "surfaces": about }))
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
        let ball = |centre, radius| Ball { add: true, centre, radius };
        let edit = Edit::ball(&volume, &ball([4.0, 3.5, 0.0], 2.0));
        assert_eq!(edit.region(), [3..6, 2..6, 0..2]);
        let inside = |[i, j, k]: [f64; 3]| (i - 4.0).powi(2) + (j - 3.5).powi(2) + k.powi(2) <= 4.0;
        edit.turn(&mut volume);
        let expected = Occupancy::from_fn(before.grid().clone(), |p| inside(p.map(|n| n as f64)));
        assert_eq!(volume, expected);
        assert_eq!(Edit::ball(&volume, &ball([4.0, 3.5, 0.0], 2.0)).voxels.len(), 0);
        edit.turn(&mut volume);
        assert_eq!(volume, before);
        for centre in [[-1e300, 0.0, 0.0], [1e300; 3], [100.0, 3.0, 3.0]] {
            assert_eq!(Edit::ball(&volume, &ball(centre, 256.0)).voxels.len() % 504, 0);
        }
    }

    #[test]
    fn a_stroke_is_one_change() {
        let edit = |n, stroke| Edit { voxels: vec![[n; 3]], stroke };
        let mut edits = Edits::default();
        let strokes = [Some(1), Some(1), Some(2), None, None, Some(2)];
        (0..).zip(strokes).for_each(|(n, stroke)| edits.push(edit(n, stroke)));
        let sizes: Vec<usize> = edits.done.iter().map(|edit| edit.voxels.len()).collect();
        assert_eq!(sizes, [2, 1, 1, 1, 1]);
    }
}
