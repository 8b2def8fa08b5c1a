//! Some bytes of every period: one volume of several that are interleaved.

use std::io::{self, BufRead, Read};

/// Which bytes of a stream are wanted: those from `from` to `to` of each of `periods` periods, and
/// what follows these.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pick {
    /// Bytes of a period, not 0.
    pub(crate) period: u64,
    pub(crate) from: u64,
    /// Past `from`, at most `period`.
    pub(crate) to: u64,
    pub(crate) periods: u64,
}

impl Pick {
    /// How many of the first `bytes` bytes of the stream are wanted.
    pub(crate) fn count(&self, bytes: u64) -> u64 {
        let (whole, part) = match bytes / self.period {
            whole if whole < self.periods => (whole, bytes % self.period),
            _ => (self.periods, 0),
        };
        let after = bytes.saturating_sub(self.period.saturating_mul(self.periods));
        whole * (self.to - self.from) + part.clamp(self.from, self.to) - self.from + after
    }
}

impl Pick {
    /// Copies what is wanted of the whole periods that lie at the start of `bytes` and find room;
    /// returns their number.
    fn copy(&self, bytes: &[u8], out: &mut [u8]) -> u64 {
        let Self { period, from, to, periods } = *self;
        let width = to - from;
        let count = (bytes.len() as u64 / period).min(out.len() as u64 / width).min(periods);
        if count == 0 {
            return 0;
        }
        let (from, width) = (from as usize, width as usize);
        let chunks = bytes.chunks_exact(period as usize).map(|chunk| &chunk[from..from + width]);
        let places = out.chunks_exact_mut(width).take(count as usize).zip(chunks);
        // Single numbers are copied as such, not by a call for each.
        match width {
            1 => places.for_each(|(place, chunk)| place[0] = chunk[0]),
            2 => places.for_each(|(place, chunk)| copy_number::<2>(place, chunk)),
            4 => places.for_each(|(place, chunk)| copy_number::<4>(place, chunk)),
            8 => places.for_each(|(place, chunk)| copy_number::<8>(place, chunk)),
            _ => places.for_each(|(place, chunk)| place.copy_from_slice(chunk)),
        }
        count
    }
}

fn copy_number<const SIZE: usize>(place: &mut [u8], chunk: &[u8]) {
    if let (Some(place), Some(chunk)) = (place.first_chunk_mut::<SIZE>(), chunk.first_chunk()) {
        *place = *chunk;
    }
}

/// The wanted bytes of a stream.
pub(crate) struct Picked<R> {
    inner: R,
    pick: Pick,
    /// Bytes of the present period that have passed.
    within: u64,
}

impl<R: BufRead> Picked<R> {
    pub(crate) fn new(inner: R, pick: Pick) -> Self {
        Self { inner, pick, within: 0 }
    }
}

impl<R: BufRead> Read for Picked<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled == 0 && !out.is_empty() && self.pick.periods > 0 {
            let bytes = self.inner.fill_buf()?;
            if bytes.is_empty() {
                return Ok(0);
            }
            let mut at = 0;
            while at < bytes.len() && filled < out.len() && self.pick.periods > 0 {
                let Pick { period, from, to, .. } = self.pick;
                if self.within == 0
                    && let whole @ 1.. = self.pick.copy(&bytes[at..], &mut out[filled..])
                {
                    at += (whole * period) as usize;
                    filled += (whole * (to - from)) as usize;
                    self.pick.periods -= whole;
                    continue;
                }
                let (wanted, end) = match self.within {
                    within if within < from => (false, from),
                    within if within < to => (true, to),
                    _ => (false, period),
                };
                let mut step = (end - self.within).min((bytes.len() - at) as u64);
                if wanted {
                    step = step.min((out.len() - filled) as u64);
                    let taken = step as usize;
                    out[filled..filled + taken].copy_from_slice(&bytes[at..at + taken]);
                    filled += taken;
                }
                at += step as usize;
                self.within += step;
                if self.within == period {
                    self.within = 0;
                    self.pick.periods -= 1;
                }
            }
            self.inner.consume(at);
        }
        if filled == 0 { self.inner.read(out) } else { Ok(filled) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wanted_bytes_come_through_whatever_the_buffers() {
        let data: Vec<u8> = (0..100).collect();
        for (period, from, to, periods) in [
            (1, 0, 1, 50),
            (12, 4, 6, 8),
            (12, 4, 8, 8),
            (12, 4, 12, 8),
            (7, 2, 5, 9),
            (7, 0, 1, 14),
            (10, 9, 10, 10),
            (100, 40, 60, 1),
        ] {
            let pick = Pick { period, from, to, periods };
            let wanted = |n: &u8| {
                let n = u64::from(*n);
                n >= period * periods || (from..to).contains(&(n % period))
            };
            let expected: Vec<u8> = data.iter().copied().filter(wanted).collect();
            for (inner, outer) in [(1, 64), (3, 2), (64, 1), (64, 64)] {
                let reader = io::BufReader::with_capacity(inner, data.as_slice());
                let mut picked = Picked::new(reader, pick);
                let (mut all, mut buffer) = (Vec::<u8>::new(), vec![0; outer]);
                loop {
                    let count = picked.read(&mut buffer).unwrap();
                    if count == 0 {
                        break;
                    }
                    all.extend(&buffer[..count]);
                }
                assert_eq!(all, expected, "{pick:?} {inner} {outer}");
            }
            for bytes in 0..=100 {
                let expected = data.iter().take(bytes).filter(|n| wanted(n)).count();
                assert_eq!(pick.count(bytes as u64), expected as u64, "{pick:?} {bytes}");
            }
        }
    }
}
