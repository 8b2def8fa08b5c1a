//! Two labels are the binary case.

use shrouds::materials::{Interfaces, Labels, MaterialMesh, Settings, shrouds};
use shrouds::network::Network;
use shrouds::optimize::{Preset, Start};
use shrouds::surface::Surface;
use shrouds::volume::{Border, phantom};
use shrouds::{Grid, Occupancy, shroud};

fn values(volume: &Occupancy, label: u8) -> Vec<u8> {
    let [nx, ny, nz] = volume.grid().dims();
    let points = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
    points.map(|point| label * u8::from(volume.get(point))).collect()
}

#[test]
fn a_volume_of_one_label_has_the_mesh_of_the_binary_flow_bit_by_bit() {
    let volume = phantom::linked_tori(24).unwrap();
    for preset in [Preset::Fast, Preset::Default, Preset::Exact] {
        for start in [Start::Blur, Start::Random(3)] {
            let settings = Settings { preset, start: start.clone(), ..Settings::default() };
            let labels = Labels::new(volume.grid(), &values(&volume, 7)).unwrap();
            let found = shrouds(labels, &settings).unwrap();
            let mut binary = shrouds::Settings::default();
            binary.optimize.preset = preset;
            binary.optimize.start = start.clone();
            let expected = shroud(&volume, &binary).unwrap().mesh;
            assert_eq!(found.mesh.surface, expected, "{preset:?} {start:?}");
            assert_eq!(found.mesh.closed_mesh(7), expected);
            assert!(found.mesh.pairs.iter().all(|pair| *pair == [7, 0]));
            assert!(found.mesh.lines.is_empty());
        }
    }
}

/// The rules for several labels, not the binary flow: crossings, their numbers, and triangles.
#[test]
fn the_interfaces_of_one_label_are_its_binary_surface() {
    for volume in [
        phantom::linked_tori(24).unwrap(),
        phantom::noise(&Grid::new([14; 3], [1.0; 3]).unwrap(), 0.4, 5).unwrap(),
    ] {
        for rule in [shrouds::volume::FaceRule::Separate, shrouds::volume::FaceRule::Join] {
            let surface = Surface::extract(&volume, rule, Border::Closed).unwrap();
            let labels = Labels::new(volume.grid(), &values(&volume, 9)).unwrap();
            let interfaces = Interfaces::extract(labels, rule).unwrap();
            assert_eq!(interfaces.crossings(), surface.crossings().collect::<Vec<_>>());
            assert!(interfaces.junctions().is_empty());
            let half = vec![0.5; surface.vertex_count()];
            let slopes = vec![[0.0; 2]; surface.vertex_count()];
            let mesh = MaterialMesh::span(&interfaces, &half, &slopes);
            let network = Network::trace(&surface);
            let kind = shrouds::mesh::MeshKind::Primal;
            let fixed = shrouds::mesh::Triangles::Fixed;
            let expected = shrouds::TriMesh::place(&surface, &network, &half, kind, fixed);
            assert_eq!(mesh.surface.vertices, expected.vertices);
            assert_eq!(mesh.surface.triangles.len(), expected.triangles.len());
            assert!((mesh.surface.volume() / expected.volume() - 1.0).abs() < 0.05);
        }
    }
}
