//! Bit planes give every bit back, and damage is noticed.
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;

use proptest::prelude::*;
use shrouds::check::{CheckSettings, check};
use shrouds::mesh::{MeshKind, Triangles, place_vertices, slope_normals};
use shrouds::optimize::{self, Optimum, optimize};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Grid, Occupancy, TriMesh};
use shrouds_codec::geometry::{MAX_PLANES, decode, encode};
use shrouds_codec::{Error, Planes, Settings, pack_with_planes, unpack};

fn surface(dims: [usize; 3], spacing: [f64; 3], border: Border, faces: FaceRule) -> Surface {
    let grid = Grid::new(dims, spacing).unwrap();
    Surface::extract(&phantom::noise(&grid, 0.4, 7).unwrap(), faces, border).unwrap()
}

/// A number from 0 to 1 for each vertex.
fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(u32::MAX >> 1)
    };
    (0..count).map(|_| next()).collect()
}

fn payloads(planes: &Planes) -> Vec<(&[u8], u32)> {
    planes.payloads.iter().map(|(payload, sum)| (&payload[..], *sum)).collect()
}

/// Codes and decodes; checks that the intervals hold δ and that the places lie in them.
fn goes_round(surface: &Surface, delta: &[f64], planes: usize) {
    let coded = encode(surface, delta, planes).unwrap();
    assert_eq!(coded.payloads.len(), planes);
    let places = decode(surface, &coded.settings, &payloads(&coded));
    assert_eq!((places.planes, &places.lost), (planes, &None));
    let found = places.deltas();
    assert_eq!(found.len(), delta.len());
    for ((interval, found), delta) in places.intervals().zip(found).zip(delta) {
        let [low, high] = interval;
        assert_eq!(high - low, 1.0 / f64::from(1 << planes));
        assert!((low..=high).contains(delta), "{delta} in {low}..{high}");
        let [low, high] = [low, high].map(|end| end.clamp(0.002, 0.998));
        assert!((low..=high).contains(&found), "{found} in {low}..{high}");
    }
}

/// Places the vertices within the intervals of some planes as `shrouds unpack` does; checks that they
/// are there and that the mesh has every lattice point on its side.
fn separates(volume: &Occupancy, surface: &Surface, delta: &[f64], planes: usize) {
    if delta.is_empty() {
        return;
    }
    let coded = encode(surface, delta, planes).unwrap();
    let intervals: Vec<[f64; 2]> =
        decode(surface, &coded.settings, &payloads(&coded)).intervals().collect();
    let settings = optimize::Settings {
        preset: optimize::Preset::Exact,
        intervals: Some(intervals.clone().into()),
        ..Default::default()
    };
    let Optimum { delta: found, slopes, .. } =
        optimize(surface, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
    for ((found, delta), [low, high]) in found.iter().zip(delta).zip(intervals) {
        assert!(low < *found && *found < high, "{found} in {low}..{high}");
        assert!((found - delta).abs() <= high - low);
    }
    let vertices = place_vertices(surface, &found);
    let normals = slope_normals(surface, &slopes);
    let mesh = TriMesh::span(surface, vertices, normals, MeshKind::Primal, Triangles::Fixed);
    // Places at random may cross each other.
    let settings = CheckSettings { self_intersections: false, ..CheckSettings::default() };
    let report = check(&mesh, volume, &settings).unwrap();
    assert!(report.is_clean(), "{:?}", report.problems());
}

#[test]
fn every_number_of_planes_comes_back() {
    for border in [Border::Closed, Border::Open] {
        for faces in [FaceRule::Separate, FaceRule::Join] {
            let surface = surface([9, 8, 7], [1.0, 0.7, 3.0], border, faces);
            let delta = random(surface.vertex_count(), 3);
            (0..=MAX_PLANES).for_each(|planes| goes_round(&surface, &delta, planes));
        }
    }
}

#[test]
fn small_volumes_come_back() {
    let grid = Grid::new([3; 3], [1.0; 3]).unwrap();
    for inside in [false, true] {
        let volume = Occupancy::from_fn(grid.clone(), |p| inside && p == [1; 3]);
        let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
        let ends = [0.0, 1.0, 0.5, 1.0 / 256.0, 0.25, 0.75];
        goes_round(&surface, &ends[..surface.vertex_count()], 8);
    }
    let image =
        Occupancy::from_fn(Grid::new([9, 8, 1], [1.0; 3]).unwrap(), |[i, j, _]| i * j % 5 > 1);
    let surface = Surface::of_image(&image, FaceRule::Separate, Border::Closed).unwrap();
    goes_round(&surface, &random(surface.vertex_count(), 1), 8);
}

#[test]
fn the_error_falls_with_planes_and_the_bits_are_few() {
    let volume = phantom::linked_tori(40).unwrap();
    let shroud = shrouds::shroud(&volume, &shrouds::Settings::default()).unwrap();
    let coded = encode(&shroud.surface, &shroud.delta, 8).unwrap();
    let mut last = f64::INFINITY;
    for planes in 1..=8 {
        let places = decode(&shroud.surface, &coded.settings, &payloads(&coded)[..planes]);
        let off =
            places.deltas().iter().zip(&shroud.delta).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        // Middles of intervals, which is all that is left to say where bits are noise.
        let blind = shroud.delta.len() as f64 / 12.0 / f64::from(1 << (2 * planes));
        assert!(off < 0.7 * last && off < 1.02 * blind, "{planes} planes: {off}, {blind}");
        last = off;
    }
    // Less than a bit per vertex in each of the planes that tell of the surface.
    let bits =
        |plane: usize| 8.0 * coded.payloads[plane].0.len() as f64 / shroud.delta.len() as f64;
    assert!(bits(0) < 0.5 && bits(1) < 0.65, "{} and {}", bits(0), bits(1));
}

#[test]
fn what_is_no_place_is_refused() {
    let surface = surface([5; 3], [1.0; 3], Border::Closed, FaceRule::Separate);
    let count = surface.vertex_count();
    let refused = |delta: &[f64], planes| {
        assert!(matches!(encode(&surface, delta, planes), Err(Error::Setting { .. })));
    };
    refused(&vec![0.5; count], 9);
    refused(&vec![0.5; count - 1], 2);
    for odd in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
        let mut delta = vec![0.5; count];
        delta[count / 2] = odd;
        refused(&delta, 2);
    }
}

#[test]
fn a_damaged_plane_leaves_those_before_it() {
    let surface = surface([9, 8, 7], [1.0; 3], Border::Closed, FaceRule::Separate);
    let delta = random(surface.vertex_count(), 5);
    let coded = encode(&surface, &delta, 4).unwrap();
    let whole = decode(&surface, &coded.settings, &payloads(&coded)[..2]);
    let mut damaged = coded.clone();
    damaged.payloads[2].0[3] ^= 16;
    let places = decode(&surface, &damaged.settings, &payloads(&damaged));
    assert_eq!((places.planes, &places.steps), (2, &whole.steps));
    assert_eq!(places.deltas(), whole.deltas());
    assert!(places.lost.unwrap().contains("plane 3"));
}

#[test]
fn planes_go_through_a_file_and_its_beginning_is_a_coarser_model() {
    let volume = phantom::linked_tori(24).unwrap();
    let shroud = shrouds::shroud(&volume, &shrouds::Settings::default()).unwrap();
    let coded = encode(&shroud.surface, &shroud.delta, 3).unwrap();
    let mut file = Vec::new();
    pack_with_planes(&volume, &Settings::default(), &coded, &mut file).unwrap();
    for (length, planes) in [(file.len(), 3), (file.len() - 1, 2)] {
        let unpacked = unpack(&file[..length]).unwrap();
        let surface =
            Surface::extract(&unpacked.volume, unpacked.header.faces, unpacked.header.border)
                .unwrap();
        let chunks: Vec<(&[u8], u32)> =
            unpacked.planes.iter().map(|chunk| (&chunk.payload[..], chunk.decoded_sum)).collect();
        let places = decode(&surface, &unpacked.header.plane_settings, &chunks);
        assert_eq!((places.planes, unpacked.lost.is_some()), (planes, planes < 3));
        let direct = decode(&shroud.surface, &coded.settings, &payloads(&coded)[..planes]);
        assert_eq!(places, direct);
    }
}

/// What the bytes of version 1 are: never to be changed.
#[test]
fn bytes_are_the_same_everywhere() {
    let surface = surface([9, 8, 7], [1.0; 3], Border::Closed, FaceRule::Separate);
    let delta = random(surface.vertex_count(), 5);
    let coded = encode(&surface, &delta, 8).unwrap();
    let sums: Vec<u32> = coded.payloads.iter().map(|(bytes, _)| crc32fast::hash(bytes)).collect();
    assert_eq!(sums, GOLDEN);
}

const GOLDEN: [u32; 8] = [
    2_558_640_546,
    3_914_761_233,
    3_817_105_875,
    2_138_659_308,
    3_762_305_217,
    691_407_602,
    4_142_279_648,
    4_009_701_364,
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn any_volume_comes_back(
        dims in [1usize..7, 1usize..7, 1usize..7],
        bits in prop::collection::vec(any::<bool>(), 216),
        seed in any::<u64>(),
        planes in 1usize..=8,
    ) {
        let [nx, ny, _] = dims;
        let grid = Grid::new(dims, [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid, |[i, j, k]| bits[(k * ny + j) * nx + i]);
        let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
        let delta = random(surface.vertex_count(), seed);
        goes_round(&surface, &delta, planes);
        separates(&volume, &surface, &delta, planes);
    }

    #[test]
    fn any_bytes_are_noticed(
        settings in prop::collection::vec(any::<u8>(), 0..60),
        payload in prop::collection::vec(any::<u8>(), 0..500),
        sum in any::<u32>(),
    ) {
        let surface = surface([9, 8, 7], [1.0; 3], Border::Open, FaceRule::Separate);
        let places = decode(&surface, &settings, &[(&payload, sum), (&payload, sum)]);
        prop_assert_eq!(places.planes, 0);
        prop_assert!(places.deltas().iter().all(|delta| (0.002..=0.998).contains(delta)));
    }
}
