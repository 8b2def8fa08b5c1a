//! Small parts away, cavities filled.

use std::cmp::Reverse;

use crate::volume::components::Components;
use crate::volume::{FaceRule, Occupancy};

/// A volume that was cleaned, and how much of it changed sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaned {
    /// What it is now.
    pub volume: Occupancy,
    /// How many components were removed, or cavities filled.
    pub components: usize,
    /// How many lattice points they have.
    pub voxels: u64,
}

impl Occupancy {
    /// Keeps the `count` components with the most lattice points; of equal ones, those that come first
    /// in memory. [`Occupancy::components`] says what `rule` connects.
    pub fn keep_largest(&self, count: usize, rule: FaceRule) -> Cleaned {
        let components = self.components(rule);
        let mut by_size: Vec<usize> = (0..components.count()).collect();
        by_size.sort_by_key(|&component| Reverse(components.sizes()[component]));
        let mut kept = vec![false; components.count()];
        by_size.iter().take(count).for_each(|&component| kept[component] = true);
        keep(&components, &kept)
    }

    /// Removes all components of fewer than `least` lattice points. [`Occupancy::components`] says what
    /// `rule` connects.
    pub fn drop_smaller(&self, least: u64, rule: FaceRule) -> Cleaned {
        let components = self.components(rule);
        let kept: Vec<bool> = components.sizes().iter().map(|&size| size >= least).collect();
        keep(&components, &kept)
    }

    /// Puts cavities inside: the components of the outside points that do not reach the border of the
    /// lattice, if `most` is given only those of at most so many points.
    ///
    /// Outside points are connected as the surface made by `rule` leaves them: across lattice faces with
    /// [`FaceRule::Separate`] (18-connected), along grid edges alone with [`FaceRule::Join`] (6-connected).
    /// In an image, a volume of one slice, everything reaches the border.
    pub fn fill_cavities(&self, most: Option<u64>, rule: FaceRule) -> Cleaned {
        let outside = Components::find(&self.complement(), rule == FaceRule::Separate);
        let most = most.unwrap_or(u64::MAX);
        let at_border = outside.reach_border();
        let filled: Vec<bool> =
            outside.sizes().iter().zip(at_border).map(|(&size, at)| !at && size <= most).collect();
        let (components, voxels) = total(&outside, &filled);
        if components == 0 {
            return Cleaned { volume: self.clone(), components, voxels };
        }
        let cavities = outside.select(|component| filled[component]);
        Cleaned { volume: self.zip_words(&cavities, |a, b| a | b), components, voxels }
    }
}

fn keep(components: &Components, kept: &[bool]) -> Cleaned {
    let removed: Vec<bool> = kept.iter().map(|kept| !kept).collect();
    let (count, voxels) = total(components, &removed);
    Cleaned { volume: components.select(|component| kept[component]), components: count, voxels }
}

/// Number and lattice points of the components that are chosen.
fn total(components: &Components, chosen: &[bool]) -> (usize, u64) {
    let sizes = components.sizes().iter().zip(chosen).filter(|(_, chosen)| **chosen);
    sizes.fold((0, 0), |(count, voxels), (size, _)| (count + 1, voxels + size))
}
