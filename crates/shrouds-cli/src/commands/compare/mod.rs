//! `shrouds compare`: one volume, one energy after the other, to choose by.

mod row;
mod sheet;
mod table;

use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use shrouds::energy::measures;
use shrouds::optimize::{Preset, Solver};

use crate::args::{CompareArgs, FrameChoice, SolveArgs};
use crate::console::{Console, print_json};
use crate::energies;
use crate::failure::Failure;
use crate::input::{self, Source};
use crate::output::{check_png, check_targets, write_picture};
use crate::phantom;
use crate::progress::Progress;
use crate::report::Input;
use crate::settings::{Job, SettingsReport};
use crate::truth::Body;
use row::Outcome;
pub(crate) use row::Row;
use sheet::Sheet;

/// What an input that is no file begins with.
const PHANTOM: &str = "demo:";
/// What stands for the energy of the preset in a list.
const PRESET: &str = "preset";

/// One energy to be compared.
pub(crate) struct Candidate {
    /// What it is called in the table.
    pub(crate) name: String,
    job: Job,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Comparison {
    input: Input,
    /// Common to all energies.
    settings: SettingsReport,
    /// Inside voxels times the volume of one.
    voxel_volume: f64,
    /// What the formula of a phantom says.
    true_volume: Option<f64>,
    true_area: Option<f64>,
    energies: Vec<Row>,
    version: &'static str,
}

pub(crate) fn run(args: &CompareArgs, console: Console) -> Result<(), Failure> {
    let candidates = candidates(args.energies.as_deref(), &args.solve)?;
    let phantom = phantom_name(args)?;
    check_files(args, phantom)?;
    let progress = Progress::new(console.quiet);
    let source = source(args, phantom, console, &progress)?;
    let body = phantom.and_then(|name| Body::of_phantom(name, phantom::size(name, args.size)));

    let mut sheet = args.picture.as_ref().map(|_| Sheet::default());
    let mut rows = Vec::new();
    for (n, candidate) in candidates.iter().enumerate() {
        progress.part(&format!("{} of {}, {}", n + 1, candidates.len(), candidate.name));
        let (row, shroud) = Row::new(candidate, &source, body.as_ref(), args.multistart, &progress);
        if let Some(sheet) = &mut sheet {
            progress.stage("drawing");
            sheet.add(&row, shroud.as_ref())?;
        }
        rows.push(row);
    }
    if let (Some(path), Some(sheet)) = (&args.picture, sheet) {
        write_picture(path, &sheet.finish()?)?;
    }
    drop(progress);
    let comparison = Comparison::new(&source, &candidates, rows);
    if args.json {
        print_json(&comparison)?;
    } else {
        console.result(&table::table(&comparison))?;
    }
    comparison.verdict()
}

/// The energies in the order they were asked for, each once.
pub(crate) fn candidates(list: Option<&str>, solve: &SolveArgs) -> Result<Vec<Candidate>, Failure> {
    let mut solve = solve.clone();
    if solve.solver == Solver::Newton {
        solve.preset = solve.preset.or(Some(Preset::Exact));
    }
    let texts: Vec<String> = match list {
        Some(list) => {
            let texts = list.split(';').map(str::trim).filter(|text| !text.is_empty());
            texts.map(str::to_owned).collect()
        }
        None => [PRESET.to_owned()].into_iter().chain(energies::usual()).collect(),
    };
    if texts.is_empty() {
        let message =
            "--energies is empty; give some, such as 'bending;curvature(chord)', or leave it out";
        return Err(Failure::Call(message.into()));
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    for text in texts {
        let candidate = Candidate::new(&text, &solve, list.is_some())?;
        if candidates.iter().all(|other| other.name != candidate.name) {
            candidates.push(candidate);
        }
    }
    Ok(candidates)
}

impl Candidate {
    /// `--parameter` goes to the measures that take one; that others do not is no fault in a list.
    fn new(text: &str, solve: &SolveArgs, typed: bool) -> Result<Self, Failure> {
        let mut solve = solve.clone();
        if text == PRESET || !measures(text).any(|(_, entry)| entry.takes_parameter()) {
            solve.parameter = None;
        }
        let energy = (text != PRESET).then_some(text);
        let job =
            Job::with_energy(&solve, energy, false, FrameChoice::World).map_err(|failure| {
                match failure {
                    Failure::Call(message) if typed => {
                        Failure::Call(format!("--energies: {message}"))
                    }
                    other => other,
                }
            })?;
        let in_force = job.energy();
        let name = if text == PRESET { format!("{PRESET}: {in_force}") } else { in_force };
        Ok(Self { name, job })
    }
}

/// The name of the phantom, if the input is one.
fn phantom_name(args: &CompareArgs) -> Result<Option<&str>, Failure> {
    args.volume.refuse_coordinates()?;
    let name = args.input.to_str().and_then(|input| input.strip_prefix(PHANTOM));
    let misplaced = match name {
        None if args.size.is_some() => Some("--size is for phantoms, demo:NAME"),
        Some(_) if args.volume.is_given() => {
            Some("--label, --threshold, --frame, --array and --spacing are for files")
        }
        _ => None,
    };
    match misplaced {
        Some(message) => Err(Failure::Call(format!("{message}; leave it out"))),
        None => Ok(name),
    }
}

/// Finds out before the work whether the files can be what they are to be.
fn check_files(args: &CompareArgs, phantom: Option<&str>) -> Result<(), Failure> {
    let mut inputs: Vec<&Path> = Vec::new();
    if phantom.is_none() {
        shrouds_io::volume_format(&args.input)?;
        inputs.push(&args.input);
    }
    let Some(picture) = args.picture.as_deref() else { return Ok(()) };
    check_png(picture)?;
    check_targets(&[picture], &inputs)
}

fn source(
    args: &CompareArgs,
    phantom: Option<&str>,
    console: Console,
    progress: &Progress,
) -> Result<Source, Failure> {
    let Some(name) = phantom else {
        return input::source(&args.input, &args.volume, console, progress);
    };
    progress.stage("building the phantom");
    phantom::source(name, phantom::size(name, args.size), args.input.clone(), Instant::now())
}

impl Comparison {
    fn new(source: &Source, candidates: &[Candidate], energies: Vec<Row>) -> Self {
        let volume = &source.occupancy;
        let mut settings = candidates[0].job.report.clone();
        settings.energy = None;
        Self {
            input: Input::new(source),
            settings,
            voxel_volume: volume.count() as f64 * volume.grid().voxel_volume(),
            true_volume: source.truth[0],
            true_area: source.truth[1],
            energies,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// A failure when a mesh is not what every energy has to leave alone, or none was made.
    fn verdict(&self) -> Result<(), Failure> {
        let mut first_error = None;
        for row in &self.energies {
            match &row.outcome {
                Outcome::Done(done) => {
                    if let Some(problem) = done.problems.first() {
                        return Err(Failure::Undone(format!(
                            "{}: the mesh fails its check: {problem}; this is a fault of the program: please report it with the volume",
                            row.energy
                        )));
                    }
                }
                Outcome::Failed { error } => first_error = first_error.or(Some(error)),
            }
        }
        let is_done = |row: &Row| matches!(row.outcome, Outcome::Done(_));
        match first_error {
            Some(error) if !self.energies.iter().any(is_done) => {
                Err(Failure::Undone(format!("no energy gave a surface: {error}")))
            }
            _ => Ok(()),
        }
    }
}
