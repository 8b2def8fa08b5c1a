//! Makes the prior of the profile `dense`: the network as it is before it has seen anything of a volume.
//!
//! ```sh
//! cargo xtask train     # or: cargo run --release -p shrouds-codec --example train -- PRIOR.bin
//! ```
//!
//! The volumes are made here from random numbers, and so are none of those that anybody packs. The
//! network learns by the same integer steps that it takes while coding, from the voxels of all
//! volumes in random order, in passes that go slower and slower.

mod solids;

use std::env;
use std::error::Error;
use std::fs;

use shrouds_codec::coder::Encoder;
use shrouds_codec::logistic::squash;
use shrouds_codec::network::{Bits, Network};
use shrouds_codec::topology::dense::{HIDDEN, INPUTS};
use shrouds_codec::topology::scan::Scan;
use shrouds_codec::topology::window::ROWS;
use shrouds_codec::topology::{Model, Window};

use crate::solids::{Random, random_solid};

const VOLUMES: u64 = 1000;
/// Most voxels of one volume.
const PER_VOLUME: usize = 40_000;
/// How fast the network learns in each pass, in units of 1/65536.
const PASSES: [u32; 10] = [1600, 1600, 1100, 700, 450, 280, 170, 100, 60, 35];
/// Half the range of the random weights in the beginning, in the same units.
const SPREAD: u32 = 16_000;

/// A voxel as a network sees it, and whether it is inside.
type Sample = (Bits<3>, bool);

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args().nth(1).ok_or("give the name of the file to write")?;
    let mut random = Random::new(1);
    let mut recorder = Recorder::default();
    let mut samples = Vec::new();
    for number in 0..VOLUMES {
        recorder.watch(&random_solid(&mut Random::new(1000 + number))?);
        // No volume more than others: noisy ones have far more surface.
        shuffle(&mut recorder.samples, &mut random);
        samples.extend(recorder.samples.drain(..).take(PER_VOLUME));
    }
    println!("{} voxels of {VOLUMES} volumes", samples.len());
    let mut network = Network::<INPUTS, HIDDEN>::random(5, SPREAD, 0);
    for (pass, rate) in PASSES.into_iter().enumerate() {
        network.set_rate(rate);
        shuffle(&mut samples, &mut random);
        let bits: f64 = samples.iter().map(|sample| learn(&mut network, sample)).sum();
        println!("pass {pass}: {:.4} bits per voxel", bits / samples.len() as f64);
    }
    let bytes: Vec<u8> = network.to_prior().into_iter().flat_map(i16::to_le_bytes).collect();
    fs::write(path, bytes)?;
    Ok(())
}

/// Shows the network a sample; the bits it would have cost.
fn learn(network: &mut Network<INPUTS, HIDDEN>, (bits, inside): &Sample) -> f64 {
    let probability = squash(network.logit(bits));
    network.update(bits, *inside, probability);
    let share = f64::from(probability) / 65536.0;
    -(if *inside { share } else { 1.0 - share }).log2()
}

fn shuffle(samples: &mut [Sample], random: &mut Random) {
    for last in (1..samples.len()).rev() {
        samples.swap(last, (random.next() * (last + 1) as f64) as usize);
    }
}

/// A model that only takes down what it is shown.
#[derive(Default)]
struct Recorder {
    samples: Vec<Sample>,
    bits: Option<Bits<3>>,
}

impl Recorder {
    fn watch(&mut self, volume: &shrouds::Occupancy) {
        let [nx, ny, nz] = volume.grid().dims();
        let mut scan = Scan::new([nx, ny]);
        for k in 0..nz {
            let mut layer: Vec<u64> = (0..ny).flat_map(|j| volume.row(j, k)).copied().collect();
            scan.layer(&mut Encoder::new(), self, &mut layer);
        }
    }
}

impl Model for Recorder {
    const ROWS: usize = ROWS.len();

    fn predict(&mut self, window: &Window) -> u16 {
        self.bits = Some(Bits::of_bytes(window));
        1 << 15
    }

    fn update(&mut self, inside: bool) {
        self.samples.extend(self.bits.map(|bits| (bits, inside)));
    }
}
