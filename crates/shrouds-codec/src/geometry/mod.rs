//! The places of vertices in bit planes.
//!
//! δ of each vertex, 1 being the inside end of its grid edge, is cut into bits: plane 1 says in which
//! half it lies, plane 2 in which quarter, and so on to plane 8. Each plane is a pass over all vertices
//! in their order. Before its bit is coded, every vertex is predicted from where its neighbours are now,
//! those that had their bit already and those that did not; after it, the vertex is moved into the half
//! that is left. Between planes a fixed number of sweeps smooths the surface within what is known.
//!
//! Predictor and sweeps are whole numbers and frozen by the format version. What the decoder shows is
//! another matter: [`Places::deltas`].
//!
//! Planes cover the whole surface, however the topology was cut into slabs.

mod model;
mod stencil;
mod sweep;

use shrouds::surface::{Crossing, Surface};

use crate::coder::{Coder, Decoder, Encoder};
use crate::error::Error;
use crate::geometry::model::{Known, Model};
use crate::geometry::stencil::{ONE, Stencil, stencils};
use crate::geometry::sweep::{Aim, Box, predict, sweep};
use crate::pack::Planes;

/// Most bit planes.
pub const MAX_PLANES: usize = 8;
/// Vertices keep this distance from the ends of their edges, in edge lengths.
const MARGIN: f64 = 0.002;
/// Bytes of the settings for each plane, see [`State::best_hints`], and the one that changes nothing.
const HINTS: usize = 7;
const MIDDLE: u8 = 128;
/// Sweeps before the first plane, after it, and after each of the others.
const FIRST_SWEEPS: usize = 14;
const SECOND_SWEEPS: usize = 12;
const SWEEPS: usize = 5;

/// Codes δ of all vertices of a surface in some bit planes.
///
/// # Errors
/// [`Error::Setting`] when there is not one δ per vertex, one is not a number, or there are more than
/// eight planes.
pub fn encode(surface: &Surface, delta: &[f64], planes: usize) -> Result<Planes, Error> {
    if planes > MAX_PLANES {
        return Err(wrong("the number of bit planes", planes.to_string(), "0 to 8"));
    }
    if planes == 0 {
        return check(surface, delta).map(|()| Planes::default());
    }
    let mut encoder = PlaneEncoder::new(surface, delta)?;
    (0..planes).for_each(|_| encoder.code_next());
    Ok(encoder.planes)
}

fn wrong(name: &'static str, value: String, range: &str) -> Error {
    Error::Setting { name, value, range: range.into() }
}

/// Refuses what is not one δ for each vertex.
fn check(surface: &Surface, delta: &[f64]) -> Result<(), Error> {
    if delta.len() != surface.vertex_count() {
        let range = format!("{}, one per vertex", surface.vertex_count());
        return Err(wrong("the number of places", delta.len().to_string(), &range));
    }
    match delta.iter().find(|delta| !(0.0..=1.0).contains(*delta)) {
        Some(odd) => Err(wrong("the place of a vertex", odd.to_string(), "between 0 and 1")),
        None => Ok(()),
    }
}

/// Codes bit planes one after the other, for who wants to know of each as it comes. The first planes of
/// many are those of few.
pub struct PlaneEncoder<'a> {
    delta: &'a [f64],
    steps: Vec<u8>,
    state: State,
    planes: Planes,
}

impl<'a> PlaneEncoder<'a> {
    /// Before the first plane.
    ///
    /// # Errors
    /// Those of [`encode`].
    pub fn new(surface: &Surface, delta: &'a [f64]) -> Result<Self, Error> {
        check(surface, delta)?;
        let steps = delta.iter().map(|delta| (delta * 256.0).min(255.0) as u8).collect();
        Ok(Self { delta, steps, state: State::new(surface), planes: Planes::default() })
    }

    /// Codes one more plane, unless there are [`MAX_PLANES`].
    pub fn code_next(&mut self) {
        let Self { delta, steps, state, planes } = self;
        let plane = planes.payloads.len();
        if plane == MAX_PLANES {
            return;
        }
        let mut encoder = Encoder::new();
        let sum = state.plane(&mut encoder, plane, |v| steps[v] >> (7 - plane) & 1 == 1);
        planes.payloads.push((encoder.finish(), sum));
        planes.settings.extend(state.best_hints(delta));
    }

    /// The planes so far.
    pub fn planes(&self) -> &Planes {
        &self.planes
    }
}

/// What some bit planes say.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// How many planes were read.
    pub planes: usize,
    /// The highest bits of δ of every vertex, as many as planes.
    pub steps: Vec<u8>,
    /// The places of the smoothed surface within the intervals.
    smooth: Vec<f64>,
    /// Why not all planes were read, if so.
    pub lost: Option<String>,
}

/// Decodes bit planes, the payload of each with its check sum, as far as they are sound. `settings` are
/// those of [`Planes`].
///
/// Time and memory are bounded by the vertices, whatever the bytes are.
pub fn decode(surface: &Surface, settings: &[u8], payloads: &[(&[u8], u32)]) -> Places {
    let mut state = State::new(surface);
    let mut places = Places { planes: 0, steps: state.steps(), smooth: Vec::new(), lost: None };
    places.smooth = state.smooth(&[]);
    for (plane, &(payload, sum)) in payloads.iter().take(MAX_PLANES).enumerate() {
        if state.plane(&mut Decoder::new(payload), plane, |_| false) != sum {
            places.lost = Some(format!("bit plane {} is damaged", plane + 1));
            break;
        }
        places.planes = plane + 1;
        places.steps = state.steps();
        places.smooth = state.smooth(settings.get(HINTS * plane..).unwrap_or_default());
    }
    places
}

impl Places {
    /// The interval of δ of every vertex.
    pub fn intervals(&self) -> impl Iterator<Item = [f64; 2]> {
        let width = 1.0 / f64::from(1 << self.planes as u32);
        self.steps.iter().map(move |&step| [0.0, 1.0].map(|end| (f64::from(step) + end) * width))
    }

    /// δ of every vertex: the place within its interval where the surface is smooth, and not quite at a
    /// lattice point.
    pub fn deltas(&self) -> Vec<f64> {
        self.smooth.iter().map(|delta| delta.clamp(MARGIN, 1.0 - MARGIN)).collect()
    }
}

/// A surface between two bits.
struct State {
    crossings: Vec<Crossing>,
    stencils: Vec<Stencil>,
    places: Vec<i32>,
    boxes: Vec<Box>,
    model: Model,
    planes: usize,
}

impl State {
    fn new(surface: &Surface) -> Self {
        let (crossings, stencils) = stencils(surface);
        let boxes = vec![Box { low: 0, high: ONE as i32 }; crossings.len()];
        let mut places = vec![ONE as i32 / 2; crossings.len()];
        for _ in 0..FIRST_SWEEPS {
            sweep(&stencils, &mut places, &boxes, Aim::Bending, 26);
        }
        Self { crossings, stencils, places, boxes, model: Model::new(), planes: 0 }
    }

    /// Codes a plane; the check sum of its bits.
    fn plane(&mut self, coder: &mut impl Coder, plane: usize, bit: impl Fn(usize) -> bool) -> u32 {
        let before = self.places.clone();
        let mut bits = vec![0u8; self.places.len().div_ceil(8)];
        for (v, stencil) in self.stencils.iter().enumerate() {
            let (own, interval) = (i64::from(before[v]), self.boxes[v]);
            let predictions = predict(stencil, &self.places, own);
            let inside_low = self.crossings[v].inside_low();
            let known = Known {
                stencil,
                places: &self.places,
                predictions,
                before: own,
                interval,
                inside_low,
                axis: self.crossings[v].axis(),
                plane,
            };
            let probability = self.model.predict(&known);
            let bit = coder.code(bit(v), probability);
            self.model.update(bit);
            bits[v / 8] |= u8::from(bit) << (v % 8);
            let middle = interval.low + (interval.high - interval.low) / 2;
            let kept = if bit != inside_low {
                Box { low: middle, ..interval }
            } else {
                Box { high: middle, ..interval }
            };
            self.boxes[v] = kept;
            let place = (predictions.cubic[0] + predictions.cubic[1]) >> 1;
            self.places[v] = place.clamp(kept.low.into(), kept.high.into()) as i32;
        }
        self.planes = plane + 1;
        let (count, aim, pull) = match plane {
            0 => (SECOND_SWEEPS, Aim::Chords, 128),
            _ => (SWEEPS, Aim::Cubics, 64),
        };
        for _ in 0..count {
            sweep(&self.stencils, &mut self.places, &self.boxes, aim, pull);
        }
        crc32fast::hash(&bits)
    }

    /// The bits of δ so far.
    fn steps(&self) -> Vec<u8> {
        let step = |(crossing, interval): (&Crossing, &Box)| {
            let outer =
                if crossing.inside_low() { ONE as i32 - interval.high } else { interval.low };
            (outer >> (16 - self.planes)) as u8
        };
        self.crossings.iter().zip(&self.boxes).map(step).collect()
    }

    /// Of every vertex the middle of the interval of δ, and how far from it the sweeps put it.
    fn offsets(&self) -> impl Iterator<Item = (f64, f64)> {
        let fixed = |x: i32| f64::from(x) / ONE as f64;
        let boxes = self.crossings.iter().zip(&self.boxes);
        boxes.zip(&self.places).map(move |((crossing, interval), &place)| {
            let middle = interval.low + (interval.high - interval.low) / 2;
            let off = fixed(place - middle);
            let off = if crossing.inside_low() { -off } else { off };
            (crossing.from_low(fixed(middle)), off)
        })
    }

    /// The flat face that every vertex lies on, by which way it looks, or none.
    fn faces(&self) -> impl Iterator<Item = Option<usize>> {
        self.crossings.iter().zip(&self.stencils).map(|(crossing, stencil)| {
            let is_flat = stencil.iter().flatten().all(|link| link.is_level());
            is_flat.then(|| 2 * crossing.axis() + usize::from(crossing.inside_low()))
        })
    }

    /// The width of the intervals.
    fn width(&self) -> f64 {
        1.0 / f64::from(1 << self.planes as u32)
    }

    /// δ within each interval as the hints have it.
    fn smooth(&self, hints: &[u8]) -> Vec<f64> {
        let hints: [u8; HINTS] = std::array::from_fn(|n| *hints.get(n).unwrap_or(&MIDDLE));
        let share = f64::from(hints[0]) / 128.0;
        let half = self.width() / 2.0;
        let move_on = |((middle, off), face): ((f64, f64), Option<usize>)| {
            let shift = face.map_or(0.0, |face| f64::from(hints[1 + face]) - f64::from(MIDDLE));
            middle + (share * off + shift * self.width() / 256.0).clamp(-half, half)
        };
        self.offsets().zip(self.faces()).map(move_on).collect()
    }

    /// The hints that come nearest to δ: the share of the way from the middle of the interval to
    /// where the sweeps put a vertex, in units of 1/128, and for each way that flat faces look how much
    /// further inside they lie on average, in units of 1/256 of the interval, from 128 on.
    fn best_hints(&self, delta: &[f64]) -> [u8; HINTS] {
        let mut hints = [MIDDLE; HINTS];
        let (mut above, mut below) = (0.0, 0.0);
        for (((middle, off), face), delta) in self.offsets().zip(self.faces()).zip(delta) {
            if face.is_none() {
                above += off * (delta - middle);
                below += off * off;
            }
        }
        let byte = |x: f64| x.round().clamp(0.0, 255.0) as u8;
        if below > 0.0 {
            hints[0] = byte(128.0 * above / below);
        }
        let mut means = [(0.0, 0u32); 6];
        for ((smooth, face), delta) in self.smooth(&hints).iter().zip(self.faces()).zip(delta) {
            if let Some(face) = face {
                means[face].0 += delta - smooth;
                means[face].1 += 1;
            }
        }
        for (hint, (sum, count)) in hints[1..].iter_mut().zip(means) {
            *hint = byte(128.0 + 256.0 * sum / f64::from(count.max(1)) / self.width());
        }
        hints
    }
}
