//! All labels of a packed label map: a volume of them, or a mesh of each.

use std::time::Instant;

use shrouds_codec::{Header, unpack_labels};
use shrouds_io::write_labels;

use super::shroud_args;
use super::volume::Report;
use crate::args::UnpackArgs;
use crate::console::Console;
use crate::each::{Each, Label, Target};
use crate::failure::Failure;
use crate::packed::{frame, open};
use crate::progress::Progress;
use crate::settings::Job;
use crate::work::Extras;

/// Writes the label map.
pub(super) fn write(
    args: &UnpackArgs,
    console: Console,
    progress: Progress,
) -> Result<(), Failure> {
    let (header, map) = open(&args.input, unpack_labels)?;
    progress.stage("writing");
    write_labels(&args.output, map.grid(), map.values(), &frame(&header))?;
    drop(progress);
    let mut report = Report::new(args, &header, map.grid());
    report.labels = Some(map.labels().to_vec());
    report.tell(args, console)
}

/// Makes a mesh of every label but 0.
pub(super) fn meshes(
    args: &UnpackArgs,
    target: Target,
    header: &Header,
    start: Instant,
    console: Console,
    progress: Progress,
) -> Result<(), Failure> {
    target.format()?;
    let job = Job::new(&shroud_args(args, header)?, args.frame.frame)?;
    job.warn(console);
    let (_, map) = open(&args.input, unpack_labels)?;
    let (extras, frame) = (&Extras::default(), frame(header));
    let (keeps_meshes, done) = (false, Vec::new());
    let mut each = Each { target, job: &job, extras, console, progress, keeps_meshes, done };
    let labels: Vec<i64> = map.labels().iter().copied().filter(|&label| label != 0).collect();
    for (n, &label) in labels.iter().enumerate() {
        each.progress.part(&format!("label {label}, {} of {}", n + 1, labels.len()));
        let (name, layer) = (String::new(), None);
        each.add(Label { label: label.into(), name, layer }, map.occupancy(label), &frame)?;
    }
    each.require_labels()?;
    each.progress.part("");
    each.progress.stage("writing");
    each.write_file(map.grid(), &frame)?;
    each.finish(start, None, args.json)
}
