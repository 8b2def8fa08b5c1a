//! Random numbers that are the same on every machine and in any order.

/// Number `index` of the SplitMix64 sequence (Steele, Lea and Flood, 2014) that starts at `seed`,
/// as a float in [0, 1): the upper 53 bits make every such float equally likely.
pub(crate) fn uniform(seed: u64, index: u64) -> f64 {
    (split_mix(seed, index) >> 11) as f64 / (1u64 << 53) as f64
}

fn split_mix(seed: u64, index: u64) -> u64 {
    let mut z = seed.wrapping_add(index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_sequence() {
        let expected = [6457827717110365317, 3203168211198807973, 9817491932198370423];
        assert_eq!([0, 1, 2].map(|n| split_mix(1234567, n)), expected);
    }
}
