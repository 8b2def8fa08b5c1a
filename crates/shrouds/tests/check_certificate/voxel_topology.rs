use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;
use shrouds::check::{VoxelTopology, voxel_topology};
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy};

use crate::shapes::{cubic, random_volume};

const RULES: [FaceRule; 2] = [FaceRule::Separate, FaceRule::Join];

fn surfaces_and_euler(
    n: usize,
    faces: FaceRule,
    inside: impl Fn([i64; 3]) -> bool + Sync,
) -> (u64, i64) {
    let centre = (n / 2) as i64;
    let volume = Occupancy::from_fn(cubic(n), |index| inside(index.map(|x| x as i64 - centre)));
    let found = voxel_topology(&volume, Border::Closed, faces);
    (found.surface_components.expect("the border is closed"), found.euler)
}

#[test]
fn known_bodies() {
    let square = |p: [i64; 3]| p.iter().map(|x| x * x).sum::<i64>();
    for faces in RULES {
        assert_eq!(surfaces_and_euler(15, faces, |p| square(p) <= 30), (1, 2), "ball");
        let shell = |p| (9..=36).contains(&square(p));
        assert_eq!(surfaces_and_euler(15, faces, shell), (2, 4), "ball with a cavity");
        let two = |[x, y, z]: [i64; 3]| square([x.abs() - 4, y, z]) <= 8;
        assert_eq!(surfaces_and_euler(15, faces, two), (2, 4), "two balls");
        let ring = |[x, y, z]: [i64; 3]| {
            let r = ((x * x + y * y) as f64).sqrt() - 5.0;
            r * r + (z * z) as f64 <= 4.5
        };
        assert_eq!(surfaces_and_euler(15, faces, ring), (1, 0), "solid torus");
        assert_eq!(surfaces_and_euler(3, faces, |_| false), (0, 0), "nothing");
        assert_eq!(surfaces_and_euler(3, faces, |_| true), (1, 2), "everything");
        let body = |p: [i64; 3]| p == [0; 3] || p == [1; 3];
        assert_eq!(surfaces_and_euler(4, faces, body), (2, 4), "across a body diagonal");
        let hollow = |p: [i64; 3]| !body(p);
        assert_eq!(
            surfaces_and_euler(6, faces, hollow),
            (3, 6),
            "two holes across a body diagonal"
        );
    }
    let face = |p: [i64; 3]| p == [0; 3] || p == [1, 1, 0];
    assert_eq!(surfaces_and_euler(4, FaceRule::Separate, face), (2, 4));
    assert_eq!(surfaces_and_euler(4, FaceRule::Join, face), (1, 2));
    let holes = |p: [i64; 3]| !face(p);
    assert_eq!(surfaces_and_euler(6, FaceRule::Separate, holes), (2, 4));
    assert_eq!(surfaces_and_euler(6, FaceRule::Join, holes), (3, 6));
}

#[test]
fn an_open_border_cuts_the_surface() {
    let euler = |inside: fn([usize; 3]) -> bool| {
        let volume = Occupancy::from_fn(cubic(6), inside);
        let found = voxel_topology(&volume, Border::Open, FaceRule::Separate);
        assert_eq!(found.surface_components, None);
        found.euler
    };
    assert_eq!(euler(|[i, ..]| i < 3), 1, "a plane is a disc");
    assert_eq!(euler(|[i, j, _]| (2..4).contains(&i) && (2..4).contains(&j)), 0, "a rod is a tube");
    assert_eq!(euler(|[i, j, k]| i < 2 && j < 2 && k < 2), 1, "a corner is a disc");
    assert_eq!(euler(|index| index.iter().all(|x| (2..4).contains(x))), 2, "a box is a sphere");
    assert_eq!(euler(|_| true), 0, "nothing is cut");
}

/// The points of the lattice and, with a closed border, one layer around them.
struct Explicit {
    dims: [usize; 3],
    inside: Vec<bool>,
    faces: FaceRule,
}

impl Explicit {
    fn new(volume: &Occupancy, border: Border, faces: FaceRule) -> Self {
        let margin = usize::from(border == Border::Closed);
        let dims = volume.grid().dims().map(|n| n + 2 * margin);
        let inside = (0..dims.iter().product())
            .map(|n| {
                let index = [n % dims[0], n / dims[0] % dims[1], n / dims[0] / dims[1]];
                let own = index.map(|x| x.wrapping_sub(margin));
                (0..3).all(|d| own[d] < volume.grid().dims()[d]) && volume.get(own)
            })
            .collect();
        Self { dims, inside, faces }
    }

    fn position(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.dims[1] + j) * self.dims[0] + i
    }

    fn at(&self, index: [usize; 3]) -> bool {
        self.inside[self.position(index)]
    }

    /// First corners of the squares spanned by these two axes.
    fn squares(&self, [u, v]: [usize; 2]) -> Vec<[[usize; 3]; 4]> {
        let mut squares = Vec::new();
        for n in 0..self.inside.len() {
            let first = [
                n % self.dims[0],
                n / self.dims[0] % self.dims[1],
                n / self.dims[0] / self.dims[1],
            ];
            if first[u] + 1 < self.dims[u] && first[v] + 1 < self.dims[v] {
                let mut square = [first; 4];
                square[1][u] += 1;
                square[2][u] += 1;
                square[2][v] += 1;
                square[3][v] += 1;
                squares.push(square);
            }
        }
        squares
    }

    /// Components of the points on one side, by the definition.
    fn components(&self, side: bool) -> usize {
        let mut links = BTreeSet::new();
        for axes in [[0, 1], [1, 2], [2, 0]] {
            for square in self.squares(axes) {
                let sides = square.map(|p| self.at(p));
                let joined = side == (self.faces == FaceRule::Join);
                for n in 0..4 {
                    let p = |m: usize| self.position(square[(n + m) % 4]);
                    links.insert([p(0), p(1)]);
                    if joined
                        && sides[n] == side
                        && sides[(n + 1) % 4] != side
                        && sides[(n + 3) % 4] != side
                    {
                        links.insert([p(0), p(2)]);
                    }
                }
            }
        }
        // A single line of points has no squares.
        for d in 0..3 {
            for n in 0..self.inside.len() {
                let step = self.dims[..d].iter().product::<usize>();
                if n / step % self.dims[d] + 1 < self.dims[d] {
                    links.insert([n, n + step]);
                }
            }
        }
        let members = (0..self.inside.len()).filter(|&n| self.inside[n] == side);
        let links = links.into_iter().filter(|l| l.iter().all(|&n| self.inside[n] == side));
        sets(members, links)
    }

    /// The surface itself: segments on the lattice faces join crossings, in each cell they close to
    /// loops, and every loop is filled. Returns its components and V − E + F.
    fn surface(&self) -> (usize, i64) {
        // A segment joins two crossings, named by the two lattice points each lies between.
        type Segment = [[usize; 2]; 2];
        let mut segments: BTreeSet<Segment> = BTreeSet::new();
        let mut cells: BTreeMap<usize, BTreeSet<Segment>> = BTreeMap::new();
        for axes in [[0, 1], [1, 2], [2, 0]] {
            let across = 3 - axes[0] - axes[1];
            for square in self.squares(axes) {
                let sides = square.map(|p| self.at(p));
                let crossing = |n: usize| {
                    let [a, b] = [n % 4, (n + 1) % 4].map(|n| self.position(square[n]));
                    [a.min(b), a.max(b)]
                };
                let crossed: Vec<usize> =
                    (0..4).filter(|&n| sides[n] != sides[(n + 1) % 4]).collect();
                // With four crossings cut off the two corners on the side that is kept apart.
                let apart = self.faces == FaceRule::Separate;
                let pairs = match crossed[..] {
                    [a, b] => vec![[a, b]],
                    [_, _, _, _] => {
                        (0..4).filter(|&n| sides[n] == apart).map(|n| [n + 3, n]).collect()
                    }
                    _ => vec![],
                };
                for pair in pairs {
                    let mut segment = pair.map(crossing);
                    segment.sort_unstable();
                    segments.insert(segment);
                    for back in [0, 1] {
                        let mut cell = square[0];
                        if cell[across] >= back && cell[across] - back + 1 < self.dims[across] {
                            cell[across] -= back;
                            cells.entry(self.position(cell)).or_default().insert(segment);
                        }
                    }
                }
            }
        }
        let mut names: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for d in 0..3 {
            for n in 0..self.inside.len() {
                let step = self.dims[..d].iter().product::<usize>();
                if n / step % self.dims[d] + 1 < self.dims[d]
                    && self.inside[n] != self.inside[n + step]
                {
                    let name = names.len();
                    names.insert([n, n + step], name);
                }
            }
        }
        let numbered = |list: &BTreeSet<Segment>| -> Vec<[usize; 2]> {
            list.iter().map(|segment| segment.map(|crossing| names[&crossing])).collect()
        };
        let loops: usize = cells
            .values()
            .map(|list| {
                let links = numbered(list);
                let members: BTreeSet<usize> = links.iter().flatten().copied().collect();
                assert!(
                    members.iter().all(|m| links.iter().flatten().filter(|n| *n == m).count() == 2)
                );
                sets(members.into_iter(), links.into_iter())
            })
            .sum();
        let euler = names.len() as i64 - segments.len() as i64 + loops as i64;
        (sets(0..names.len(), numbered(&segments).into_iter()), euler)
    }
}

/// Number of sets that links leave of the members.
fn sets(members: impl Iterator<Item = usize>, links: impl Iterator<Item = [usize; 2]>) -> usize {
    let mut parents: BTreeMap<usize, usize> = members.map(|n| (n, n)).collect();
    let root = |parents: &BTreeMap<usize, usize>, mut n: usize| {
        while parents[&n] != n {
            n = parents[&n];
        }
        n
    };
    let mut count = parents.len();
    for [a, b] in links {
        let (a, b) = (root(&parents, a), root(&parents, b));
        if a != b {
            parents.insert(a, b);
            count -= 1;
        }
    }
    count
}

fn compare(volume: &Occupancy, border: Border, faces: FaceRule) -> Result<(), TestCaseError> {
    let explicit = Explicit::new(volume, border, faces);
    let (components, euler) = explicit.surface();
    let expected = VoxelTopology {
        inside_components: explicit.components(true) as u64,
        outside_components: explicit.components(false) as u64,
        surface_components: (border == Border::Closed).then_some(components as u64),
        euler,
    };
    prop_assert_eq!(voxel_topology(volume, border, faces), expected);
    Ok(())
}

#[test]
fn every_cell() {
    for bits in 0..256usize {
        let grid = Grid::new([2; 3], [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid, |[i, j, k]| bits >> (i + 2 * j + 4 * k) & 1 == 1);
        for faces in RULES {
            for border in [Border::Closed, Border::Open] {
                compare(&volume, border, faces).unwrap();
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]
    #[test]
    fn random_volumes_agree_with_the_explicit_surface(
        dims in [1usize..7, 1usize..7, 1usize..7],
        seed: u64,
        density in 0.1..0.9,
        open: bool,
        join: bool,
    ) {
        let open = open && !dims.contains(&1);
        let border = if open { Border::Open } else { Border::Closed };
        compare(&random_volume(dims, seed, density), border, RULES[usize::from(join)])?;
    }

    #[test]
    fn rows_of_several_words_agree_too(
        nx in 61usize..70,
        twice: bool,
        seed: u64,
        density in 0.3..0.7,
        open: bool,
        join: bool,
    ) {
        let dims = [if twice { nx + 64 } else { nx }, 3, 2];
        let border = if open { Border::Open } else { Border::Closed };
        compare(&random_volume(dims, seed, density), border, RULES[usize::from(join)])?;
    }
}
