//! A probability that learns from the bits it sees.

/// The probability that a bit is 1, by counting: 22 bits of probability above 10 bits of how many bits
/// were seen, in one word, because models keep large tables of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counter(u32);

/// One part in `n + 1.6` of the difference goes into the probability after `n` bits.
const SHARES: [u32; 1024] = {
    let mut shares = [0; 1024];
    let mut n = 0;
    while n < 1024 {
        shares[n as usize] = 655_360 / (10 * n + 16);
        n += 1;
    }
    shares
};

/// The bits of a counter that count.
const COUNT: u32 = 1023;

impl Default for Counter {
    fn default() -> Self {
        Self::new(1 << 15, 0)
    }
}

impl Counter {
    /// A counter at a probability in units of 1/65536, as sure of it as after `seen` bits, below 1024.
    pub const fn new(probability: u16, seen: u16) -> Self {
        Self((probability as u32) << 16 | (seen as u32 & COUNT))
    }

    /// The probability of a 1 in units of 1/65536, never 0.
    #[inline(always)]
    pub fn probability(self) -> u16 {
        ((self.0 >> 16) as u16).max(1)
    }

    /// How many bits were seen, at most the limit of [`Counter::update`].
    #[inline(always)]
    pub fn seen(self) -> u32 {
        self.0 & COUNT
    }

    /// Learns from a bit. After `limit` bits, at most 1023, old ones begin to be forgotten.
    #[inline(always)]
    pub fn update(&mut self, bit: bool, limit: u32) {
        let seen = self.0 & COUNT;
        let probability = i64::from(self.0 >> 10);
        let share = i64::from(SHARES[seen as usize]);
        // Rounded towards the ends, so that it gets there.
        let change = if bit {
            (((1 << 22) - 1 - probability) * share + 65535) >> 16
        } else {
            (-probability * share) >> 16
        };
        let seen = if seen < limit { seen + 1 } else { seen };
        self.0 = ((probability + change) as u32) << 10 | seen;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_tends_to_the_frequency() {
        let mut counter = Counter::default();
        for n in 0..10_000 {
            counter.update(n % 4 == 0, 1023);
        }
        assert!((counter.probability() as i32 - 16384).abs() < 200, "{}", counter.probability());
        assert_eq!(counter.seen(), 1023);
    }

    #[test]
    fn it_reaches_neither_end() {
        for bit in [false, true] {
            let mut counter = Counter::default();
            for _ in 0..100_000 {
                counter.update(bit, 255);
            }
            let end = if bit { 65535 } else { 1 };
            assert_eq!(counter.probability(), end);
        }
    }
}
