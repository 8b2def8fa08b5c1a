//! The crossings in vertex order.

use crate::surface::Surface;
use crate::surface::bits::shifted;
use crate::surface::crossing::Crossing;

impl Surface {
    /// All crossings in vertex order.
    pub fn crossings(&self) -> impl ExactSizeIterator<Item = Crossing> {
        Crossings::new(self, 0..3 * (self.rows.len() - 1))
    }

    /// The crossings of [`slice_vertices`](Self::slice_vertices), in vertex order.
    ///
    /// # Panics
    /// When there is no such slice.
    pub fn slice_crossings(&self, k: usize) -> impl ExactSizeIterator<Item = Crossing> {
        assert!(k < self.slice_count(), "slice {k} of {}", self.slice_count());
        let rows = self.grid().dims()[1];
        Crossings::new(self, 3 * k * rows..3 * (k + 1) * rows)
    }

    /// The crossing of one vertex, by a search over the rows. For loops over many there is
    /// [`slice_crossings`](Self::slice_crossings).
    ///
    /// # Panics
    /// When there is no such vertex.
    pub fn crossing(&self, v: u32) -> Crossing {
        assert!((v as usize) < self.vertex_count(), "vertex {v} of {}", self.vertex_count());
        let firsts = self.rows.as_flattened();
        let stream = firsts.partition_point(|&first| first <= v) - 1;
        let mut crossings = Crossings::new(self, stream..stream + 1);
        match crossings.nth((v - firsts[stream]) as usize) {
            Some(crossing) => crossing,
            None => unreachable!("the rows count their crossings"),
        }
    }
}

/// The crossings of some streams: stream `3·row + axis` holds those of a lattice row along an axis.
struct Crossings<'a> {
    surface: &'a Surface,
    /// Streams not begun.
    streams: std::ops::Range<usize>,
    /// The row of the current stream, and the next one along its axis.
    pair: [&'a [u64]; 2],
    axis: usize,
    /// The crossing at the start of the row with its inside end high.
    start: Crossing,
    /// The current word, what is left of it, and the lattice points it belongs to.
    word: usize,
    crossed: u64,
    inside: u64,
    /// Crossings left in the current stream, and in all.
    left_in_stream: u32,
    left: usize,
}

impl<'a> Crossings<'a> {
    fn new(surface: &'a Surface, streams: std::ops::Range<usize>) -> Self {
        let firsts = surface.rows.as_flattened();
        let left = (firsts[streams.end] - firsts[streams.start]) as usize;
        Self {
            surface,
            streams,
            pair: [&[]; 2],
            axis: 0,
            start: Crossing::new([0; 3], 0, false),
            word: 0,
            crossed: 0,
            inside: 0,
            left_in_stream: 0,
            left,
        }
    }

    /// Moves on to the next stream that has crossings; there must be one.
    fn next_stream(&mut self) {
        let firsts = self.surface.rows.as_flattened();
        let Some(stream) = self.streams.find(|&s| firsts[s] != firsts[s + 1]) else { return };
        let [_, ny, _] = self.surface.grid().dims();
        let (row, axis) = (stream / 3, stream % 3);
        let (j, k) = (row % ny, row / ny);
        self.left_in_stream = firsts[stream + 1] - firsts[stream];
        self.axis = axis;
        self.start = Crossing::new([0, j, k], axis, false);
        let [other_j, other_k] = [[j, k], [j + 1, k], [j, k + 1]][axis];
        self.pair = [self.surface.volume.row(j, k), self.surface.volume.row(other_j, other_k)];
        self.next_word(0);
    }

    /// Moves on to the first word from `word` on that has crossings; there must be one.
    #[inline]
    fn next_word(&mut self, word: usize) {
        let [here, other] = self.pair;
        for w in word..here.len() {
            // Along x this lets an inside point at the end differ from one beyond, but the number of
            // crossings in the stream does not count that.
            let other = if self.axis == 0 { shifted(here, w) } else { other[w] };
            if here[w] != other {
                (self.word, self.inside, self.crossed) = (w, here[w], here[w] ^ other);
                return;
            }
        }
    }
}

impl Iterator for Crossings<'_> {
    type Item = Crossing;

    #[inline]
    fn next(&mut self) -> Option<Crossing> {
        if self.left == 0 {
            return None;
        }
        if self.left_in_stream == 0 {
            self.next_stream();
        } else if self.crossed == 0 {
            self.next_word(self.word + 1);
        }
        let bit = self.crossed.trailing_zeros();
        self.crossed &= self.crossed - 1;
        self.left_in_stream -= 1;
        self.left -= 1;
        Some(self.start.along_row(64 * self.word as u64 + u64::from(bit), self.inside >> bit & 1))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Crossings<'_> {}
