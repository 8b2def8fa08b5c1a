//! A walk through the labels: runs where nothing is expected, elsewhere one question after another:
//! is it the label of this neighbour?

use crate::coder::Coder;
use crate::counter::Counter;
use crate::labels::layers::Layers;
use crate::topology::Model;

/// Longest run.
const LONGEST: usize = 64;
/// Neighbours whose labels are asked for, as steps along x, y, z.
const ASKED: [[isize; 3]; 9] = [
    [-1, 0, 0],
    [0, -1, 0],
    [0, 0, -1],
    [1, -1, 0],
    [0, 1, -1],
    [1, 0, -1],
    [-1, -1, 0],
    [0, -1, -1],
    [-1, 0, -1],
];
/// Different labels that are asked for before the label is told.
const QUESTIONS: usize = 4;
/// Bits that counters of flags and of told labels remember.
const MEMORY: u32 = 1000;
const TOLD_MEMORY: u32 = 60;
/// Told labels have one counter for each beginning of this many bits.
const LEARNT_BITS: u32 = 16;

/// The walk.
pub(super) struct Scan<M> {
    nx: usize,
    layers: Layers,
    flags: [Counter; 7],
    /// One for each question, made when it is first asked.
    models: [Option<M>; QUESTIONS],
    told: Vec<Counter>,
    labels: usize,
}

impl<M: Model + Default> Scan<M> {
    /// A walk through layers of so many voxels along x and y with so many labels.
    pub(super) fn new([nx, ny]: [usize; 2], labels: usize) -> Self {
        let bits = bits_of(labels).min(LEARNT_BITS);
        Self {
            nx,
            layers: Layers::new([nx, ny]),
            flags: std::array::from_fn(|size| Counter::new(64 << size.min(5), 4)),
            models: std::array::from_fn(|_| None),
            told: vec![Counter::default(); 1 << bits],
            labels,
        }
    }

    /// Codes a layer, x fastest.
    pub(super) fn layer(&mut self, coder: &mut impl Coder, labels: &mut [u32]) {
        self.layers.advance();
        for (j, row) in labels.chunks_exact_mut(self.nx).enumerate() {
            let mut x = 0;
            while x < row.len() {
                x += self.run(coder, j, x, row);
                if x < row.len() {
                    row[x] = self.voxel(coder, [j, x], row[x]);
                    self.layers.set([j, x], row[x]);
                    x += 1;
                }
            }
            self.layers.finish_row(j);
        }
    }

    /// Codes voxels that are like those before as long as that is expected and so; how many.
    fn run(&mut self, coder: &mut impl Coder, j: usize, x: usize, row: &mut [u32]) -> usize {
        let label = self.layers.label([j, x], [-1, 0, 0]);
        if self.layers.label([j, x], [-2, 0, 0]) != label {
            return 0;
        }
        let end = row.len().min(x / LONGEST * LONGEST + LONGEST);
        let quiet = (x..end).take_while(|&x| self.layers.is_quiet([j, x], label)).count();
        if quiet == 0 {
            return 0;
        }
        let same = row[x..x + quiet].iter().take_while(|&&other| other == label).count();
        let flag = &mut self.flags[quiet.ilog2() as usize];
        let broken = coder.code(same < quiet, flag.probability());
        flag.update(broken, MEMORY);
        let same =
            if broken { coder.code_below(same as u32, quiet as u32) as usize } else { quiet };
        row[x..x + same].fill(label);
        (x..x + same).for_each(|at| self.layers.set([j, at], label));
        if !broken {
            return same;
        }
        let at = x + same;
        row[at] = self.tell(coder, row[at]);
        self.layers.set([j, at], row[at]);
        same + 1
    }

    /// Codes the label of a voxel at a boundary.
    fn voxel(&mut self, coder: &mut impl Coder, place: [usize; 2], label: u32) -> u32 {
        let mut asked = [0; QUESTIONS];
        let mut count = 0;
        for steps in ASKED {
            let candidate = self.layers.label(place, steps);
            if count == QUESTIONS || asked[..count].contains(&candidate) {
                continue;
            }
            let model = self.models[count].get_or_insert_with(M::default);
            let probability = model.predict(&self.layers.window(place, candidate, M::ROWS));
            let is_it = coder.code(label == candidate, probability);
            model.update(is_it);
            if is_it {
                return candidate;
            }
            asked[count] = candidate;
            count += 1;
        }
        self.tell(coder, label)
    }

    /// Codes a label that no neighbour has, bit by bit, the highest first.
    fn tell(&mut self, coder: &mut impl Coder, label: u32) -> u32 {
        let bits = bits_of(self.labels);
        let mut told = 1;
        for place in (0..bits).rev() {
            let bit = label >> place & 1 == 1;
            let bit = match self.told.get_mut(told as usize) {
                Some(counter) => {
                    let bit = coder.code(bit, counter.probability());
                    counter.update(bit, TOLD_MEMORY);
                    bit
                }
                None => coder.code(bit, 1 << 15),
            };
            told = told << 1 | u64::from(bit);
        }
        // Damaged bytes may tell a label that there is not.
        ((told - (1 << bits)) as u32).min(self.labels.saturating_sub(1) as u32)
    }
}

/// Bits that tell one of so many labels.
fn bits_of(labels: usize) -> u32 {
    usize::BITS - labels.saturating_sub(1).leading_zeros()
}
