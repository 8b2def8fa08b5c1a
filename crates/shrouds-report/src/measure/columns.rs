//! What a column holds, and in which unit.

use serde::{Serialize, Serializer};

/// What a number measures, which decides its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dimension {
    /// A count, a share or a direction.
    None,
    /// A length.
    Length,
    /// A length squared.
    Area,
    /// A length cubed.
    Volume,
    /// One over a length.
    PerLength,
    /// One over a length squared.
    PerArea,
}

impl Dimension {
    /// The unit where lengths have this one; nothing for plain numbers.
    pub fn unit(self, length: &str) -> String {
        match self {
            Self::None => String::new(),
            Self::Length => length.to_owned(),
            Self::Area => format!("{length}²"),
            Self::Volume => format!("{length}³"),
            Self::PerLength => format!("1/{length}"),
            Self::PerArea => format!("1/{length}²"),
        }
    }
}

/// A value; none where it has no meaning, as the volume of an open mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A whole number.
    Count(Option<i64>),
    /// Any finite number.
    Number(Option<f64>),
    /// Three along x, y, z.
    Vector(Option<[f64; 3]>),
}

/// A column of one row.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its name.
    pub key: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// How much of it there is.
    pub value: Value,
}

/// Entries in the order of the columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Entries(
    /// One after another.
    pub Vec<Entry>,
);

impl Entries {
    /// Appends a count.
    pub fn count(&mut self, key: &'static str, value: impl Into<Option<i64>>) {
        self.push(key, Dimension::None, Value::Count(value.into()));
    }

    /// Appends a number; one that is not finite is none.
    pub fn number(
        &mut self,
        key: &'static str,
        dimension: Dimension,
        value: impl Into<Option<f64>>,
    ) {
        let value = value.into().filter(|x| x.is_finite());
        self.push(key, dimension, Value::Number(value));
    }

    /// Appends a vector.
    pub fn vector(
        &mut self,
        key: &'static str,
        dimension: Dimension,
        value: impl Into<Option<[f64; 3]>>,
    ) {
        self.push(key, dimension, Value::Vector(value.into()));
    }

    fn push(&mut self, key: &'static str, dimension: Dimension, value: Value) {
        self.0.push(Entry { key, dimension, value });
    }

    /// The column of this name.
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.0.iter().find(|entry| entry.key == key)
    }
}

impl Entry {
    /// The values as text, exact; a vector has three.
    pub fn exact(&self) -> Vec<String> {
        let text = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
        match &self.value {
            Value::Count(count) => vec![count.map_or(String::new(), |n| n.to_string())],
            Value::Number(x) => vec![text(*x)],
            Value::Vector(v) => (0..3).map(|k| text(v.map(|v| v[k]))).collect(),
        }
    }

    /// The headings of [`exact`](Self::exact), with units in brackets.
    pub fn headings(&self, length: &str) -> Vec<String> {
        let unit = match self.dimension.unit(length) {
            unit if unit.is_empty() => unit,
            unit => format!(" [{unit}]"),
        };
        match &self.value {
            Value::Vector(_) => ["x", "y", "z"].map(|d| format!("{}_{d}{unit}", self.key)).into(),
            _ => vec![format!("{}{unit}", self.key)],
        }
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Count(count) => count.serialize(serializer),
            Self::Number(x) => x.serialize(serializer),
            Self::Vector(v) => v.serialize(serializer),
        }
    }
}

impl Serialize for Entries {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|entry| (entry.key, &entry.value)))
    }
}

/// The units of all columns that have one, by their keys.
pub struct Units<'a> {
    /// The columns.
    pub entries: &'a Entries,
    /// The unit of length.
    pub length: &'a str,
}

impl Serialize for Units<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let with_unit = self.entries.0.iter().filter(|entry| entry.dimension != Dimension::None);
        serializer
            .collect_map(with_unit.map(|entry| (entry.key, entry.dimension.unit(self.length))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_name_their_units() {
        let mut entries = Entries::default();
        entries.count("voxels", 7);
        entries.number("area", Dimension::Area, 2.5);
        entries.number("volume", Dimension::Volume, f64::NAN);
        entries.vector("centroid", Dimension::Length, [1.0, -2.0, 0.1]);
        let headings: Vec<String> = entries.0.iter().flat_map(|e| e.headings("mm")).collect();
        let expected = [
            "voxels",
            "area [mm²]",
            "volume [mm³]",
            "centroid_x [mm]",
            "centroid_y [mm]",
            "centroid_z [mm]",
        ];
        assert_eq!(headings, expected);
        let cells: Vec<String> = entries.0.iter().flat_map(Entry::exact).collect();
        assert_eq!(cells, ["7", "2.5", "", "1", "-2", "0.1"]);
        let json = serde_json::to_string(&entries).unwrap();
        assert_eq!(json, r#"{"voxels":7,"area":2.5,"volume":null,"centroid":[1.0,-2.0,0.1]}"#);
        let units = serde_json::to_string(&Units { entries: &entries, length: "mm" }).unwrap();
        assert_eq!(units, r#"{"area":"mm²","volume":"mm³","centroid":"mm"}"#);
    }
}
