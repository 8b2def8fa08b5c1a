//! The file that says where the fragments of a mesh are.

use std::cmp::Ordering;
use std::collections::BTreeMap;

/// A fragment of one resolution: a cube, and the bytes that it takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node<T> {
    pub(crate) place: [u32; 3],
    pub(crate) size: u32,
    /// Whose it is; nobody's where a finer cube has a mesh and this one has not.
    pub(crate) source: Option<T>,
}

/// The fragments of all resolutions, the finest first.
pub(crate) struct Manifest<T> {
    /// Voxels along an edge of a cube, of the lattice of its resolution.
    edge: usize,
    pub(crate) levels: Vec<Vec<Node<T>>>,
}

impl<T: Copy> Manifest<T> {
    /// From the fragments of each resolution, with places as [`Fragment`](super::fragment::Fragment) has them.
    pub(crate) fn new(edge: usize, mut levels: Vec<Vec<Node<T>>>) -> Self {
        let count = levels.len();
        for (level, nodes) in levels.iter_mut().enumerate() {
            // The cubes of all resolutions begin at the same place, an edge of the largest before the first point.
            let shift = (1 << (count - 1 - level)) - 1;
            nodes.iter_mut().for_each(|node| node.place = node.place.map(|x| x + shift));
        }
        for level in 1..count {
            let parents = levels[level - 1].iter().map(|node| node.place.map(|x| x / 2));
            let mut nodes: BTreeMap<[u32; 3], Node<T>> =
                parents.map(|place| (place, Node { place, size: 0, source: None })).collect();
            nodes.extend(levels[level].iter().map(|node| (node.place, *node)));
            levels[level] = nodes.into_values().collect();
        }
        levels.iter_mut().for_each(|nodes| nodes.sort_by(|a, b| along_curve(a.place, b.place)));
        Self { edge, levels }
    }

    /// The bytes of the file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let count = self.levels.len();
        let scale = |level: usize| (1u32 << level) as f32;
        let origin = -(self.edge as f32) * scale(count - 1);
        let mut floats = vec![self.edge as f32; 3];
        floats.extend([origin; 3]);
        let mut bytes = of_floats(floats.into_iter());
        bytes.extend((count as u32).to_le_bytes());
        bytes.extend(of_floats((0..count).map(scale)));
        // The first point of a lattice that is halved lies between the first ones of the finer one.
        bytes.extend(of_floats((0..count).flat_map(|level| [0.5 * (scale(level) - 1.0); 3])));
        bytes.extend(of_numbers(self.levels.iter().map(|nodes| nodes.len() as u32)));
        for nodes in &self.levels {
            (0..3).for_each(|d| bytes.extend(of_numbers(nodes.iter().map(|node| node.place[d]))));
            bytes.extend(of_numbers(nodes.iter().map(|node| node.size)));
        }
        bytes
    }
}

fn of_numbers(numbers: impl Iterator<Item = u32>) -> Vec<u8> {
    numbers.flat_map(u32::to_le_bytes).collect()
}

fn of_floats(numbers: impl Iterator<Item = f32>) -> Vec<u8> {
    numbers.flat_map(f32::to_le_bytes).collect()
}

/// The order of two cubes along the Z curve: decided by the axis whose numbers differ in the highest bit, of
/// such axes by the last.
fn along_curve(a: [u32; 3], b: [u32; 3]) -> Ordering {
    let highest = |d: usize| (a[d] ^ b[d]).checked_ilog2();
    let axis = (0..3).max_by_key(|&d| highest(d)).unwrap_or(0);
    a[axis].cmp(&b[axis])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_interleaves_bits() {
        let code = |place: [u32; 3]| {
            (0..30).map(|n| ((place[n % 3] >> (n / 3) & 1) as u64) << n).sum::<u64>()
        };
        let places: Vec<[u32; 3]> =
            (0..512u32).map(|n| [n % 8, n / 8 % 8, n / 64].map(|x| 3 * x + x % 2)).collect();
        for (a, b) in places.iter().flat_map(|a| places.iter().map(move |b| (*a, *b))) {
            assert_eq!(along_curve(a, b), code(a).cmp(&code(b)), "{a:?} {b:?}");
        }
    }

    #[test]
    fn cubes_lie_in_cubes_of_the_next_resolution() {
        let node = |place| Node { place, size: 7, source: Some(()) };
        // Beyond the first point, within, and one whose parent has no mesh of its own.
        let fine = [[0, 1, 1], [1, 1, 1], [4, 4, 4]].map(node).to_vec();
        let manifest = Manifest::new(128, vec![fine, vec![node([1, 1, 1])]]);
        let places = |level: usize| manifest.levels[level].iter().map(|node| node.place);
        assert!(places(0).eq([[1, 2, 2], [2, 2, 2], [5, 5, 5]]));
        // Of two resolutions all cubes begin 256 points before the first.
        assert!(places(1).eq([[0, 1, 1], [1, 1, 1], [2, 2, 2]]));
        let sizes: Vec<u32> = manifest.levels[1].iter().map(|node| node.size).collect();
        assert_eq!(sizes, [0, 7, 0]);
    }
}
