//! The profile `dense`: a small network that knows what surfaces look like, and tables that learn what
//! this one looks like.

use crate::counter::Counter;
use crate::logistic::squash;
use crate::mixer::{Mixer, Refinement, counted};
use crate::network::{Bits, Network};
use crate::topology::contexts::{CONTEXTS, Contexts, REFINED, SETS, SIZE_BITS};
use crate::topology::window::{Model, ROWS, Window};

/// Voxels that the network looks at: all of a [`Window`].
pub const INPUTS: usize = 192;
/// Hidden units of the network.
pub const HIDDEN: usize = 32;
/// The tables, the network, and a constant.
const OPINIONS: usize = CONTEXTS + 2;

/// The network before it has seen a volume, made by `cargo xtask train`: numbers of two bytes, the low
/// one first, in the order of [`Network::from_prior`].
const PRIOR: [u8; 2 * Network::<INPUTS, HIDDEN>::PARAMETERS] = *include_bytes!("prior.bin");

/// Bits after which a counter begins to forget.
const MEMORY: u32 = 255;
/// How fast the network learns, in units of 1/65536.
const RATE: u32 = 200;
/// How much the opinions weigh in the beginning, in units of 1/65536.
const TABLE_WEIGHT: i32 = 2000;
const NETWORK_WEIGHT: i32 = 58_000;
/// How fast mixers and refinements learn.
const MIXER_RATE: i32 = 6;
const REFINEMENT_SHIFT: u32 = 6;

/// A network and tables, mixed.
#[derive(Debug, Clone)]
pub struct Dense {
    network: Network<INPUTS, HIDDEN>,
    tables: Vec<Counter>,
    mixers: [Mixer<OPINIONS>; 2],
    refinements: [Refinement; 2],
    /// Of the voxel that is being coded: what the network sees, its probability, and the places in the
    /// tables.
    bits: Bits<3>,
    probability: u16,
    places: [usize; CONTEXTS],
}

impl Default for Dense {
    fn default() -> Self {
        let (numbers, _) = PRIOR.as_chunks::<2>();
        let prior: Vec<i16> = numbers.iter().map(|&number| i16::from_le_bytes(number)).collect();
        let mut weights = [TABLE_WEIGHT; OPINIONS];
        (weights[CONTEXTS], weights[CONTEXTS + 1]) = (NETWORK_WEIGHT, 0);
        Self {
            network: Network::from_prior(&prior, RATE),
            tables: vec![Counter::default(); CONTEXTS << SIZE_BITS],
            mixers: SETS.map(|sets| Mixer::new(sets, weights, MIXER_RATE)),
            refinements: REFINED.map(|contexts| Refinement::new(contexts, REFINEMENT_SHIFT)),
            bits: Bits([0; 3]),
            probability: 0,
            places: [0; CONTEXTS],
        }
    }
}

impl Model for Dense {
    const ROWS: usize = ROWS.len();

    #[inline]
    fn predict(&mut self, window: &Window) -> u16 {
        self.bits = Bits::of_bytes(window);
        let logit = self.network.logit(&self.bits);
        self.probability = squash(logit);
        let Contexts { places, sets, refined } = Contexts::of(window);
        let mut opinions = [256; OPINIONS];
        for (table, opinion) in opinions[..CONTEXTS].iter_mut().enumerate() {
            self.places[table] = table << SIZE_BITS | places[table];
            *opinion = counted(self.tables[self.places[table]]);
        }
        opinions[CONTEXTS] = logit;
        let mut mixed = 0;
        for (mixer, set) in self.mixers.iter_mut().zip(sets) {
            mixed += mixer.mix(&opinions, set);
        }
        let logit = mixed >> 1;
        let mut sum = 2 * u32::from(squash(logit));
        for (refinement, context) in self.refinements.iter_mut().zip(refined) {
            sum += u32::from(refinement.refine(logit, context));
        }
        (sum >> 2).max(1) as u16
    }

    #[inline]
    fn update(&mut self, inside: bool) {
        self.network.update(&self.bits, inside, self.probability);
        self.places.iter().for_each(|&place| self.tables[place].update(inside, MEMORY));
        self.mixers.iter_mut().for_each(|mixer| mixer.update(inside));
        self.refinements.iter_mut().for_each(|refinement| refinement.update(inside));
    }
}
