//! A walk through the voxels that codes runs where nothing is expected and asks a model elsewhere.

use crate::coder::Coder;
use crate::counter::Counter;
use crate::topology::layers::Layers;
use crate::topology::window::{Model, ROWS, Window};

/// Voxels that share one look at the rows around them: half a word, so that 64 bits reach 16 voxels
/// beyond on both sides.
const STRIP: usize = 32;
const BEYOND: i32 = 16;

/// Surprises that a flag remembers.
const MEMORY: u32 = 1000;

/// The walk: what it knows of the last layers and of how often runs are broken.
#[derive(Debug, Clone)]
pub struct Scan {
    nx: usize,
    ny: usize,
    layers: Layers,
    /// Whether a run is broken, by its side and the size of its length.
    flags: [[Counter; 7]; 2],
}

impl Scan {
    /// A walk through layers of `ny` rows of `nx` voxels, before the first one.
    pub fn new([nx, ny]: [usize; 2]) -> Self {
        // Runs are broken once in a thousand voxels, as long as nothing better is known.
        let flags = std::array::from_fn(|size| Counter::new(64 << size.min(5), 4));
        Self { nx, ny, layers: Layers::new(nx, ny), flags: [flags; 2] }
    }

    /// Codes a layer: `words` are its rows one after another, each beginning a new word. An encoder
    /// reads them, a decoder puts them there; bits past the end of a row are 0.
    pub fn layer<M: Model>(&mut self, coder: &mut impl Coder, model: &mut M, words: &mut [u64]) {
        self.layers.advance();
        for (j, row) in words.chunks_exact_mut(self.nx.div_ceil(64)).take(self.ny).enumerate() {
            self.row(coder, model, j, row);
            self.layers.finish_row(j, row);
        }
    }

    fn row<M: Model>(&mut self, coder: &mut impl Coder, model: &mut M, j: usize, row: &mut [u64]) {
        // The voxels before the next one, the nearest in the lowest bit.
        let mut known = 0;
        for (w, word) in row.iter_mut().enumerate() {
            let count = (self.nx - 64 * w).min(64);
            self.word(coder, model, [j, w, count], &mut known, word);
        }
    }

    /// Codes `count` voxels of word `w` of row `j`.
    #[inline(always)]
    fn word<M: Model>(
        &mut self,
        coder: &mut impl Coder,
        model: &mut M,
        [j, w, count]: [usize; 3],
        known: &mut u64,
        word: &mut u64,
    ) {
        let quiet = self.layers.quiet(j, w);
        let (source, mut coded) = (*word, 0);
        let mut near = Near::default();
        let mut x = 0;
        while x < count {
            let inside = *known & 1;
            let run = match *known & 3 {
                0 | 3 => (quiet[inside as usize] >> x).trailing_ones() as usize,
                _ => 0,
            };
            let (voxels, length) = if run > 0 {
                self.run(coder, inside, source >> x, run.min(count - x))
            } else {
                let window = near.window::<M>(&self.layers, [j, w, x], *known);
                let probability = model.predict(&window);
                let voxel = coder.code(source >> x & 1 == 1, probability);
                model.update(voxel);
                (u64::from(voxel), 1)
            };
            coded |= voxels << x;
            // Shifted in two steps, because one of 64 is not allowed.
            *known = *known << (length - 1) << 1 | voxels.reverse_bits() >> (64 - length);
            x += length;
        }
        *word = coded;
    }

    /// Codes voxels that are expected to be like those before: all `length` of them, or those up to the
    /// first that is not. Returns them and how many there are.
    #[inline(always)]
    fn run(
        &mut self,
        coder: &mut impl Coder,
        inside: u64,
        source: u64,
        length: usize,
    ) -> (u64, usize) {
        let expected = 0u64.wrapping_sub(inside);
        let within = u64::MAX >> (64 - length);
        let same = (source ^ expected).trailing_zeros() as usize;
        let flag = &mut self.flags[inside as usize][length.ilog2() as usize];
        let broken = coder.code(same < length, flag.probability());
        flag.update(broken, MEMORY);
        if !broken {
            return (expected & within, length);
        }
        let same = coder.code_below(same as u32, length as u32) as usize;
        let voxels = expected & (u64::MAX >> (63 - same)) ^ 1 << same;
        (voxels, same + 1)
    }
}

/// The rows around a strip of voxels, once a model has to know of them.
#[derive(Default)]
struct Near {
    /// The strip of the word, from 1.
    strip: usize,
    rows: [u64; ROWS.len()],
}

impl Near {
    #[inline(always)]
    fn window<M: Model>(&mut self, layers: &Layers, [j, w, x]: [usize; 3], known: u64) -> Window {
        let strip = x / STRIP + 1;
        if self.strip != strip {
            self.strip = strip;
            let start = (x / STRIP * STRIP) as i32 - BEYOND;
            for (row, &steps) in self.rows.iter_mut().zip(&ROWS).take(M::ROWS) {
                *row = layers.read(j, steps, w, start);
            }
        }
        let mut window = [0; 24];
        window[0] = known as u8;
        let shift = x as i32 % STRIP as i32 + BEYOND - 3;
        for (byte, row) in window[1..].iter_mut().zip(&self.rows).take(M::ROWS) {
            *byte = (row >> shift) as u8;
        }
        window
    }
}
