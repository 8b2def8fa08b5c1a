//! The last few layers of voxels, as rows of 64-bit words.

/// Words of zeros before and after each row, and rows of zeros before and after each layer.
const MARGIN_WORDS: usize = 1;
const MARGIN_ROWS: usize = 3;
/// The layer that is being coded and the four before it.
const DEPTH: usize = 5;

/// Voxels within this many steps along x, y and z decide whether a voxel is in a run.
const REACH: u32 = 2;

/// The last layers, with zeros around them.
#[derive(Debug, Clone)]
pub(super) struct Layers {
    /// Words of a row that hold voxels.
    words: usize,
    rows: usize,
    /// The newest first.
    bits: [Vec<u64>; DEPTH],
    /// For the newest layer, where all and where any of the voxels within reach along x are inside.
    along_x: Sides,
    /// The same within reach along x and y, for the layer before.
    near: Sides,
    /// The same within reach along x and a step along y, for the layer before and the one before that.
    far: [Sides; 2],
    /// The same for all known voxels of the layers before that are within reach.
    before: Sides,
}

/// Words of bits that tell where all of some voxels are inside and where any is.
#[derive(Debug, Clone)]
struct Sides {
    all: Vec<u64>,
    any: Vec<u64>,
}

impl Sides {
    fn new(words: usize) -> Self {
        Self { all: vec![0; words], any: vec![0; words] }
    }

    /// Sets `count` words from `at` to what `others` say together.
    fn gather<'a>(
        &mut self,
        at: usize,
        count: usize,
        others: impl IntoIterator<Item = (&'a Self, usize)>,
    ) {
        let (all, any) = (&mut self.all[at..at + count], &mut self.any[at..at + count]);
        all.fill(u64::MAX);
        any.fill(0);
        for (other, from) in others {
            let range = from..from + count;
            all.iter_mut().zip(&other.all[range.clone()]).for_each(|(all, more)| *all &= more);
            any.iter_mut().zip(&other.any[range]).for_each(|(any, more)| *any |= more);
        }
    }
}

impl Layers {
    /// Layers of nothing; a row has `nx` voxels and a layer `ny` rows.
    pub(super) fn new(nx: usize, ny: usize) -> Self {
        let words = nx.div_ceil(64);
        let size = (words + 2 * MARGIN_WORDS) * (ny + 2 * MARGIN_ROWS);
        let sides = || Sides::new(size);
        Self {
            words,
            rows: ny,
            bits: std::array::from_fn(|_| vec![0; size]),
            along_x: sides(),
            near: sides(),
            far: [sides(), sides()],
            before: sides(),
        }
    }

    fn stride(&self) -> usize {
        self.words + 2 * MARGIN_WORDS
    }

    /// Where the words of row `j` start.
    fn row(&self, j: isize) -> usize {
        (j + MARGIN_ROWS as isize) as usize * self.stride() + MARGIN_WORDS
    }

    /// Begins a layer.
    pub(super) fn advance(&mut self) {
        let (stride, start) = (self.stride() as isize, self.row(0));
        // All rows at once; what the margins between them get is never looked at.
        let count = self.rows * self.stride() - 2 * MARGIN_WORDS;
        let x = &self.along_x;
        let from = |step: isize| (x, (start as isize + step * stride) as usize);
        self.far.swap(0, 1);
        self.near.gather(start, count, (-2..=2).map(from));
        self.far[0].gather(start, count, (-1..=1).map(from));
        self.before.gather(start, count, [(&self.near, start), (&self.far[1], start)]);
        self.bits.rotate_right(1);
    }

    /// Where all known voxels around those of a word are outside, and where all are inside.
    #[inline(always)]
    pub(super) fn quiet(&self, j: usize, w: usize) -> [u64; 2] {
        let [here, one, two] = [0, -1, -2].map(|step| self.row(j as isize + step) + w);
        let (x, before) = (&self.along_x, &self.before);
        [!(before.any[here] | x.any[one] | x.any[two]), before.all[here] & x.all[one] & x.all[two]]
    }

    /// Takes in row `j` of the newest layer.
    pub(super) fn finish_row(&mut self, j: usize, row: &[u64]) {
        let at = self.row(j as isize);
        self.bits[0][at..at + self.words].copy_from_slice(row);
        let bits = &self.bits[0];
        for w in at..at + self.words {
            let (before, word, after) = (bits[w - 1], bits[w], bits[w + 1]);
            let (mut all, mut any) = (word, word);
            for step in 1..=REACH {
                let left = word << step | before >> (64 - step);
                let right = word >> step | after << (64 - step);
                all &= left & right;
                any |= left | right;
            }
            (self.along_x.all[w], self.along_x.any[w]) = (all, any);
        }
    }

    /// 64 voxels of a row `steps` along y and z from row `j`: bit 0 is voxel `64 w + start`, which
    /// may lie up to 63 voxels before or after word `w`.
    #[inline(always)]
    pub(super) fn read(&self, j: usize, steps: [isize; 2], w: usize, start: i32) -> u64 {
        let bits = &self.bits[steps[1].unsigned_abs()];
        let at = self.row(j as isize + steps[0]) + w;
        match start {
            0 => bits[at],
            1.. => bits[at] >> start | bits[at + 1] << (64 - start),
            _ => bits[at] << -start | bits[at - 1] >> (64 + start),
        }
    }
}
