//! A small neural network of integers that learns from every bit.
//!
//! One hidden layer of leaky rectifiers and one logit. Weights are in units of 1/65536. The sums of
//! the first layer wrap around, so that they may be added in any order and by vector instructions;
//! what learning does to the weights is rounded, never cut off.

/// What goes into a network.
pub trait Inputs<const COUNT: usize> {
    /// `bias` plus the sum over the inputs of what comes in times the weights of the input.
    fn weigh<const HIDDEN: usize>(
        &self,
        weights: &[[i32; HIDDEN]; COUNT],
        bias: &[i32; HIDDEN],
    ) -> [i32; HIDDEN];

    /// Moves weights and bias against the gradient: `steps` are the steps for an input of 1.
    fn descend<const HIDDEN: usize>(
        &self,
        weights: &mut [[i32; HIDDEN]; COUNT],
        bias: &mut [i32; HIDDEN],
        steps: &[i32; HIDDEN],
    );
}

/// Inputs that are numbers in units of 1/256, best within ±4.
impl<const COUNT: usize> Inputs<COUNT> for [i32; COUNT] {
    #[inline]
    fn weigh<const HIDDEN: usize>(
        &self,
        weights: &[[i32; HIDDEN]; COUNT],
        bias: &[i32; HIDDEN],
    ) -> [i32; HIDDEN] {
        let mut sums = [0i32; HIDDEN];
        for (&input, row) in self.iter().zip(weights) {
            for (sum, &weight) in sums.iter_mut().zip(row) {
                // Four bits less, so that 31 hold the sum of several large ones.
                *sum = sum.wrapping_add((weight >> 4).wrapping_mul(input));
            }
        }
        std::array::from_fn(|j| bias[j].wrapping_add(sums[j] >> 4))
    }

    #[inline]
    fn descend<const HIDDEN: usize>(
        &self,
        weights: &mut [[i32; HIDDEN]; COUNT],
        bias: &mut [i32; HIDDEN],
        steps: &[i32; HIDDEN],
    ) {
        for (&input, row) in self.iter().zip(weights) {
            for (weight, &step) in row.iter_mut().zip(steps) {
                *weight = weight.wrapping_sub(step.wrapping_mul(input).wrapping_add(128) >> 8);
            }
        }
        for (bias, &step) in bias.iter_mut().zip(steps) {
            *bias = bias.wrapping_sub(step);
        }
    }
}

/// Inputs that are bits, input `i` being bit `i % 64` of word `i / 64`.
///
/// They weigh 0 or 1, which leaves half of the weights out of the sum, but the network learns as if
/// they were −1 and 1, which converges better: the two differ by a change of the bias.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bits<const WORDS: usize>(pub [u64; WORDS]);

impl Bits<3> {
    /// The bits of some bytes, one byte after another.
    #[inline]
    pub fn of_bytes(bytes: &[u8; 24]) -> Self {
        let (words, _) = bytes.as_chunks::<8>();
        Self(std::array::from_fn(|w| u64::from_le_bytes(words[w])))
    }
}

impl<const WORDS: usize, const COUNT: usize> Inputs<COUNT> for Bits<WORDS> {
    #[inline]
    fn weigh<const HIDDEN: usize>(
        &self,
        weights: &[[i32; HIDDEN]; COUNT],
        bias: &[i32; HIDDEN],
    ) -> [i32; HIDDEN] {
        let mut sums = *bias;
        for (&word, rows) in self.0.iter().zip(weights.chunks_exact(64)) {
            let mut rest = word;
            while rest != 0 {
                let row = &rows[rest.trailing_zeros() as usize];
                sums = std::array::from_fn(|j| sums[j].wrapping_add(row[j]));
                rest &= rest - 1;
            }
        }
        sums
    }

    #[inline]
    fn descend<const HIDDEN: usize>(
        &self,
        weights: &mut [[i32; HIDDEN]; COUNT],
        bias: &mut [i32; HIDDEN],
        steps: &[i32; HIDDEN],
    ) {
        // A weight between −1 and 1 that moves by a step is one between 0 and 1 that moves by two.
        let changes = [steps.map(|step| 2 * step), steps.map(|step| -2 * step)];
        for (&word, rows) in self.0.iter().zip(weights.chunks_exact_mut(64)) {
            for (place, row) in rows.iter_mut().enumerate() {
                let change = &changes[(word >> place & 1) as usize];
                // All of them read before one is written, so that vector instructions do it.
                *row = std::array::from_fn(|j| row[j].wrapping_add(change[j]));
            }
        }
        let set: u32 = self.0.iter().map(|word| word.count_ones()).sum();
        let balance = 2 * set as i32 - COUNT as i32 - 1;
        for (bias, &step) in bias.iter_mut().zip(steps) {
            *bias = bias.wrapping_add(step.wrapping_mul(balance));
        }
    }
}

/// The network: `INPUTS` inputs, `HIDDEN` units, one logit.
#[derive(Debug, Clone)]
pub struct Network<const INPUTS: usize, const HIDDEN: usize> {
    weights: Box<[[i32; HIDDEN]; INPUTS]>,
    bias: [i32; HIDDEN],
    output: [i32; HIDDEN],
    output_bias: i32,
    /// What came out of the hidden units last.
    hidden: [i32; HIDDEN],
    /// Mean squares of the gradients of `bias` and `output`, in units of 2⁻⁴⁸, and the steps per
    /// gradient that follow from them, in units of 2⁻³².
    squares: [[u64; HIDDEN]; 2],
    paces: [[i64; HIDDEN]; 2],
    rate: u32,
    updates: u32,
}

/// Errors below this, in units of 1/65536, teach nothing worth the time.
const LEAST_ERROR: u32 = 100;
/// Added to the root mean square of a gradient, in units of 2⁻²⁴, before anything is divided by it.
const FLOOR: u64 = 1311 << 8;
/// Gradients are cut off at 16, in units of 2⁻²⁴: what follows from them fits into 64 bits.
const STEEPEST: i64 = 1 << 28;
/// Updates between two looks at the paces.
const PACE_EVERY: u32 = 16;

impl<const INPUTS: usize, const HIDDEN: usize> Network<INPUTS, HIDDEN> {
    /// Numbers in a prior: weights, biases, output weights and output bias.
    pub const PARAMETERS: usize = (INPUTS + 2) * HIDDEN + 1;

    /// A network of random weights, always the same for a seed. Weights of the first layer lie within
    /// ±`spread`, in units of 1/65536. `rate` is how fast it learns, in the
    /// same units, below 1.
    pub fn random(seed: u64, spread: u32, rate: u32) -> Self {
        let mut state = seed;
        let mut next = |spread: u32| {
            // SplitMix64 (Steele, Lea and Flood, 2014).
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            let unit = ((z ^ (z >> 31)) >> 40) as i64 - (1 << 23);
            ((unit * i64::from(spread)) >> 23) as i32
        };
        let mut network = Self::still(rate);
        network.weights.iter_mut().flatten().for_each(|weight| *weight = next(spread));
        network.output.iter_mut().for_each(|weight| *weight = next(1 << 14));
        network
    }

    /// The network of a prior: for each input the weights to all units, then the biases of the units,
    /// their output weights, and the output bias. Weights are in units of 1/2048 and biases in units of
    /// 1/256. Numbers that are missing are 0.
    pub fn from_prior(prior: &[i16], rate: u32) -> Self {
        let mut numbers = prior.iter().map(|&number| i32::from(number)).chain(std::iter::repeat(0));
        let mut next = |unit: u32| numbers.next().unwrap_or(0) << unit;
        let mut network = Self::still(rate);
        network.weights.iter_mut().flatten().for_each(|weight| *weight = next(5));
        network.bias.iter_mut().for_each(|bias| *bias = next(8));
        network.output.iter_mut().for_each(|weight| *weight = next(5));
        network.output_bias = next(8);
        network
    }

    /// The prior that this network is, rounded.
    pub fn to_prior(&self) -> Vec<i16> {
        let rounded = |value: i32, unit: u32| {
            (value.saturating_add(1 << (unit - 1)) >> unit).clamp(i16::MIN.into(), i16::MAX.into())
                as i16
        };
        let weights = self.weights.iter().flatten().map(|&weight| rounded(weight, 5));
        let biases = self.bias.iter().map(|&bias| rounded(bias, 8));
        let outputs = self.output.iter().map(|&weight| rounded(weight, 5));
        weights.chain(biases).chain(outputs).chain([rounded(self.output_bias, 8)]).collect()
    }

    /// A network without weights.
    fn still(rate: u32) -> Self {
        let weights = vec![[0; HIDDEN]; INPUTS].try_into();
        Self {
            weights: weights.unwrap_or_else(|_| unreachable!("as many rows as were asked for")),
            bias: [0; HIDDEN],
            output: [0; HIDDEN],
            output_bias: 0,
            hidden: [0; HIDDEN],
            squares: [[0; HIDDEN]; 2],
            paces: [[0; HIDDEN]; 2],
            rate,
            updates: 0,
        }
    }

    /// Changes how fast it learns, in units of 1/65536, below 65536.
    pub fn set_rate(&mut self, rate: u32) {
        self.rate = rate;
    }

    /// The logit for some inputs, in units of 1/256.
    #[inline]
    pub fn logit(&mut self, inputs: &impl Inputs<INPUTS>) -> i32 {
        let sums = inputs.weigh(&self.weights, &self.bias);
        self.hidden = sums.map(|sum| if sum > 0 { sum } else { sum >> 3 });
        let products = self.hidden.iter().zip(&self.output);
        let bias = i64::from(self.output_bias) << 16;
        let sum = products
            .fold(bias, |sum, (&h, &w)| sum.wrapping_add(i64::from(h).wrapping_mul(i64::from(w))));
        (sum >> 24).clamp(-4000, 4000) as i32
    }

    /// Learns that for the inputs of the last [`Network::logit`], a bit came to which `probability`, in
    /// units of 1/65536, had been given: the network's own, or that of a mixture it is part of.
    #[inline]
    pub fn update(&mut self, inputs: &impl Inputs<INPUTS>, bit: bool, probability: u16) {
        let error = i32::from(probability) - (i32::from(bit) << 16);
        if error.unsigned_abs() < LEAST_ERROR {
            return;
        }
        let error = i64::from(error);
        let gradients: [[i64; HIDDEN]; 2] = [
            std::array::from_fn(|j| {
                let leak = if self.hidden[j] > 0 { 0 } else { 3 };
                (error * i64::from(self.output[j])) >> (8 + leak)
            }),
            std::array::from_fn(|j| (error * i64::from(self.hidden[j])) >> 8),
        ]
        .map(|gradients: [i64; HIDDEN]| gradients.map(|g| g.clamp(-STEEPEST, STEEPEST)));
        for (squares, gradients) in self.squares.iter_mut().zip(&gradients) {
            for (square, &gradient) in squares.iter_mut().zip(gradients) {
                *square = *square - (*square >> 10) + (gradient.unsigned_abs().pow(2) >> 10);
            }
        }
        if self.updates.is_multiple_of(PACE_EVERY) {
            self.find_paces();
        }
        self.updates = self.updates.wrapping_add(1);
        // Rounded up as often as what is cut off says: many small steps weigh as much as a large one.
        let cut = i64::from(self.updates.wrapping_mul(0x9e37_79b1) >> 8);
        let step = |gradient: i64, pace: i64| ((gradient * pace + cut) >> 24) as i32;
        let steps = std::array::from_fn(|j| step(gradients[0][j], self.paces[0][j]));
        for (j, weight) in self.output.iter_mut().enumerate() {
            *weight = weight.wrapping_sub(step(gradients[1][j], self.paces[1][j]));
        }
        inputs.descend(&mut self.weights, &mut self.bias, &steps);
        let change = step(error, (i64::from(self.rate) << 8) / 10);
        self.output_bias = self.output_bias.wrapping_sub(change);
    }

    /// Steps are a tenth of the rate for weights of the first layer, and three tenths for those of the
    /// output, at a gradient of the usual size.
    fn find_paces(&mut self) {
        let rate = u64::from(self.rate) << 24;
        for ((paces, squares), share) in self.paces.iter_mut().zip(&self.squares).zip([1, 3]) {
            for (pace, square) in paces.iter_mut().zip(squares) {
                *pace = (share * rate / (10 * (square.isqrt() + FLOOR))) as i64;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logistic::squash;

    /// The share of the bits of an exclusive or that the network gets right after learning it.
    fn learnt<I: Inputs<COUNT>, const COUNT: usize>(inputs: impl Fn(u32) -> I) -> usize {
        let mut network = Network::<COUNT, 8>::random(5, 1 << 15, 3000);
        let bit = |n: u32| (n ^ n >> 1) & 1 == 1;
        let mut right = 0;
        for n in 0..20_000u32 {
            let n = n.wrapping_mul(0x9e37_79b9) >> 20;
            let inputs = inputs(n);
            let logit = network.logit(&inputs);
            network.update(&inputs, bit(n), squash(logit));
            right = right * 999 / 1000 + usize::from((logit > 0) == bit(n)) * 1000;
        }
        right / 10_000
    }

    #[test]
    fn it_learns_what_is_not_linear() {
        let bits = learnt::<_, 64>(|n| Bits([u64::from(n & 3)]));
        let values = learnt::<_, 2>(|n| [(n & 1) as i32 * 512 - 256, (n & 2) as i32 * 256 - 256]);
        assert!(bits > 95 && values > 95, "{bits} and {values} of 100");
    }

    #[test]
    fn bits_are_numbers_0_and_1() {
        let network = Network::<64, 4>::random(9, 1 << 17, 400);
        let word = 0x1234_5678_9abc_def0u64;
        let values: [i32; 64] = std::array::from_fn(|i| ((word >> i & 1) as i32) << 8);
        let sums = Bits([word]).weigh(&network.weights, &network.bias);
        let expected = values.weigh(&network.weights, &network.bias);
        for (sum, expected) in sums.iter().zip(expected) {
            assert!((sum - expected).abs() <= 64 * 16, "{sum} and {expected}");
        }
    }

    #[test]
    fn a_prior_comes_back() {
        let network = Network::<64, 4>::random(7, 1 << 16, 400);
        let prior = network.to_prior();
        assert_eq!(prior.len(), Network::<64, 4>::PARAMETERS);
        let mut again = Network::<64, 4>::from_prior(&prior, 400);
        assert_eq!(again.to_prior(), prior);
        let inputs = Bits([0xff00_ff00_1234_5678]);
        let error = again.logit(&inputs) - network.clone().logit(&inputs);
        assert!(error.abs() < 3, "{error}");
    }
}
