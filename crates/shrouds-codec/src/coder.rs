//! A binary arithmetic coder: bits with probabilities in, bytes out, and back.
//!
//! The interval is kept as two 32-bit ends; whenever their first bytes agree, that byte is settled
//! and moves out. Everything is integer, so the bytes are the same everywhere.

/// Bits that pass through a model, on their way into bytes or out of them.
///
/// Model code is written once, for both: it hands over the bit and goes on with the one it gets back.
pub trait Coder {
    /// Codes one bit that is 1 with a probability of `probability / 65536`, which is not 0.
    ///
    /// An encoder writes `bit` and returns it; a decoder ignores it and returns the one it reads.
    fn code(&mut self, bit: bool, probability: u16) -> bool;

    /// Codes the lowest `count` bits of `value`, all of them equally likely.
    fn code_bits(&mut self, value: u64, count: u32) -> u64 {
        (0..count).rev().fold(0, |bits, place| {
            bits << 1 | u64::from(self.code(value >> place & 1 == 1, 1 << 15))
        })
    }

    /// Codes a number below `end`, all of them equally likely. The numbers are at most 2¹⁶.
    fn code_below(&mut self, value: u32, end: u32) -> u32 {
        let (mut low, mut high) = (0, end);
        while high - low > 1 {
            let middle = low.midpoint(high);
            let probability = ((high - middle) * 65536 / (high - low)) as u16;
            if self.code(value >= middle, probability) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

/// The two ends of the interval, both of them part of it.
#[derive(Debug, Clone, Copy)]
struct Interval {
    low: u32,
    high: u32,
}

impl Interval {
    const WHOLE: Self = Self { low: 0, high: u32::MAX };

    /// The last value that stands for a 1.
    #[inline(always)]
    fn split(self, probability: u16) -> u32 {
        self.low + ((u64::from(self.high - self.low) * u64::from(probability)) >> 16) as u32
    }

    #[inline(always)]
    fn narrow(&mut self, bit: bool, split: u32) {
        if bit {
            self.high = split;
        } else {
            self.low = split + 1;
        }
    }

    /// Whether the first byte is settled.
    #[inline(always)]
    fn is_settled(self) -> bool {
        (self.low ^ self.high) >> 24 == 0
    }

    #[inline(always)]
    fn shift(&mut self) {
        self.low <<= 8;
        self.high = self.high << 8 | 255;
    }
}

/// Writes bits.
#[derive(Debug, Clone)]
pub struct Encoder {
    interval: Interval,
    bytes: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Encoder {
    /// An encoder that has written nothing.
    pub fn new() -> Self {
        Self { interval: Interval::WHOLE, bytes: Vec::new() }
    }

    /// All bytes, with as few at the end as tell the bits apart from others. A decoder takes the bytes
    /// that follow for zeros.
    pub fn finish(mut self) -> Vec<u8> {
        let Interval { low, high } = self.interval;
        for count in 0..=4 {
            let rest = u64::from(u32::MAX) >> (8 * count);
            let value = (u64::from(low) + rest) & !rest;
            if value <= u64::from(high) {
                self.bytes.extend_from_slice(&(value as u32).to_be_bytes()[..count]);
                break;
            }
        }
        self.bytes
    }
}

impl Coder for Encoder {
    #[inline(always)]
    fn code(&mut self, bit: bool, probability: u16) -> bool {
        debug_assert!(probability != 0, "a probability of 0 cannot be coded");
        self.interval.narrow(bit, self.interval.split(probability));
        while self.interval.is_settled() {
            self.bytes.push((self.interval.high >> 24) as u8);
            self.interval.shift();
        }
        bit
    }
}

/// Reads bits from the bytes of an [`Encoder`]; past the end it reads zeros.
///
/// Whatever the bytes are, there are always bits: whether they are the right ones is for a check sum
/// to tell.
#[derive(Debug, Clone)]
pub struct Decoder<'a> {
    interval: Interval,
    value: u32,
    rest: &'a [u8],
}

impl<'a> Decoder<'a> {
    /// A decoder at the first bit.
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { interval: Interval::WHOLE, value: 0, rest: bytes };
        (0..4).for_each(|_| decoder.read_byte());
        decoder
    }

    #[inline(always)]
    fn read_byte(&mut self) {
        let (byte, rest) = self.rest.split_first().map_or((0, self.rest), |(&b, rest)| (b, rest));
        self.value = self.value << 8 | u32::from(byte);
        self.rest = rest;
    }
}

impl Coder for Decoder<'_> {
    #[inline(always)]
    fn code(&mut self, _: bool, probability: u16) -> bool {
        debug_assert!(probability != 0, "a probability of 0 cannot be coded");
        let split = self.interval.split(probability);
        let bit = self.value <= split;
        self.interval.narrow(bit, split);
        while self.interval.is_settled() {
            self.interval.shift();
            self.read_byte();
        }
        bit
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn bits_come_back(bits in prop::collection::vec((any::<bool>(), 1..=u16::MAX), 0..2000)) {
            let mut encoder = Encoder::new();
            for &(bit, probability) in &bits {
                encoder.code(bit, probability);
            }
            let bytes = encoder.finish();
            let mut decoder = Decoder::new(&bytes);
            for (bit, probability) in bits {
                prop_assert_eq!(decoder.code(false, probability), bit);
            }
        }
    }

    #[test]
    fn the_length_is_the_entropy() {
        // One bit in 65536 is 1, and is said to be.
        let mut encoder = Encoder::new();
        for n in 0..1 << 20 {
            encoder.code(n % 65536 == 77, 1);
        }
        // 16 rare bits of 16 bits each, and log2(65536 / 65535) for each of the others.
        let entropy = 16.0 * 16.0 + f64::from(1 << 20) * (65536.0f64 / 65535.0).log2();
        let bits = 8.0 * encoder.finish().len() as f64;
        assert!((entropy..entropy + 16.0).contains(&bits), "{bits} bits for {entropy}");
    }

    #[test]
    fn values_keep_their_bits() {
        let mut encoder = Encoder::new();
        encoder.code_bits(0x1234_5678_9abc, 48);
        encoder.code_bits(5, 3);
        let bytes = encoder.finish();
        let mut decoder = Decoder::new(&bytes);
        assert_eq!(decoder.code_bits(0, 48), 0x1234_5678_9abc);
        assert_eq!(decoder.code_bits(0, 3), 5);
    }
}
