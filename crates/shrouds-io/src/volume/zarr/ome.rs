//! OME metadata of images: levels of resolution, axes with units, labels with names.
//!
//! Standard: OME-NGFF (OME-Zarr) 0.4 and 0.5, and what older versions have of them.

use std::path::{Component, Path};

use serde_json::Value;

use crate::error::Error;
use crate::volume::Segment;
use crate::volume::zarr::node::Node;
use crate::volume::zarr::slabs::Layout;

/// Lengths by name in metres, with the names by which they go here.
const UNITS: [(&str, &str, f64); 7] = [
    ("meter", "m", 1.0),
    ("centimeter", "cm", 1e-2),
    ("millimeter", "mm", 1e-3),
    ("micrometer", "um", 1e-6),
    ("nanometer", "nm", 1e-9),
    ("angstrom", "angstrom", 1e-10),
    ("picometer", "pm", 1e-12),
];
/// Names of the axes before versions 0.4 and 0.3 of the standard, the last ones counting.
const OLD_AXES: [&str; 5] = ["t", "c", "z", "y", "x"];

/// An image in several resolutions.
pub(super) struct Image<'a> {
    node: &'a Node,
    multiscale: &'a Value,
}

/// Where one resolution of an image lies.
#[derive(Debug)]
pub(super) struct Placement {
    pub(super) layout: Layout,
    /// Distance of lattice points along x, y, z.
    pub(super) spacing: [f64; 3],
    pub(super) origin: [f64; 3],
    pub(super) unit: String,
    pub(super) warnings: Vec<String>,
}

struct Axis<'a> {
    name: &'a str,
    is_space: bool,
    unit: Option<&'a str>,
}

impl<'a> Image<'a> {
    /// The image that a group is, if it is one.
    pub(super) fn of(node: &'a Node) -> Option<Self> {
        let multiscale = node.ome()["multiscales"].get(0)?;
        Some(Self { node, multiscale })
    }

    /// Paths of the resolutions within the group, the finest first.
    pub(super) fn levels(&self) -> Result<Vec<&'a str>, Error> {
        let list = self.multiscale["datasets"].as_array().map_or(&[][..], Vec::as_slice);
        let paths: Option<Vec<&str>> = list
            .iter()
            .map(|level| level["path"].as_str().filter(|path| is_inside(path)))
            .collect();
        paths.filter(|paths| !paths.is_empty()).ok_or_else(|| {
            self.damaged("the resolutions of the image are not paths within its folder")
        })
    }

    /// Where the voxels of a resolution of this shape lie.
    pub(super) fn placement(&self, level: usize, shape: &[usize]) -> Result<Placement, Error> {
        let axes = self.axes(shape.len())?;
        let layout = self.layout(&axes)?;
        let dataset = &self.multiscale["datasets"][level]["coordinateTransformations"];
        let mut warnings = Vec::new();
        if !dataset.is_array() {
            warnings.push("The image states no distance of its voxels: 1 is taken.".into());
        }
        let mut map = vec![(1.0, 0.0); axes.len()];
        for list in [dataset, &self.multiscale["coordinateTransformations"]] {
            for step in list.as_array().map_or(&[][..], Vec::as_slice) {
                self.apply(step, &mut map)?;
            }
        }
        let (factors, unit) = units(&axes, &layout, &mut warnings);
        let along = |n: usize| layout.spatial[n].map(|axis| map[axis]);
        let mut spacing = [0, 1, 2].map(|n| along(n).map_or(0.0, |(scale, _)| scale * factors[n]));
        let origin = [0, 1, 2].map(|n| along(n).map_or(0.0, |(_, shift)| shift * factors[n]));
        if layout.spatial[2].is_none() {
            spacing[2] = spacing[0].abs().min(spacing[1].abs());
            warnings.push(format!(
                "The image has no axis z: it is taken as one slice, {} thick.",
                spacing[2]
            ));
        }
        Ok(Placement { layout, spacing, origin, unit, warnings })
    }

    fn axes(&self, rank: usize) -> Result<Vec<Axis<'a>>, Error> {
        let axes: Vec<Axis> = match self.multiscale["axes"].as_array() {
            Some(list) => list.iter().take(rank + 1).map(axis).collect(),
            None => {
                let skipped = OLD_AXES.len().saturating_sub(rank);
                let names = OLD_AXES[skipped..].iter();
                names.map(|name| Axis { name, is_space: is_spatial(name), unit: None }).collect()
            }
        };
        if axes.len() == rank {
            return Ok(axes);
        }
        let problem = format!("the image has {} axes, but its array has {rank}", axes.len());
        Err(self.damaged(problem))
    }

    fn layout(&self, axes: &[Axis]) -> Result<Layout, Error> {
        let space: Vec<usize> = (0..axes.len()).filter(|n| axes[*n].is_space).collect();
        let others = (0..axes.len()).filter(|n| !axes[*n].is_space).collect();
        let named = ["x", "y", "z"]
            .map(|name| space.iter().copied().find(|n| axes[*n].name.eq_ignore_ascii_case(name)));
        let spatial = if named.iter().flatten().count() == space.len() {
            named
        } else {
            // Other names: the fastest is x, as everywhere else in the standard.
            let mut last = space.iter().rev().copied();
            [last.next(), last.next(), last.next()]
        };
        match (space.len(), spatial) {
            (2 | 3, [Some(_), Some(_), _]) => Ok(Layout { spatial, others }),
            _ => {
                let what = format!("an image with {} axes of space", space.len());
                let advice = "give it two or three, named x, y and z";
                Err(Error::unsupported(&self.node.file, what, advice))
            }
        }
    }

    /// Puts a scale or a translation after the map of each axis.
    fn apply(&self, step: &Value, map: &mut [(f64, f64)]) -> Result<(), Error> {
        let kind = step["type"].as_str().unwrap_or("without a type");
        if kind == "identity" {
            return Ok(());
        }
        if kind != "scale" && kind != "translation" {
            let what = format!("the coordinate transformation {kind}");
            let advice = "write the image with a scale and a translation";
            return Err(Error::unsupported(&self.node.file, what, advice));
        }
        let numbers = step[kind].as_array().filter(|numbers| numbers.len() == map.len());
        let numbers: Option<Vec<f64>> =
            numbers.and_then(|numbers| numbers.iter().map(Value::as_f64).collect());
        let numbers = numbers
            .ok_or_else(|| self.damaged(format!("a {kind} is not a number for each axis")))?;
        for ((scale, shift), number) in map.iter_mut().zip(numbers) {
            if kind == "scale" {
                (*scale, *shift) = (*scale * number, *shift * number);
            } else {
                *shift += number;
            }
        }
        Ok(())
    }

    fn damaged(&self, problem: impl Into<String>) -> Error {
        Error::header(&self.node.file, problem)
    }

    /// Whether the image is one of labels.
    pub(super) fn is_label(&self) -> bool {
        self.node.ome()["image-label"].is_object()
    }

    /// The labels that have a name.
    pub(super) fn segments(&self) -> Vec<Segment> {
        let list = &self.node.ome()["image-label"]["properties"];
        let segment = |entry: &Value| {
            let value = &entry["label-value"];
            let label =
                value.as_i64().map(i128::from).or_else(|| value.as_u64().map(i128::from))?;
            let name = ["name", "label", "class"].iter().find_map(|key| entry[key].as_str())?;
            Some(Segment { name: name.into(), label, layer: 0 })
        };
        list.as_array().map_or_else(Vec::new, |list| list.iter().filter_map(segment).collect())
    }
}

/// Names of the label images that a `labels` group lists.
pub(super) fn label_names(folder: &Path) -> Result<Vec<String>, Error> {
    let Some(node) = Node::read(&folder.join("labels"))? else { return Ok(Vec::new()) };
    let names = node.ome()["labels"].as_array().cloned().unwrap_or_default();
    let names = names.iter().filter_map(Value::as_str).filter(|name| is_inside(name));
    Ok(names.map(str::to_owned).collect())
}

fn axis(value: &Value) -> Axis<'_> {
    // Version 0.3 has names only.
    let name = value["name"].as_str().or(value.as_str()).unwrap_or_default();
    let is_space = match value["type"].as_str() {
        Some(kind) => kind == "space",
        None => is_spatial(name),
    };
    Axis { name, is_space, unit: value["unit"].as_str() }
}

fn is_spatial(name: &str) -> bool {
    ["x", "y", "z"].iter().any(|axis| name.eq_ignore_ascii_case(axis))
}

/// Factors from the unit of each axis of space to that of all of them, which comes second.
fn units(axes: &[Axis], layout: &Layout, warnings: &mut Vec<String>) -> ([f64; 3], String) {
    let of = |n: usize| layout.spatial[n].and_then(|axis| axes[axis].unit);
    let known = |unit: &str| UNITS.iter().find(|(name, ..)| unit.eq_ignore_ascii_case(name));
    let Some(first) = of(0) else { return ([1.0; 3], "unknown".into()) };
    let Some(&(_, name, size)) = known(first) else { return ([1.0; 3], first.into()) };
    let factors = [0, 1, 2].map(|n| match of(n) {
        Some(unit) => known(unit).map(|(.., other)| other / size),
        None => Some(1.0),
    });
    let unknown = factors.contains(&None);
    if unknown || factors != [Some(1.0); 3] {
        let rest = if unknown {
            "one of them is not known and taken as the same"
        } else {
            "all are converted"
        };
        warnings.push(format!("The axes have different units; that of x is {name}, {rest}."));
    }
    (factors.map(|factor| factor.unwrap_or(1.0)), name.into())
}

/// Whether a path leads into a folder and nowhere else.
fn is_inside(path: &str) -> bool {
    !path.is_empty()
        && Path::new(path)
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
