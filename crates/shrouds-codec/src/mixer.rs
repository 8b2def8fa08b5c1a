//! The opinions of several models made into one.

use crate::logistic::{LIMIT, squash, stretch};

/// A weighted sum of logits, with weights that learn which models to trust.
///
/// There are several sets of weights; the caller picks one for each bit by what it knows of it.
/// Source: logistic mixing as in Mahoney, *Adaptive weighing of context models* (2005).
#[derive(Debug, Clone)]
pub struct Mixer<const MODELS: usize> {
    sets: Vec<Set<MODELS>>,
    /// The set, the inputs and the probability of the bit that is being coded.
    at: usize,
    inputs: [i32; MODELS],
    probability: u16,
    rate: i32,
}

#[derive(Debug, Clone, Copy)]
struct Set<const MODELS: usize> {
    /// In units of 1/65536.
    weights: [i32; MODELS],
    seen: u8,
}

impl<const MODELS: usize> Mixer<MODELS> {
    /// A mixer of `sets` sets, each of them beginning with `weights`, in units of 1/65536. `rate` is how
    /// fast it learns, 2 for a start; the first bits of a set count up to four times as much.
    pub fn new(sets: usize, weights: [i32; MODELS], rate: i32) -> Self {
        let sets = vec![Set { weights, seen: 0 }; sets];
        Self { sets, at: 0, inputs: [0; MODELS], probability: 1 << 15, rate }
    }

    /// The logit that the models have together with the weights of `set`, in units of 1/256 as those
    /// of the inputs.
    #[inline]
    pub fn mix(&mut self, inputs: &[i32; MODELS], set: usize) -> i32 {
        (self.at, self.inputs) = (set, *inputs);
        let weights = &self.sets[set].weights;
        let sum: i64 = weights.iter().zip(inputs).map(|(&w, &x)| i64::from(w) * i64::from(x)).sum();
        let logit = (sum >> 16).clamp(-i64::from(LIMIT), i64::from(LIMIT)) as i32;
        self.probability = squash(logit);
        logit
    }

    /// Learns from the bit that came.
    #[inline]
    pub fn update(&mut self, bit: bool) {
        let set = &mut self.sets[self.at];
        let haste = 4 - i32::from(set.seen >> 6);
        set.seen = set.seen.saturating_add(1);
        let error = (i32::from(bit) << 16) - i32::from(self.probability);
        let step = i64::from(error * self.rate * haste);
        for (weight, &input) in set.weights.iter_mut().zip(&self.inputs) {
            *weight = weight.wrapping_add(((i64::from(input) * step + (1 << 19)) >> 20) as i32);
        }
    }
}

/// What a logit has come to mean, learnt for each context: corrects models that are too sure or not
/// sure enough.
#[derive(Debug, Clone)]
pub struct Refinement {
    curves: Vec<[u16; KNOTS]>,
    /// The curve and the nearer knot of the bit that is being coded.
    at: (usize, usize),
    shift: u32,
}

/// Knots of a curve, and the logits between two of them.
const KNOTS: usize = 33;
const GAP: i32 = 2 * (LIMIT + 1) / (KNOTS as i32 - 1);

impl Refinement {
    /// A refinement for `contexts` contexts that takes over one part in `1 << shift` of each error.
    pub fn new(contexts: usize, shift: u32) -> Self {
        let curve = std::array::from_fn(|knot| squash(GAP * knot as i32 - LIMIT - 1));
        Self { curves: vec![curve; contexts], at: (0, 0), shift }
    }

    /// The probability, in units of 1/65536, that a logit in units of 1/256 means in a context.
    #[inline]
    pub fn refine(&mut self, logit: i32, context: usize) -> u16 {
        let place = logit.clamp(-LIMIT, LIMIT) + LIMIT + 1;
        let (knot, part) = ((place / GAP) as usize, place % GAP);
        self.at = (context, knot + usize::from(part > GAP / 2));
        let curve = &self.curves[context];
        let (low, high) = (i32::from(curve[knot]), i32::from(curve[knot + 1]));
        ((low * (GAP - part) + high * part) / GAP).max(1) as u16
    }

    /// Learns from the bit that came.
    #[inline]
    pub fn update(&mut self, bit: bool) {
        let (context, knot) = self.at;
        let value = &mut self.curves[context][knot];
        if bit {
            *value += (u16::MAX - *value) >> self.shift;
        } else {
            *value -= *value >> self.shift;
        }
    }
}

/// The logit of a counter, the nearer to 0 the fewer bits it has seen, in units of 1/256.
#[inline(always)]
pub fn counted(counter: crate::counter::Counter) -> i32 {
    (stretch(counter.probability()) * TRUST[counter.seen().min(31) as usize]) >> 8
}

/// (n + 0.2) / (n + 1.5) in units of 1/256.
const TRUST: [i32; 32] = {
    let mut trust = [0; 32];
    let mut n = 0;
    while n < 32 {
        trust[n as usize] = 256 * (10 * n + 2) / (10 * n + 15);
        n += 1;
    }
    trust
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mixer_learns_whom_to_trust() {
        let mut mixer = Mixer::new(1, [32768; 2], 2);
        for n in 0..20_000 {
            let bit = n % 3 == 0;
            let right = if bit { 500 } else { -500 };
            let wrong = if n % 2 == 0 { 500 } else { -500 };
            mixer.mix(&[right, wrong], 0);
            mixer.update(bit);
        }
        assert!(mixer.mix(&[500, -500], 0) > 600);
        assert!(mixer.mix(&[-500, 500], 0) < -600);
    }

    #[test]
    fn a_refinement_begins_as_it_is_and_learns() {
        let mut refinement = Refinement::new(2, 6);
        for logit in [-LIMIT, -1000, -5, 0, 300, LIMIT] {
            let error = i32::from(refinement.refine(logit, 1)) - i32::from(squash(logit));
            assert!(error.abs() < 400, "{logit}: {error}");
        }
        for n in 0..3000 {
            refinement.refine(704, 1);
            refinement.update(n % 4 == 0);
        }
        assert!(refinement.refine(704, 1) < 22000);
        assert!(refinement.refine(704, 0) > 59000);
    }
}
