//! Probabilities and their logarithmic odds, in tables made by integer arithmetic.
//!
//! Models add evidence as *logits*, ln(p / (1 − p)), in units of 1/256. The tables are worked out by
//! the compiler from integers alone: no platform's logarithm has a say in the bytes of a file.

/// Logits reach from minus this to this, where probabilities are 1/65536 from their ends.
pub const LIMIT: i32 = 2815;

/// The probability, in units of 1/65536, of a logit in units of 1/256. Never 0.
#[inline(always)]
pub fn squash(logit: i32) -> u16 {
    SQUASH[(logit.clamp(-LIMIT, LIMIT) + LIMIT) as usize]
}

/// The logit, in units of 1/256, of a probability in units of 1/65536, of which the highest 12 bits
/// count.
#[inline(always)]
pub fn stretch(probability: u16) -> i32 {
    i32::from(STRETCH[usize::from(probability >> 4)])
}

const ENTRIES: usize = 2 * LIMIT as usize + 1;

static SQUASH: [u16; ENTRIES] = squash_table();

const fn squash_table() -> [u16; ENTRIES] {
    const ONE: u128 = 1 << 62;
    // exp(−1/256) by its series.
    let (mut step, mut term, mut n) = (ONE as i128, ONE as i128, 1);
    while n < 12 {
        term = -term / (256 * n);
        step += term;
        n += 1;
    }
    let mut table = [0; ENTRIES];
    let mut power = ONE;
    let mut logit = 0;
    while logit <= LIMIT as usize {
        // 65536 / (1 + exp(−logit)), rounded.
        let sum = ONE + power;
        let probability = ((ONE << 17) + sum) / (2 * sum);
        table[LIMIT as usize + logit] = probability as u16;
        table[LIMIT as usize - logit] = (65536 - probability) as u16;
        power = (power * step as u128) >> 62;
        logit += 1;
    }
    table
}

static STRETCH: [i16; 4096] = stretch_table();

const fn stretch_table() -> [i16; 4096] {
    let squash = squash_table();
    let mut table = [0; 4096];
    let mut entry = 0;
    let mut at = 0;
    while entry < 4096 {
        // The first logit whose probability is not below the middle of the entry.
        let middle = 16 * entry as u16 + 8;
        while at + 1 < ENTRIES && squash[at] < middle {
            at += 1;
        }
        table[entry] = at as i16 - LIMIT as i16;
        entry += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squash_is_the_logistic_function() {
        for logit in -LIMIT..=LIMIT {
            let exact = 65536.0 / (1.0 + (-f64::from(logit) / 256.0).exp());
            assert!((f64::from(squash(logit)) - exact).abs() <= 0.5001, "{logit}");
        }
        assert_eq!((squash(i32::MIN), squash(i32::MAX)), (1, 65535));
    }

    #[test]
    fn stretch_undoes_it() {
        for logit in -1500..=1500 {
            let probability = f64::from(squash(logit));
            // 12 bits of probability: an error of 8 in 65536, of logits that over p (1 − p).
            let slope = probability * (65536.0 - probability) / 65536.0 / 256.0;
            let error = f64::from(stretch(squash(logit)) - logit);
            assert!(error.abs() <= 1.5 + 8.0 / slope, "{logit}: {error}");
        }
    }
}
