//! One body measured.

use shrouds::measure::{
    Curvature, curvature_areas, curvatures, flat_threshold, integrals, mesh_curvatures,
    smooth_integrals, uncertainty,
};
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::network::Network;
use shrouds::optimize::{self, Preset};
use shrouds::surface::Surface;
use shrouds::{Occupancy, Settings, TriMesh, shroud};

use crate::bodies::Body;

pub(crate) const HEAD: &str = "body,spacing,voxel,ratio,radius,preset,mesh,vertices,true_area,true_volume,\
    area,volume,smooth_area,smooth_volume,voxel_volume,volume_error,volume_low,volume_high,\
    area_error,area_low,area_high,true_positive,true_negative,positive,negative,near_zero,\
    convex,concave,curvature_median,curvature_95,mesh_curvature_median,mesh_curvature_95";

/// A body and its volume, with the names they have in the table.
pub(crate) struct Case<'a> {
    pub(crate) name: &'a str,
    pub(crate) radius: f64,
    pub(crate) body: &'a Body,
    pub(crate) volume: &'a Occupancy,
}

/// Prints a line of CSV under [`HEAD`] for each mesh; what is not known is empty.
#[allow(clippy::unwrap_used)] // The program cannot go on.
pub(crate) fn print(case: &Case<'_>, preset: Preset, meshes: &[MeshKind]) {
    let optimize = optimize::Settings { preset, ..Default::default() };
    let made = shroud(case.volume, &Settings { optimize, ..Default::default() }).unwrap();
    let network = Network::trace(&made.surface);
    for &kind in meshes {
        let mesh = match kind {
            MeshKind::Primal => made.mesh.clone(),
            MeshKind::Dual => {
                TriMesh::place(&made.surface, &network, &made.delta, kind, Triangles::Fitted)
            }
        };
        let known = (kind == MeshKind::Primal).then_some(&network);
        println!("{}", line(case, preset, kind, &made.surface, &mesh, known));
    }
}

#[allow(clippy::unwrap_used)]
fn line(
    case: &Case<'_>,
    preset: Preset,
    kind: MeshKind,
    surface: &Surface,
    mesh: &TriMesh,
    network: Option<&Network>,
) -> String {
    let Case { name, radius, body, volume } = case;
    let (grid, truth) = (volume.grid(), body.shape.truth());
    let spacing = grid.spacing();
    let [plain, smooth] = [integrals(mesh), smooth_integrals(mesh)].map(Result::unwrap);
    let known = uncertainty(surface, &smooth);
    let of_mesh = mesh_curvatures(mesh).unwrap();
    let of_network = network.map(|network| curvatures(network, &mesh.vertices, &mesh.normals));
    let best = of_network.as_ref().unwrap_or(&of_mesh);
    let areas = curvature_areas(mesh, best, flat_threshold(spacing)).unwrap();
    let errors = |found: &[Curvature]| curvature_errors(body, &mesh.vertices, found);
    let ratio = spacing.into_iter().fold(0.0, f64::max) / grid.min_spacing();
    let mut line = format!(
        "{name},{},{:.6},{ratio:.6},{radius},{preset:?},{kind:?},{}",
        spacing[2],
        grid.voxel_volume().cbrt(),
        mesh.vertices.len()
    );
    let mut add = |value: Option<f64>| {
        line += &value.map_or(",".into(), |value| format!(",{value:.9}"));
    };
    for value in [
        truth.area,
        truth.volume,
        plain.area,
        plain.volume,
        smooth.area,
        smooth.volume,
        volume.count() as f64 * grid.voxel_volume(),
    ] {
        add(Some(value));
    }
    for span in [known.volume, known.area] {
        [span.error, span.low, span.high].into_iter().for_each(|value| add(Some(value)));
    }
    [0, 1].into_iter().for_each(|n| add(truth.signs.map(|signs| signs[n])));
    let (gaussian, mean) = (areas.gaussian, areas.mean);
    for value in
        [gaussian.positive, gaussian.negative, gaussian.near_zero, mean.positive, mean.negative]
    {
        add(Some(value));
    }
    let of_network = of_network.and_then(|found| errors(&found));
    for found in [of_network, errors(&of_mesh)] {
        [0, 1].into_iter().for_each(|n| add(found.map(|errors| errors[n])));
    }
    line
}

/// Median and 95th percentile of the errors of the principal curvatures, over the larger one.
fn curvature_errors(body: &Body, vertices: &[[f64; 3]], found: &[Curvature]) -> Option<[f64; 2]> {
    let mut errors = Vec::new();
    for (curvature, &vertex) in found.iter().zip(vertices) {
        let truth = body.shape.principal(body.own(vertex))?;
        for (found, truth_one) in curvature.principal.into_iter().zip(truth) {
            errors.push((found - truth_one).abs() / truth[0]);
        }
    }
    errors.sort_by(f64::total_cmp);
    let at = |share: f64| errors[(share * (errors.len() - 1) as f64) as usize];
    (!errors.is_empty()).then(|| [at(0.5), at(0.95)])
}
