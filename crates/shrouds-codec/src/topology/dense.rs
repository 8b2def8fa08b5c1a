//! The profile `dense`: a small network that knows what surfaces look like, and tables that learn what
//! this one looks like.

use crate::counter::Counter;
use crate::logistic::squash;
use crate::mixer::{Mixer, Refinement, counted};
use crate::network::{Bits, Network};
use crate::topology::contexts::{CONTEXTS, Contexts, SIZE_BITS};
use crate::topology::window::{Model, ROWS, Window};

/// Voxels that the network looks at, and its hidden units.
pub const INPUTS: usize = 192;
pub const HIDDEN: usize = 16;
/// The tables, the network, and a constant.
const OPINIONS: usize = CONTEXTS + 2;

/// Bits after which a counter begins to forget.
const MEMORY: u32 = 255;
/// How fast the network learns, in units of 1/65536.
pub const RATE: u32 = 400;

/// A network and tables, mixed.
#[derive(Debug, Clone)]
pub struct Dense {
    pub network: Network<INPUTS, HIDDEN>,
    tables: Vec<Counter>,
    mixers: [Mixer<OPINIONS>; 2],
    refinements: [Refinement; 2],
    /// Of the voxel that is being coded: what the network sees, its probability, and the places in the
    /// tables.
    bits: Bits<3>,
    probability: u16,
    places: [usize; CONTEXTS],
}

impl Dense {
    pub fn new(network: Network<INPUTS, HIDDEN>) -> Self {
        let mut weights = [4000; OPINIONS];
        weights[CONTEXTS] = 52000;
        weights[CONTEXTS + 1] = 0;
        Self {
            network,
            tables: vec![Counter::default(); CONTEXTS << SIZE_BITS],
            mixers: [Mixer::new(8, weights, 2), Mixer::new(64, weights, 2)],
            refinements: [Refinement::new(1 << 10, 6), Refinement::new(1 << 10, 6)],
            bits: Bits([0; 3]),
            probability: 0,
            places: [0; CONTEXTS],
        }
    }
}

impl Default for Dense {
    fn default() -> Self {
        let prior = std::fs::read("/tmp/codecdata/prior.bin").ok().map(|b| b.chunks_exact(2).map(|c| i16::from_le_bytes([c[0], c[1]])).collect::<Vec<_>>());
        let rate = std::env::var("RATE").ok().and_then(|x| x.parse().ok()).unwrap_or(RATE);
        match prior {
            Some(p) if p.len() == Network::<INPUTS, HIDDEN>::PARAMETERS => Self::new(Network::from_prior(&p, rate)),
            _ => Self::new(Network::random(5, 16000, 1310)),
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
        self.places = places;
        let mut opinions = [256; OPINIONS];
        for (table, opinion) in opinions[..CONTEXTS].iter_mut().enumerate() {
            self.places[table] |= table << SIZE_BITS;
            *opinion = counted(self.tables[self.places[table]]);
        }
        opinions[CONTEXTS] = logit.clamp(-2800, 2800);
        let [a, b] = [0, 1].map(|m: usize| self.mixers[m].mix(&opinions, sets[m]));
        let logit = (a + b) >> 1;
        let mixed = i32::from(squash(logit));
        let [c, d] = [0, 1].map(|r: usize| i32::from(self.refinements[r].refine(logit, refined[r])));
        ((2 * mixed + c + d) >> 2).max(1) as u16
    }

    #[inline]
    fn update(&mut self, inside: bool) {
        self.network.update(&self.bits, inside, self.probability);
        self.places.iter().for_each(|&place| self.tables[place].update(inside, MEMORY));
        self.mixers.iter_mut().for_each(|mixer| mixer.update(inside));
        self.refinements.iter_mut().for_each(|refinement| refinement.update(inside));
    }
}
