//! Which label each voxel has: the voxels of one label cost what it is large, not what the volume is.

use std::collections::BTreeMap;
use std::ops::Range;

use shrouds::{Grid, Occupancy};
use shrouds_io::Volume;

use crate::failure::Failure;

/// First to last index along x, y, z, the end not counted.
pub(crate) type Window = [Range<usize>; 3];

/// The labels of a volume.
pub(crate) struct LabelMap {
    /// Every value there is, 0 too, ascending.
    labels: Vec<i128>,
    /// For every voxel, x fastest, the place of its label in the list.
    numbers: Vec<u16>,
    grid: Grid,
    /// Where the voxels of each label lie.
    windows: Vec<Option<Window>>,
}

impl LabelMap {
    /// Nothing if the values are no labels.
    pub(crate) fn new(volume: &Volume) -> Option<Self> {
        let (labels, numbers) = volume.values.numbered()?;
        let mut windows = vec![None; labels.len()];
        for (index, &number) in indices(volume.grid.dims()).zip(&numbers) {
            include(&mut windows[usize::from(number)], index);
        }
        Some(Self { labels, numbers, grid: volume.grid.clone(), windows })
    }

    /// The labels but 0, each with its number.
    pub(crate) fn all(&self) -> impl Iterator<Item = (u16, i128)> {
        let numbered = (0u16..).zip(self.labels.iter().copied());
        numbered.filter(|(_, label)| *label != 0)
    }

    pub(crate) fn number_of(&self, label: i128) -> Option<u16> {
        self.labels.binary_search(&label).ok()?.try_into().ok()
    }

    pub(crate) fn label(&self, number: u16) -> i128 {
        self.labels[usize::from(number)]
    }

    /// The number of the label of a voxel.
    pub(crate) fn number_at(&self, [i, j, k]: [usize; 3]) -> u16 {
        let [nx, ny, _] = self.grid.dims();
        self.numbers[(k * ny + j) * nx + i]
    }

    /// Where the voxels of a label lie.
    pub(crate) fn window(&self, number: u16) -> Window {
        self.windows[usize::from(number)].clone().unwrap_or_else(|| self.whole())
    }

    pub(crate) fn whole(&self) -> Window {
        self.grid.dims().map(|length| 0..length)
    }

    /// A window with so many more voxels on all sides, as far as there are any.
    pub(crate) fn wider(&self, window: &Window, margin: usize) -> Window {
        let dims = self.grid.dims();
        std::array::from_fn(|d| {
            window[d].start.saturating_sub(margin)..(window[d].end + margin).min(dims[d])
        })
    }

    /// The voxels in a window whose labels are chosen by their numbers.
    pub(crate) fn occupancy(
        &self,
        window: &Window,
        chosen: impl Fn(u16) -> bool + Sync,
    ) -> Result<Occupancy, Failure> {
        let grid = self.grid.crop(window.clone())?;
        let first = [0, 1, 2].map(|d| window[d].start);
        Ok(Occupancy::from_fn(grid, |point| {
            chosen(self.number_at(std::array::from_fn(|d| first[d] + point[d])))
        }))
    }

    /// The pairs of labels but 0 that a grid edge joins, the smaller first, and where.
    pub(crate) fn neighbours(&self) -> BTreeMap<[u16; 2], Window> {
        let outside = self.number_of(0);
        let dims = self.grid.dims();
        let mut pairs: BTreeMap<[u16; 2], Option<Window>> = BTreeMap::new();
        for (index, &number) in indices(dims).zip(&self.numbers) {
            if Some(number) == outside {
                continue;
            }
            for axis in 0..3 {
                let mut next = index;
                next[axis] += 1;
                if next[axis] == dims[axis] {
                    continue;
                }
                let other = self.number_at(next);
                if other == number || Some(other) == outside {
                    continue;
                }
                let pair = [number.min(other), number.max(other)];
                let window = pairs.entry(pair).or_default();
                include(window, index);
                include(window, next);
            }
        }
        pairs.into_iter().filter_map(|(pair, window)| Some((pair, window?))).collect()
    }
}

/// All indices, x fastest.
fn indices([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

fn include(window: &mut Option<Window>, index: [usize; 3]) {
    let wide = window.get_or_insert_with(|| index.map(|i| i..i + 1));
    for (range, i) in wide.iter_mut().zip(index) {
        *range = range.start.min(i)..range.end.max(i + 1);
    }
}
