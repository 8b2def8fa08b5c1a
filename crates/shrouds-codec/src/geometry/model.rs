//! The probability of the next bit of a vertex, from what its neighbours predict.

use crate::counter::Counter;
use crate::geometry::stencil::{ONE, Stencil};
use crate::geometry::sweep::{Box, Predictions};
use crate::logistic::squash;
use crate::mixer::{Mixer, Refinement, counted};
use crate::network::Network;

const TABLES: usize = 8;
const LINES: usize = 5;
/// Tables, straight lines, the network and a constant.
const MODELS: usize = TABLES + LINES + 2;
const INPUTS: usize = 56;
const HIDDEN: usize = 16;
/// Sizes of the tables.
const SIZES: [usize; TABLES] =
    [41 * 24, 41 * 29 * 8, 21 * 21 * 8, 21 * 21 * 8, 33 * 72, 81 * 13 * 8, 33 * 33 * 8, 49 * 64];
/// Bits after which a counter begins to forget.
const MEMORY: u32 = 400;

/// What is known of a vertex before its bit.
pub(super) struct Known<'a> {
    pub(super) stencil: &'a Stencil,
    pub(super) places: &'a [i32],
    pub(super) predictions: Predictions,
    /// Where it was before the plane began.
    pub(super) before: i64,
    pub(super) interval: Box,
    pub(super) inside_low: bool,
    pub(super) axis: usize,
    /// From 0.
    pub(super) plane: usize,
}

/// Learns as it goes, from plane to plane.
pub(super) struct Model {
    tables: [Vec<Counter>; TABLES],
    at: [usize; TABLES],
    mixers: [Mixer<MODELS>; 2],
    refinement: Refinement,
    network: Network<INPUTS, HIDDEN>,
    inputs: [i32; INPUTS],
    opinion: u16,
}

impl Model {
    pub(super) fn new() -> Self {
        let mut weights = [0; MODELS];
        weights[..TABLES].fill(65536 / 9);
        weights[TABLES + LINES] = 20_000;
        Self {
            tables: SIZES.map(|size| vec![Counter::default(); size]),
            at: [0; TABLES],
            mixers: [Mixer::new(8 * 6, weights, 2), Mixer::new(15 * 8, weights, 2)],
            refinement: Refinement::new(8 * 25, 6),
            network: Network::random(11, 12_000, 1400),
            inputs: [0; INPUTS],
            opinion: 1 << 15,
        }
    }

    /// The probability, in units of 1/65536, that the vertex lies in the half nearer to the inside end.
    pub(super) fn predict(&mut self, known: &Known) -> u16 {
        let Predictions { even, chord, cubic, line } = known.predictions;
        let width = i64::from(known.interval.high - known.interval.low);
        let middle = i64::from(known.interval.low) + width / 2;
        // Towards the inside.
        let turn = if known.inside_low { -1 } else { 1 };
        let off = |place: i64| turn * (place - middle);
        let [even, before] = [even, known.before].map(off);
        let (chord, cubic, line) = (chord.map(off), cubic.map(off), line.map(off));
        let both = |pair: [i64; 2]| (pair[0] + pair[1]) >> 1;
        let (chords, cubics) = (both(chord), both(cubic));
        let plane = known.plane.min(7);
        let step =
            |x: i64, limit: i64| ((8 * x).div_euclid(width).clamp(-limit, limit) + limit) as usize;
        let apart = match ((cubic[0] - cubic[1]).abs() * 8 / width).min(15) {
            few @ 0..=3 => few as usize,
            4..=7 => 4,
            _ => 5,
        };
        let shape = known
            .stencil
            .iter()
            .fold(0, |shape, links| shape * 9 + links[1].kind() * 3 + links[2].kind());
        let places = [
            (step(cubics, 20) * 8 + plane) * 3 + known.axis,
            (step(even, 20) * 29 + step(before, 14)) * 8 + plane,
            (step(chord[0], 10) * 21 + step(chord[1], 10)) * 8 + plane,
            (step(cubic[0], 10) * 21 + step(cubic[1], 10)) * 8 + plane,
            ((step(cubics, 16) * 6 + apart) * 4 + plane.min(3)) * 3 + known.axis,
            (shape * 13 + step(even, 6)) * 8 + plane,
            (step(chords, 16) * 33 + step(cubics, 16)) * 8 + plane,
            (step(4 * cubics, 24) * 8 + plane) * 8 + apart,
        ];
        self.at = places;
        let mut opinions = [0; MODELS];
        for ((opinion, table), place) in opinions.iter_mut().zip(&self.tables).zip(places) {
            *opinion = counted(table[place]);
        }
        let distances = [chords, cubics, even, before, (cubic[0] + chord[0]) >> 1];
        for (opinion, distance) in opinions[TABLES..].iter_mut().zip(distances) {
            *opinion = (distance * 512).div_euclid(width).clamp(-1200, 1200) as i32;
        }
        self.look(
            known,
            [even, chord[0], chord[1], cubic[0], cubic[1], before, cubics, chords],
            line,
        );
        let logit = self.network.logit(&self.inputs);
        self.opinion = squash(logit);
        opinions[TABLES + LINES] = logit.clamp(-2047, 2047);
        opinions[MODELS - 1] = 256;
        let [by_width, by_place] = &mut self.mixers;
        let first = by_width.mix(&opinions, plane * 6 + apart);
        let second = by_place.mix(&opinions, step(cubics, 7) * 8 + plane);
        let logit = (first + second) >> 1;
        let refined = self.refinement.refine(logit, plane * 25 + step(even, 12));
        ((3 * u32::from(squash(logit)) + u32::from(refined)) / 4).clamp(32, 65504) as u16
    }

    /// Fills the inputs of the network.
    fn look(&mut self, known: &Known, offsets: [i64; 8], lines: [i64; 4]) {
        let width = i64::from(known.interval.high - known.interval.low);
        let middle = i64::from(known.interval.low) + width / 2;
        let turn = if known.inside_low { -1 } else { 1 };
        self.inputs.fill(0);
        for (n, offset) in offsets.into_iter().chain(lines).enumerate() {
            let share = (offset * 256).div_euclid(width);
            self.inputs[n] = share.clamp(-512, 512) as i32;
            self.inputs[12 + n] = (6 * share).clamp(-256, 256) as i32;
        }
        self.inputs[24 + known.plane.min(5)] = 256;
        self.inputs[30 + known.axis.min(1)] = 256 * i32::from(known.axis < 2);
        let mut n = 32;
        for links in known.stencil {
            for (link, further) in links.iter().zip([true, false, false, true]) {
                if link.exists {
                    let (along, aside) = link.place(known.places);
                    self.inputs[n] = ((turn * (along - middle)) >> 8).clamp(-768, 768) as i32;
                    self.inputs[n + 1] = (aside.abs() >> 8).min(768) as i32;
                    if !further {
                        self.inputs[n + 2] = if link.parallel { 256 } else { -256 };
                    }
                }
                n += 2 + usize::from(!further);
            }
        }
        // The width of the interval; the inputs after it are always 0.
        self.inputs[52] = (width * 256 / ONE) as i32;
    }

    /// Learns from the bit that came.
    pub(super) fn update(&mut self, bit: bool) {
        for (table, place) in self.tables.iter_mut().zip(self.at) {
            table[place].update(bit, MEMORY);
        }
        self.mixers.iter_mut().for_each(|mixer| mixer.update(bit));
        self.refinement.update(bit);
        self.network.update(&self.inputs, bit, self.opinion);
    }
}
