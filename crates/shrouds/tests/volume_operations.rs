//! Operations on volumes, held against brute force over lattice points, the surface and each other.

#![allow(clippy::unwrap_used)]

mod common;

use common::volumes;
use proptest::prelude::*;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, Interpolation, Operation, phantom};
use shrouds::{Error, Grid, Occupancy};

const RULES: [FaceRule; 2] = [FaceRule::Separate, FaceRule::Join];

/// The indices of all lattice points.
fn points(grid: &Grid) -> Vec<[usize; 3]> {
    let [nx, ny, _] = grid.dims();
    (0..grid.point_count()).map(|n| [n % nx, n / nx % ny, n / nx / ny]).collect()
}

fn on(volume: &Occupancy, grid: &Grid) -> Occupancy {
    Occupancy::from_fn(grid.clone(), |p| volume.get(p))
}

fn is_subset(a: &Occupancy, b: &Occupancy) -> bool {
    a.combine(Operation::Subtract, b).unwrap().count() == 0
}

fn squared_distance(a: [isize; 3], b: [isize; 3], spacing: [f64; 3]) -> f64 {
    (0..3).map(|d| ((a[d] - b[d]) as f64 * spacing[d]).powi(2)).sum()
}

/// Growing or shrinking by looking from every point at every other one; beyond a closed border, at two
/// layers.
fn offset_by_force(volume: &Occupancy, distance: f64, border: Border) -> Occupancy {
    let spacing = volume.grid().spacing();
    let dims = volume.grid().dims().map(|n| n as isize);
    let margin = if border == Border::Closed { 2 } else { 0 };
    let mut sources = Vec::new();
    for k in -margin..dims[2] + margin {
        for j in -margin..dims[1] + margin {
            for i in -margin..dims[0] + margin {
                let p = [i, j, k];
                let within = (0..3).all(|d| (0..dims[d]).contains(&p[d]));
                let inside = within && volume.get(p.map(|x| x as usize));
                if inside == (distance > 0.0) {
                    sources.push(p);
                }
            }
        }
    }
    let limit = distance * distance * (1.0 + 1e-6);
    Occupancy::from_fn(volume.grid().clone(), |p| {
        let at = p.map(|x| x as isize);
        let reached = sources.iter().any(|&s| squared_distance(at, s, spacing) <= limit);
        if distance > 0.0 { reached } else { volume.get(p) && !reached }
    })
}

/// Orthogonal axes in the world, turned and perhaps mirrored.
fn turned(dims: [usize; 3], [x, y, z]: [f64; 3]) -> Grid {
    let (c, s) = (0.6, 0.8);
    let affine = [[c * x, -s * y, 0.0, 3.0], [s * x, c * y, 0.0, -7.0], [0.0, 0.0, -z, 0.5]];
    Grid::with_affine(dims, affine).unwrap()
}

fn spacings() -> impl Strategy<Value = [f64; 3]> {
    let spacing = prop_oneof![Just(1.0), Just(0.3f64), Just(f64::from(0.7f32)), 0.2..3.0];
    [spacing.clone(), spacing.clone(), spacing]
}

proptest! {
    #[test]
    fn offsets_are_those_of_brute_force(
        volume in volumes(),
        spacing in spacings(),
        distance in prop_oneof![Just(0.9), Just(3.0), 0.1..6.0f64],
        seldom: bool,
        upright: bool,
    ) {
        // Many slices are swept in several parts.
        let turn = |[x, y, z]: [usize; 3]| if upright { [z, y, x] } else { [x, y, z] };
        let grid = turned(turn(volume.grid().dims()), spacing);
        let mut volume = Occupancy::from_fn(grid.clone(), |p| volume.get(turn(p)));
        if seldom {
            // Few points, far apart.
            volume = Occupancy::from_fn(grid.clone(), |p| {
                volume.get(p) && (p[0] * 5 + p[1] * 3 + p[2] * 7) % 11 == 0
            });
        }
        for (distance, border) in [
            (distance, Border::Closed),
            (-distance, Border::Closed),
            (-distance, Border::Open),
        ] {
            let expected = offset_by_force(&volume, distance, border);
            prop_assert!(volume.offset(distance, border).unwrap() == expected, "{distance} {border:?}");
        }
    }

    #[test]
    fn two_offsets_stay_within_their_sum(
        volume in volumes(),
        spacing in spacings(),
        steps in [0.1..4.0f64, 0.1..4.0f64],
    ) {
        let volume = on(&volume, &Grid::new(volume.grid().dims(), spacing).unwrap());
        let grow = |v: &Occupancy, r: f64| v.offset(r, Border::Closed).unwrap();
        let both = grow(&grow(&volume, steps[0]), steps[1]);
        prop_assert!(is_subset(&both, &grow(&volume, steps[0] + steps[1])));
        let both = grow(&grow(&volume, -steps[0]), -steps[1]);
        prop_assert!(is_subset(&grow(&volume, -steps[0] - steps[1]), &both));
        // Closing holds the volume, where there is room for it.
        let padded = volume.padded_for(steps[0]).unwrap();
        let closed = grow(&grow(&padded, steps[0]), -steps[0]);
        prop_assert!(is_subset(&padded, &closed));
    }

    #[test]
    fn room_for_an_offset_is_room_for_all_of_it(
        volume in volumes(),
        spacing in spacings(),
        distance in 0.1..4.0f64,
    ) {
        let volume = on(&volume, &Grid::new(volume.grid().dims(), spacing).unwrap());
        let grown = volume.padded_for(distance).unwrap().offset(distance, Border::Closed).unwrap();
        let more = volume.padded(25).unwrap().offset(distance, Border::Closed).unwrap();
        prop_assert_eq!(grown.count(), more.count());
        // And no room is wasted: the offset touches every side that was moved.
        let outermost = |d: usize| {
            let [before, after] = [volume.grid().dims()[d], grown.grid().dims()[d]];
            let at_border = |ranges: [std::ops::Range<usize>; 3]| {
                ranges[d].start == 0 || ranges[d].end == after
            };
            before == after || grown.bounding_box().is_some_and(at_border)
        };
        prop_assert!((0..3).all(outermost));
    }

    #[test]
    fn operations_are_those_of_the_bits(volume in volumes(), shift in 1..9usize) {
        let [nx, ny, nz] = volume.grid().dims();
        let other = Occupancy::from_fn(volume.grid().clone(), |[i, j, k]| {
            volume.get([(i + shift) % nx, (j + 1) % ny, (k + shift) % nz])
        });
        type Rule = fn(bool, bool) -> bool;
        let rules: [(Operation, Rule); 4] = [
            (Operation::Union, |a, b| a || b),
            (Operation::Intersect, |a, b| a && b),
            (Operation::Subtract, |a, b| a && !b),
            (Operation::Xor, |a, b| a != b),
        ];
        for (operation, rule) in rules {
            let expected = Occupancy::from_fn(volume.grid().clone(), |p| {
                rule(volume.get(p), other.get(p))
            });
            prop_assert_eq!(volume.combine(operation, &other).unwrap(), expected);
        }
    }

    #[test]
    fn components_and_cavities_are_those_of_the_surface(volume in volumes()) {
        for rule in RULES {
            let surface = Surface::extract(&volume, rule, Border::Closed).unwrap();
            let surfaces = surface.components();
            let bodies = surfaces.voxels().iter().filter(|n| **n > 0).count();
            let components = volume.components(rule);
            prop_assert_eq!(components.count(), bodies, "{:?}", rule);
            prop_assert_eq!(components.sizes().iter().sum::<u64>(), volume.count());
            let filled = volume.fill_cavities(None, rule);
            prop_assert_eq!(filled.components, surfaces.count() - bodies, "{:?}", rule);
            prop_assert_eq!(filled.volume.count(), volume.count() + filled.voxels);
            let again = Surface::extract(&filled.volume, rule, Border::Closed).unwrap();
            prop_assert!(again.components().voxels().iter().all(|n| *n > 0));
        }
    }

    #[test]
    fn components_are_those_of_a_flood(volume in volumes()) {
        for rule in RULES {
            let components = volume.components(rule);
            let floods = floods(&volume, rule);
            prop_assert_eq!(components.count(), floods.len());
            for (n, flood) in floods.iter().enumerate() {
                prop_assert_eq!(components.sizes()[n], flood.count());
                prop_assert_eq!(&components.select(|c| c == n), flood);
            }
            let least = 4;
            let dropped = volume.drop_smaller(least, rule);
            let kept = floods.iter().filter(|f| f.count() >= least);
            prop_assert_eq!(dropped.volume.count(), kept.clone().map(Occupancy::count).sum::<u64>());
            prop_assert_eq!(dropped.components, floods.len() - kept.count());
            prop_assert_eq!(dropped.voxels, volume.count() - dropped.volume.count());
            let largest = volume.keep_largest(1, rule);
            let most = floods.iter().map(Occupancy::count).max().unwrap_or(0);
            // The first of the largest ones.
            let first = floods.iter().find(|f| f.count() == most);
            prop_assert_eq!(Some(&largest.volume), first.or(Some(&volume)));
            prop_assert_eq!(volume.keep_largest(2, rule).components, floods.len().saturating_sub(2));
        }
    }

    #[test]
    fn resampled_points_have_the_side_of_the_formula(
        volume in volumes(),
        spacing in spacings(),
        finer in [0.3..2.6f64, 0.3..2.6, 0.3..2.6],
        shift in [-2.0..2.0f64, -2.0..2.0, -2.0..2.0],
        oblique: bool,
        solid: bool,
    ) {
        let grid = turned(volume.grid().dims(), spacing);
        let in_box = |p: [usize; 3]| p.iter().zip(grid.dims()).all(|(&x, n)| x > n / 3 && x < n - 1);
        let volume = Occupancy::from_fn(grid.clone(), |p| if solid { in_box(p) } else { volume.get(p) });
        let frame = if oblique {
            Grid::new([9, 8, 7], finer).unwrap()
        } else {
            volume.grid().with_spacing(std::array::from_fn(|d| spacing[d] * finer[d])).unwrap()
        };
        let mut affine = frame.affine();
        (0..3).for_each(|r| affine[r][3] = volume.grid().affine()[r][3] + shift[r]);
        let target = Grid::with_affine(frame.dims(), affine).unwrap();
        let nearest = volume.resample(&target, Interpolation::Nearest).unwrap();
        let linear = volume.resample(&target, Interpolation::Linear).unwrap();
        for p in points(&target) {
            let at = index_in(volume.grid(), target.point(p.map(|x| x as f64)));
            let rounded = at.map(f64::round);
            // Ties are for another test.
            if at.iter().all(|x| (x.fract().abs() - 0.5).abs() > 1e-6) {
                prop_assert_eq!(nearest.get(p), value(&volume, rounded) == 1.0, "{:?}", p);
            }
            let mean = mean_over_voxel(&volume, &target, p);
            if (mean - 0.5).abs() > 1e-6 {
                prop_assert_eq!(linear.get(p), mean > 0.5, "{:?} {}", p, mean);
            }
        }
    }
}

fn index_in(grid: &Grid, world: [f64; 3]) -> [f64; 3] {
    grid.inverse_affine().map(|r| r[0] * world[0] + r[1] * world[1] + r[2] * world[2] + r[3])
}

/// 1 at an inside lattice point, 0 at all others and beyond.
fn value(volume: &Occupancy, index: [f64; 3]) -> f64 {
    let dims = volume.grid().dims();
    let within = (0..3).all(|d| index[d] >= 0.0 && index[d] < dims[d] as f64);
    f64::from(within && volume.get(index.map(|x| x as usize)))
}

/// The mean of the sum of hats over all inside points, at samples that are made in the world.
fn mean_over_voxel(volume: &Occupancy, target: &Grid, p: [usize; 3]) -> f64 {
    let counts: [usize; 3] = std::array::from_fn(|d| {
        let mut end = [0.0; 3];
        end[d] = 1.0;
        let [a, b] = [[0.0; 3], end].map(|x| index_in(volume.grid(), target.point(x)));
        let steps = (0..3).map(|r| (b[r] - a[r]).abs()).fold(0.0, f64::max);
        (1..).find(|&n| n as f64 >= steps - 1e-6).unwrap()
    });
    let mut sum = 0.0;
    for n in 0..counts.iter().product() {
        let place = [n % counts[0], n / counts[0] % counts[1], n / counts[0] / counts[1]];
        let index =
            std::array::from_fn(|d| p[d] as f64 - 0.5 + (place[d] as f64 + 0.5) / counts[d] as f64);
        let at = index_in(volume.grid(), target.point(index));
        let corner = at.map(f64::floor);
        for c in 0..8 {
            let q: [f64; 3] = std::array::from_fn(|d| corner[d] + (c >> d & 1) as f64);
            let hat: f64 = (0..3).map(|d| (1.0 - (at[d] - q[d]).abs()).max(0.0)).product();
            sum += hat * value(volume, q);
        }
    }
    sum / counts.iter().product::<usize>() as f64
}

/// The components one by one, each found by walking from point to point.
fn floods(volume: &Occupancy, rule: FaceRule) -> Vec<Occupancy> {
    let dims = volume.grid().dims();
    let farthest = if rule == FaceRule::Join { 2 } else { 1 };
    let mut found: Vec<Occupancy> = Vec::new();
    for seed in points(volume.grid()) {
        if !volume.get(seed) || found.iter().any(|flood| flood.get(seed)) {
            continue;
        }
        let mut flood = Occupancy::empty(volume.grid().clone());
        flood.set(seed, true);
        let mut open = vec![seed];
        while let Some(p) = open.pop() {
            for n in 0..27usize {
                let step = [n % 3, n / 3 % 3, n / 9].map(|x| x as isize - 1);
                let q: [usize; 3] = std::array::from_fn(|d| p[d].wrapping_add_signed(step[d]));
                let near = step.iter().map(|x| x.abs()).sum::<isize>() <= farthest;
                let within = (0..3).all(|d| q[d] < dims[d]);
                if near && within && volume.get(q) && !flood.get(q) {
                    flood.set(q, true);
                    open.push(q);
                }
            }
        }
        found.push(flood);
    }
    found
}

#[test]
fn an_offset_point_is_a_ball() {
    let grid = Grid::new([41, 41, 17], [0.5, 0.5, 1.25]).unwrap();
    let mut point = Occupancy::empty(grid.clone());
    point.set([20, 20, 8], true);
    let ball = point.offset(10.0, Border::Closed).unwrap();
    let distance =
        |p: [usize; 3]| squared_distance(p.map(|x| x as isize), [20, 20, 8], grid.spacing());
    // 100 is reached exactly, for one along each axis.
    assert_eq!(ball, Occupancy::from_fn(grid.clone(), |p| distance(p) <= 100.0));
    assert!(ball.get([0, 20, 8]) && ball.get([20, 20, 0]));
    assert_eq!(ball.offset(0.0, Border::Closed).unwrap(), ball);
    // Back to the point: a ball is what is left of it when it shrinks by less than its radius.
    assert!(ball.offset(-9.9, Border::Closed).unwrap().get([20, 20, 8]));
    assert_eq!(ball.offset(-11.3, Border::Closed).unwrap().count(), 0);
}

#[test]
fn distances_beyond_the_lattice_fill_or_empty_it() {
    let volume = phantom::sphere(20).unwrap();
    for distance in [1e3, 1e200, f64::MAX] {
        let all = volume.offset(distance, Border::Closed).unwrap();
        assert_eq!(all.count(), volume.grid().point_count() as u64);
        assert_eq!(volume.offset(-distance, Border::Open).unwrap().count(), 0);
    }
    assert_eq!(volume.offset(1e-200, Border::Closed).unwrap(), volume);
    let empty = Occupancy::empty(volume.grid().clone());
    assert_eq!(empty.offset(5.0, Border::Closed).unwrap(), empty);
    let full = volume.offset(1e3, Border::Closed).unwrap();
    assert_eq!(full.offset(-5.0, Border::Open).unwrap(), full);
    let receded = full.offset(-5.0 * full.grid().min_spacing(), Border::Closed).unwrap();
    assert_eq!(receded.bounding_box(), Some(full.grid().dims().map(|n| 5..n - 5)));
}

#[test]
fn what_cannot_be_offset_is_refused() {
    let sheared = [[1.0, 0.1, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let volume = Occupancy::empty(Grid::with_affine([3; 3], sheared).unwrap());
    let error = volume.offset(1.0, Border::Closed).unwrap_err();
    assert!(matches!(error, Error::Sheared { axes: "x and y", .. }), "{error}");
    let volume = phantom::sphere(8).unwrap();
    for distance in [f64::NAN, f64::INFINITY] {
        let error = volume.offset(distance, Border::Closed).unwrap_err();
        assert!(matches!(error, Error::Setting { name: "the distance", .. }), "{error}");
        assert!(volume.padded_for(distance).is_err());
    }
    assert!(volume.padded_for(1e300).is_err());
}

#[test]
fn only_volumes_that_share_a_lattice_are_combined() {
    let a = phantom::sphere(8).unwrap();
    let b = Occupancy::empty(a.grid().with_spacing([2.0; 3]).unwrap());
    let error = a.combine(Operation::Union, &b).unwrap_err();
    assert!(matches!(error, Error::DifferentLattices { .. }));
    assert!(error.to_string().contains("resample"), "{error}");
}

#[test]
fn large_cavities_can_be_left() {
    let grid = Grid::new([70, 9, 9], [1.0; 3]).unwrap();
    let hole = |p: [usize; 3]| p == [3, 4, 4] || (p[0] > 60 && p[0] < 66 && p[1] == 4 && p[2] == 4);
    let volume = Occupancy::from_fn(grid.clone(), |p| !hole(p) && p != [0, 0, 0]);
    let some = volume.fill_cavities(Some(4), FaceRule::Separate);
    assert_eq!((some.components, some.voxels), (1, 1));
    let all = volume.fill_cavities(None, FaceRule::Separate);
    assert_eq!((all.components, all.voxels), (2, 6));
    assert_eq!(all.volume, Occupancy::from_fn(grid, |p| p != [0, 0, 0]));
}

#[test]
fn the_same_lattice_gives_the_same_volume() {
    let volume = phantom::linked_tori(30).unwrap();
    let affine = [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];
    let volume = on(&volume, &Grid::with_affine(volume.grid().dims(), affine).unwrap());
    for interpolation in [Interpolation::Nearest, Interpolation::Linear] {
        assert_eq!(volume.resample(volume.grid(), interpolation).unwrap(), volume);
        // Every third point of a lattice three times finer is one of this one; and a lattice beyond
        // has nothing inside.
        let third = volume.grid().spacing().map(|h| h / 3.0);
        let finer = volume.resample(&volume.grid().with_spacing(third).unwrap(), interpolation);
        let finer = finer.unwrap();
        assert!(
            points(volume.grid()).iter().all(|p| finer.get(p.map(|x| 3 * x)) == volume.get(*p))
        );
        let mut affine = affine;
        affine[2][3] += 1e4;
        let away = Grid::with_affine([5; 3], affine).unwrap();
        assert_eq!(volume.resample(&away, interpolation).unwrap().count(), 0);
    }
}

#[test]
fn shapes_keep_their_volume_on_other_lattices() {
    let volume = phantom::sphere(48).unwrap();
    let size = |v: &Occupancy| v.count() as f64 * v.grid().voxel_volume();
    let spacing = volume.grid().spacing();
    for factor in [0.4, 0.7, 1.3, 2.0, 3.0] {
        let grid = volume.grid().with_spacing(spacing.map(|h| h * factor)).unwrap();
        let other = volume.resample(&grid, Interpolation::Linear).unwrap();
        let ratio = size(&other) / size(&volume);
        assert!((ratio - 1.0).abs() < 0.02, "{factor}: {ratio}");
    }
}

#[test]
fn ties_go_to_the_inside_and_to_the_larger_index() {
    let grid = Grid::new([4, 1, 1], [1.0; 3]).unwrap();
    let volume = Occupancy::from_fn(grid.clone(), |[i, _, _]| i == 1 || i == 2);
    let half = grid.with_spacing([0.5, 1.0, 1.0]).unwrap();
    let inside = |interpolation| {
        let finer = volume.resample(&half, interpolation).unwrap();
        (0..7).filter(|&i| finer.get([i, 0, 0])).collect::<Vec<_>>()
    };
    assert_eq!(inside(Interpolation::Linear), [1, 2, 3, 4, 5]);
    assert_eq!(inside(Interpolation::Nearest), [1, 2, 3, 4]);
}

#[test]
fn any_number_of_threads_gives_the_same_volumes() {
    let volume = phantom::linked_tori(70).unwrap();
    let grid = volume.grid().with_spacing([0.8, 1.7, 1.1]).unwrap();
    let results = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let grown = volume.padded_for(5.3).unwrap().offset(5.3, Border::Closed).unwrap();
            (grown, volume.resample(&grid, Interpolation::Linear).unwrap())
        })
    });
    assert_eq!(results[0], results[1]);
}
