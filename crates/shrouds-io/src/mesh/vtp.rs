//! VTP out: meshes and lines as VTK XML PolyData.

use std::io::{self, Write};

use crate::mesh::part::Parts;
use crate::mesh::vtk_xml::{Array, Counts, Kind, Section, field_data, strings, write_file};
use crate::mesh::{Attribute, Line, MeshOptions};

pub(super) fn write(writer: &mut dyn Write, parts: Parts, options: &MeshOptions) -> io::Result<()> {
    let (vertices, triangles) = (parts.vertex_count(), parts.triangle_count());
    let places = move || parts.iter().flat_map(|part| &part.mesh.vertices);
    let labels = parts.labels().map(|labels| label_array(parts, labels));
    let sections = [
        Section { name: "PointData", arrays: point_data(parts) },
        Section { name: "CellData", arrays: labels.into_iter().collect() },
        Section {
            name: "Points",
            arrays: vec![Array::points(vertices, options.precision, places)],
        },
        Section { name: "Polys", arrays: polygons(parts) },
    ];
    let mut fields = field_data(options);
    let names: Vec<&str> = parts.iter().map(|part| part.name).collect();
    if names.iter().any(|name| !name.is_empty()) {
        fields.push_str(&strings("names", &names));
    }
    let counts = Counts { points: vertices, lines: 0, polygons: triangles };
    write_file(writer, &counts, &fields, &sections)
}

fn point_data(parts: Parts) -> Vec<Array> {
    let count = parts.vertex_count();
    let normals = move || parts.iter().flat_map(|part| &part.mesh.normals);
    let normals = Array::new("Normals", Kind::Float32, [count, 3], normals, |normal, bytes| {
        bytes.extend_from_slice(normal.map(f32::to_le_bytes).as_flattened());
    });
    let attributes = parts.attribute_names().enumerate().map(|(n, name)| {
        let values = move || parts.iter().flat_map(move |part| part.attributes[n].values);
        Array::numbers(name, count, values)
    });
    parts.have_normals().then_some(normals).into_iter().chain(attributes).collect()
}

/// The label of every triangle.
fn label_array(parts: Parts, labels: Vec<i64>) -> Array {
    let parts_labels: Vec<(usize, i64)> =
        parts.iter().map(|part| part.mesh.triangles.len()).zip(labels).collect();
    let labels = move || {
        let all = parts_labels.clone().into_iter();
        all.flat_map(|(count, label)| std::iter::repeat_n(label, count))
    };
    let count = parts.triangle_count();
    Array::new("label", Kind::Int64, [count, 1], labels, |label, bytes| {
        bytes.extend_from_slice(&label.to_le_bytes());
    })
}

/// Corners of the triangles, and where those of each end.
fn polygons(parts: Parts) -> Vec<Array> {
    let count = parts.triangle_count();
    let kind = Kind::up_to(3 * count.max(parts.vertex_count()));
    let corners = move || {
        parts.counted().flat_map(|(first, part)| {
            part.mesh.triangles.iter().map(move |triangle| triangle.map(|v| first + v))
        })
    };
    let ends = move || (1..=count as u64).map(|n| [3 * n]);
    vec![
        Array::new("connectivity", kind, [3 * count, 1], corners, move |t, bytes| {
            kind.put(t, bytes);
        }),
        Array::new("offsets", kind, [count, 1], ends, move |end, bytes| kind.put(end, bytes)),
    ]
}

pub(super) fn write_lines(
    writer: &mut dyn Write,
    lines: &[Line],
    attributes: &[Attribute],
    options: &MeshOptions,
) -> io::Result<()> {
    // A line without points is left out.
    let kept = move || lines.iter().enumerate().filter(|(_, line)| !line.points.is_empty());
    let line_count = kept().count();
    let point_count = lines.iter().map(|line| line.points.len()).sum();
    // Where those of each line end, as points and as places in the list that joins them.
    let ends = move || {
        kept().scan([0, 0], |[points, places], (_, line)| {
            *points += line.points.len() as u64;
            *places += line.points.len() as u64 + u64::from(line.closed);
            Some(([*points, *places], line))
        })
    };
    let joined = ends().last().map_or(0, |([_, places], _)| places) as usize;
    let indices =
        move || ends().flat_map(|([end, _], line)| line.indices(end - line.points.len() as u64));
    let kind = Kind::up_to(joined);
    let numbers = attributes.iter().map(|attribute| {
        let values = move || kept().map(|(n, _)| &attribute.values[n]);
        Array::numbers(attribute.name, line_count, values)
    });
    let points = move || lines.iter().flat_map(|line| line.points);
    let points = Array::points(point_count, options.precision, points);
    let cells = vec![
        Array::new("connectivity", kind, [joined, 1], indices, move |index, bytes| {
            kind.put([index], bytes);
        }),
        Array::new("offsets", kind, [line_count, 1], ends, move |([_, end], _), bytes| {
            kind.put([end], bytes);
        }),
    ];
    let sections = [
        Section { name: "CellData", arrays: numbers.collect() },
        Section { name: "Points", arrays: vec![points] },
        Section { name: "Lines", arrays: cells },
    ];
    let counts = Counts { points: point_count, lines: line_count, polygons: 0 };
    write_file(writer, &counts, &field_data(options), &sections)
}
