//! One energy: its shroud in numbers.

use std::ops::ControlFlow;

use serde::Serialize;
use shrouds::check::CheckReport;
use shrouds::optimize::{self, Start, optimize};
use shrouds::{Error, Shroud};

use super::Candidate;
use crate::energies;
use crate::failure::Failure;
use crate::input::Source;
use crate::progress::Progress;
use crate::report::{FirstLast, RmsMax};
use crate::truth::{Body, Errors};
use crate::work;
use shrouds_report::looks::{difference, largest_move, roughness};

#[derive(Serialize)]
pub(crate) struct Row {
    /// What it is called in the table.
    #[serde(skip)]
    pub(super) name: String,
    /// The one in force, arguments included.
    pub(super) energy: String,
    /// Whether it stands for that of the preset.
    pub(super) of_preset: bool,
    pub(super) keeps_thin_parts: bool,
    /// As that of the optimisation, or `failed`.
    pub(super) status: &'static str,
    #[serde(flatten)]
    pub(super) outcome: Outcome,
}

#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum Outcome {
    Done(Box<Numbers>),
    Failed { error: String },
}

#[derive(Serialize)]
pub(super) struct Numbers {
    pub(super) iterations: usize,
    /// Seconds that the optimisation took.
    pub(super) seconds: f64,
    pub(super) value: FirstLast,
    /// What each vertex alone would still move, in grid edge lengths.
    projected_step: RmsMax,
    /// Null where the mesh does not close.
    pub(super) volume: Option<f64>,
    /// Against the inside voxels times the volume of one, in percent.
    pub(super) volume_error: Option<f64>,
    pub(super) area: f64,
    /// Root mean square of the angles between neighbouring triangles, weighted with the lengths of
    /// their common edges, in degrees.
    pub(super) roughness: f64,
    /// The largest distance from the middle of a grid edge, in edge lengths.
    pub(super) largest_move: f64,
    /// Share of the vertices at a bound, 0 to 1.
    pub(super) at_bound: f64,
    pub(super) wrong_side: u64,
    /// What is wrong with the mesh, in sentences.
    pub(super) problems: Vec<String>,
    /// Root mean square over the area of the distance to the true surface, in world units.
    pub(super) distance: Option<f64>,
    /// The same of the angle to its normals, in degrees.
    pub(super) normal: Option<f64>,
    /// Null where no other starts were asked for.
    pub(super) multistart: Option<Multistart>,
}

/// How far results from random starts lie from that of the usual start.
#[derive(Serialize)]
pub(super) struct Multistart {
    /// Over all vertices and starts, in grid edge lengths: the root mean square and the largest.
    pub(super) difference: RmsMax,
    /// Largest less smallest energy in the end, the usual start included, by the smallest.
    pub(super) spread: f64,
    starts: Vec<RandomStart>,
}

#[derive(Serialize)]
struct RandomStart {
    seed: u64,
    status: &'static str,
    iterations: usize,
    value: FirstLast,
    difference: RmsMax,
}

impl Row {
    /// The row of an energy, and its shroud unless that failed.
    pub(crate) fn new(
        candidate: &Candidate,
        source: &Source,
        body: Option<&Body>,
        multistart: u64,
        progress: &Progress,
    ) -> (Self, Option<Shroud>) {
        let done = work::shroud(&source.occupancy, &candidate.job, progress).and_then(|shroud| {
            let numbers = Numbers::new(&shroud, candidate, source, body, multistart, progress)?;
            Ok((numbers, shroud))
        });
        let energy = candidate.job.energy();
        let keeps_thin_parts = energies::destructive(&energy).is_none();
        let row = |status, outcome| Self {
            name: candidate.name.clone(),
            of_preset: candidate.name != energy,
            energy: energy.clone(),
            keeps_thin_parts,
            status,
            outcome,
        };
        match done {
            Ok((numbers, shroud)) => {
                let status = shroud.report.status.name();
                (row(status, Outcome::Done(Box::new(numbers))), Some(shroud))
            }
            Err(failure) => {
                let error = failure.message().to_owned();
                (row("failed", Outcome::Failed { error }), None)
            }
        }
    }
}

impl Numbers {
    fn new(
        shroud: &Shroud,
        candidate: &Candidate,
        source: &Source,
        body: Option<&Body>,
        multistart: u64,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        progress.stage("checking");
        let checks = work::certify(&shroud.mesh, &source.occupancy, &candidate.job)?;
        progress.stage("measuring");
        let errors = body.and_then(|body| body.errors(&shroud.mesh));
        let volume = volume(&checks);
        let voxels = source.occupancy.count() as f64 * source.occupancy.grid().voxel_volume();
        Ok(Self {
            iterations: shroud.report.iterations,
            seconds: shroud.times.optimize,
            value: first_last(&shroud.report),
            projected_step: RmsMax {
                rms: shroud.report.projected_step_rms,
                max: shroud.report.projected_step_max,
            },
            volume,
            volume_error: volume.map(|volume| 100.0 * (volume / voxels - 1.0)),
            area: checks.structure.area,
            roughness: roughness(&shroud.mesh),
            largest_move: largest_move(&shroud.delta),
            at_bound: shroud.report.at_bound,
            wrong_side: checks.separation.wrong_side.count,
            problems: checks.problems(),
            distance: errors.map(|Errors { distance, .. }| distance),
            normal: errors.map(|Errors { normal, .. }| normal),
            multistart: Multistart::new(
                shroud,
                &candidate.job.settings.optimize,
                multistart,
                progress,
            )?,
        })
    }
}

fn volume(checks: &CheckReport) -> Option<f64> {
    checks.structure.is_closed().then_some(checks.structure.volume)
}

fn first_last(report: &optimize::Report) -> FirstLast {
    let [first, last] = report.energy;
    FirstLast { first, last }
}

impl Multistart {
    /// Starts `count` times more, with the seeds 1, 2 and so on.
    fn new(
        shroud: &Shroud,
        settings: &optimize::Settings,
        count: u64,
        progress: &Progress,
    ) -> Result<Option<Self>, Error> {
        let starts = (1..=count).map(|seed| RandomStart::new(shroud, settings, seed, progress));
        let starts: Vec<RandomStart> = starts.collect::<Result<_, _>>()?;
        if starts.is_empty() {
            return Ok(None);
        }
        let squares: f64 = starts.iter().map(|start| start.difference.rms.powi(2)).sum();
        let max = starts.iter().map(|start| start.difference.max).fold(0.0, f64::max);
        let ends = || starts.iter().map(|start| start.value.last);
        let usual = shroud.report.energy[1];
        let (low, high) = (ends().fold(usual, f64::min), ends().fold(usual, f64::max));
        // A flat surface may have no energy at all.
        let spread = if high > low { (high - low) / low.max(f64::MIN_POSITIVE) } else { 0.0 };
        Ok(Some(Self {
            difference: RmsMax { rms: (squares / starts.len() as f64).sqrt(), max },
            spread: spread.min(f64::MAX),
            starts,
        }))
    }
}

impl RandomStart {
    fn new(
        shroud: &Shroud,
        settings: &optimize::Settings,
        seed: u64,
        progress: &Progress,
    ) -> Result<Self, Error> {
        progress.stage(&format!("random start {seed}"));
        let settings = optimize::Settings { start: Start::Random(seed), ..settings.clone() };
        let optimum = optimize(&shroud.surface, &settings, &mut |now| {
            progress.optimize(now);
            ControlFlow::Continue(())
        })?;
        let [rms, max] = difference(&shroud.delta, &optimum.delta);
        Ok(Self {
            seed,
            status: optimum.report.status.name(),
            iterations: optimum.report.iterations,
            value: first_last(&optimum.report),
            difference: RmsMax { rms, max },
        })
    }
}
