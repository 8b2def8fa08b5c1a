//! Everything that was measured: as JSON, as files of columns, and as a table for people.

use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};
use shrouds_io::write_atomically;
use shrouds_report::measure::{Dimension, Entries, Entry, Measured, Units, Value};

use super::contacts::Contact;
use super::volumes::Name;
use crate::console::{aligned, number, plural};
use crate::failure::Failure;
use crate::settings::SettingsReport;

/// The columns of a table of several rows.
const SHOWN: [&str; 9] = [
    "volume",
    "volume_error",
    "voxel_volume",
    "area",
    "area_error",
    "sphericity",
    "genus",
    "thickness_median",
    "contact_outside",
];
/// And those when distances were asked for.
const DISTANCES: [&str; 2] = ["distance_mean", "distance_95"];

/// What was measured, and where it stands.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    pub(super) input: String,
    /// Which voxels are inside, in words; null for a mesh.
    pub(super) selection: Option<String>,
    /// Of the coordinates.
    pub(super) frame: Option<String>,
    /// Of the coordinates' axes: right, left, or null where the frame does not tell.
    pub(super) handedness: Option<&'static str>,
    /// Of length.
    pub(super) unit: String,
    pub(super) units: Units<'a>,
    pub(super) settings: Option<&'a SettingsReport>,
    pub(super) distance_to: Option<String>,
    pub(super) rows: &'a [Row],
    /// The areas in which labels touch; null unless asked for.
    pub(super) contacts: Option<&'a [Contact]>,
    /// Seconds.
    pub(super) time: f64,
    /// Largest memory in bytes, where the system tells it.
    pub(super) memory: Option<u64>,
    pub(super) version: &'static str,
}

/// One body.
pub(super) struct Row {
    pub(super) name: Name,
    pub(super) measured: Measured,
}

impl Row {
    pub(super) fn add_outside(&mut self, area: f64) {
        self.measured.entries.number("contact_outside", Dimension::Area, area);
    }

    fn entries(&self) -> &Entries {
        &self.measured.entries
    }

    /// What people call it; nothing for the only one.
    fn title(&self) -> String {
        let Name { label, segment, component } = &self.name;
        let label = match label {
            Some(label) if segment.is_empty() => label.to_string(),
            Some(label) => format!("{label} {segment}"),
            None => String::new(),
        };
        let component = component.map_or(String::new(), |n| format!("part {n}"));
        [label, component]
            .into_iter()
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join(", ")
    }
}

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Flat<'a> {
            label: Option<i128>,
            name: &'a str,
            component: Option<usize>,
            #[serde(flatten)]
            entries: &'a Entries,
            notes: &'a [String],
        }
        let Name { label, segment, component } = &self.name;
        let (entries, notes) = (self.entries(), &self.measured.notes[..]);
        Flat { label: *label, name: segment, component: *component, entries, notes }
            .serialize(serializer)
    }
}

impl Report<'_> {
    /// Writes all columns to one file, and contacts to another.
    pub(super) fn write_csv(&self, path: &Path) -> Result<(), Failure> {
        let heading = |entries: &Entries| {
            let columns = entries.0.iter().flat_map(|entry| entry.headings(&self.unit));
            ["label", "name", "component"].map(str::to_owned).into_iter().chain(columns).collect()
        };
        let mut lines: Vec<Vec<String>> = vec![heading(self.units.entries)];
        lines.extend(self.rows.iter().map(|row| {
            let Name { label, segment, component } = &row.name;
            let label = label.map_or(String::new(), |label| label.to_string());
            let component = component.map_or(String::new(), |n| n.to_string());
            let mut cells = vec![label, segment.clone(), component];
            // A row without distances has cells for them all the same.
            cells.extend(self.units.entries.0.iter().flat_map(|column| {
                let blank = || column.headings("").iter().map(|_| String::new()).collect();
                row.entries().get(column.key).map_or_else(blank, Entry::exact)
            }));
            cells
        }));
        write_lines(path, &lines)?;
        let Some(contacts) = self.contacts else { return Ok(()) };
        let area = format!("area [{}]", Dimension::Area.unit(&self.unit));
        let heading = ["label", "name", "other_label", "other_name", &area].map(str::to_owned);
        let mut lines = vec![heading.to_vec()];
        lines.extend(contacts.iter().map(|contact| {
            let Contact { label, name, other, other_name, area } = contact;
            vec![
                label.to_string(),
                name.clone(),
                other.to_string(),
                other_name.clone(),
                area.to_string(),
            ]
        }));
        write_lines(&contacts_path(path), &lines)
    }

    /// Title, numbers and notes for people.
    pub(super) fn text(&self) -> String {
        let mut text = vec![self.title(), String::new()];
        match self.rows {
            [row] => text.extend(self.list(row)),
            rows => text.extend(self.table(rows)),
        }
        if let Some(contacts) = self.contacts {
            text.push(String::new());
            text.extend(self.contact_lines(contacts));
        }
        let notes = self.rows.iter().flat_map(|row| {
            let title = if self.rows.len() > 1 { row.title() + ": " } else { String::new() };
            row.measured.notes.iter().map(move |note| format!("note: {title}{note}"))
        });
        text.extend(notes);
        text.join("\n")
    }

    fn title(&self) -> String {
        let selection = self.selection.as_ref().map_or(String::new(), |words| format!(", {words}"));
        let frame = match (&self.frame, self.handedness) {
            (Some(frame), Some(hand)) => format!("{frame}, {hand}-handed, "),
            (Some(frame), None) => format!("{frame}, "),
            (None, _) => String::new(),
        };
        format!("{}{selection}; coordinates: {frame}lengths in {}", self.input, self.unit)
    }

    /// All columns of one body, a line for each.
    fn list(&self, row: &Row) -> Vec<String> {
        let line = |entry: &Entry| {
            vec![entry.key.replace('_', " "), entry.dimension.unit(&self.unit), readable(entry)]
        };
        let lines: Vec<Vec<String>> = row.entries().0.iter().map(line).collect();
        aligned(&lines, 3)
    }

    /// The most wanted columns of several bodies.
    fn table(&self, rows: &[Row]) -> Vec<String> {
        let columns: Vec<&Entry> =
            SHOWN.iter().chain(&DISTANCES).filter_map(|key| self.units.entries.get(key)).collect();
        let keys = columns.iter().map(|column| column.key.replace('_', " "));
        let units = columns.iter().map(|column| column.dimension.unit(&self.unit));
        let mut lines: Vec<Vec<String>> = vec![
            std::iter::once(String::new()).chain(keys).collect(),
            std::iter::once(String::new()).chain(units).collect(),
        ];
        lines.extend(rows.iter().map(|row| {
            let cell = |column: &&Entry| row.entries().get(column.key).map_or("-".into(), readable);
            std::iter::once(row.title()).chain(columns.iter().map(cell)).collect()
        }));
        let mut text = aligned(&lines, 1);
        let all = self.units.entries.0.len();
        text.push(format!("{} of {all} columns; all of them with --csv or --json", columns.len()));
        text
    }

    fn contact_lines(&self, contacts: &[Contact]) -> Vec<String> {
        let unit = Dimension::Area.unit(&self.unit);
        let title = |label: i128, name: &str| match name {
            "" => label.to_string(),
            name => format!("{label} {name}"),
        };
        let mut lines = vec![vec!["contact of".into(), "and".into(), format!("area {unit}")]];
        lines.extend(contacts.iter().map(|contact| {
            let Contact { label, name, other, other_name, area } = contact;
            vec![title(*label, name), title(*other, other_name), number(*area)]
        }));
        let mut text = aligned(&lines, 2);
        text.push(plural(contacts.len(), "contact"));
        text
    }
}

/// A column for people, with about six digits.
fn readable(entry: &Entry) -> String {
    const NONE: &str = "-";
    match &entry.value {
        Value::Count(count) => count.map_or(NONE.into(), |n| n.to_string()),
        Value::Number(x) => x.map_or(NONE.into(), number),
        Value::Vector(v) => v.map_or(NONE.into(), |v| v.map(number).join("  ")),
    }
}

/// Where contacts go when rows go to `path`.
pub(super) fn contacts_path(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map(|e| format!(".{}", e.to_string_lossy()));
    path.with_file_name(format!("{stem}-contacts{}", extension.unwrap_or_default()))
}

/// Writes cells with commas between them (RFC 4180).
fn write_lines(path: &Path, lines: &[Vec<String>]) -> Result<(), Failure> {
    let quoted = |cell: &String| match cell.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell.clone(),
    };
    Ok(write_atomically(path, |writer| {
        lines.iter().try_for_each(|cells| {
            let cells: Vec<String> = cells.iter().map(quoted).collect();
            write!(writer, "{}\r\n", cells.join(","))
        })
    })?)
}
