//! TIFF and BigTIFF: the pages of a file, or the files of a folder, are the slices of a volume.
//!
//! Format: TIFF 6.0 with the supplements on predictors and BigTIFF; ImageJ's description; OME-XML. The
//! index axes are those of the pages: x to the right, y downwards, z from page to page.
//!
//! The reader is our own: the one that is in wide use refuses images of colour numbers, which label
//! images often are, turns values around in others, and takes memory by the word of a header.

mod describe;
mod file;
mod folder;
mod page;
mod predict;

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::stream::Progress;
use crate::volume::decode::convert;
use crate::volume::{
    Contents, Frame, Slabs, Unread, Values, VolumeOptions, affine_of, diagonal, lattice,
};
use describe::Plan;
use file::TiffFile;
use page::{Image, Page};

pub(super) use folder::{holds_slices, slices};

/// The tags that describe a file.
const DESCRIPTION: u16 = 270;
const RESOLUTION: [u16; 2] = [282, 283];
const RESOLUTION_UNIT: u16 = 296;

/// Where the pages of a volume are.
enum Places {
    /// The directories of one file.
    Directories(Vec<u64>),
    /// One block of pages from here on, of which the file has but the first directory.
    Block(u64),
    /// One file each.
    Files(Vec<PathBuf>),
}

/// A file or a folder whose directories have been read.
struct Stack {
    image: Image,
    places: Places,
    plan: Plan,
    warnings: Vec<String>,
}

pub(super) fn open<'a>(path: &'a Path, options: &VolumeOptions<'a>) -> Result<Unread<'a>, Error> {
    let Stack { image, places, plan, mut warnings } =
        if path.is_dir() { folder_stack(path)? } else { file_stack(path)? };
    if image.white_is_zero {
        let text = "The image calls its smallest value white: values were kept as they are stored.";
        warnings.push(text.into());
    }
    let dims = [image.width, image.height, plan.slices];
    let spacing = plan.spacing.map(|spacing| spacing.unwrap_or(1.0));
    let frame = Frame::new("index", plan.unit.clone(), plan.source);
    let (grid, frame) =
        lattice(path, dims, affine_of(diagonal(spacing), [0.0; 3]), frame, options)?;
    let layers = plan.channels.saturating_mul(plan.frames);
    let layer = options.layer.filter(|layer| *layer < layers).unwrap_or(0);
    let contents = Contents { layers, warnings, ..Contents::default() };
    let (scaling, progress) = (plan.scaling, options.progress);
    let slabs = Box::new(Pages { path, image, places, plan, layer, next: 0, progress, open: None });
    Ok(Unread { grid, frame, contents, slabs, z_fastest: false, scaling })
}

/// The pages of one file.
fn file_stack(path: &Path) -> Result<Stack, Error> {
    let mut file = TiffFile::open(path)?;
    let (image, places, mut warnings) = pages(&mut file)?;
    let first = file.directory(places[0])?;
    let mut plan = plan(&mut file, &first, places.len())?;
    let raw = Page::new(&mut file, &first)?.raw_start();
    let places = match raw {
        // ImageJ writes stacks of more than 4 GB with one directory.
        Some(start) if places.len() == 1 && is_block(&plan, start, places[0]) => {
            let bytes = block_bytes(&plan, image);
            let found = file.length.saturating_sub(start);
            if bytes > found {
                return Err(Error::Truncated { path: path.into(), expected: bytes, found });
            }
            Places::Block(start)
        }
        _ => Places::Directories(places),
    };
    if let Places::Directories(places) = &places {
        let found = places.len();
        let beyond = plan.pages.values().any(|page| *page >= found);
        if plan.total() > found || beyond || (plan.total() < found && plan.source != "OME-XML") {
            let text = format!(
                "The {} tells of {} pages, but there are {found}: each was taken as a slice.",
                plan.source,
                plan.total()
            );
            plan = Plan {
                spacing: plan.spacing,
                unit: plan.unit,
                source: plan.source,
                scaling: plan.scaling,
                warnings: plan.warnings,
                ..Plan::slices(found)
            };
            warnings.push(text);
        }
    }
    warnings.append(&mut plan.warnings);
    Ok(Stack { image, places, plan, warnings })
}

fn block_bytes(plan: &Plan, image: Image) -> u64 {
    image.page_bytes().saturating_mul(plan.images as u64)
}

/// Whether the pages can be one block from `start` on, behind the one directory.
fn is_block(plan: &Plan, start: u64, directory: u64) -> bool {
    let several = plan.images > 1 && plan.total() == plan.images;
    several && plan.source == "ImageJ description" && start > directory
}

/// One file per slice.
fn folder_stack(path: &Path) -> Result<Stack, Error> {
    let (files, mut warnings) = folder::slices(path)?;
    let mut found: Option<(Image, Plan)> = None;
    for part in &files {
        let mut file = TiffFile::open(part)?;
        let (image, places, _) = pages(&mut file)?;
        if places.len() > 1 {
            let what = format!("a file of {} pages in a folder of slices", places.len());
            return Err(Error::unsupported(part, what, "name that file instead of the folder"));
        }
        match &found {
            Some((first, _)) if *first != image => return Err(unlike(part, *first, image)),
            Some(_) => {}
            None => {
                let directory = file.directory(places[0])?;
                found = Some((image, plan(&mut file, &directory, 1)?));
            }
        }
    }
    let Some((image, first)) = found else {
        let what = "a folder without .tif files";
        return Err(Error::unsupported(path, what, "name a folder of slices"));
    };
    let Plan { spacing, unit, source, scaling, .. } = first;
    let plan = Plan { spacing, unit, source, scaling, ..Plan::slices(files.len()) };
    warnings.extend(first.warnings);
    Ok(Stack { image, places: Places::Files(files), plan, warnings })
}

/// What all pages of a file have in common, their directories, and what is doubtful.
fn pages(file: &mut TiffFile) -> Result<(Image, Vec<u64>, Vec<String>), Error> {
    let all = file.places()?;
    let (mut places, mut found): (Vec<u64>, Option<Image>) = (Vec::new(), None);
    for place in &all {
        let directory = file.directory(*place)?;
        if found.is_some() && page::is_secondary(file, &directory)? {
            continue;
        }
        let page = Page::new(file, &directory)?;
        page.check(file)?;
        match found {
            Some(first) if first != page.image => return Err(unlike(file.path, first, page.image)),
            _ => found = Some(page.image),
        }
        places.push(*place);
    }
    let left = all.len() - places.len();
    let text = format!("{left} smaller copies or masks among the pages were left out.");
    let warnings = if left > 0 { vec![text] } else { Vec::new() };
    let image = found.ok_or_else(|| Error::header(file.path, "it has no pages"))?;
    Ok((image, places, warnings))
}

fn unlike(path: &Path, first: Image, other: Image) -> Error {
    let name = |image: Image| format!("{} x {} {:?}", image.width, image.height, image.element);
    let what = format!("slices of several kinds ({} and {})", name(first), name(other));
    Error::unsupported(path, what, "keep slices of one size and type only")
}

/// How the pages make volumes, as the first of them tells.
fn plan(file: &mut TiffFile, first: &file::Directory, pages: usize) -> Result<Plan, Error> {
    let text = file.text(first, DESCRIPTION)?;
    let resolution = [file.ratio(first, RESOLUTION[0])?, file.ratio(first, RESOLUTION[1])?];
    let unit = file.number_of(first, RESOLUTION_UNIT)?.unwrap_or(2);
    if let Some(plan) = describe::ome(&text, pages) {
        return Ok(plan);
    }
    if let Some(plan) = describe::image_j(&text, pages, resolution, unit) {
        return Ok(plan);
    }
    let mut plan = Plan::slices(pages);
    if let ([Some(x), Some(y)], 3) = (resolution, unit) {
        plan.warnings.push(format!(
            "The resolution of {x} x {y} pixels per cm was not used, since no distance between slices is \
             told: the spacing is 1 unless you give it."
        ));
    }
    Ok(plan)
}

/// The values of one volume, page by page.
struct Pages<'a> {
    path: &'a Path,
    image: Image,
    places: Places,
    plan: Plan,
    layer: usize,
    /// The slice after the last that was read.
    next: usize,
    progress: Option<Progress<'a>>,
    /// The one file of all pages.
    open: Option<TiffFile<'a>>,
}

impl Pages<'_> {
    fn read(&mut self, slice: usize) -> Result<Values, Error> {
        let page = self.plan.page(slice, self.layer);
        match &self.places {
            Places::Files(files) => {
                let mut file = TiffFile::open(&files[page])?;
                let place = file.places()?[0];
                read_page(&mut file, place, self.image)
            }
            Places::Directories(places) => {
                read_page(opened(&mut self.open, self.path)?, places[page], self.image)
            }
            Places::Block(start) => {
                let file = opened(&mut self.open, self.path)?;
                let bytes = self.image.page_bytes();
                let bytes = file.bytes(start + page as u64 * bytes, bytes)?;
                Ok(convert(&bytes, self.image.element, file.endian))
            }
        }
    }
}

fn opened<'o, 'a>(
    open: &'o mut Option<TiffFile<'a>>,
    path: &'a Path,
) -> Result<&'o mut TiffFile<'a>, Error> {
    match open {
        Some(file) => Ok(file),
        None => Ok(open.insert(TiffFile::open(path)?)),
    }
}

/// The values of a page, which is still as it was when its size was checked.
fn read_page(file: &mut TiffFile, place: u64, image: Image) -> Result<Values, Error> {
    let directory = file.directory(place)?;
    let page = Page::new(file, &directory)?;
    if page.image != image {
        return Err(Error::header(file.path, "it changed while it was read"));
    }
    page.values(file)
}

impl Slabs for Pages<'_> {
    fn next(&mut self) -> Result<Option<Values>, Error> {
        if self.next == self.plan.slices {
            return Ok(None);
        }
        let values = self.read(self.next)?;
        self.next += 1;
        if let Some(progress) = self.progress {
            // Pages are of one size before they are compressed.
            let bytes = self.image.page_bytes();
            let done = |pages: usize| bytes.saturating_mul(pages as u64);
            progress(done(self.next), done(self.plan.slices));
        }
        Ok(Some(values))
    }
}
