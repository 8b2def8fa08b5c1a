//! Whether a mesh carries the 4\*-network of its volume, from its vertices and edges alone.
//!
//! The vertices of a primal mesh lie on the grid edges that change sides, one on each. An edge of the mesh
//! whose ends lie in one lattice plane is part of the planar curve there, because no diagonal of a patch
//! lies on the face of a cell. By the paper's Theorem 1 every vertex has two neighbours on each of its two
//! planar curves, four in all; one fewer on a curve that ends at an open border.

use crate::check::crossing::in_index_coordinates;
use crate::check::found::Found;
use crate::check::structure::refuse_damage;
use crate::check::voxel_rows::Rows;
use crate::check::voxel_topology::low_bits;
use crate::error::Error;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::volume::{Border, Occupancy};

/// A vertex this near to a grid edge, in units of the index, lies on it: half of what vertices keep away
/// from lattice points.
const ON_EDGE: f64 = 1e-3;

/// The 4\*-network that a mesh carries.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FourNetwork {
    /// Its vertices, each the only one on a grid edge between an inside and an outside point.
    pub vertices: u64,
    /// Vertices that do not have two neighbours on both of their planar curves.
    pub wrong_valence: Found<u32>,
}

/// A vertex on its grid edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct OnEdge {
    axis: usize,
    /// The low end of the grid edge.
    low: [i64; 3],
}

/// Looks for the 4\*-network of the volume in a mesh; there is none unless the vertices of the mesh lie on
/// the grid edges that change sides, one on each.
///
/// ```
/// use shrouds::{Settings, check::four_network, mesh::MeshKind, shroud, volume::{Border, phantom}};
///
/// let volume = phantom::sphere(16)?;
/// let mut settings = Settings::default();
/// let primal = shroud(&volume, &settings)?.mesh;
/// let network = four_network(&primal, &volume, Border::Closed)?.expect("a primal mesh");
/// assert!(network.wrong_valence.is_empty());
/// settings.mesh = MeshKind::Dual;
/// let dual = shroud(&volume, &settings)?.mesh;
/// assert_eq!(four_network(&dual, &volume, Border::Closed)?, None);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] as for [`check`](crate::check::check).
pub fn four_network(
    mesh: &TriMesh,
    volume: &Occupancy,
    border: Border,
) -> Result<Option<FourNetwork>, Error> {
    refuse_damage(mesh)?;
    let mesh = in_index_coordinates(mesh, volume.grid(), border)?;
    let Some(places) = places(&mesh, volume, border) else { return Ok(None) };
    if places.len() as u64 != crossings(volume, border) {
        return Ok(None);
    }
    let found = neighbours(&mesh, &places);
    let dims = volume.grid().dims();
    let mut wrong_valence = Found::default();
    for (v, (place, found)) in places.iter().zip(&found).enumerate() {
        if *found != place.valence(dims, border) {
            wrong_valence.push(v as u32);
        }
    }
    Ok(Some(FourNetwork { vertices: places.len() as u64, wrong_valence }))
}

impl OnEdge {
    fn new(vertex: [f64; 3]) -> Option<Self> {
        let away = vertex.map(|x| (x - x.round()).abs());
        let farther = |a: usize, b: usize| if away[b] > away[a] { b } else { a };
        let axis = farther(farther(0, 1), 2);
        if (0..3).any(|d| d != axis && away[d] > ON_EDGE) {
            return None;
        }
        let mut low = vertex.map(|x| x.round() as i64);
        low[axis] = vertex[axis].floor() as i64;
        Some(Self { axis, low })
    }

    /// Whether one end of its grid edge is inside and the other is not.
    fn changes_sides(self, volume: &Occupancy, border: Border) -> bool {
        let dims = volume.grid().dims();
        let is_in = |index: [i64; 3]| {
            let known = (0..3).all(|d| (0..dims[d] as i64).contains(&index[d]));
            known.then(|| volume.get(index.map(|x| x as usize)))
        };
        let mut high = self.low;
        high[self.axis] += 1;
        let sides = [self.low, high].map(is_in);
        match border {
            Border::Open => sides.iter().all(Option::is_some) && sides[0] != sides[1],
            Border::Closed => sides[0].unwrap_or(false) != sides[1].unwrap_or(false),
        }
    }

    /// How many neighbours it has in lattice planes across each axis.
    fn valence(self, dims: [usize; 3], border: Border) -> [u8; 3] {
        std::array::from_fn(|plane| {
            if plane == self.axis {
                return 0;
            }
            let across = 3 - plane - self.axis;
            let last = dims[across] as i64 - 1;
            let ends = border == Border::Open && [0, last].contains(&self.low[across]);
            if ends { 1 } else { 2 }
        })
    }
}

/// The vertices on their grid edges, if each has one of its own that changes sides.
fn places(mesh: &TriMesh, volume: &Occupancy, border: Border) -> Option<Vec<OnEdge>> {
    let place = |vertex: &[f64; 3]| {
        OnEdge::new(*vertex).filter(|place| place.changes_sides(volume, border))
    };
    let places: Vec<OnEdge> = mesh.vertices.iter().map(place).collect::<Option<_>>()?;
    let mut keys: Vec<(usize, [i64; 3])> = places.iter().map(|p| (p.axis, p.low)).collect();
    keys.sort_unstable();
    keys.windows(2).all(|pair| pair[0] != pair[1]).then_some(places)
}

/// How many edges of the mesh leave each vertex in lattice planes across each axis.
fn neighbours(mesh: &TriMesh, places: &[OnEdge]) -> Vec<[u8; 3]> {
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[u, v]| [u.min(v), u.max(v)]);
    let mut edges: Vec<[u32; 2]> = mesh.triangles.iter().flat_map(sides).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut counts = vec![[0u8; 3]; places.len()];
    for [u, v] in edges.into_iter().map(|edge| edge.map(|v| v as usize)) {
        let (a, b) = (places[u], places[v]);
        for plane in (0..3).filter(|&plane| plane != a.axis && plane != b.axis) {
            if a.low[plane] == b.low[plane] {
                counts[u][plane] = counts[u][plane].saturating_add(1);
                counts[v][plane] = counts[v][plane].saturating_add(1);
            }
        }
    }
    counts
}

/// The number of grid edges that change sides; with a closed border all is outside around the volume.
fn crossings(volume: &Occupancy, border: Border) -> u64 {
    let rows = Rows::new(volume, border);
    let [nx, ny, nz] = rows.dims();
    let slices = parallel::blocks(nz, 1, |slices| {
        let [mut here, mut next] = [rows.buffer(), rows.buffer()];
        let mut count = 0;
        for (j, k) in slices.flat_map(|k| (0..ny).map(move |j| (j, k))) {
            rows.read(j, k, &mut here);
            let along = |w: usize| here[w] ^ (here[w] >> 1 | here[w + 1] << 63);
            let words = nx.div_ceil(64);
            let ends = |w: usize| low_bits((nx - 1).saturating_sub(64 * w));
            count += (0..words).map(|w| (along(w) & ends(w)).count_ones()).sum::<u32>() as u64;
            for (j, k) in [(j + 1, k), (j, k + 1)].into_iter().filter(|&(j, k)| j < ny && k < nz) {
                rows.read(j, k, &mut next);
                let changed = here.iter().zip(&next).map(|(a, b)| (a ^ b).count_ones());
                count += changed.sum::<u32>() as u64;
            }
        }
        count
    });
    slices.into_iter().sum()
}
