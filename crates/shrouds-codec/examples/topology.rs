//! Measures the topology of volumes: bytes and CPU time of both profiles, and the bytes of a
//! 16-neighbour adaptive coder.
//!
//! ```sh
//! cargo run --release -p shrouds-codec --example topology -- [--each] VOLUME…
//! ```
//!
//! A line of JSON for each volume, or with `--each` for each of its labels. `xtask/python/compression.py`
//! makes a table of it.

use std::env;
use std::error::Error;
use std::time::Duration;

use cpu_time::ThreadTime;
use serde_json::json;
use shrouds::{Occupancy, Select};
use shrouds_codec::coder::{Coder, Encoder};
use shrouds_codec::counter::Counter;
use shrouds_codec::{Profile, Settings, pack, unpack};
use shrouds_io::{VolumeOptions, read_volume};

fn main() -> Result<(), Box<dyn Error>> {
    let mut each = false;
    for argument in env::args().skip(1) {
        if argument == "--each" {
            each = true;
            continue;
        }
        let volume = read_volume(&argument, &VolumeOptions::default())?;
        let labels = volume.values.labels().unwrap_or_default();
        let labels: Vec<i128> =
            labels.iter().map(|&(label, _)| label).filter(|&l| l != 0).collect();
        let selections: Vec<Select> = if each {
            labels.into_iter().map(|label| Select::Labels(vec![label])).collect()
        } else {
            vec![Select::NonZero]
        };
        for select in selections {
            println!(
                "{}",
                measured(&format!("{argument} {select:?}"), &volume.occupancy(&select)?)?
            );
        }
    }
    Ok(())
}

fn measured(name: &str, volume: &Occupancy) -> Result<serde_json::Value, Box<dyn Error>> {
    let mut line = json!({
        "name": name,
        "dims": volume.grid().dims(),
        "sixteen": sixteen(volume),
    });
    for (name, profile) in [("fast", Profile::Fast), ("dense", Profile::Dense)] {
        let settings = Settings { profile, ..Settings::default() };
        let (mut bytes, mut times) = (Vec::new(), [Duration::MAX; 2]);
        // The machine is not ours alone: the best of some counts.
        for _ in 0..5 {
            bytes.clear();
            let start = ThreadTime::now();
            let packed = pack(volume, &settings, &mut bytes)?;
            times[0] = times[0].min(start.elapsed());
            let start = ThreadTime::now();
            let unpacked = unpack(&bytes[..])?;
            times[1] = times[1].min(start.elapsed());
            assert_eq!(unpacked.volume.count(), volume.count());
            line["vertices"] = json!(packed.vertices);
            line[name] = json!({ "topology": packed.topology, "file": packed.bytes });
        }
        line[name]["seconds"] = json!(times.map(|time| time.as_secs_f64()));
    }
    Ok(line)
}

/// Bytes of an adaptive arithmetic coder that codes every voxel by its 16 nearest neighbours among those
/// before it: of the class of Taubin's BLIC (2002).
fn sixteen(volume: &Occupancy) -> usize {
    let [nx, ny, nz] = volume.grid().dims().map(|n| n as isize);
    let mut steps: Vec<[isize; 3]> = Vec::new();
    for (z, y, x) in
        (-2..=0).flat_map(|z| (-2..=2).flat_map(move |y| (-2..=2).map(move |x| (z, y, x))))
    {
        if (z, y, x) < (0, 0, 0) {
            steps.push([x, y, z]);
        }
    }
    steps.sort_by_key(|&[x, y, z]| (x * x + y * y + z * z, -z, -y, x.abs(), x));
    steps.truncate(16);
    // With two voxels of nothing around, so that no step leads out.
    let stride = [1, nx + 4, (nx + 4) * (ny + 4)];
    let at = |x: isize, y: isize, z: isize| x + 2 + (y + 2) * stride[1] + (z + 2) * stride[2];
    let steps: Vec<isize> =
        steps.iter().map(|step| step.iter().zip(stride).map(|(a, b)| a * b).sum()).collect();
    let mut known = vec![0u8; (stride[2] * (nz + 4)) as usize];
    let mut counters = vec![Counter::default(); 1 << 16];
    let mut encoder = Encoder::new();
    for (z, y) in (0..nz).flat_map(|z| (0..ny).map(move |y| (z, y))) {
        let row = volume.row(y as usize, z as usize);
        for x in 0..nx {
            let here = at(x, y, z);
            let context = steps
                .iter()
                .fold(0, |context, step| context << 1 | usize::from(known[(here + step) as usize]));
            let bit = row[x as usize / 64] >> (x % 64) & 1 == 1;
            encoder.code(bit, counters[context].probability());
            counters[context].update(bit, 1000);
            known[here as usize] = bit.into();
        }
    }
    encoder.finish().len()
}
