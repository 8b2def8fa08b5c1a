//! Shrouds that follow their volumes, against fresh ones.

#![allow(clippy::unwrap_used)]

mod common;

use std::ops::{ControlFlow, Range};

use common::CONVENTIONS;
use proptest::prelude::*;
use shrouds::live::Ranges;
use shrouds::mesh::{MeshKind, TriMesh};
use shrouds::network::Network;
use shrouds::optimize::{Crease, Preset, Solver, VolumeRule, optimize};
use shrouds::surface::Surface;
use shrouds::volume::Border;
use shrouds::{Error, Grid, LiveShroud, Occupancy, Settings};

/// A wavy rod with a tunnel, long enough for edits to be local.
fn rod(length: usize) -> Occupancy {
    let grid = Grid::new([34, 30, length], [1.0, 1.25, 1.0]).unwrap();
    Occupancy::from_fn(grid, |[i, j, k]| {
        let z = k as f64;
        let [x, y] = [i as f64 - 16.0 - 3.0 * (z / 13.0).sin(), j as f64 - 15.0];
        let radius = x.hypot(1.25 * y);
        let end = z > 4.0 && z < length as f64 - 5.0;
        end && radius < 10.0 + 2.0 * (z / 9.0).cos() && x.hypot(y - 2.0) > 3.0
    })
}

fn settings(preset: Preset) -> Settings {
    let mut settings = Settings::default();
    settings.optimize.preset = preset;
    settings
}

fn fresh(volume: &Occupancy, settings: &Settings) -> (Surface, Vec<f64>) {
    let surface = Surface::extract(volume, settings.faces, settings.border).unwrap();
    let go_on = &mut |_: shrouds::optimize::Progress| ControlFlow::Continue(());
    let delta = optimize(&surface, &settings.optimize, go_on).unwrap().delta;
    (surface, delta)
}

/// Puts the points of a ball inside or outside, as far as they are in the volume; returns its box.
fn ball(volume: &mut Occupancy, centre: [usize; 3], radius: usize, inside: bool) -> Ranges {
    let dims = volume.grid().dims();
    let region =
        [0, 1, 2].map(|d| centre[d].saturating_sub(radius)..dims[d].min(centre[d] + radius + 1));
    for point in points(&region) {
        let square: usize = (0..3).map(|d| point[d].abs_diff(centre[d]).pow(2)).sum();
        if square <= radius * radius {
            volume.set(point, inside);
        }
    }
    region
}

fn points([x, y, z]: &Ranges) -> Vec<[usize; 3]> {
    let rows = z.clone().flat_map(|k| y.clone().map(move |j| (j, k)));
    rows.flat_map(|(j, k)| x.clone().map(move |i| [i, j, k])).collect()
}

fn all_cells(surface: &Surface) -> Ranges {
    surface.grid().dims().map(|points| 0..points - 1)
}

#[test]
fn what_is_resumed_goes_on_as_if_it_had_never_stopped() {
    let mut volume = rod(150);
    let settings = settings(Preset::Default);
    let mut live = LiveShroud::new(&volume, &settings).unwrap();
    let (surface, delta) = fresh(&volume, &settings);
    let mut resumed = LiveShroud::resume(surface.clone(), delta.clone(), &settings).unwrap();
    let region = ball(&mut volume, [26, 15, 60], 5, true);
    let changes = [&mut live, &mut resumed].map(|live| live.update(&volume, region.clone()));
    assert_eq!(changes[0].as_ref().unwrap(), changes[1].as_ref().unwrap());
    assert_eq!(live.delta(), resumed.delta());
    let mut beyond = delta.clone();
    beyond[7] = f64::NAN;
    let beyond = LiveShroud::resume(surface.clone(), beyond, &settings);
    assert!(matches!(beyond, Err(Error::Setting { name: "delta", .. })));
    let few = LiveShroud::resume(surface, delta[1..].to_vec(), &settings);
    assert!(matches!(few.err(), Some(Error::Setting { name: "delta", .. })));
}

const EDITS: [([usize; 3], usize, bool); 5] = [
    ([26, 15, 60], 5, true),
    ([16, 25, 120], 4, false),
    ([26, 15, 60], 5, false),
    ([18, 14, 100], 3, true),
    ([16, 10, 196], 2, true),
];

#[test]
fn updates_stay_where_they_say_and_a_refresh_makes_a_fresh_solve_of_them() {
    for preset in [Preset::Fast, Preset::Default, Preset::Exact] {
        let mut volume = rod(200);
        let settings = settings(preset);
        let mut live = LiveShroud::new(&volume, &settings).unwrap();
        for (centre, radius, inside) in EDITS {
            let before = live.clone();
            let region = ball(&mut volume, centre, radius, inside);
            let change = live.update(&volume, region).unwrap();
            assert!(!change.is_whole);
            stays_outside(&before, &live, &change.cells);
            // Single precision rounds the bounds.
            let margin = settings.optimize.margin - 1e-7;
            assert!(live.delta().iter().all(|d| (margin..=1.0 - margin).contains(d)));
            let (surface, delta) = fresh(&volume, &settings);
            let mut refreshed = live.clone();
            refreshed.refresh().unwrap();
            assert_eq!((refreshed.surface(), refreshed.delta()), (&surface, &delta[..]));
        }
    }
}

/// Slabs of cells that none of these boxes touches have the same mesh as before.
fn stays_outside(before: &LiveShroud, after: &LiveShroud, changed: &[Ranges]) {
    let [x, y, z] = all_cells(after.surface());
    let mut slabs = 0;
    for k in z.clone().step_by(4) {
        let slab = [x.clone(), y.clone(), k..z.end.min(k + 4)];
        let touches = |other: &Range<usize>| other.start < slab[2].end && slab[2].start < other.end;
        if !changed.iter().any(|cells| touches(&cells[2])) {
            assert_eq!(before.mesh(slab.clone()).unwrap(), after.mesh(slab).unwrap(), "{k}");
            slabs += 1;
        }
    }
    assert!(slabs > 0 || changed[0] == all_cells(after.surface()));
}

#[test]
fn vertices_keep_their_order_and_those_outside_their_bits() {
    let mut volume = rod(200);
    let mut live = LiveShroud::new(&volume, &settings(Preset::Default)).unwrap();
    let before = live.clone();
    let region = ball(&mut volume, [26, 15, 60], 4, true);
    let change = live.update(&volume, region).unwrap();
    assert!(!change.is_whole);
    let [gone, come] = change.renumbered;
    let lows = |live: &LiveShroud| live.surface().crossings().collect::<Vec<_>>();
    let (old, new) = (lows(&before), lows(&live));
    assert_eq!(old[..gone.start], new[..come.start]);
    assert_eq!(old[gone.end..], new[come.end..]);
    let is_outside = |low: [usize; 3]| {
        !change.cells.iter().any(|cells| (0..3).all(|d| cells[d].contains(&low[d])))
    };
    let places = |live: &LiveShroud, list: &[shrouds::surface::Crossing]| -> Vec<_> {
        let all = list.iter().copied().zip(live.delta().iter().copied());
        all.filter(|(crossing, _)| is_outside(crossing.low())).collect()
    };
    let (old, new) = (places(&before, &old), places(&live, &new));
    assert!(old.len() > 1000);
    assert_eq!(old, new);
}

#[test]
fn boxes_of_cells_have_the_mesh_of_the_whole() {
    let volume = rod(60);
    let live = LiveShroud::new(&volume, &settings(Preset::Default)).unwrap();
    let surface = live.surface();
    let network = Network::trace(surface);
    let Settings { triangles, .. } = Settings::default();
    let whole = TriMesh::place(surface, &network, live.delta(), MeshKind::Primal, triangles);
    assert_eq!(live.mesh(all_cells(surface)).unwrap(), whole);
    // The parts have the same triangles between them.
    let corners = |mesh: &TriMesh| -> Vec<[[u64; 3]; 3]> {
        let of = |t: &[u32; 3]| mesh.corners(*t).map(|corner| corner.map(f64::to_bits));
        mesh.triangles.iter().map(of).collect()
    };
    let [x, y, z] = all_cells(surface);
    let mut parts = Vec::new();
    for (x, y) in [(0..13, 0..7), (13..x.end, 0..7), (0..13, 7..y.end), (13..x.end, 7..y.end)] {
        for z in [0..20, 20..z.end] {
            parts.extend(corners(&live.mesh([x.clone(), y.clone(), z]).unwrap()));
        }
    }
    let mut whole = corners(&whole);
    whole.sort_unstable();
    parts.sort_unstable();
    assert_eq!(parts, whole);
    assert!(matches!(live.mesh([3..3, 0..2, 0..2]), Err(Error::NoSuchPoints { .. })));
    assert!(matches!(live.mesh([0..x.end + 1, 0..2, 0..2]), Err(Error::NoSuchPoints { .. })));
}

#[test]
fn volumes_can_be_emptied_and_filled() {
    for border in [Border::Closed, Border::Open] {
        let mut volume = rod(40);
        let everything = volume.grid().dims().map(|count| 0..count);
        let settings = Settings { border, ..settings(Preset::Default) };
        let mut live = LiveShroud::new(&volume, &settings).unwrap();
        for inside in [false, true] {
            points(&everything).into_iter().for_each(|point| volume.set(point, inside));
            live.update(&volume, everything.clone()).unwrap();
            let (surface, delta) = fresh(&volume, &settings);
            assert_eq!((live.surface(), live.delta()), (&surface, &delta[..]));
            assert_eq!(live.delta().is_empty(), !inside || border == Border::Open);
        }
        let region = ball(&mut volume, [20, 10, 20], 4, false);
        live.update(&volume, region.clone()).unwrap();
        let (surface, delta) = fresh(&volume, &settings);
        assert_eq!(live.surface(), &surface);
        assert_eq!(live.delta().len(), delta.len());
        // Nothing is left to do.
        let change = live.update(&volume, region).unwrap();
        assert_eq!(change, shrouds::live::Change::default());
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let volume = rod(40);
    let mut live = LiveShroud::new(&volume, &settings(Preset::Fast)).unwrap();
    let grid = Grid::new(volume.grid().dims(), [2.0; 3]).unwrap();
    let other = Occupancy::empty(grid);
    let error = live.update(&other, [0..2, 0..2, 0..2]).unwrap_err();
    assert!(matches!(error, Error::DifferentLattices { .. }));
    let error = live.update(&volume, [0..2, 0..2, 0..41]).unwrap_err();
    assert!(matches!(error, Error::NoSuchPoints { axis: 'z', .. }));
    let refused = |change: fn(&mut Settings)| {
        let mut settings = settings(Preset::Fast);
        change(&mut settings);
        matches!(LiveShroud::new(&volume, &settings), Err(Error::Setting { .. }))
    };
    assert!(refused(|settings| settings.mesh = MeshKind::Dual));
    assert!(refused(|settings| settings.optimize.solver = Solver::Sweeps));
    assert!(refused(|settings| settings.optimize.volume = VolumeRule::Keep));
    assert!(refused(|settings| settings.optimize.crease = Some(Crease::default())));
    assert!(refused(|settings| settings.optimize.margin = 0.7));
}

/// A box by fractions of the volume, and what its points become.
type Edit = ([(f64, f64); 3], Vec<bool>);

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let side = || (0.0..1.0f64, 0.0..0.6f64);
    let bits = proptest::collection::vec(any::<bool>(), 1..60);
    proptest::collection::vec(([side(), side(), side()], bits), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn surfaces_are_those_of_a_fresh_extraction(
        (mut volume, convention, edits) in (common::volumes(), 0..4usize, edits())
    ) {
        let (faces, border) = CONVENTIONS[convention];
        let settings = Settings { faces, border, ..settings(Preset::Fast) };
        let mut live = LiveShroud::new(&volume, &settings).unwrap();
        let dims = volume.grid().dims();
        for (sides, bits) in edits {
            // Counted patches have to be counted again.
            live.surface().patch_count();
            let region = [0, 1, 2].map(|d| {
                let start = (sides[d].0 * dims[d] as f64) as usize;
                start..dims[d].min(start + 1 + (sides[d].1 * dims[d] as f64) as usize)
            });
            for (point, bit) in points(&region).into_iter().zip(bits.iter().cycle()) {
                volume.set(point, *bit);
            }
            live.update(&volume, region).unwrap();
            let surface = Surface::extract(&volume, faces, border).unwrap();
            surface.patch_count();
            prop_assert_eq!(live.surface(), &surface);
            let margin = settings.optimize.margin - 1e-7;
            prop_assert!(live.delta().iter().all(|d| (margin..=1.0 - margin).contains(d)));
        }
    }
}
