//! The certificate.

use crate::check::CheckSettings;
use crate::check::found::Found;
use crate::check::separation::{Separation, WrongPoint};
use crate::check::structure::Structure;
use crate::check::voxel_topology::VoxelTopology;
use crate::volume::Border;

/// What the check found, in the order it is read: the mesh by itself, against its volume, and
/// against the topology that the volume asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckReport {
    /// What was expected of the mesh.
    pub settings: CheckSettings,
    /// The mesh by itself.
    pub structure: Structure,
    /// Boundary edges where none may be: with a closed border all, with an open one those that do
    /// not lie in an outermost lattice plane.
    pub stray_boundary_edges: Found<[u32; 2]>,
    /// Pairs of triangles, the smaller index first, that meet elsewhere than in vertices they share;
    /// `None` when not looked for. Degenerate triangles take no part.
    pub self_intersections: Option<Found<[u32; 2]>>,
    /// On which side of the mesh the lattice points lie.
    pub separation: Separation,
    /// The topology that the bits of the volume ask for.
    pub expected: VoxelTopology,
}

impl CheckReport {
    /// Whether everything expected of the mesh holds: there are no [`CheckReport::problems`].
    pub fn is_clean(&self) -> bool {
        self.problems().is_empty()
    }

    /// What keeps the mesh from its certificate, a sentence each: what, how many, where first.
    pub fn problems(&self) -> Vec<String> {
        let mut problems = self.structure_problems();
        problems.extend(self.separation_problems());
        problems.extend(self.topology_problems());
        problems
    }

    /// What is worth knowing but harms nothing.
    pub fn notes(&self) -> Vec<String> {
        let structure = &self.structure;
        let mut notes = Vec::new();
        note(&mut notes, &self.separation.touching, "lattice points on the surface", |p| {
            format!("{p:?}")
        });
        note(
            &mut notes,
            &structure.sliver_triangles,
            "triangles below 1e-9 of the mean area",
            u32::to_string,
        );
        if structure.unused_vertices > 0 {
            notes.push(format!("{} vertices without a triangle", structure.unused_vertices));
        }
        notes
    }

    fn structure_problems(&self) -> Vec<String> {
        let structure = &self.structure;
        let mut problems = Vec::new();
        let edge = |[a, b]: &[u32; 2]| format!("between vertices {a} and {b}");
        let vertex = |v: &u32| format!("vertex {v}");
        let triangle = |t: &u32| format!("triangle {t}");
        let boundary = match self.settings.border {
            Border::Closed => "edges with one triangle",
            Border::Open => "edges with one triangle away from the border of the volume",
        };
        note(&mut problems, &self.stray_boundary_edges, boundary, edge);
        let more = "edges with more than two triangles";
        note(&mut problems, &structure.non_manifold_edges, more, edge);
        let same = "edges whose triangles face opposite sides";
        note(&mut problems, &structure.inconsistent_edges, same, edge);
        let fans = "vertices with more than one fan of triangles";
        note(&mut problems, &structure.non_manifold_vertices, fans, vertex);
        let flat = "triangles without area";
        note(&mut problems, &structure.degenerate_triangles, flat, triangle);
        if let Some(pairs) = &self.self_intersections {
            note(&mut problems, pairs, "pairs of triangles that intersect", |[a, b]| {
                format!("triangles {a} and {b}")
            });
        }
        problems
    }

    fn separation_problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        if self.separation.inverted {
            problems.push("the mesh is inside out: its triangles face the inside points".into());
        }
        let point = |WrongPoint { index, inside, winding, .. }: &WrongPoint| {
            let side = if *inside { "inside" } else { "outside" };
            format!("{index:?}, {side}, with winding number {winding}")
        };
        let Separation { wrong_side, odd_winding, .. } = &self.separation;
        note(&mut problems, wrong_side, "lattice points on the wrong side", point);
        let odd = "lattice points with a winding number other than 0 and 1";
        note(&mut problems, odd_winding, odd, point);
        problems
    }

    fn topology_problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        let (found, wanted) = (self.structure.euler(), self.expected.euler);
        if found != wanted {
            problems.push(format!("the Euler characteristic is {found}, the volume's {wanted}"));
        }
        let found = self.structure.components.len() as u64;
        if let Some(wanted) = self.expected.surface_components.filter(|&wanted| wanted != found) {
            problems.push(format!("there are {found} components, the volume's are {wanted}"));
        }
        problems
    }
}

fn note<T>(list: &mut Vec<String>, found: &Found<T>, what: &str, show: impl Fn(&T) -> String) {
    if let Some(first) = found.first.first() {
        list.push(format!("{} {what}; first: {}", found.count, show(first)));
    }
}
