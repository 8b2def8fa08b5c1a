//! One process of `cargo xtask bench`: makes meshes of a volume that it holds in memory, and tells
//! what that costs.
//!
//! ```text
//! bench_worker presets
//! bench_worker VOLUME NX,NY,NZ SX,SY,SZ PRESET THREADS
//! ```
//!
//! The second form takes a file that ends with an array of 8-bit values indexed `[z, y, x]`, such as
//! an NPY file. It does one piece of work for every line on standard input and answers with a line of
//! JSON on standard output:
//!
//! * `run`: from the bytes to the finished mesh, as [`shrouds::shroud`] does it;
//! * `stages`: the same, stage by stage;
//! * `midpoint`: from the bytes to the surface with all vertices in the middle of their grid edges;
//! * `save PATH`: writes the mesh of the last `run`.

#[path = "../../shrouds/benches/stages/presets.rs"]
mod presets;

use std::error::Error;
use std::fs;
use std::io::stdin;
use std::ops::ControlFlow;
use std::str::FromStr;
use std::time::Instant;

use cpu_time::ProcessTime;
use serde_json::{Map, Value, json};
use shrouds::mesh::{place_vertices, slope_normals};
use shrouds::optimize::{Optimum, Report, optimize};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy, Select, Settings, Shroud, TriMesh, shroud};
use shrouds_io::{MeshOptions, Precision, write_mesh};

type Done<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> Done<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["presets"] => {
            let names = presets::presets().into_iter().map(|(name, _)| name);
            println!("{}", names.collect::<Vec<_>>().join(" "));
            Ok(())
        }
        [volume, dims, spacing, preset, threads] => {
            let mut worker = Worker::new(volume, dims, spacing, preset)?;
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.parse()?).build()?;
            pool.install(|| worker.serve())
        }
        _ => Err("bench_worker presets | VOLUME NX,NY,NZ SX,SY,SZ PRESET THREADS".into()),
    }
}

struct Worker {
    grid: Grid,
    values: Vec<u8>,
    settings: Settings,
    last: Option<Shroud>,
}

impl Worker {
    fn new(volume: &str, dims: &str, spacing: &str, preset: &str) -> Done<Self> {
        let grid = Grid::new(three(dims)?, three(spacing)?)?;
        // What comes before the values is the header.
        let mut values = fs::read(volume)?;
        let header = values.len().checked_sub(grid.point_count());
        values.drain(..header.ok_or("the file is shorter than its dimensions say")?);
        let found = presets::presets().into_iter().find(|(name, _)| *name == preset);
        let (_, settings) = found.ok_or_else(|| format!("no preset {preset}"))?;
        Ok(Self { grid, values, settings, last: None })
    }

    fn serve(&mut self) -> Done<()> {
        for line in stdin().lines() {
            let line = line?;
            let answer = match line.split_once(' ').unwrap_or((&line, "")) {
                ("run", _) => self.run()?,
                ("stages", _) => self.stages()?,
                ("midpoint", _) => self.midpoint()?,
                ("save", path) => self.save(path)?,
                _ => return Err(format!("unknown work: {line}").into()),
            };
            println!("{answer}");
        }
        Ok(())
    }

    fn run(&mut self) -> Done<Value> {
        self.last = None;
        let memory = Memory::now();
        let clock = Clock::start();
        let volume = bits(&self.grid, &self.values)?;
        let done = shroud(&volume, &self.settings)?;
        let mut answer = clock.read();
        answer.insert("memory".into(), json!(memory.map(|memory| memory.growth())));
        describe(&mut answer, &done.mesh, &done.report);
        self.last = Some(done);
        Ok(answer.into())
    }

    fn stages(&mut self) -> Done<Value> {
        self.last = None;
        let (grid, values, settings) = (&self.grid, &self.values, &self.settings);
        let mut answer = Map::new();
        let mut stage = |name: &str, clock: Clock| answer.insert(name.into(), clock.read().into());
        let clock = Clock::start();
        let volume = bits(grid, values)?;
        stage("bits", clock);
        let clock = Clock::start();
        let surface = Surface::extract(&volume, settings.faces, settings.border)?;
        stage("surface", clock);
        let clock = Clock::start();
        let Optimum { delta, slopes, report } = kernel_solve(&surface, settings)?;
        stage("solve", clock);
        let clock = Clock::start();
        let normals = slope_normals(&surface, &slopes);
        let vertices = place_vertices(&surface, &delta);
        let (kind, triangles) = (settings.mesh, settings.triangles);
        let mesh = TriMesh::span(&surface, vertices, normals, kind, triangles);
        stage("mesh", clock);
        describe(&mut answer, &mesh, &report);
        Ok(answer.into())
    }

    fn midpoint(&mut self) -> Done<Value> {
        self.last = None;
        let clock = Clock::start();
        let mesh = kernel_midpoint(&self.grid, &self.values)?;
        let mut answer = clock.read();
        answer.insert("vertices".into(), json!(mesh.vertices.len()));
        answer.insert("triangles".into(), json!(mesh.triangles.len()));
        Ok(answer.into())
    }

    fn save(&mut self, path: &str) -> Done<Value> {
        let done = self.last.as_ref().ok_or("nothing was run yet")?;
        let options = MeshOptions { precision: Precision::Double, ..MeshOptions::default() };
        write_mesh(path, &done.mesh, &options)?;
        Ok(json!({ "saved": path }))
    }
}

fn bits(grid: &Grid, values: &[u8]) -> Done<Occupancy> {
    Ok(Occupancy::from_values(grid.clone(), values, &Select::NonZero)?)
}

// The two kernels are functions of their own, so that `cargo xtask bench --instructions` can count
// what happens in each.

/// The midpoint surface M (equation 2), without normals.
#[inline(never)]
fn kernel_midpoint(grid: &Grid, values: &[u8]) -> Done<TriMesh> {
    let volume = bits(grid, values)?;
    let surface = Surface::extract(&volume, FaceRule::default(), Border::default())?;
    Ok(TriMesh::midpoint(&surface))
}

#[inline(never)]
fn kernel_solve(surface: &Surface, settings: &Settings) -> Done<Optimum> {
    Ok(optimize(surface, &settings.optimize, &mut |_| ControlFlow::Continue(()))?)
}

fn describe(answer: &mut Map<String, Value>, mesh: &TriMesh, report: &Report) {
    answer.insert("vertices".into(), json!(mesh.vertices.len()));
    answer.insert("triangles".into(), json!(mesh.triangles.len()));
    answer.insert("status".into(), json!(report.status.name()));
    answer.insert("energy".into(), json!(report.energy[1]));
    answer.insert("step".into(), json!(report.projected_step_rms));
}

/// Processor seconds of all threads of this process, and seconds on the wall.
struct Clock {
    cpu: ProcessTime,
    wall: Instant,
}

impl Clock {
    fn start() -> Self {
        Self { cpu: ProcessTime::now(), wall: Instant::now() }
    }

    fn read(&self) -> Map<String, Value> {
        let cpu = self.cpu.elapsed().as_secs_f64();
        let wall = self.wall.elapsed().as_secs_f64();
        Map::from_iter([("cpu".into(), json!(cpu)), ("wall".into(), json!(wall))])
    }
}

/// Kilobytes held at a moment from which on the peak is watched; only Linux tells.
struct Memory(u64);

impl Memory {
    fn now() -> Option<Self> {
        fs::write("/proc/self/clear_refs", "5").ok()?;
        kilobytes("VmRSS:").map(Self)
    }

    /// By how many megabytes the peak exceeds what was held at first.
    fn growth(&self) -> Option<f64> {
        Some(kilobytes("VmHWM:")?.saturating_sub(self.0) as f64 / 1024.0)
    }
}

fn kilobytes(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

fn three<T: FromStr>(text: &str) -> Done<[T; 3]> {
    let numbers: Vec<T> = text.split(',').filter_map(|number| number.parse().ok()).collect();
    numbers.try_into().map_err(|_| format!("not three numbers: {text}").into())
}
