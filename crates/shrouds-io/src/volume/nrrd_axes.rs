//! Which axes of an NRRD file are those of the lattice, and which one tells its volumes apart.

use std::path::Path;

use crate::error::Error;
use crate::volume::data::Layers;
use crate::volume::nrrd_header::Header;

/// Most axes of a file.
const MAX_AXES: usize = 16;
const ADVICE: &str = "extract one volume of three dimensions";

/// The axes of a file.
pub(super) struct Axes {
    /// Lengths of all of them, the fastest first.
    pub(super) sizes: Vec<usize>,
    /// The two or three that lie in space, ascending: x, y, z.
    pub(super) spatial: Vec<usize>,
    /// Steps along each axis of the file, where it gives them and the axis lies in space.
    pub(super) directions: Option<Vec<Option<Vec<f64>>>>,
}

impl Axes {
    pub(super) fn new(path: &Path, header: &mut Header) -> Result<Self, Error> {
        let sizes = sizes(path, header)?;
        let directions = directions(path, header, sizes.len())?;
        let mut spatial: Vec<usize> = match &directions {
            Some(steps) => (0..sizes.len()).filter(|n| steps[*n].is_some()).collect(),
            None => by_kind(path, header, sizes.len())?,
        };
        // Dimensions of one point are no dimensions, where there are too many.
        while spatial.len() > 3
            && let Some(flat) = spatial.iter().rposition(|n| sizes[*n] == 1)
        {
            spatial.remove(flat);
        }
        if spatial.len() == 4 {
            spatial.pop();
            header.warnings.push(
                "The header does not say which of its four axes is none in space: the slowest is \
                 taken for a series of volumes."
                    .into(),
            );
        }
        if !(2..=3).contains(&spatial.len()) {
            let what = format!("an NRRD with {} axes in space (sizes {sizes:?})", spatial.len());
            return Err(Error::unsupported(path, what, ADVICE));
        }
        Ok(Self { sizes, spatial, directions })
    }

    /// Points along x, y, z; an image is one slice.
    pub(super) fn dims(&self) -> [usize; 3] {
        [0, 1, 2].map(|n| self.spatial.get(n).map_or(1, |axis| self.sizes[*axis]))
    }

    /// The axis that tells several volumes apart.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when there are two such axes, [`Error::Header`] when the sizes multiply
    /// to more than can be counted.
    pub(super) fn layers(&self, path: &Path) -> Result<Layers, Error> {
        let sizes = &self.sizes;
        let mut others = (0..sizes.len()).filter(|n| sizes[*n] > 1 && !self.spatial.contains(n));
        let layer = others.next().unwrap_or(sizes.len());
        if others.next().is_some() {
            let what = format!("an NRRD with several axes beside those in space (sizes {sizes:?})");
            return Err(Error::unsupported(path, what, ADVICE));
        }
        let product = |sizes: &[usize]| sizes.iter().try_fold(1usize, |all, n| all.checked_mul(*n));
        let after = sizes.get(layer + 1..).unwrap_or_default();
        let (Some(inner), Some(outer)) = (product(&sizes[..layer]), product(after)) else {
            let problem = format!("sizes {sizes:?} are more than a file can hold");
            return Err(Error::header(path, problem));
        };
        let count = sizes.get(layer).copied().unwrap_or(1);
        Ok(Layers { inner, count, outer, chosen: 0 })
    }
}

fn sizes(path: &Path, header: &Header) -> Result<Vec<usize>, Error> {
    let (text, dimension) = (header.need(path, "sizes")?, header.need(path, "dimension")?);
    let number =
        dimension.parse().ok().filter(|n| (1..=MAX_AXES).contains(n)).ok_or_else(|| {
            Error::header(path, format!("the dimension '{dimension:.20}' is not 1 to {MAX_AXES}"))
        })?;
    let sizes: Option<Vec<usize>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
    let sizes = sizes.filter(|sizes| sizes.len() == number && !sizes.contains(&0));
    let problem = format!("the sizes '{text:.60}' are not {number} numbers from 1 on");
    sizes.ok_or_else(|| Error::header(path, problem))
}

/// The axes whose kind is one of space, or not told; or that have a spacing.
fn by_kind(path: &Path, header: &Header, count: usize) -> Result<Vec<usize>, Error> {
    let mut spatial: Vec<usize> = (0..count).collect();
    if let Some(text) = header.get("kinds") {
        let kinds: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
        if kinds.len() != count {
            let problem = format!("the kinds '{text:.60}' are not one for each of {count} axes");
            return Err(Error::header(path, problem));
        }
        let of_space = |n: &usize| {
            ["domain", "space", "???", "none", "unknown", "stub", "scalar"]
                .contains(&kinds[*n].as_str())
        };
        spatial.retain(of_space);
    }
    if spatial.len() > 3
        && let Some(spacings) = header.numbers(path, "spacings")?
        && spacings.len() == count
    {
        spatial.retain(|n| spacings[*n].is_finite());
    }
    Ok(spatial)
}

fn directions(
    path: &Path,
    header: &Header,
    count: usize,
) -> Result<Option<Vec<Option<Vec<f64>>>>, Error> {
    let Some(text) = header.get("space directions") else { return Ok(None) };
    let steps = vectors(text).filter(|steps| steps.len() == count);
    let problem = format!("the space directions '{text:.80}' are not one for each of {count} axes");
    steps.map(Some).ok_or_else(|| Error::header(path, problem))
}

/// The vectors of a text such as `(1,0,0) none (0,1,0)`; `None` if there is anything else in it. A
/// vector of which nothing is a number is none.
pub(super) fn vectors(text: &str) -> Option<Vec<Option<Vec<f64>>>> {
    let (mut vectors, mut rest) = (Vec::new(), text.trim());
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            vectors.push(None);
            rest = after.trim_start();
            continue;
        }
        let (inside, after) = rest.strip_prefix('(')?.split_once(')')?;
        let numbers = inside.split(',').map(|n| n.trim().parse().ok());
        let vector = numbers.collect::<Option<Vec<f64>>>()?;
        vectors.push(Some(vector).filter(|vector| !vector.iter().all(|x| x.is_nan())));
        rest = after.trim_start();
    }
    Some(vectors)
}
