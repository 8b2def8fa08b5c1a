//! What updates of a live shroud cost, in processor time, and how near they come to a fresh solve:
//! `cargo run --release -p shrouds --example updates -- 512 [exact] [rounds]`.

use std::error::Error;
use std::ops::Range;

use cpu_time::ProcessTime;
use shrouds::optimize::Preset;
use shrouds::volume::phantom;
use shrouds::{Grid, LiveShroud, Occupancy, Settings, shroud};

const RADIUS: isize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let size: usize = words.first().map_or(Ok(512), |word| word.parse())?;
    let mut settings = Settings::default();
    if words.iter().any(|word| word == "exact") {
        settings.optimize.preset = Preset::Exact;
    }
    if words.iter().any(|word| word == "fast") {
        settings.optimize.preset = Preset::Fast;
    }
    let rounds: usize = words.last().and_then(|word| word.parse().ok()).unwrap_or(12);
    for (name, volume) in [
        ("sphere", phantom::sphere(size)?),
        ("tori", phantom::linked_tori(size)?),
        ("gyroid", phantom::gyroid(size / 2)?),
        ("block", phantom::block(&cube(size / 2)?, [9; 3], [size / 2 - 20; 3])?),
    ] {
        measure(name, volume, &settings, rounds)?;
    }
    Ok(())
}

fn cube(size: usize) -> Result<Grid, shrouds::Error> {
    Grid::new([size; 3], [1.0; 3])
}

fn measure(
    name: &str,
    mut volume: Occupancy,
    settings: &Settings,
    rounds: usize,
) -> Result<(), Box<dyn Error>> {
    let start = ProcessTime::now();
    let mut live = LiveShroud::new(&volume, settings)?;
    println!(
        "{name}: {} vertices, first {:.2} s",
        live.delta().len(),
        start.elapsed().as_secs_f64()
    );
    let mut times = Vec::new();
    for round in 0..rounds {
        // Added and taken away in turns, at vertices all over the surface.
        let vertex = (round * 7919 + 3) * live.delta().len() / (rounds * 7919);
        let crossing = live.surface().crossing((vertex % live.delta().len()) as u32);
        let centre = crossing.inside().map(|x| x as isize - 1);
        let region = ball(&mut volume, centre, round % 2 == 0);
        let start = ProcessTime::now();
        let change = live.update(&volume, region)?;
        let middle = start.elapsed().as_secs_f64();
        let mut triangles = 0;
        for cells in &change.cells {
            triangles += live.mesh(cells.clone())?.triangles.len();
        }
        let all = start.elapsed().as_secs_f64();
        times.push(all);
        println!(
            "  {:.2} ms, {:.2} without the mesh; {triangles} triangles in {:?}{}",
            1e3 * all,
            1e3 * middle,
            change.cells,
            if change.is_whole { ", all anew" } else { "" }
        );
    }
    times.sort_by(f64::total_cmp);
    println!("  median {:.2} ms", 1e3 * times[times.len() / 2]);
    let start = ProcessTime::now();
    let fresh = shroud(&volume, settings)?;
    let seconds = start.elapsed().as_secs_f64();
    let differences = live.delta().iter().zip(&fresh.delta).map(|(a, b)| (a - b).abs());
    let (mut squares, mut greatest, mut at) = (0.0, 0.0, 0);
    let (mut many, mut some) = (0, 0);
    for (v, difference) in differences.enumerate() {
        squares += difference * difference;
        many += usize::from(difference > 1e-3);
        some += usize::from(difference > 1e-2);
        if difference > greatest {
            (greatest, at) = (difference, v);
        }
    }
    println!(
        "  fresh {seconds:.2} s; RMS {:.2e}, greatest {greatest:.2e} at {:?}; {many} above 1e-3, {some} above 1e-2",
        (squares / fresh.delta.len() as f64).sqrt(),
        fresh.surface.crossing(at as u32),
    );
    Ok(())
}

/// Puts the points of a ball inside, or outside; returns the box around it.
fn ball(volume: &mut Occupancy, centre: [isize; 3], inside: bool) -> [Range<usize>; 3] {
    let dims = volume.grid().dims();
    let range = |d: usize| {
        let end = (centre[d] + RADIUS + 1).min(dims[d] as isize);
        (centre[d] - RADIUS).max(0) as usize..end as usize
    };
    let region = [0, 1, 2].map(range);
    for k in region[2].clone() {
        for (i, j) in region[1].clone().flat_map(|j| region[0].clone().map(move |i| (i, j))) {
            let square: isize =
                [i, j, k].iter().zip(centre).map(|(&x, centre)| (x as isize - centre).pow(2)).sum();
            if square <= RADIUS * RADIUS {
                volume.set([i, j, k], inside);
            }
        }
    }
    region
}
