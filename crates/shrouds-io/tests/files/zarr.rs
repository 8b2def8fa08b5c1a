//! Zarr folders built by hand: what is chosen, where it lies, and what is damaged.

use std::path::Path;

use proptest::prelude::*;
use shrouds_io::{Error, Values, VolumeFormat, VolumeOptions, read_contents, volume_format};

use crate::common::{Folder, bytes, gzip, read_both};

const ARRAY: &str = r#"{"zarr_format": 2, "shape": [2, 3, 4], "chunks": [1, 3, 2], "dtype": "<u2",
    "compressor": null, "fill_value": 9, "order": "C", "filters": null}"#;

/// Files of a hierarchy: path and content.
type Files = Vec<(String, Vec<u8>)>;

fn file(path: &str, content: impl Into<Vec<u8>>) -> (String, Vec<u8>) {
    (path.into(), content.into())
}

fn write(folder: &Folder, name: &str, files: &Files) -> std::path::PathBuf {
    let root = folder.path(name);
    let _ = std::fs::remove_dir_all(&root);
    std::fs::create_dir(&root).unwrap();
    for (path, content) in files {
        let path = root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    root
}

/// The values of [`ARRAY`]: 0, 1, 2 …
fn ramp() -> Values {
    Values::U16((0..24).collect())
}

/// An array in the folder `at`, of version 2, whose values are [`ramp`].
fn second(at: &str) -> Files {
    let chunk = |k: u16, i: u16| {
        let values = (0..3).flat_map(|j| (0..2).map(move |n| k * 12 + j * 4 + i * 2 + n));
        file(&format!("{at}{k}.0.{i}"), bytes(&values.collect::<Vec<u16>>(), false))
    };
    let metadata = file(&format!("{at}.zarray"), ARRAY);
    [metadata]
        .into_iter()
        .chain([(0, 0), (0, 1), (1, 0), (1, 1)].map(|(k, i)| chunk(k, i)))
        .collect()
}

/// The same of version 3, gzip, in two shards of two chunks.
fn third() -> Files {
    let metadata = r#"{"zarr_format": 3, "node_type": "array", "shape": [2, 3, 4], "data_type": "uint16",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [1, 3, 4]}},
        "chunk_key_encoding": {"name": "default"}, "fill_value": 9,
        "codecs": [{"name": "sharding_indexed", "configuration": {"chunk_shape": [1, 3, 2],
            "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "gzip"}],
            "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "crc32c"}]}}]}"#;
    let mut files = vec![file("zarr.json", metadata)];
    let chunks = second("");
    for k in 0..2 {
        let (mut shard, mut index) = (Vec::new(), Vec::new());
        for i in 0..2 {
            let packed = gzip(&chunks[1 + 2 * k + i].1);
            index.extend([shard.len() as u64, packed.len() as u64]);
            shard.extend(packed);
        }
        let index = bytes(&index, false);
        shard.extend(&index);
        shard.extend(crc32c(&index).to_le_bytes());
        files.push(file(&format!("c/{k}/0/0"), shard));
    }
    files
}

fn crc32c(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum: u32, _| (sum >> 1) ^ ((sum & 1) * 0x82f6_3b78))
    })
}

/// An image of two resolutions with labels of two names.
fn image() -> Files {
    let scale = |z, y, x| format!(r#"{{"type": "scale", "scale": [{z}, {y}, {x}]}}"#);
    let level = |path: &str, scale: String| {
        let shift = r#"{"type": "translation", "translation": [1, 2, 3]}"#;
        format!(r#"{{"path": "{path}", "coordinateTransformations": [{scale}, {shift}]}}"#)
    };
    let axis = |name, unit| format!(r#"{{"name": "{name}", "type": "space", "unit": "{unit}"}}"#);
    let attributes = |more: &str| {
        format!(
            r#"{{"multiscales": [{{"axes": [{}, {}, {}], "datasets": [{}, {}],
                "coordinateTransformations": [{}]}}], {more} "x": 0}}"#,
            axis("z", "nanometer"),
            axis("y", "micrometer"),
            axis("x", "micrometer"),
            level("s0", scale(500, 4, 6)),
            level("deep/s1", scale(1000, 8, 12)),
            scale(1, 1, 2),
        )
    };
    let names = r#""image-label": {"properties": [{"label-value": 3, "name": "cell"},
        {"label-value": 4}, {"label-value": 18446744073709551615, "class": "glia"}]},"#;
    let mut files = vec![file(".zgroup", "{}"), file(".zattrs", attributes(""))];
    files.extend(second("s0/"));
    files.extend(second("deep/s1/"));
    files.push(file("labels/.zattrs", r#"{"labels": ["cells", "parts"]}"#));
    for name in ["cells", "parts"] {
        files.push(file(&format!("labels/{name}/.zattrs"), attributes(names)));
        files.extend(second(&format!("labels/{name}/s0/")));
    }
    files
}

fn refusal(files: &Files, options: &VolumeOptions) -> String {
    let folder = Folder::new();
    let error = read_both(&write(&folder, "a.zarr", files), options).unwrap_err().to_string();
    assert!(error.contains("a.zarr"), "{error}");
    error
}

fn with(files: &Files, path: &str, from: &str, to: &str) -> Files {
    let mut files = files.clone();
    let (_, content) = files.iter_mut().find(|(other, _)| other == path).unwrap();
    let text = String::from_utf8(content.clone()).unwrap();
    assert!(text.contains(from));
    *content = text.replacen(from, to, 1).into();
    files
}

#[test]
fn folders_are_known_by_name_or_by_what_they_hold() {
    let folder = Folder::new();
    assert_eq!(volume_format("no/such.ome.ZARR/").unwrap(), VolumeFormat::Zarr);
    let path = write(&folder, "array", &second(""));
    let chunks = ["0.0.0", "0.0.1", "1.0.0", "1.0.1"].map(|chunk| format!("array/{chunk}"));
    assert_eq!(folder.files_of("array"), [&["array/.zarray".into()], &chunks[..]].concat());
    assert_eq!(volume_format(path).unwrap(), VolumeFormat::Zarr);
    assert!(volume_format(write(&folder, "empty", &vec![])).is_err());
    let empty = write(&folder, "empty.zarr", &vec![]);
    let error = read_both(&empty, &VolumeOptions::default()).unwrap_err().to_string();
    assert!(error.contains("not a Zarr folder"), "{error}");
}

#[test]
fn chunks_make_the_array() {
    let folder = Folder::new();
    for (name, files) in [("second", second("")), ("third", third())] {
        let volume = read_both(&write(&folder, name, &files), &VolumeOptions::default()).unwrap();
        assert_eq!(volume.values, ramp(), "{name}");
        assert_eq!(volume.grid.dims(), [4, 3, 2]);
        assert_eq!((&volume.frame.name[..], volume.frame.source), ("index", "none"));
    }
}

#[test]
fn chunks_that_are_missing_have_the_fill_value() {
    let folder = Folder::new();
    let mut files = second("");
    files.retain(|(path, _)| path != "1.0.0");
    let volume = read_both(&write(&folder, "a", &files), &VolumeOptions::default()).unwrap();
    let expected = (0..24).map(|n| if n >= 12 && n % 4 < 2 { 9 } else { n }).collect();
    assert_eq!(volume.values, Values::U16(expected));
}

#[test]
fn levels_of_an_image() {
    let folder = Folder::new();
    let path = write(&folder, "a.zarr", &image());
    let options = VolumeOptions { array: Some("image"), ..VolumeOptions::default() };
    for (level, factor) in [(0, 1.0), (1, 2.0)] {
        let volume = read_both(&path, &VolumeOptions { level, ..options }).unwrap();
        assert_eq!(volume.values, ramp());
        let [x, y, z] = [12.0, 4.0, 0.5].map(|x| x * factor);
        // The scale of all levels comes after the translation of the one.
        let affine = [[x, 0.0, 0.0, 6.0], [0.0, y, 0.0, 2.0], [0.0, 0.0, z, 0.001]];
        for (row, expected) in volume.grid.affine().iter().flatten().zip(affine.iter().flatten()) {
            assert!((row - expected).abs() < 1e-12, "{affine:?}");
        }
        assert_eq!((&volume.frame.name[..], &volume.frame.unit[..]), ("unnamed", "um"));
        assert!(volume.contents.warnings[0].contains("different units; that of x is um"));
        assert_eq!(volume.contents.levels, 2);
    }
    let error = read_both(&path, &VolumeOptions { level: 2, ..options }).unwrap_err().to_string();
    assert!(error.contains("it holds levels 0 to 1; name one"), "{error}");
}

#[test]
fn labels_are_chosen_by_name() {
    let folder = Folder::new();
    let path = write(&folder, "a.zarr", &image());
    let options = VolumeOptions::default();
    let error = read_both(&path, &options).unwrap_err().to_string();
    assert!(error.contains("the arrays cells, parts, image; name one"), "{error}");
    let named = VolumeOptions { array: Some("parts"), ..options };
    let (_, _, contents) = read_contents(&path, &named).unwrap();
    let segments: Vec<_> = contents.segments.iter().map(|s| (&s.name[..], s.label)).collect();
    assert_eq!(segments, [("cell", 3), ("glia", u64::MAX.into())]);
    assert_eq!(contents.arrays, ["cells", "parts", "image"]);
    let wrong = VolumeOptions { array: Some("part"), ..options };
    assert!(matches!(read_both(&path, &wrong), Err(Error::Choice { .. })));

    let one = with(&image(), "labels/.zattrs", r#", "parts""#, "");
    let path = write(&folder, "b.zarr", &one);
    let volume = read_both(&path, &options).unwrap();
    assert_eq!(volume.contents.arrays, ["cells", "image"]);
    assert!(volume.contents.warnings[0].contains("'cells' is read"));
    assert_eq!(volume.contents.segments.len(), 2);
}

#[test]
fn arrays_of_a_group_are_chosen_by_name() {
    let folder = Folder::new();
    let mut files = vec![file(".zgroup", r#"{"zarr_format": 2}"#)];
    files.extend(second("b/"));
    files.push(file("c/.zgroup", r#"{"zarr_format": 2}"#));
    let options = VolumeOptions::default();
    let path = write(&folder, "one.zarr", &files);
    assert_eq!(read_both(&path, &options).unwrap().values, ramp());
    files.extend(second("a/"));
    let path = write(&folder, "two.zarr", &files);
    let error = read_both(&path, &options).unwrap_err().to_string();
    assert!(error.contains("the arrays a, b; name one"), "{error}");
    let chosen = VolumeOptions { array: Some("a"), ..options };
    assert_eq!(read_both(&path, &chosen).unwrap().values, ramp());
    assert!(refusal(&files[..1].to_vec(), &options).contains("a Zarr group without either"));
}

/// A series of 3 times and 2 channels of one slice each, which is what its voxels are.
fn series() -> Files {
    let metadata = r#"{"zarr_format": 3, "node_type": "array", "shape": [3, 1, 2, 4, 2], "data_type": "int8",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 1, 2, 3, 2]}},
        "chunk_key_encoding": {"name": "v2"}, "fill_value": 0,
        "codecs": [{"name": "transpose", "configuration": {"order": [4, 1, 0, 3, 2]}}, {"name": "bytes"}]}"#;
    let image = r#"{"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.5",
        "image-label": {"properties": [{"label-value": 1, "name": "one"}]},
        "multiscales": [{"axes": [{"name": "t", "type": "time"}, {"name": "z", "type": "space"},
            {"name": "c", "type": "channel"}, {"name": "y", "type": "space"}, {"name": "x", "type": "space"}],
        "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [7, 3, 1, 2, 1]}]}]}]}}}"#;
    let mut files = vec![file("zarr.json", image), file("0/zarr.json", metadata)];
    for (t0, y0) in [(0, 0), (0, 3), (2, 0), (2, 3)] {
        let mut chunk = Vec::new();
        for (x, t) in (0..2).flat_map(|x| (0..2).map(move |t| (x, t0 + t))) {
            for (y, c) in (0..3).flat_map(|y| (0..2).map(move |c| (y0 + y, c))) {
                chunk.push((t * 40 + c * 20 + y * 2 + x) as u8);
            }
        }
        files.push(file(&format!("0/{}.0.0.{}.0", t0 / 2, y0 / 3), chunk));
    }
    files
}

#[test]
fn times_and_channels_are_layers() {
    let folder = Folder::new();
    let path = write(&folder, "a.zarr", &series());
    let options = VolumeOptions::default();
    for layer in 0..6 {
        let volume = read_both(&path, &VolumeOptions { layer: Some(layer), ..options }).unwrap();
        assert_eq!((volume.contents.layers, volume.grid.dims()), (6, [2, 4, 1]));
        assert_eq!(volume.grid.spacing(), [1.0, 2.0, 3.0]);
        let expected = (0..8).map(|n| (layer * 20 + n) as i8).collect();
        assert_eq!(volume.values, Values::I8(expected), "{layer}");
    }
    // Names of labels do not make layers of segments of a series.
    for layer in [None, Some(6)] {
        let error = read_both(&path, &VolumeOptions { layer, ..options }).unwrap_err().to_string();
        assert!(error.contains("frames 0 to 5; name one"), "{error}");
    }
}

#[test]
fn what_is_not_read_is_named() {
    let options = VolumeOptions::default();
    let second_with = |from, to| refusal(&with(&second(""), ".zarray", from, to), &options);
    let third_with = |from, to| refusal(&with(&third(), "zarr.json", from, to), &options);
    let codec = r#""compressor": {"id": "bz2"}"#;
    assert!(second_with(r#""compressor": null"#, codec).contains("the codec bz2 cannot be read"));
    let filter = r#""filters": [{"id": "delta"}]"#;
    assert!(second_with(r#""filters": null"#, filter).contains("the filters"));
    assert!(second_with("<u2", "<c8").contains("the data type <c8"));
    assert!(second_with("9,", "70000,").contains("the fill value 70000 is none of the data type"));
    assert!(second_with("[2, 3, 4]", "[2, 0, 4]").contains("not a list of positive numbers"));
    assert!(second_with("[1, 3, 2]", "[1, 3]").contains("the chunks has 2 axes"));
    assert!(second_with("[2, 3, 4]", "[2, 3, 4").contains(".zarray: the header is damaged"));
    assert!(third_with("uint16", "string").contains("the data type string"));
    assert!(third_with("\"gzip\"", "\"zfpy\"").contains("the codec zfpy"));
    assert!(third_with("[1, 3, 2]", "[1, 2, 2]").contains("the chunks do not divide the shard"));
    let outside = with(&image(), ".zattrs", "\"s0\"", "\"../s0\"");
    let image_only = VolumeOptions { array: Some("image"), ..options };
    assert!(refusal(&outside, &image_only).contains("not paths within its folder"));
    let gone = with(&image(), ".zattrs", "\"s0\"", "\"s9\"");
    assert!(refusal(&gone, &image_only).contains("resolution 's9' is no array"));
    let rotated = with(&image(), ".zattrs", "\"scale\"", "\"rotation\"");
    assert!(refusal(&rotated, &image_only).contains("the coordinate transformation rotation"));
}

#[test]
fn damaged_chunks_are_named() {
    let options = VolumeOptions::default();
    let mut files = second("");
    files[2].1.pop();
    let error = refusal(&files, &options);
    assert!(error.contains("0.0.1: this chunk of voxels is damaged: it has 11 bytes"), "{error}");
    let mut files = third();
    let place = files[2].1.len() - 30;
    files[2].1[place] ^= 1;
    let error = refusal(&files, &options);
    assert!(
        error.contains("0: this chunk of voxels is damaged: in its index, its checksum"),
        "{error}"
    );
}

#[test]
fn absurd_shapes_fail_before_memory_and_patience_do() {
    let options = VolumeOptions::default();
    let shape = |from, to: &str| with(&second(""), ".zarray", from, to);
    let refused = |files: &Files| refusal(files, &options);
    let wide = shape("[2, 3, 4]", "[1000000, 1000000, 1000000]");
    assert!(refused(&wide).contains("of which 4 are there"));
    let flat = shape("[2, 3, 4]", "[1, 30000, 30000]");
    assert!(
        refused(&with(&flat, ".zarray", "[1, 3, 2]", "[1, 1, 1]")).contains("of which 4 are there")
    );
    let many = shape("[2, 3, 4]", "[18446744073709551615, 3, 4]");
    assert!(refused(&many).contains("between 1 and"));
    for huge in ["[4000000, 4000000, 4000000]", "[9223372036854775807, 9223372036854775807, 2]"] {
        let refusal = refused(&shape("[1, 3, 2]", huge));
        assert!(
            refusal.contains("at most a gigabyte") || refusal.contains("are there"),
            "{refusal}"
        );
    }
    // A few bytes that unpack to far more than a chunk.
    let mut bomb = shape("null", r#"{"id": "gzip"}"#);
    bomb[1].1 = gzip(&vec![0; 1 << 24]);
    assert!(refused(&bomb).contains("more than the 12 bytes of a chunk"));
}

fn damaged(files: &Files) {
    let folder = Folder::new();
    let path = write(&folder, "a.zarr", files);
    let options = VolumeOptions { layer: Some(0), array: Some("cells"), ..Default::default() };
    if let Err(error) = read_both(&path, &options) {
        assert!(error.to_string().contains("a.zarr"), "{error}");
    }
}

#[test]
fn truncated_files_never_panic() {
    for files in [second(""), third(), series(), image()] {
        for n in 0..files.len() {
            for length in (0..files[n].1.len()).step_by(1 + files[n].1.len() / 12) {
                let mut files = files.clone();
                files[n].1.truncate(length);
                damaged(&files);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn changed_bytes_never_panic(
        which in 0usize..4,
        changes in prop::collection::vec(
            (any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<u8>()),
            1..4,
        ),
    ) {
        let mut files = match which { 0 => second(""), 1 => third(), 2 => series(), _ => image() };
        for (n, place, value) in &changes {
            let count = files.len();
            let content = &mut files[n.index(count)].1;
            let length = content.len();
            content[place.index(length)] = *value;
        }
        damaged(&files);
    }
}

/// What numcodecs made of 600 values: the name of the codec, and bytes.
fn packed() -> Vec<(&'static str, Vec<u8>)> {
    let lines = include_str!("zarr_packed.txt").lines().filter(|line| !line.starts_with('#'));
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    lines
        .map(|line| {
            let (name, digits) = line.split_once(' ').unwrap();
            (name, digits.as_bytes().chunks(2).map(byte).collect())
        })
        .collect()
}

fn of_one_chunk(name: &str, chunk: &[u8]) -> Files {
    let metadata = format!(
        r#"{{"zarr_format": 2, "shape": [5, 10, 12], "chunks": [5, 10, 12], "dtype": "<u2", "order": "C",
        "compressor": {{"id": "{name}"}}, "fill_value": 9, "filters": null}}"#
    );
    vec![file(".zarray", metadata), file("0.0.0", chunk)]
}

#[test]
fn packed_chunks_unpack_and_truncated_ones_do_not() {
    let folder = Folder::new();
    let value = |n: u16| {
        (u32::from(n) * u32::from(n) / 900 % 23) as u16 + 300 * u16::from(n.is_multiple_of(97))
    };
    let expected = Values::U16((0..600).map(value).collect());
    for (name, chunk) in packed() {
        let path = write(&folder, "a.zarr", &of_one_chunk(name, &chunk));
        assert_eq!(read_both(&path, &VolumeOptions::default()).unwrap().values, expected, "{name}");
        for length in (0..chunk.len()).step_by(3) {
            let files = of_one_chunk(name, &chunk[..length]);
            let refusal = refusal(&files, &VolumeOptions::default());
            assert!(refusal.contains("0.0.0: this chunk of voxels is damaged"), "{refusal}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn changed_packed_chunks_never_panic(
        which in 0usize..6,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let (name, mut chunk) = packed().swap_remove(which);
        for (place, value) in &changes {
            let length = chunk.len();
            chunk[place.index(length)] = *value;
        }
        damaged(&of_one_chunk(name, &chunk));
    }
}

#[test]
fn a_path_that_is_not_there_is_refused() {
    let error = read_both(Path::new("no/such.zarr"), &VolumeOptions::default()).unwrap_err();
    assert!(error.to_string().contains("such.zarr: cannot open it"), "{error}");
}
