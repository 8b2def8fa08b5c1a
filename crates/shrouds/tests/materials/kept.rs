//! Labels whose volumes are kept.

use shrouds::check::{CheckSettings, check};
use shrouds::materials::{LabelVolume, Labels, Settings, Shrouds, shrouds};
use shrouds::optimize::{Preset, VolumeRule};
use shrouds::{Grid, TriMesh};

/// Labels of the nearest of some places within a ball, with a label of one voxel beside it.
fn cells(affine: [[f64; 4]; 3], seeds: &[[f64; 3]]) -> Labels {
    let dims = [24, 22, 20];
    let grid = Grid::with_affine(dims, affine).unwrap();
    let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let label = |n: usize| {
        let place = [n % dims[0], n / dims[0] % dims[1], n / dims[0] / dims[1]];
        let place = place.map(|index| index as f64);
        match place {
            [2.0, 2.0, 2.0] => 99,
            _ if square(place, [12.1, 11.3, 9.8]) > 75.0 => 0,
            _ => {
                let distances = seeds.iter().map(|&seed| square(place, seed));
                let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
                nearest.map_or(0, |(n, _)| 1 + n as u8)
            }
        }
    };
    let values: Vec<u8> = (0..dims.iter().product()).map(label).collect();
    Labels::new(&grid, &values).unwrap()
}

const SEEDS: [[f64; 3]; 5] =
    [[8.0, 9.0, 7.0], [15.0, 8.0, 9.0], [11.0, 15.0, 8.0], [12.0, 11.0, 14.0], [7.0, 14.0, 12.0]];

fn kept(labels: &Labels, preset: Preset, margin: f64) -> Shrouds {
    let volume = VolumeRule::Keep;
    shrouds(labels.clone(), &Settings { preset, margin, volume, ..Settings::default() }).unwrap()
}

/// What each label should enclose and does, by the mesh alone.
fn volumes(labels: &Labels, made: &Shrouds) -> Vec<(i64, f64, f64)> {
    let (voxel, counts) = (labels.grid().voxel_volume(), labels.counts());
    let own = labels.values().iter().zip(counts).skip(1);
    own.map(|(&label, count)| (label, count as f64 * voxel, made.mesh.closed_mesh(label).volume()))
        .collect()
}

fn is_separated(labels: &Labels, made: &Shrouds) {
    let occupancies = labels.occupancies().unwrap();
    for (&label, occupancy) in labels.values()[1..].iter().zip(&occupancies) {
        let mesh: TriMesh = made.mesh.closed_mesh(label);
        let found = check(&mesh, occupancy, &CheckSettings::default()).unwrap();
        assert_eq!(found.separation.wrong_side.count, 0, "label {label}");
        assert_eq!(found.structure.boundary_edges.count, 0, "label {label}");
        assert_eq!(found.self_intersections.map(|pairs| pairs.count), Some(0), "label {label}");
    }
}

#[test]
fn labels_enclose_their_voxels() {
    let plain = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    // Thick slices, turned, mirrored, far away.
    let other = [[0.0, -0.5, 0.0, 900.0], [0.5, 0.0, 0.0, -400.0], [0.0, 0.0, -1.5, 70.0]];
    for (affine, preset) in
        [(plain, Preset::Fast), (plain, Preset::Exact), (other, Preset::Default)]
    {
        let labels = cells(affine, &SEEDS);
        let made = kept(&labels, preset, 0.002);
        let free = shrouds(labels.clone(), &Settings { preset, ..Settings::default() }).unwrap();
        assert!(free.report.volumes.is_empty());
        assert_eq!(free.mesh.pairs, made.mesh.pairs);
        let off = |made: &Shrouds| {
            let errors = volumes(&labels, made).into_iter().map(|(_, t, v)| (v / t - 1.0).abs());
            errors.fold(0.0, f64::max)
        };
        assert!(off(&free) > 0.01, "nothing to do: {}", off(&free));
        assert!(off(&made) < 1e-9, "{}", off(&made));
        for (told, (label, target, reached)) in
            made.report.volumes.iter().zip(volumes(&labels, &made))
        {
            assert_eq!((told.label, told.is_held), (label, false));
            assert!((told.target - target).abs() < 1e-9 * target);
            assert!((told.reached - reached).abs() < 1e-9 * target);
        }
        is_separated(&labels, &made);
    }
}

#[test]
fn a_label_that_cannot_is_told_and_the_others_reach_theirs() {
    let plain = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let labels = cells(plain, &SEEDS);
    // An octahedron with corners .9 away holds 4/3 · .9³.
    let made = kept(&labels, Preset::Default, 0.1);
    let [others @ .., point] = &made.report.volumes[..] else { panic!("no volumes") };
    assert!(others.iter().all(|found: &LabelVolume| !found.is_held));
    assert!(point.is_held && point.label == 99);
    assert!((point.reached - 4.0 / 3.0 * 0.9f64.powi(3)).abs() < 1e-9, "{}", point.reached);
    is_separated(&labels, &made);
}

#[test]
fn one_label_has_the_volume_of_the_binary_flow() {
    let labels =
        cells([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]], &SEEDS[..0]);
    let made = kept(&labels, Preset::Default, 0.002);
    let [found] = made.report.volumes[..] else { panic!("one label") };
    assert_eq!((found.label, found.is_held, found.target), (99, false, 1.0));
    assert!((made.mesh.surface.volume() - 1.0).abs() < 1e-9);
}
