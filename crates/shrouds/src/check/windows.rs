//! Stretches of vertices with the triangles that touch them.
//!
//! The triangles of most meshes come near those that share their vertices. A stretch of vertices then
//! has all its triangles in a few blocks of the list, and what is known about it fits a fast memory.

use std::ops::Range;

use crate::mesh::TriMesh;
use crate::parallel;

/// Triangles per block.
const BLOCK: usize = 1 << 10;
/// Vertices per window.
const LEAST: usize = 1 << 14;
const MOST: usize = 1 << 18;

/// The windows of a mesh.
pub(super) struct Windows<'a> {
    mesh: &'a TriMesh,
    /// The vertices that each block of triangles lies between.
    blocks: Vec<Range<usize>>,
    size: usize,
}

impl<'a> Windows<'a> {
    /// Divides the vertices of a mesh whose triangles name none that is missing; nothing when the
    /// order of its triangles has too little to do with that of its vertices.
    pub(super) fn new(mesh: &'a TriMesh) -> Option<Self> {
        let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
            let numbers = mesh.triangles[range].as_flattened();
            let low = numbers.iter().fold(u32::MAX, |low, &v| low.min(v));
            let high = numbers.iter().fold(0, |high, &v| high.max(v));
            low as usize..high as usize + 1
        });
        let width = blocks.iter().map(Range::len).sum::<usize>() / blocks.len().max(1);
        let size = (4 * width).clamp(LEAST, MOST);
        let windows = Self { mesh, blocks, size };
        let visits: usize =
            windows.blocks.iter().map(|block| block.end.div_ceil(size) - block.start / size).sum();
        (visits <= 16 + 4 * windows.blocks.len()).then_some(windows)
    }

    pub(super) fn mesh(&self) -> &'a TriMesh {
        self.mesh
    }

    /// Number of windows.
    pub(super) fn count(&self) -> usize {
        self.mesh.vertices.len().div_ceil(self.size)
    }

    /// Vertices of a window at most.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// The vertices of a window.
    pub(super) fn vertices(&self, window: usize) -> Range<usize> {
        window * self.size..((window + 1) * self.size).min(self.mesh.vertices.len())
    }

    /// The vertices that the triangles of [`Windows::triangles`] lie between, and its own.
    pub(super) fn surroundings(&self, window: usize) -> Range<usize> {
        let own = self.vertices(window);
        self.blocks
            .iter()
            .filter(|block| touch(block, &own))
            .fold(own.clone(), |all, block| all.start.min(block.start)..all.end.max(block.end))
    }

    /// All triangles that touch a window, and some more, in order, a block at a
    /// time.
    pub(super) fn triangles(&self, window: usize) -> impl Iterator<Item = &'a [[u32; 3]]> {
        let own = self.vertices(window);
        let count = self.mesh.triangles.len();
        let touching = move |&(_, block): &(usize, &Range<usize>)| touch(block, &own);
        self.blocks
            .iter()
            .enumerate()
            .filter(touching)
            .map(move |(n, _)| &self.mesh.triangles[n * BLOCK..((n + 1) * BLOCK).min(count)])
    }
}

fn touch(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.start < b.end && b.start < a.end
}
