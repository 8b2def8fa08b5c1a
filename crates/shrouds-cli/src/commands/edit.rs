//! Volumes out of volumes: `shrouds combine`, `offset`, `crop`, `resample` and `clean`.

use std::ops::Range;
use std::path::Path;

use serde::Serialize;
use shrouds::volume::{self, Cleaned};
use shrouds::{Grid, Occupancy};
use shrouds_io::{
    Frame, Selected, VolumeOptions, read_contents, volume_format, write_volume, written_format,
};

use crate::args::{
    CleanArgs, CombineArgs, CropArgs, EditArgs, Interpolation, OffsetArgs, Operation, ResampleArgs,
    VolumeArgs, Window,
};
use crate::console::{Console, grouped, plural, print_json};
use crate::failure::Failure;
use crate::input;
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::name;
use crate::selection::Selection;

/// A volume that was written.
#[derive(Debug, Serialize)]
struct Edited {
    output: String,
    /// Lattice points along x, y, z.
    dims: [usize; 3],
    spacing: [f64; 3],
    affine: [[f64; 4]; 3],
    frame: String,
    unit: String,
    /// Voxels inside before, of the first volume, and after.
    before: u64,
    inside: u64,
    /// What was done, in sentences.
    notes: Vec<String>,
}

/// A volume to work on.
struct Work {
    volume: Occupancy,
    frame: Frame,
    before: u64,
    notes: Vec<String>,
}

pub(crate) fn combine(args: &CombineArgs, console: Console) -> Result<(), Failure> {
    args.volume.refuse_coordinates()?;
    check_files(&args.output, &[&args.a, &args.b])?;
    let progress = Progress::new(console.quiet);
    let mut work = Work::read(&args.a, &args.volume, console, &progress)?;
    let mut other = args.volume.clone();
    if !args.labels_b.is_empty() {
        (other.labels, other.threshold) = (args.labels_b.clone(), None);
    }
    let other = Work::read(&args.b, &other, console, &progress)?;
    progress.stage("combining");
    let operation = match args.operation {
        Operation::Union => volume::Operation::Union,
        Operation::Intersect => volume::Operation::Intersect,
        Operation::Subtract => volume::Operation::Subtract,
        Operation::Xor => volume::Operation::Xor,
    };
    work.volume = work.volume.combine(operation, &other.volume).map_err(|error| {
        Failure::Undone(format!("{} and {}: {error}", args.a.display(), args.b.display()))
    })?;
    work.write(&args.output, args.json, console, progress)
}

pub(crate) fn offset(args: &OffsetArgs, console: Console) -> Result<(), Failure> {
    edit(&args.edit, &[], console, |work, progress| {
        progress.stage("measuring distances");
        if !args.keep_lattice {
            let dims = work.volume.grid().dims();
            work.volume = work.volume.padded_for(args.by)?;
            let grown = work.volume.grid().dims();
            if grown != dims {
                work.notes.push(format!("the lattice grew from {dims:?} to {grown:?} voxels"));
            }
        }
        work.volume = work.volume.offset(args.by, args.border)?;
        Ok(())
    })
}

pub(crate) fn crop(args: &CropArgs, console: Console) -> Result<(), Failure> {
    edit(&args.edit, &[], console, |work, _| {
        let inside = match &args.window {
            Some(Window(ranges)) => Some(ranges.clone()),
            None => work.volume.bounding_box(),
        };
        let ranges = inside.ok_or_else(|| {
            Failure::Undone("nothing is inside: give --box to crop an empty volume".into())
        })?;
        let margin = args.margin.unwrap_or(u32::from(args.window.is_none())) as usize;
        let dims = work.volume.grid().dims();
        let ranges: [Range<usize>; 3] = std::array::from_fn(|d| {
            let Range { start, end } = ranges[d];
            // A window beyond the lattice is left as it is, to be refused.
            start.saturating_sub(margin)..end.max(dims[d].min(end.saturating_add(margin)))
        });
        let text: Vec<String> = ranges.iter().map(|r| format!("{}:{}", r.start, r.end)).collect();
        work.notes.push(format!("the box is {}", text.join(",")));
        work.volume = work.volume.crop(ranges)?;
        Ok(())
    })
}

pub(crate) fn resample(args: &ResampleArgs, console: Console) -> Result<(), Failure> {
    let like: Vec<&Path> = args.like.as_deref().into_iter().collect();
    edit(&args.edit, &like, console, |work, progress| {
        let grid = match (&args.like, args.to) {
            (Some(like), _) => lattice_of(like, work)?,
            (None, Some(spacing)) => work.volume.grid().with_spacing(spacing)?,
            (None, None) => work.volume.grid().clone(),
        };
        let interpolation = match args.interpolation {
            Interpolation::Nearest => volume::Interpolation::Nearest,
            Interpolation::Linear => volume::Interpolation::Linear,
        };
        progress.stage("resampling");
        work.volume = work.volume.resample(&grid, interpolation)?;
        Ok(())
    })
}

/// The lattice of a volume file; its frame becomes that of the work.
fn lattice_of(path: &Path, work: &mut Work) -> Result<Grid, Failure> {
    let (grid, frame, _) = read_contents(path, &VolumeOptions::default())?;
    if (&frame.name, &frame.unit) != (&work.frame.name, &work.frame.unit) {
        work.notes.push(format!(
            "the frames have different names, {} in {} and {} in {}: coordinates are taken as they are",
            work.frame.name, work.frame.unit, frame.name, frame.unit
        ));
    }
    work.frame = frame;
    Ok(grid)
}

pub(crate) fn clean(args: &CleanArgs, console: Console) -> Result<(), Failure> {
    let rule = args.faces;
    edit(&args.edit, &[], console, |work, progress| {
        progress.stage("finding the components");
        if let Some(least) = args.drop_below {
            let cleaned = work.volume.drop_smaller(least, rule);
            work.take(cleaned, "component", "removed");
        }
        if let Some(count) = args.keep_largest {
            let cleaned = work.volume.keep_largest(count as usize, rule);
            work.take(cleaned, "component", "removed");
        }
        if let Some(most) = args.fill_cavities {
            let cleaned = work.volume.fill_cavities(Some(most), rule);
            work.take(cleaned, "cavity", "filled");
        }
        Ok(())
    })
}

/// Reads a volume, does something with it and writes it; `others` are files that are read, too.
fn edit(
    args: &EditArgs,
    others: &[&Path],
    console: Console,
    change: impl FnOnce(&mut Work, &Progress) -> Result<(), Failure>,
) -> Result<(), Failure> {
    args.volume.refuse_coordinates()?;
    let inputs: Vec<&Path> = std::iter::once(&*args.input).chain(others.iter().copied()).collect();
    check_files(&args.output, &inputs)?;
    let progress = Progress::new(console.quiet);
    let mut work = Work::read(&args.input, &args.volume, console, &progress)?;
    change(&mut work, &progress).map_err(|failure| match failure {
        Failure::Undone(text) => Failure::Undone(format!("{}: {text}", args.input.display())),
        other => other,
    })?;
    work.write(&args.output, args.json, console, progress)
}

/// Finds out before the work whether the files can be what they are to be.
fn check_files(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    for input in inputs {
        volume_format(input)?;
    }
    written_format(output)?;
    check_targets(&[output], inputs)
}

impl Work {
    fn read(
        path: &Path,
        args: &VolumeArgs,
        console: Console,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let (_, _, contents) = input::contents(path, args, console)?;
        let selection = Selection::new(path, args, &contents)?;
        let selected = input::selected(path, args, &selection, console, progress)?;
        let Selected { occupancy: volume, frame, .. } = selected;
        let before = volume.count();
        if before == 0 {
            console.warn(&format!("{}: nothing is inside ({})", path.display(), selection.words));
        }
        Ok(Self { volume, frame, before, notes: Vec::new() })
    }

    /// Takes a volume that was cleaned; says what `happened` to how many of what.
    fn take(&mut self, cleaned: Cleaned, what: &str, happened: &str) {
        let Cleaned { volume, components, voxels } = cleaned;
        let what = match (what, components) {
            ("cavity", 1) => "1 cavity".into(),
            ("cavity", _) => format!("{} cavities", grouped(components as u64)),
            _ => plural(components, what),
        };
        self.notes.push(format!("{what} of {} voxels {happened}", grouped(voxels)));
        self.volume = volume;
    }

    fn write(
        self,
        path: &Path,
        json: bool,
        console: Console,
        progress: Progress,
    ) -> Result<(), Failure> {
        progress.stage("writing");
        write_volume(path, &self.volume, &self.frame)?;
        drop(progress);
        let grid = self.volume.grid();
        let edited = Edited {
            output: name(path),
            dims: grid.dims(),
            spacing: grid.spacing(),
            affine: grid.affine(),
            frame: self.frame.name,
            unit: self.frame.unit,
            before: self.before,
            inside: self.volume.count(),
            notes: self.notes,
        };
        if edited.inside == 0 {
            console.warn(&format!("{}: nothing is inside the result", path.display()));
        }
        if json {
            print_json(&edited)
        } else {
            console.message(&edited.in_words(path));
            Ok(())
        }
    }
}

impl Edited {
    fn in_words(&self, path: &Path) -> String {
        let [nx, ny, nz] = self.dims;
        let notes: String = self.notes.iter().map(|note| format!("; {note}")).collect();
        format!(
            "{}: {nx} × {ny} × {nz} voxels, {} inside ({} before){notes}",
            path.display(),
            grouped(self.inside),
            grouped(self.before)
        )
    }
}
