//! Series of NIfTI, pairs of files, and NumPy archives.

use shrouds::Select;
use shrouds_io::{Error, Values, VolumeOptions, read_contents, read_occupancy, read_volume};

use crate::common::{Folder, Nifti, bytes, cases, gzip, npy, npz, read_both};

fn frame(layer: usize) -> VolumeOptions<'static> {
    VolumeOptions { layer: Some(layer), ..VolumeOptions::default() }
}

fn array(name: &str) -> VolumeOptions<'_> {
    VolumeOptions { array: Some(name), ..VolumeOptions::default() }
}

#[test]
fn every_frame_of_a_nifti_series_is_reached() {
    let folder = Folder::new();
    for dims in [&[2, 3, 1, 5][..], &[2, 3, 1, 1, 5]] {
        let data: Vec<i16> = (0..30).collect();
        let mut file = Nifti::new(dims, 4, false);
        file.put(108, 368f32);
        let file = file.with(&[vec![0; 16], bytes(&data, false)].concat());
        for (name, file) in [("a.nii", file.clone()), ("a.nii.gz", gzip(&file))] {
            let path = folder.file(name, &file);
            for n in 0..5 {
                let volume = read_both(&path, &frame(n)).unwrap();
                assert_eq!(volume.values, Values::I16(data[6 * n..6 * n + 6].into()));
                assert_eq!((volume.grid.dims(), volume.contents.layers), ([2, 3, 1], 5));
            }
            for options in [frame(5), VolumeOptions::default()] {
                let error = read_both(&path, &options).unwrap_err();
                assert!(matches!(error, Error::Choice { .. }));
                assert!(error.to_string().contains("frames 0 to 4"), "{error}");
            }
            assert_eq!(read_contents(&path, &VolumeOptions::default()).unwrap().2.layers, 5);
        }
    }
}

#[test]
fn a_cut_series_lacks_only_its_last_frames() {
    let folder = Folder::new();
    let file = Nifti::new(&[2, 3, 1, 5], 2, false).with(&[7; 20]);
    let path = folder.file("a.nii", &file);
    assert_eq!(read_both(&path, &frame(2)).unwrap().values, Values::U8(vec![7; 6]));
    let cut = read_both(&path, &frame(3)).unwrap_err();
    assert!(matches!(cut, Error::Truncated { expected: 6, found: 2, .. }), "{cut}");
    assert!(matches!(read_both(&path, &frame(4)), Err(Error::Truncated { found: 0, .. })));
}

#[test]
fn a_pair_is_read_by_either_name_plain_or_compressed() {
    let folder = Folder::new();
    for case in cases(true) {
        let mut file = Nifti::new(&[4, 3, 2], crate::common::datatype(case.name), true);
        file.put(108, 0f32).header[344..348].copy_from_slice(b"ni1\0");
        for (header, data) in [("a.hdr", "a.img"), ("b.hdr.gz", "b.img.gz"), ("c.HDR", "c.IMG.gz")]
        {
            let packed = |name: &str, bytes: &[u8]| {
                if name.ends_with("gz") { gzip(bytes) } else { bytes.to_vec() }
            };
            folder.file(header, &packed(header, &file.header[..348]));
            folder.file(data, &packed(data, &case.bytes));
            for name in [header, data] {
                let volume = read_both(&folder.path(name), &VolumeOptions::default()).unwrap();
                assert_eq!(volume.values, case.values, "{name}");
            }
        }
    }
    for name in ["a.hdr", "a.img"] {
        assert_eq!(folder.files_of(name), ["a.hdr", "a.img"]);
    }
    std::fs::remove_file(folder.path("a.img")).unwrap();
    let error = read_volume(folder.path("a.hdr"), &VolumeOptions::default()).unwrap_err();
    assert!(error.to_string().contains("a.img: cannot open it"), "{error}");
}

#[test]
fn nifti_headers_that_contradict_themselves_are_said() {
    let folder = Folder::new();
    let warnings = |change: &dyn Fn(&mut Nifti)| {
        let mut file = Nifti::new(&[4, 3, 2], 2, false);
        file.put_all(280, &[1f32, 0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 6.0, 0.0, 0.0, 1.0, 7.0]);
        file.put_all(268, &[5f32, 6.0, 7.0]).put_all(252, &[1i16, 1]).header[123] = 2;
        change(&mut file);
        folder.volume("a.nii", &file.with(&[1; 24])).unwrap().contents.warnings
    };
    assert_eq!(warnings(&|_| {}), [""; 0]);
    let moved = warnings(&|file| {
        file.put(268, 5.6f32);
    });
    assert!(moved.len() == 1 && moved[0].contains("a corner 0.6000 mm apart: the sform was used"));
    assert_eq!(
        warnings(&|file| {
            file.put(268, 5.4f32);
        }),
        [""; 0]
    );
    // The far corner alone: a quarter turn about z at the first voxel, with the same offset.
    let turned = warnings(&|file| {
        file.put(264, 0.5f32.sqrt());
    });
    assert!(turned[0].contains("apart"), "{turned:?}");
    let sheared = warnings(&|file| {
        file.put(284, 0.25f32).put(252, 0i16);
    });
    assert!(sheared[0].contains("not at right angles (cosine 0.2425)"), "{sheared:?}");
    assert!(sheared[1].contains("pixdim gives the spacing [1.0, 1.0, 1.0], the sform 1 x 1.03"));
    let unset = warnings(&|file| {
        file.put_all(252, &[0i16, 0]);
    });
    assert!(unset[0].contains("Neither sform nor qform"), "{unset:?}");
    let long = warnings(&|file| {
        file.put(254, 0i16).put(260, 1.5f32);
    });
    assert!(long[0].contains("length 1.5000"), "{long:?}");
    assert!(warnings(&|file| file.header[123] = 0)[0].contains("no unit"));
    let mut flat = Nifti::new(&[4, 3, 1], 2, false);
    flat.put(88, 0f32).put(252, 1i16).header[123] = 2;
    let volume = folder.volume("a.nii", &flat.with(&[1; 12])).unwrap();
    assert_eq!(volume.grid.spacing(), [1.0; 3]);
    assert!(volume.contents.warnings[0].contains("pixdim 0"));
}

#[test]
fn an_archive_gives_the_array_that_is_named_or_the_only_volume() {
    let folder = Folder::new();
    let (a, b) = (npy("'|u1'", false, "(1, 2, 3)", &[1, 2, 3, 4, 5, 6]), bytes(&[9i16; 4], false));
    let b = npy("'<i2'", true, "(1, 2, 2)", &b);
    let flat = npy("'|u1'", false, "(2, 3)", &[0; 6]);
    let objects = npy("'|O'", false, "(1, 2, 3)", &[0; 6]);
    for deflate in [false, true] {
        let file =
            npz(&[("flat", flat.clone()), ("objects", objects.clone()), ("a", a.clone())], deflate);
        let volume = folder.volume("a.npz", &file).unwrap();
        assert_eq!(volume.values, Values::U8(vec![1, 2, 3, 4, 5, 6]));
        assert!(volume.contents.arrays.is_empty());
        let refused = read_both(&folder.path("a.npz"), &array("flat")).unwrap_err().to_string();
        assert!(refused.contains("three dimensions"), "{refused}");
        let two = npz(&[("a", a.clone()), ("deep/b", b.clone())], deflate);
        let refused = folder.refusal("a.npz", &two);
        assert!(refused.contains("the arrays a, deep/b; name one"), "{refused}");
        for name in ["deep/b", "deep/b.npy"] {
            let volume = read_both(&folder.path("a.npz"), &array(name)).unwrap();
            assert_eq!(volume.values, Values::I16(vec![9; 4]));
            assert_eq!(volume.contents.arrays, ["a", "deep/b"]);
        }
        assert!(matches!(read_both(&folder.path("a.npz"), &array("c")), Err(Error::Choice { .. })));
    }
    assert!(folder.refusal("a.npz", &npz(&[], false)).contains("without any array"));
    assert!(folder.refusal("a.npz", &npz(&[("flat", flat)], false)).contains("three dimensions"));
    assert!(folder.refusal("a.npz", &a).contains("zip archive"));
}

#[test]
fn a_changed_byte_in_an_archive_is_an_error() {
    let folder = Folder::new();
    for deflate in [false, true] {
        let array = npy("'|u1'", false, "(1, 2, 3)", &[1, 2, 3, 4, 5, 6]);
        let mut file = npz(&[("a", array)], deflate);
        // The last byte of the array stands before the central directory.
        let end = file.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
        file[end - 1] ^= 1;
        let refused = folder.refusal("a.npz", &file);
        assert!(refused.contains("zip data is truncated or damaged"), "{refused}");
    }
}

#[test]
fn a_bomb_in_an_archive_is_refused_before_it_grows() {
    let folder = Folder::new();
    // The header promises what a thousand times the bytes cannot be.
    let header = npy("'<f8'", false, "(4000, 4000, 4000)", &[0; 4096]);
    let refused = folder.refusal("a.npz", &npz(&[("a", header)], true));
    assert!(refused.contains("more than are packed here"), "{refused}");
    // What follows the last voxel is not kept.
    let tail = npy("'|u1'", false, "(1, 1, 1)", &vec![1; 80 << 20]);
    let path = folder.file("a.npz", &npz(&[("a", tail)], true));
    let error = read_occupancy(path, &VolumeOptions::default(), &Select::NonZero).unwrap_err();
    assert!(error.to_string().contains("follow the last voxel"), "{error}");
}
