//! Raw voxels with a layout from the call or from a file beside them.

use shrouds_io::{
    ElementType, Error, Frame, RawLayout, Values, VolumeOptions, read_contents, read_volume,
};

use crate::common::{Folder, cases, read_both};

const LAYOUT: RawLayout =
    RawLayout { dims: [4, 3, 2], element: ElementType::U8, big_endian: false, offset: 0 };

fn with(raw: RawLayout) -> VolumeOptions<'static> {
    VolumeOptions { raw: Some(raw), ..VolumeOptions::default() }
}

#[test]
fn every_type_by_every_name_from_the_call_and_from_the_side() {
    let folder = Folder::new();
    for big_endian in [false, true] {
        for case in cases(big_endian) {
            let element = ElementType::from_name(case.name).unwrap();
            let path = folder.file("a.raw", &[b"abc", case.bytes.as_slice()].concat());
            let layout = RawLayout { element, big_endian, offset: 3, ..LAYOUT };
            let volume = read_both(&path, &with(layout)).unwrap();
            assert_eq!((volume.grid.dims(), volume.values), ([4, 3, 2], case.values.clone()));
            for (sidecar, name) in [("a.json", case.name), ("a.raw.json", element.name())] {
                let endian = if big_endian { "big" } else { "little" };
                let json = format!(
                    r#"{{"dims": [4, 3, 2], "type": "{name}", "endian": "{endian}", "offset": 3,
                    "spacing": [1, 2.5, 3], "origin": [-1, 0, 1e1], "unit": "um"}}"#
                );
                folder.file(sidecar, json.as_bytes());
                let volume = read_both(&path, &VolumeOptions::default()).unwrap();
                assert_eq!(volume.values, case.values);
                assert_eq!(volume.grid.point([1.0; 3]), [0.0, 2.5, 13.0]);
                let (name, unit) = ("unnamed".into(), "um".into());
                assert_eq!(volume.frame, Frame { name, unit, source: "sidecar" });
            }
            std::fs::remove_file(folder.path("a.raw.json")).unwrap();
        }
    }
    let path = folder.file("b.bin", &[1; 24]);
    let volume = read_both(&path, &with(LAYOUT)).unwrap();
    assert_eq!((volume.values, volume.frame.name.as_str()), (Values::U8(vec![1; 24]), "index"));
}

#[test]
fn lengths_that_do_not_fit_come_with_readings_that_do() {
    let folder = Folder::new();
    let path = folder.file("a.raw", &[0; 48]);
    let refusal = |layout| read_volume(&path, &with(layout)).unwrap_err().to_string();
    let told = refusal(LAYOUT);
    for reading in ["type uint16; type int16; type float16", "offset 24", "dims 4, 3, 4"] {
        assert!(
            told.contains("are 24 bytes, but the file has 48") && told.contains(reading),
            "{told}"
        );
    }
    let told = refusal(RawLayout { dims: [5, 11, 1], ..LAYOUT });
    assert!(told.contains("no type or offset"), "{told}");
    let told = refusal(RawLayout { offset: u64::MAX, ..LAYOUT });
    assert!(told.contains("offset 24") && !told.contains("type uint16;"), "{told}");
    assert!(refusal(RawLayout { dims: [1 << 19; 3], ..LAYOUT }).contains("has 48"));
    assert!(refusal(RawLayout { dims: [0, 1, 1], ..LAYOUT }).contains("between 1 and"));
}

#[test]
fn a_raw_file_without_a_layout_says_what_to_do() {
    let folder = Folder::new();
    let path = folder.file("a.raw", &[0; 24]);
    let refusal = || {
        let error = read_contents(&path, &VolumeOptions::default()).unwrap_err();
        error.to_string()
    };
    assert!(refusal().contains(".mhd or .nhdr file that belongs to it"));
    folder.file("a.mhd", b"");
    assert!(refusal().contains("a.mhd"));
    for (json, word) in [
        ("{", "not JSON"),
        ("[]", "not an object"),
        (r#"{"type": "uint8"}"#, "'dims'"),
        (r#"{"dims": [4, 3], "type": "uint8"}"#, "'dims'"),
        (r#"{"dims": [4, 3, -2], "type": "uint8"}"#, "'dims'"),
        (r#"{"dims": [4, 3, 2]}"#, "'type' is missing"),
        (r#"{"dims": [4, 3, 2], "type": "uint9"}"#, "none of bool, uint8"),
        (r#"{"dims": [4, 3, 2], "type": "u8", "endian": "middle"}"#, "'endian'"),
        (r#"{"dims": [4, 3, 2], "type": "u8", "offset": 1.5}"#, "'offset'"),
        (r#"{"dims": [4, 3, 2], "type": "u8", "spacing": 1}"#, "'spacing'"),
        (r#"{"dims": [4, 3, 2], "type": "u8", "unit": 1}"#, "'unit'"),
        (r#"{"dims": [4, 3, 2], "type": "u8", "axes": "zyx"}"#, "'axes' is none of dims"),
    ] {
        folder.file("a.json", json.as_bytes());
        let refusal = refusal();
        assert!(refusal.contains("a.json") && refusal.contains(word), "{refusal} lacks {word}");
    }
    folder.file("a.json", &[b"[".repeat(60_000).as_slice(), b"]"].concat());
    assert!(refusal().contains("not JSON"));
    let error = read_volume(folder.path("none.raw"), &with(LAYOUT));
    assert!(matches!(error, Err(Error::Io { .. })));
}
