//! The planar curves of all interfaces, which begin and end at junctions.

use crate::materials::interfaces::{Interfaces, across};
use crate::parallel;

/// A place is where a planar curve passes a crossing: crossing `v` has place `2·v` in the plane normal
/// to the axis after its own, and place `2·v + 1` in the plane normal to the one after that. Curves run
/// with the first label of the pair on their right.
#[derive(Debug)]
pub(super) struct Network {
    /// What stands before and after each place on its curve: another place, or with the bit
    /// [`JUNCTION`] a junction.
    pub(super) beside: Vec<[u32; 2]>,
    /// Where junctions stand in the stencils of places, place by place.
    pub(super) touches: Vec<Touch>,
    /// The numbers of the touches of every junction follow each other from here on.
    starts: Vec<u32>,
    by_junction: Vec<u32>,
    crossings: usize,
}

/// The bit that tells a junction from a place.
pub(super) const JUNCTION: u32 = 1 << 31;

/// A junction as number `slot` of the four points of a place's stencil: the one before it, its own, the
/// next and the one after that.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub(super) junction: u32,
    pub(super) place: u32,
    pub(super) slot: u8,
}

/// The axis normal to the plane of a place.
#[inline]
pub(super) fn normal(axis: usize, place: usize) -> usize {
    across(axis)[place % 2]
}

impl Network {
    pub(super) fn trace(interfaces: &Interfaces) -> Self {
        let crossings = interfaces.crossings();
        let count = crossings.len();
        let mut beside = vec![[0; 2]; 2 * count];
        parallel::fill(&mut beside, |place| {
            let crossing = crossings[place / 2];
            let normal = normal(crossing.axis(), place);
            interfaces.neighbours(crossing, normal).map(|point| {
                let point = point as usize;
                match crossings.get(point) {
                    Some(next) => {
                        (2 * point + usize::from(across(next.axis())[1] == normal)) as u32
                    }
                    None => (point - count) as u32 | JUNCTION,
                }
            })
        });
        let mut network = Self {
            beside,
            touches: Vec::new(),
            starts: vec![0; interfaces.junctions().len() + 1],
            by_junction: Vec::new(),
            crossings: count,
        };
        network.find_touches();
        network
    }

    fn find_touches(&mut self) {
        for place in 0..self.beside.len() {
            for (slot, point) in self.stencil(place).into_iter().enumerate() {
                if point & JUNCTION != 0 {
                    let touch = Touch {
                        junction: point & !JUNCTION,
                        place: place as u32,
                        slot: slot as u8,
                    };
                    self.starts[touch.junction as usize + 1] += 1;
                    self.touches.push(touch);
                }
            }
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.by_junction = (0..self.touches.len() as u32).collect();
        self.by_junction.sort_by_key(|&n| self.touches[n as usize].junction);
    }

    /// The places or junctions of the stencil of a place. One whose next point is a junction has no
    /// fourth point; the third stands for it.
    #[inline]
    pub(super) fn stencil(&self, place: usize) -> [u32; 4] {
        let [before, after] = self.beside[place];
        let last = if after & JUNCTION == 0 { self.beside[after as usize][1] } else { after };
        [before, place as u32, after, last]
    }

    /// Whether the stencil of a place has its fourth point.
    #[inline]
    pub(super) fn has_fourth(&self, place: usize) -> bool {
        self.beside[place][1] & JUNCTION == 0
    }

    /// The places whose stencils a place stands in, with the number of its point there: its own, the one
    /// before, the one after, and the one before the one before.
    #[inline]
    pub(super) fn stencils_of(&self, place: usize) -> [Option<(usize, usize)>; 4] {
        let [before, after] = self.beside[place];
        let is_place = |point: u32| point & JUNCTION == 0;
        let mut found = [Some((place, 1)), None, None, None];
        if is_place(before) {
            found[1] = Some((before as usize, 2));
            let first = self.beside[before as usize][0];
            found[3] = is_place(first).then_some((first as usize, 3));
        }
        if is_place(after) {
            found[2] = Some((after as usize, 0));
        }
        found
    }

    /// The numbers of the touches of a junction.
    pub(super) fn touches_of(&self, junction: usize) -> &[u32] {
        &self.by_junction[self.starts[junction] as usize..self.starts[junction + 1] as usize]
    }

    pub(super) fn crossing_count(&self) -> usize {
        self.crossings
    }

    pub(super) fn junction_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of unknowns: one for each crossing, two for each junction.
    pub(super) fn unknown_count(&self) -> usize {
        self.crossings + 2 * self.junction_count()
    }

    /// The first or only unknown of a place's crossing or of a junction.
    #[inline]
    pub(super) fn unknown(&self, point: u32) -> usize {
        if point & JUNCTION == 0 {
            point as usize / 2
        } else {
            self.crossings + 2 * (point & !JUNCTION) as usize
        }
    }
}
