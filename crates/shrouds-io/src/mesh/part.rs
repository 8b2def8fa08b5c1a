//! What goes into a mesh file: parts with their names, labels and numbers per vertex.

use shrouds::TriMesh;

use crate::mesh::MeshFormat;

/// A number for every vertex of a mesh, or for every line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attribute<'a> {
    /// Its name in the file: letters, digits and underscores, a letter first. Formats give some names
    /// a meaning: `x`, `y`, `z`, `nx`, `ny`, `nz`, `normals`, `label` and `names` are not allowed.
    pub name: &'a str,
    /// One finite number per vertex or line, in their order.
    pub values: &'a [f32],
}

/// One mesh of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part<'a> {
    /// What a viewer is to call it; may be empty.
    pub name: &'a str,
    /// Label of the voxels inside it.
    pub label: Option<i64>,
    /// The mesh, in the same world frame as all parts of the file.
    pub mesh: &'a TriMesh,
    /// Numbers per vertex. All parts have those of the same names, in the same order.
    pub attributes: &'a [Attribute<'a>],
}

impl<'a> From<&'a TriMesh> for Part<'a> {
    /// A mesh without name, label and attributes.
    fn from(mesh: &'a TriMesh) -> Self {
        Self { name: "", label: None, mesh, attributes: &[] }
    }
}

/// The parts of a file, checked.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a>(&'a [Part<'a>]);

impl<'a> Parts<'a> {
    /// Says what keeps the parts from being written with coordinates up to `largest`.
    pub(super) fn check(
        parts: &'a [Part<'a>],
        format: MeshFormat,
        largest: f64,
    ) -> Result<Self, String> {
        if parts.len() != 1 && !format.holds_parts() {
            let count = parts.len();
            return Err(format!(
                "it holds one mesh, not {count}; write each to a file of its own, or all to \
                 .ply, .obj, .glb, .vtp or .3mf"
            ));
        }
        for (n, part) in parts.iter().enumerate() {
            let here = |problem| match parts.len() {
                1 => problem,
                _ => format!("part {n} ({:.40}): {problem}", part.name),
            };
            check_mesh(part.mesh, largest).map_err(here)?;
            check_attributes(part.attributes, part.mesh.vertices.len(), "vertices")
                .map_err(here)?;
            let names = |part: &Part<'a>| part.attributes.iter().map(|a| a.name).collect();
            let [first, own]: [Vec<_>; 2] = [names(&parts[0]), names(part)];
            if own != first {
                let problem = format!("it has the attributes {own:?}, but the first {first:?}");
                return Err(here(format!("{problem}; give all parts the same ones")));
            }
        }
        let parts = Self(parts);
        for (count, what) in
            [(parts.vertex_count(), "vertices"), (parts.triangle_count(), "triangles")]
        {
            if u32::try_from(count).is_err() {
                return Err(format!("it has {count} {what}, more than 32 bits count; crop it"));
            }
        }
        Ok(parts)
    }

    pub(super) fn iter(self) -> impl Iterator<Item = &'a Part<'a>> {
        self.0.iter()
    }

    /// The parts with the numbers of their first vertices, when those of all are counted through.
    pub(super) fn counted(self) -> impl Iterator<Item = (u32, &'a Part<'a>)> {
        self.0.iter().scan(0, |next, part| {
            let first = *next;
            *next += part.mesh.vertices.len() as u32;
            Some((first, part))
        })
    }

    pub(super) fn vertex_count(self) -> usize {
        self.0.iter().map(|part| part.mesh.vertices.len()).sum()
    }

    pub(super) fn triangle_count(self) -> usize {
        self.0.iter().map(|part| part.mesh.triangles.len()).sum()
    }

    /// Whether every vertex of every part has a normal.
    pub(super) fn have_normals(self) -> bool {
        let mut meshes = self.0.iter().map(|part| part.mesh);
        self.0.iter().any(|part| !part.mesh.normals.is_empty())
            && meshes.all(|mesh| mesh.normals.len() == mesh.vertices.len())
    }

    /// Names of the attributes, the same for all parts.
    pub(super) fn attribute_names(self) -> impl Iterator<Item = &'a str> {
        self.0.first().into_iter().flat_map(|part| part.attributes).map(|a| a.name)
    }

    /// What tells the parts apart in one list: their labels, or their numbers from 1 where one has no
    /// label. Nothing for a single part without label.
    pub(super) fn labels(self) -> Option<Vec<i64>> {
        let labels: Option<Vec<i64>> = self.0.iter().map(|part| part.label).collect();
        match self.0.len() {
            0 => None,
            1 => labels,
            count => Some(labels.unwrap_or_else(|| (1..=count as i64).collect())),
        }
    }
}

/// Says what makes a mesh unusable: an index without its vertex, a coordinate beyond `largest`, a
/// normal without its vertex.
pub(super) fn check_mesh(mesh: &TriMesh, largest: f64) -> Result<(), String> {
    let count = mesh.vertices.len();
    let usable = |x: &f64| x.abs() <= largest;
    if let Some(v) = mesh.vertices.iter().position(|v| !v.iter().all(usable)) {
        return Err(format!(
            "vertex {v} lies at {:?}, which is not finite or too large",
            mesh.vertices[v]
        ));
    }
    let missing = |index: &u32| *index as usize >= count;
    if let Some(t) = mesh.triangles.iter().position(|t| t.iter().any(missing)) {
        let corners = mesh.triangles[t];
        return Err(format!(
            "triangle {t} has corners {corners:?}, but there are {count} vertices"
        ));
    }
    if !mesh.normals.is_empty() && mesh.normals.len() != count {
        return Err(format!("it has {} normals for {count} vertices", mesh.normals.len()));
    }
    Ok(())
}

/// Says what is wrong with attributes of so many of these things.
pub(super) fn check_attributes(
    attributes: &[Attribute],
    count: usize,
    things: &str,
) -> Result<(), String> {
    const TAKEN: [&str; 9] = ["x", "y", "z", "nx", "ny", "nz", "normals", "label", "names"];
    for (n, Attribute { name, values }) in attributes.iter().enumerate() {
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) || !name.chars().all(word) {
            return Err(format!(
                "'{name:.40}' names no attribute; use letters, digits and underscores"
            ));
        }
        let same = |other: &str| other.eq_ignore_ascii_case(name);
        if TAKEN.into_iter().any(same) || attributes[..n].iter().any(|a| same(a.name)) {
            return Err(format!("the attribute name '{name}' is taken; choose another"));
        }
        if values.len() != count {
            let found = values.len();
            return Err(format!("the attribute {name} has {found} values for {count} {things}"));
        }
        if let Some(at) = values.iter().position(|x| !x.is_finite()) {
            return Err(format!("value {at} of the attribute {name} is {}", values[at]));
        }
    }
    Ok(())
}
