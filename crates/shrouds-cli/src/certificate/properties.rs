//! What a mesh is, property by property, with the evidence: how many were tested, how many are wrong,
//! where the first wrong ones are.

use serde::Serialize;
use shrouds::check::{CheckReport, Found, NearestPoint, WrongPoint, four_network, nearest_point};
use shrouds::{Grid, TriMesh};

use super::Examined;
use crate::failure::Failure;
use crate::progress::Progress;

/// All properties. The certificate holds when those before `network` do: that one is for primal meshes.
#[derive(Serialize)]
pub(super) struct Properties {
    /// Edges of one triangle; at an open border only those elsewhere.
    closed: Property,
    /// Edges of more than two triangles.
    manifold_edges: Property,
    /// Vertices with more than one fan of triangles.
    manifold_vertices: Property,
    /// Edges whose triangles face opposite sides.
    oriented: Property,
    /// Triangles without area.
    proper_triangles: Property,
    /// Pairs of triangles that intersect.
    no_self_intersection: Property,
    /// Normals point out.
    outward: Outward,
    /// Lattice points on the wrong side.
    separation: Separation,
    /// Lattice points with a winding number other than 0 and 1.
    winding: Property,
    components: Components,
    euler: Euler,
    /// The 4*-network, where the vertices lie on the grid edges that change sides, one on each:
    /// whether every one has two neighbours on both of its planar curves.
    network: Option<Property>,
}

#[derive(Serialize)]
struct Property {
    holds: bool,
    tested: u64,
    wrong: u64,
    first: Vec<Place>,
}

/// Where something is wrong.
#[derive(Serialize)]
struct Place {
    /// The vertices of an edge, a vertex, a triangle, two triangles, or the index of a lattice point.
    of: Vec<usize>,
    /// Its middle, in the coordinates of the mesh.
    at: [f64; 3],
    /// Of a lattice point.
    #[serde(skip_serializing_if = "Option::is_none")]
    inside: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    winding: Option<i64>,
}

#[derive(Serialize)]
struct Outward {
    holds: bool,
}

#[derive(Serialize)]
struct Separation {
    #[serde(flatten)]
    property: Property,
    /// Lattice points on the surface, which lie on neither side.
    touching: u64,
    /// How many axes the lines of the lattice were followed along.
    axes: usize,
    /// The lattice point nearest to the surface; null if none is within half a grid edge.
    nearest: Option<Nearest>,
}

#[derive(Serialize)]
struct Nearest {
    /// In grid edges.
    distance: f64,
    index: [usize; 3],
}

#[derive(Serialize)]
struct Components {
    holds: bool,
    found: u64,
    /// What the voxels ask for; null at an open border, where any number may be right.
    expected: Option<u64>,
}

#[derive(Serialize)]
struct Euler {
    holds: bool,
    found: i64,
    /// What the voxels ask for.
    expected: i64,
    of_components: Vec<i64>,
}

impl Properties {
    pub(super) fn new(examined: &Examined, progress: &Progress) -> Result<Self, Failure> {
        progress.stage("measuring the margin");
        let Examined { mesh, volume, report, .. } = examined;
        let border = report.settings.border;
        let nearest = nearest_point(mesh, volume.grid(), border)?;
        progress.stage("looking for the network");
        let network = four_network(mesh, volume, border)?;
        let structure = &report.structure;
        let points = volume.grid().point_count() as u64;
        let point = |point: &WrongPoint| Place::of_point(point, volume.grid());
        let edges = |found: &Found<[u32; 2]>| {
            Property::new(structure.edges, found, |edge| Place::of_vertices(mesh, edge))
        };
        let vertex = |v: &u32| Place::of_vertices(mesh, &[*v]);
        let none = Found::default();
        let intersections = report.self_intersections.as_ref().unwrap_or(&none);
        Ok(Self {
            closed: edges(&report.stray_boundary_edges),
            manifold_edges: edges(&structure.non_manifold_edges),
            manifold_vertices: Property::new(
                structure.vertices,
                &structure.non_manifold_vertices,
                vertex,
            ),
            oriented: edges(&structure.inconsistent_edges),
            proper_triangles: Property::new(
                structure.triangles,
                &structure.degenerate_triangles,
                |t| Place::of_triangles(mesh, &[*t]),
            ),
            no_self_intersection: Property::new(structure.triangles, intersections, |pair| {
                Place::of_triangles(mesh, pair)
            }),
            outward: Outward { holds: !report.separation.inverted },
            separation: Separation {
                property: Property::new(points, &report.separation.wrong_side, point),
                touching: report.separation.touching.count,
                axes: report.separation.axes,
                nearest: nearest
                    .map(|NearestPoint { distance, index }| Nearest { distance, index }),
            },
            winding: Property::new(points, &report.separation.odd_winding, point),
            components: Components::new(report),
            euler: Euler::new(report),
            network: network
                .map(|network| Property::new(network.vertices, &network.wrong_valence, vertex)),
        })
    }
}

impl Property {
    fn new<T>(tested: u64, found: &Found<T>, place: impl Fn(&T) -> Place) -> Self {
        let first = found.first.iter().map(place).collect();
        Self { holds: found.is_empty(), tested, wrong: found.count, first }
    }
}

impl Place {
    fn of_vertices(mesh: &TriMesh, vertices: &[u32]) -> Self {
        let of = vertices.iter().map(|v| *v as usize).collect();
        Self { of, at: middle(mesh, vertices), inside: None, winding: None }
    }

    fn of_triangles(mesh: &TriMesh, triangles: &[u32]) -> Self {
        let corners: Vec<u32> =
            triangles.iter().flat_map(|&t| mesh.triangles[t as usize]).collect();
        let of = triangles.iter().map(|t| *t as usize).collect();
        Self { of, at: middle(mesh, &corners), inside: None, winding: None }
    }

    fn of_point(point: &WrongPoint, grid: &Grid) -> Self {
        Self {
            of: point.index.into(),
            at: grid.point(point.index.map(|x| x as f64)),
            inside: Some(point.inside),
            winding: Some(point.winding),
        }
    }
}

fn middle(mesh: &TriMesh, vertices: &[u32]) -> [f64; 3] {
    let share = (vertices.len() as f64).recip();
    vertices.iter().fold([0.0; 3], |sum, v| {
        let p = mesh.vertices[*v as usize];
        std::array::from_fn(|d| sum[d] + share * p[d])
    })
}

impl Components {
    fn new(report: &CheckReport) -> Self {
        let found = report.structure.components.len() as u64;
        let expected = report.expected.surface_components;
        Self { holds: expected.is_none_or(|expected| expected == found), found, expected }
    }
}

impl Euler {
    fn new(report: &CheckReport) -> Self {
        let (found, expected) = (report.structure.euler(), report.expected.euler);
        let components = &report.structure.components;
        let of_components = components.iter().map(|component| component.euler).collect();
        Self { holds: found == expected, found, expected, of_components }
    }
}
