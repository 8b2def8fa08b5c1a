//! The segments that 3D Slicer names in the key-value pairs of a `.seg.nrrd` header.

use std::collections::BTreeMap;

use crate::volume::Segment;
use crate::volume::nrrd_header::Header;

/// The segments of a file of so many layers.
///
/// Before version 4.11 Slicer gave every segment a layer of its own, with the label 1, and wrote
/// neither down.
pub(super) fn segments(header: &mut Header, layers: usize) -> Vec<Segment> {
    let mut found: BTreeMap<u32, BTreeMap<&str, &str>> = BTreeMap::new();
    for (key, value) in &header.pairs {
        let parts = key.strip_prefix("Segment").and_then(|rest| rest.split_once('_'));
        if let Some((number, property)) = parts
            && let Ok(number) = number.parse()
        {
            found.entry(number).or_default().insert(property, value.trim());
        }
    }
    let mut segments = Vec::new();
    let mut warnings = Vec::new();
    for (place, (number, properties)) in found.into_iter().enumerate() {
        let get = |name| properties.get(name).copied().filter(|value| !value.is_empty());
        let name = get("Name").or(get("ID")).map_or(format!("Segment {number}"), Into::into);
        let own_layer = if layers > 1 && get("LabelValue").is_none() { place } else { 0 };
        let label = get("LabelValue").map_or(Ok(1), str::parse);
        let layer = get("Layer").map_or(Ok(own_layer), str::parse);
        match (label, layer) {
            (Ok(label), Ok(layer)) if layer < layers => {
                segments.push(Segment { name, label, layer });
            }
            _ => warnings.push(format!(
                "Segment {number} ('{name:.60}') has no layer and label that the file holds; it is \
                 left out."
            )),
        }
    }
    header.warnings.extend(warnings);
    segments
}
