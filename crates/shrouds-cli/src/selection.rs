//! Which voxels of a file are inside: from what was typed and the segments that the file names.

use std::path::Path;

use shrouds::Select;
use shrouds_io::{Contents, Segment};

use crate::args::VolumeArgs;
use crate::console::number;
use crate::failure::Failure;

/// Most labels that a message lists.
const LISTED: usize = 20;

/// Which voxels of a file are inside.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Selection {
    /// What is chosen in each layer that matters; no number for the only one, or for all of them.
    pub(crate) parts: Vec<(Option<usize>, Select)>,
    /// The same as a person would say it.
    pub(crate) words: String,
}

impl Selection {
    /// What the arguments mean in a file with these contents.
    pub(crate) fn new(
        path: &Path,
        args: &VolumeArgs,
        contents: &Contents,
    ) -> Result<Self, Failure> {
        let layer = args.layer();
        let all = |select: Select, words: String| Self { parts: vec![(layer, select)], words };
        if let Some(level) = args.threshold {
            return Ok(all(Select::Above(level), format!("above {}", number(level))));
        }
        if args.labels.is_empty() {
            return Ok(all(Select::NonZero, "all but 0".into()));
        }
        let mut chosen = Vec::new();
        for text in &args.labels {
            let found = find(text, layer, contents);
            chosen.push(found.map_err(|problem| {
                let message = format!("{}: {problem}", path.display());
                // Without names no text but a number can be meant.
                if contents.segments.is_empty() {
                    Failure::Call(message)
                } else {
                    Failure::Undone(message)
                }
            })?);
        }
        let words = args.labels.iter().zip(&chosen).map(|(text, (_, label))| {
            if text.parse() == Ok(*label) { text.clone() } else { format!("{text} ({label})") }
        });
        Ok(Self { words: list(words), parts: by_layer(&chosen) })
    }

    /// The labels that are wanted, and whether there are several.
    pub(crate) fn has_several_labels(&self) -> bool {
        let count = |(_, select): &(_, Select)| match select {
            Select::Labels(labels) => labels.len(),
            _ => 1,
        };
        self.parts.iter().map(count).sum::<usize>() > 1
    }
}

/// The layer and the label that a text means.
fn find(
    text: &str,
    layer: Option<usize>,
    contents: &Contents,
) -> Result<(Option<usize>, i128), String> {
    let (segments, in_layers) = (&contents.segments, contents.has_layers_of_segments());
    let there = |segment: &&Segment| !in_layers || layer.is_none_or(|layer| layer == segment.layer);
    let of = |is: &dyn Fn(&Segment) -> bool| -> Vec<&Segment> {
        segments.iter().filter(there).filter(|segment| is(segment)).collect()
    };
    let mut found = of(&|segment| segment.name == text);
    if found.is_empty() {
        found = of(&|segment| segment.name.to_lowercase() == text.to_lowercase());
    }
    if found.is_empty() {
        match text.parse::<i128>() {
            Ok(label) if segments.is_empty() => return Ok((layer, label)),
            Ok(label) => {
                found = of(&|segment| segment.label == label);
                if found.is_empty() {
                    return Ok((layer, label));
                }
            }
            Err(_) if segments.is_empty() => {
                return Err(format!(
                    "--label {text} is no number, and the file names no segments: give the number \
                     of a label, such as --label 1 (shrouds info lists them)"
                ));
            }
            Err(_) => {
                let names = list(segments.iter().map(|segment| segment.name.clone()));
                return Err(format!("no segment is named {text}; the file has {names}"));
            }
        }
    }
    match found[..] {
        [one] => Ok((if in_layers { Some(one.layer) } else { layer }, one.label)),
        _ => {
            let describe =
                |s: &&Segment| format!("{} (label {} of frame {})", s.name, s.label, s.layer);
            let all = list(found.iter().map(describe));
            Err(format!("--label {text} may be {all}; name one, or add its --frame"))
        }
    }
}

fn by_layer(chosen: &[(Option<usize>, i128)]) -> Vec<(Option<usize>, Select)> {
    let mut layers: Vec<Option<usize>> = chosen.iter().map(|(layer, _)| *layer).collect();
    layers.sort_unstable();
    layers.dedup();
    let labels = |wanted| chosen.iter().filter(move |(layer, _)| *layer == wanted);
    let part = |layer| (layer, Select::Labels(labels(layer).map(|(_, label)| *label).collect()));
    layers.into_iter().map(part).collect()
}

/// The items with commas between them, the first of them if there are many.
pub(crate) fn list(items: impl IntoIterator<Item = String>) -> String {
    let mut items = items.into_iter();
    let shown: Vec<String> = items.by_ref().take(LISTED).collect();
    let more = items.count();
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segments() -> Contents {
        let segments = [("Liver", 1, 0), ("liver left", 2, 0), ("Tumour", 1, 1), ("7", 3, 1)]
            .map(|(name, label, layer)| Segment { name: name.into(), label, layer });
        Contents { layers: 2, segments: segments.to_vec(), ..Contents::default() }
    }

    #[test]
    fn names_come_before_numbers() {
        let found = |text| find(text, None, &segments());
        assert_eq!(found("Liver"), Ok((Some(0), 1)));
        assert_eq!(found("tumour"), Ok((Some(1), 1)));
        assert_eq!(found("7"), Ok((Some(1), 3)));
        assert_eq!(found("2"), Ok((Some(0), 2)));
        assert_eq!(found("9"), Ok((None, 9)), "the voxels decide");
        assert!(found("1").unwrap_err().contains("Liver (label 1 of frame 0), Tumour"));
        assert_eq!(find("1", Some(1), &segments()), Ok((Some(1), 1)));
        assert!(found("spleen").unwrap_err().contains("Liver, liver left, Tumour, 7"));
        let nameless = Contents::default();
        assert_eq!(find("-4", Some(2), &nameless), Ok((Some(2), -4)));
        assert!(find("liver", None, &nameless).unwrap_err().contains("names no segments"));
    }

    #[test]
    fn names_hold_in_every_frame_of_a_series() {
        let series = Contents {
            segments: segments().segments[..2].to_vec(),
            layers: 3,
            ..Contents::default()
        };
        assert_eq!(find("Liver", Some(2), &series), Ok((Some(2), 1)));
        assert_eq!(find("Liver", None, &series), Ok((None, 1)), "no frame is chosen silently");
    }

    #[test]
    fn layers_are_gathered() {
        let chosen = [(Some(1), 3), (Some(0), 1), (Some(1), 1)];
        let expected = [(Some(0), Select::Labels(vec![1])), (Some(1), Select::Labels(vec![3, 1]))];
        assert_eq!(by_layer(&chosen), expected);
    }
}
