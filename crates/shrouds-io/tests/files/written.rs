//! Volumes written as NIfTI and VTI come back with their bits, their place and its name.

use shrouds::{Grid, Occupancy, Select};
use shrouds_io::{Error, Frame, VolumeOptions, read_volume, write_labels, write_volume};

use crate::common::{Folder, read_both};

const NAMES: [&str; 3] = ["a.nii", "a.nii.gz", "a.vti"];

fn frame(name: &str, unit: &str) -> Frame {
    Frame { name: name.into(), unit: unit.into(), source: "options" }
}

fn volume(affine: [[f64; 4]; 3]) -> Occupancy {
    let grid = Grid::with_affine([67, 5, 4], affine).unwrap();
    Occupancy::from_fn(grid, |[i, j, k]| (i * 7 + j * 5 + k * 3) % 4 == 0)
}

/// A turn about an oblique axis, columns scaled; mirrored or not.
fn turned(mirror: f64) -> [[f64; 4]; 3] {
    let (a, b, c, d) = (0.1f64, 0.7, -0.5, 0.5);
    let columns = [
        [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
        [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
        [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - b * b - c * c],
    ];
    let scale = [0.5, 1.25, mirror * 3.0];
    std::array::from_fn(|r| {
        let [x, y, z] = std::array::from_fn(|c| columns[c][r] * scale[c]);
        [x, y, z, [-90.5, 126.0, 7.25][r]]
    })
}

fn assert_near(found: [[f64; 4]; 3], expected: [[f64; 4]; 3], tolerance: f64) {
    for (f, e) in found.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((f - e).abs() <= tolerance, "{found:?} {expected:?}");
    }
}

#[test]
fn bits_and_places_come_back() {
    let folder = Folder::new();
    let sheared = [[1.0, 0.3, 0.0, 5.0], [0.0, 2.0, 0.0, 6.0], [0.1, 0.0, 3.0, 7.0]];
    for affine in [turned(1.0), turned(-1.0), sheared] {
        let volume = volume(affine);
        for name in NAMES {
            let written = write_volume(folder.path(name), &volume, &frame("RAS", "mm"));
            if name == "a.vti" && affine == sheared {
                let error = written.unwrap_err();
                assert!(matches!(error, Error::UnwritableVolume { .. }));
                assert!(error.to_string().contains("right angles"), "{error}");
                continue;
            }
            let back = read_both(&folder.path(name), &VolumeOptions::default()).unwrap();
            assert_near(back.grid.affine(), affine, if name == "a.vti" { 1e-13 } else { 1e-5 });
            let bits = back.occupancy(&Select::NonZero).unwrap();
            for (j, k) in (0..4).flat_map(|k| (0..5).map(move |j| (j, k))) {
                assert_eq!(bits.row(j, k), volume.row(j, k));
            }
            let doubts: Vec<_> =
                back.contents.warnings.iter().filter(|text| !text.contains("angles")).collect();
            assert!(doubts.is_empty(), "sform, qform and pixdim agree: {doubts:?}");
        }
    }
}

#[test]
fn the_qform_alone_is_the_same_place() {
    let folder = Folder::new();
    for half_turn in 0..4 {
        for mirror in [1.0, -1.0] {
            // Half turns about every axis: each part of the quaternion is the largest once.
            let sign = |axis| if half_turn == 0 || half_turn == axis + 1 { 1.0 } else { -1.0 };
            let affine = [
                [2.0 * sign(0), 0.0, 0.0, 1.0],
                [0.0, 3.0 * sign(1), 0.0, 2.0],
                [0.0, 0.0, mirror * 5.0 * sign(2), 3.0],
            ];
            for affine in [affine, turned(mirror)] {
                write_volume(folder.path("a.nii"), &volume(affine), &frame("RAS", "um")).unwrap();
                let mut bytes = std::fs::read(folder.path("a.nii")).unwrap();
                bytes[254..256].fill(0);
                let back = folder.volume("a.nii", &bytes).unwrap();
                assert_eq!(back.frame.source, "qform");
                assert_near(back.grid.affine(), affine, 1e-5);
            }
        }
    }
}

#[test]
fn worlds_and_units_are_turned_into_those_of_nifti() {
    let folder = Folder::new();
    let affine = turned(1.0);
    let write = |affine, name: &str, unit: &str| {
        write_volume(folder.path("a.nii"), &volume(affine), &frame(name, unit)).unwrap();
        let back = read_both(&folder.path("a.nii"), &VolumeOptions::default()).unwrap();
        let header = std::fs::read(folder.path("a.nii")).unwrap();
        (back.grid.affine(), back.frame, [header[252], header[254]])
    };
    let signed = |signs: [f64; 3], factor: f64| {
        std::array::from_fn(|r| affine[r].map(|x| x * signs[r] * factor))
    };
    let cases = [
        ("RAS", "mm", [1.0; 3], 1.0, "mm", [1, 1]),
        ("LPS", "m", [-1.0, -1.0, 1.0], 1.0, "m", [1, 1]),
        ("LAS", "nm", [-1.0, 1.0, 1.0], 1e-3, "um", [1, 1]),
        ("unnamed", "cm", [1.0; 3], 10.0, "mm", [2, 2]),
        ("index", "unknown", [1.0; 3], 1.0, "unknown", [2, 2]),
    ];
    for (name, unit, signs, factor, stored, codes) in cases {
        let (found, back, found_codes) = write(affine, name, unit);
        assert_near(found, signed(signs, factor), 1e-4);
        assert_eq!((back.name.as_str(), back.unit.as_str(), found_codes), ("RAS", stored, codes));
    }
    let plain = [[0.5, 0.0, 0.0, 0.0], [0.0, 1.5, 0.0, 0.0], [0.0, 0.0, 2.5, 0.0]];
    let (found, back, codes) = write(plain, "index", "mm");
    assert_eq!((found, back.name.as_str(), codes), (plain, "index", [0, 0]));
}

#[test]
fn blocks_of_vti_end_where_the_volume_does() {
    let folder = Folder::new();
    // One block exactly, and one with a rest.
    for dims in [[1 << 10, 1 << 10, 1], [1 << 10, 1 << 10, 2], [1000, 700, 2], [1, 1, 1]] {
        let grid = Grid::new(dims, [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid, |[i, j, k]| (i ^ j ^ k) % 3 == 0);
        write_volume(folder.path("a.vti"), &volume, &frame("index", "mm")).unwrap();
        let back = read_both(&folder.path("a.vti"), &VolumeOptions::default()).unwrap();
        assert_eq!(back.occupancy(&Select::NonZero).unwrap(), volume);
    }
}

#[test]
fn axes_too_long_for_nifti_are_refused() {
    let folder = Folder::new();
    let volume = Occupancy::empty(Grid::new([40_000, 1, 1], [1.0; 3]).unwrap());
    let error = write_volume(folder.path("a.nii"), &volume, &frame("RAS", "mm")).unwrap_err();
    assert!(error.to_string().contains("32767 points along an axis, not 40000"), "{error}");
    assert!(folder.names().is_empty());
}

#[test]
fn labels_come_back_in_the_smallest_type() {
    let folder = Folder::new();
    let grid = Grid::with_affine([3, 2, 2], turned(-1.0)).unwrap();
    let cases: [(&[i64], &str); 5] = [
        (&[0, 255], "u8"),
        (&[0, 256, 65_535], "u16"),
        (&[0, 65_536], "i32"),
        (&[-1, 3], "i32"),
        (&[i64::MIN, 0, i64::MAX], "i64"),
    ];
    for (labels, element) in cases {
        let labels: Vec<i64> = labels.iter().copied().cycle().take(12).collect();
        for name in ["a.nii", "a.nii.gz", "a.nrrd", "a.npy"] {
            let path = folder.path(name);
            write_labels(&path, &grid, labels.iter().copied(), &frame("RAS", "mm")).unwrap();
            let read = read_volume(&path, &VolumeOptions::default()).unwrap();
            assert_eq!(
                (read.values.whole(), read.values.type_name()),
                (Some(labels.clone()), element)
            );
            if name != "a.npy" {
                assert_near(read.grid.affine(), grid.affine(), 1e-4);
            }
        }
    }
    let refused =
        write_labels(folder.path("a.vti"), &grid, [0; 12].into_iter(), &frame("RAS", "mm"));
    assert!(matches!(refused, Err(Error::Extension { .. })));
}
