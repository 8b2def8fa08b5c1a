//! VTK image data in all its encodings.

use std::fmt::Write as _;

use shrouds_io::{Error, Frame, Values, VolumeOptions, read_contents};

use crate::common::{Case, Folder, cases, read_both, vti, zlib};

const IMAGE: &str = "WholeExtent=\"0 3 0 2 0 1\" Origin=\"1 2 3\" Spacing=\"0.5 1 2\"";

fn base64(bytes: &[u8]) -> String {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let bits = group.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte));
        let bits = bits << (8 * (3 - group.len()));
        for n in 0..4 {
            let letter = char::from(letters[(bits >> (18 - 6 * n) & 63) as usize]);
            text.push(if n > group.len() { '=' } else { letter });
        }
    }
    text
}

fn type_name(case: &Case) -> String {
    let kind = match &case.name[..1] {
        "u" => "UInt",
        "i" => "Int",
        _ => "Float",
    };
    format!("{kind}{}", &case.name[1..])
}

fn lengths(numbers: &[u64], big: bool, wide: bool) -> Vec<u8> {
    let number = |n: &u64| match (big, wide) {
        (true, true) => n.to_be_bytes().to_vec(),
        (true, false) => (*n as u32).to_be_bytes().to_vec(),
        (false, true) => n.to_le_bytes().to_vec(),
        (false, false) => (*n as u32).to_le_bytes().to_vec(),
    };
    numbers.iter().flat_map(number).collect()
}

/// The lengths before the data, and the data: as it is, or in blocks of 20 bytes.
fn stored(data: &[u8], compressed: bool, big: bool, wide: bool) -> [Vec<u8>; 2] {
    if !compressed {
        return [lengths(&[data.len() as u64], big, wide), data.into()];
    }
    let blocks: Vec<_> = data.chunks(20).map(zlib).collect();
    let mut table = vec![blocks.len() as u64, 20, data.len() as u64 % 20];
    table.extend(blocks.iter().map(|block| block.len() as u64));
    [lengths(&table, big, wide), blocks.concat()]
}

fn text_of(values: &Values) -> String {
    macro_rules! join {
        ($v:expr) => {
            $v.iter().fold(String::new(), |mut text, value| {
                write!(text, "{value}\n ").unwrap();
                text
            })
        };
    }
    match values {
        Values::U8(v) => join!(v),
        Values::I8(v) => join!(v),
        Values::U16(v) => join!(v),
        Values::I16(v) => join!(v),
        Values::U32(v) => join!(v),
        Values::I32(v) => join!(v),
        Values::U64(v) => join!(v),
        Values::I64(v) => join!(v),
        Values::F32(v) => join!(v),
        Values::F64(v) => join!(v),
        Values::Bool(_) => unreachable!(),
    }
}

#[test]
fn every_type_in_every_encoding() {
    let folder = Folder::new();
    for n in 0..8 {
        let (big, wide, compressed) = (n & 1 > 0, n & 2 > 0, n & 4 > 0);
        let file = format!(
            "byte_order=\"{}\" header_type=\"{}\" {}",
            if big { "BigEndian" } else { "LittleEndian" },
            if wide { "UInt64" } else { "UInt32" },
            if compressed { "compressor=\"vtkZLibDataCompressor\"" } else { "" }
        );
        for case in cases(big) {
            let array = format!("<DataArray type=\"{}\" Name=\"v\"", type_name(&case));
            let points = |array: &str| format!("<PointData>\n{array}\n</PointData><CellData/>");
            let [table, data] = stored(&case.bytes, compressed, big, wide);
            let separate = base64(&table) + &base64(&data);
            let joined = base64(&[table.clone(), data.clone()].concat());
            let inline = |text: &str| {
                let array = format!("{array} format=\"binary\">\n  {text}\n</DataArray>");
                vti(&file, IMAGE, &points(&array), &[])
            };
            // Another array comes before it, and one after it.
            let appended = points(&format!("{array} format=\"appended\" offset=\"5\"/>"));
            let raw =
                [b"<AppendedData encoding=\"raw\">\n _", &b"<\xff=a>"[..], &table, &data, b"xyz"];
            let text = format!("<AppendedData encoding=\"base64\"> _ZZZZ={separate}QQ==");
            let ascii = format!("{array} format=\"ascii\">{}</DataArray>", text_of(&case.values));
            let files = [
                inline(&separate),
                inline(&joined),
                vti(&file, IMAGE, &appended, &raw.concat()),
                vti(&file, IMAGE, &appended, text.as_bytes()),
                vti(&file, IMAGE, &points(&ascii), &[]),
            ];
            for (n, file) in files.iter().enumerate() {
                let volume = folder.volume("a.vti", file).unwrap();
                assert_eq!(volume.values, case.values, "{n} {}", case.name);
                assert_eq!(volume.grid.dims(), [4, 3, 2]);
            }
        }
    }
}

/// Bytes as text, in an array of that many components.
fn array(name: &str, components: usize, values: &[u8]) -> String {
    let text: String = values.iter().map(|value| format!("{value} ")).collect();
    format!(
        "<DataArray type=\"UInt8\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"ascii\">{text}</DataArray>"
    )
}

#[test]
fn points_and_cells_lie_where_the_image_puts_them() {
    let folder = Folder::new();
    let image = "WholeExtent=\"0 9 0 9 0 9\" Origin=\"1 2 3\" Spacing=\"0.5 1 2\" \
        Direction=\"0 -1 0 1 0 0 0 0 1\"";
    let read = |piece: &str, extent: &str| {
        let file = String::from_utf8(vti("", image, piece, &[])).unwrap();
        let file = file.replace("Extent=\"0 3 0 2 0 1\"", &format!("Extent=\"{extent}\""));
        folder.volume("a.vti", file.as_bytes()).unwrap()
    };
    let points = format!("<PointData>{}</PointData>", array("v", 1, &[1; 24]));
    let volume = read(&points, "10 13 20 22 -1 0");
    // x of the index goes along y of the world, y along -x.
    assert_eq!(volume.grid.point([0.0; 3]), [1.0 - 20.0, 2.0 + 5.0, 3.0 - 2.0]);
    assert_eq!(volume.grid.point([1.0, 1.0, 1.0]), [-20.0, 7.5, 3.0]);
    let frame = Frame { name: "unnamed".into(), unit: "unknown".into(), source: "ImageData" };
    assert_eq!((volume.grid.dims(), volume.frame), ([4, 3, 2], frame));
    let cells = format!("<CellData>{}</CellData>", array("v", 1, &[1; 6]));
    let volume = read(&cells, "10 13 20 22 -1 0");
    assert_eq!(volume.grid.dims(), [3, 2, 1]);
    assert_eq!(volume.grid.point([0.0; 3]), [1.0 - 20.5, 2.0 + 5.25, 3.0 - 1.0]);
    // A flat image has one layer of cells, in its plane.
    let volume = read(&cells, "0 3 0 2 4 4");
    assert_eq!(volume.grid.dims(), [3, 2, 1]);
    assert_eq!(volume.grid.point([0.0; 3]), [1.0 - 0.5, 2.0 + 0.25, 3.0 + 8.0]);
}

#[test]
fn arrays_are_chosen_by_name_or_by_what_the_file_calls_scalars() {
    let folder = Folder::new();
    let (a, b) = (array("a", 1, &[1; 24]), array("b", 1, &[2; 24]));
    let cell = array("a", 1, &[3; 6]);
    let piece = |scalars: &str| {
        format!("<PointData {scalars}>{a}{b}</PointData><CellData>{cell}</CellData>")
    };
    let path = folder.file("a.vti", &vti("", IMAGE, &piece("Scalars='b'"), &[]));
    let read = |name| read_both(&path, &VolumeOptions { array: name, ..VolumeOptions::default() });
    let volume = read(None).unwrap();
    assert_eq!(volume.values, Values::U8(vec![2; 24]));
    assert_eq!(volume.contents.arrays, ["PointData/a", "b", "CellData/a"]);
    assert_eq!(read(Some("CellData/a")).unwrap().values, Values::U8(vec![3; 6]));
    assert_eq!(read(Some("PointData/a")).unwrap().values, Values::U8(vec![1; 24]));
    assert!(read(Some("c")).unwrap_err().to_string().contains("PointData/a, b, CellData/a"));
    assert!(folder.refusal("a.vti", &vti("", IMAGE, &piece(""), &[])).contains("name one"));
}

#[test]
fn components_are_layers() {
    let folder = Folder::new();
    let values: Vec<u8> = (0..72).collect();
    let piece = format!("<PointData>{}</PointData>", array("v", 3, &values));
    let path = folder.file("a.vti", &vti("", IMAGE, &piece, &[]));
    for layer in 0..3 {
        let options = VolumeOptions { layer: Some(layer), ..VolumeOptions::default() };
        let expected = (0..24).map(|n| 3 * n + layer as u8).collect();
        assert_eq!(read_both(&path, &options).unwrap().values, Values::U8(expected));
    }
    assert!(matches!(read_both(&path, &VolumeOptions::default()), Err(Error::Choice { .. })));
    assert_eq!(read_contents(&path, &VolumeOptions::default()).unwrap().2.layers, 3);
}

#[test]
fn what_cannot_be_read_is_said() {
    let folder = Folder::new();
    let points = |array: &str| format!("<PointData>{array}</PointData>");
    let one = points(&array("v", 1, &[1; 24]));
    let inline = |data: &str| {
        points(&format!(
            "<DataArray type=\"UInt8\" Name=\"v\" format=\"binary\">{data}</DataArray>"
        ))
    };
    let lz4 = "compressor=\"vtkLZ4DataCompressor\"";
    let zlib = "compressor=\"vtkZLibDataCompressor\"";
    let length = base64(&lengths(&[25], false, false));
    let blocks = base64(&lengths(&[u32::MAX.into(), 1 << 20, 0], false, false));
    let absurd = IMAGE.replace("0 3 0 2 0 1", "0 1");
    let cases = [
        (vti(lz4, IMAGE, &inline("AAAA"), &[]), "vtkLZ4DataCompressor"),
        (vti("", IMAGE, &inline(&length), &[]), "has 25 bytes, the lattice needs 24"),
        (vti("", IMAGE, &inline("AA"), &[]), "ends in the lengths"),
        (vti(zlib, IMAGE, &inline(&blocks), &[]), "the lattice needs 24"),
        (vti("", &absurd, &one, &[]), "WholeExtent of ImageData is '0 1', not 6 numbers"),
        (vti("", IMAGE, "<PointData/>", &[]), "without any array"),
        (vti("", IMAGE, &points(&array("v", 1, &[1; 23])), &[]), "expected 24 bytes"),
        (vti("", IMAGE, &points(&array("v", 0, &[1; 23])), &[]), "'0' components"),
        (vti("", IMAGE, &one.replace("UInt8", "Bit"), &[]), "the VTK type 'Bit'"),
        (vti("", IMAGE, &one.replace("1 1", "1 x"), &[]), "'x' is no number"),
        (vti("header_type='Int8'", IMAGE, &one, &[]), "header_type"),
        (vti("", IMAGE, &format!("{one}</Piece><Piece Extent='0 3 0 2 1 2'>"), &[]), "2 pieces"),
        (b"<VTKFile type='PolyData'>".into(), "not VTK image data"),
        (b"\x89PNG".into(), "not VTK image data"),
    ];
    for (file, word) in cases {
        let refusal = folder.refusal("a.vti", &file);
        assert!(refusal.contains(word), "{refusal} lacks {word}");
    }
    let flat = String::from_utf8(vti("", IMAGE, &one, &[])).unwrap();
    for (extent, word) in [("0 -1 0 2 0 1", "holds no points"), ("0 9e9 0 1 0 1", "not 6 numbers")]
    {
        let file = flat.replace("Piece Extent=\"0 3 0 2 0 1", &format!("Piece Extent=\"{extent}"));
        assert!(folder.refusal("a.vti", file.as_bytes()).contains(word));
    }
    let wide = format!("0 {} 0 {} 0 {}", i64::MAX, 1 << 19, 1 << 19);
    let file = flat.replace("Piece Extent=\"0 3 0 2 0 1", &format!("Piece Extent=\"{wide}"));
    assert!(folder.refusal("a.vti", file.as_bytes()).contains("between 1 and"));
}
