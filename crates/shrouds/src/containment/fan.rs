//! Annuli where sound bends or the floor is not level: rays traced from the array.
//!
//! The horizon around the array is divided into sectors, at most one horizontal spacing wide where
//! they are widest, and into steps of one such spacing outwards. In the vertical plane at each
//! border of a sector a bundle of rays leaves the array at the angles of the contact. Between two neighbouring rays
//! of a bundle and their like in the next plane lies a beam; in each step it is taken to fill all depths
//! between the least and the greatest that one of the four rays passes. So an annulus is too large by up to
//! about a spacing, and it is not too small where depths change from ray to ray in one direction. Sectors, steps
//! and rays depend on the contact and the sea alone, not on the region.
//!
//! Planes are independent of each other: of a floor that slopes across a plane only the depth counts.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;

use crate::containment::contact::{Heard, Path};
use crate::containment::ray::Section;
use crate::containment::sea::Sea;
use crate::containment::stretches::{Column, Stretches};
use crate::parallel;
use crate::vector::{dot, subtract};

/// Sectors beside each other whose planes have equally many rays.
const SECTORS: usize = 8;
/// Most sectors around the array.
const MOST_SECTORS: usize = 16384;
/// Most rays of a bundle above the horizon, and below it.
const MOST_RAYS: f64 = 400.0;
/// Most steps of all rays of a bundle, which bounds memory.
const MOST_PASSES: f64 = 4e6;
/// The steepest rays, this much less than a right angle.
const ZENITH: f64 = 1e-4;
/// A range that holds nothing.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// The depths from which a contact can come, by sector and step.
pub(super) struct Fan {
    axis: [f64; 2],
    position: [f64; 2],
    step: f64,
    sectors: Vec<Sector>,
}

/// The stretches of depth of one sector, step after step.
#[derive(Debug, Clone, Default)]
struct Sector {
    /// Where in the list those of each step end.
    ends: Vec<usize>,
    stretches: Vec<[f64; 2]>,
}

/// The rays of a vertical plane.
struct Plane {
    /// For every step the depths that each ray passes in it.
    reach: Vec<[f64; 2]>,
    /// Whether the contact can come from this plane.
    is_heard: bool,
}

/// What all planes share.
struct Tracer<'a> {
    heard: &'a Heard,
    sea: &'a Sea,
    step: f64,
    /// Steps that rays are traced through, and how many of them come before all columns that are asked for.
    steps: usize,
    before: usize,
    /// Horizontal distance to the farthest place of the sea.
    farthest: f64,
    /// Angle of a sector.
    width: f64,
}

impl Fan {
    /// The rays of a contact as far as columns within `area` need them, of which the smallest and the largest x
    /// and y are given.
    pub(super) fn new(heard: &Heard, sea: &Sea, area: [[f64; 2]; 2]) -> Self {
        let far = |area: [[f64; 2]; 2]| {
            let [_, square] = Column { area }.squares(heard.array.position);
            square.sqrt().min(heard.range[1])
        };
        let (step, farthest) = (sea.horizontal_spacing(), far(sea.area()));
        let blocks = 2.0 * PI * farthest / step / SECTORS as f64;
        let count = SECTORS * (blocks.ceil() as usize).clamp(2, MOST_SECTORS / SECTORS);
        let mut fan = Self {
            axis: heard.array.axis,
            position: heard.array.position,
            step,
            sectors: vec![Sector::default(); count],
        };
        let steps = (far(area) / step) as usize + 1;
        let [near, _] = Column { area }.squares(heard.array.position);
        // One less: rounding must not put a column before it.
        let before = ((near.sqrt() / step) as usize).saturating_sub(1);
        let width = 2.0 * PI / count as f64;
        let tracer = Tracer { heard, sea, step, steps, before, farthest, width };
        let needed = fan.sectors_of(&Column { area });
        let needed = needed.start / SECTORS..needed.end.div_ceil(SECTORS);
        let found = parallel::blocks(needed.len(), 1, |block| {
            let first = (needed.start + block.start) * SECTORS;
            tracer.sectors(first..first + SECTORS)
        });
        for (n, sector) in (needed.start * SECTORS..).zip(found.into_iter().flatten()) {
            fan.sectors[n % count] = sector;
        }
        fan
    }

    /// Adds the depths of a column from which the contact can come.
    pub(super) fn hear(&self, column: &Column, found: &mut Stretches) {
        let [least, most] =
            column.squares(self.position).map(|square| (square.sqrt() / self.step) as usize);
        for sector in self.sectors_of(column) {
            let sector = &self.sectors[sector % self.sectors.len()];
            for step in least..=most {
                found.extend(sector.at(step));
            }
        }
    }

    /// The sectors that a column reaches into, modulo their number.
    fn sectors_of(&self, column: &Column) -> Range<usize> {
        let count = self.sectors.len();
        let [low, high] = column.area.map(|corner| subtract(corner, self.position));
        if (0..2).all(|d| low[d] <= 0.0 && high[d] >= 0.0) {
            return 0..count;
        }
        let across = [-self.axis[1], self.axis[0]];
        let angle = |corner: [f64; 2]| dot(corner, across).atan2(dot(corner, self.axis));
        let middle = angle([0, 1].map(|d| (low[d] + high[d]) / 2.0));
        let turns = [low, [high[0], low[1]], [low[0], high[1]], high].map(|corner| {
            let turn = angle(corner) - middle;
            turn - 2.0 * PI * (turn / (2.0 * PI)).round()
        });
        // Seen from outside a rectangle covers less than half of the horizon.
        let sector = |turn: f64| ((middle + turn + 3.0 * PI) / (2.0 * PI) * count as f64) as usize;
        let first = sector(turns.into_iter().fold(0.0, f64::min));
        first..sector(turns.into_iter().fold(0.0, f64::max)) + 1
    }
}

impl Sector {
    fn at(&self, step: usize) -> &[[f64; 2]] {
        let Some(&end) = self.ends.get(step) else { return &[] };
        let start = if step > 0 { self.ends[step - 1] } else { 0 };
        &self.stretches[start..end]
    }
}

impl Tracer<'_> {
    /// Some sectors beside each other.
    fn sectors(&self, range: Range<usize>) -> Vec<Sector> {
        let spread = range.clone().chain([range.end]).map(|n| {
            let ([near, steep], _) = self.angles(n);
            steep - near
        });
        let wanted = spread.fold(0.0, f64::max) * self.farthest / self.step;
        let most = MOST_RAYS.min((MOST_PASSES * self.step / self.farthest).ceil());
        let rays = wanted.ceil().min(most).max(2.0) as usize + 1;
        let mut left = self.plane(range.start, rays);
        let beside = range.map(|n| {
            let right = self.plane(n + 1, rays);
            let sector = self.between(&left, &right);
            left = right;
            sector
        });
        beside.collect()
    }

    /// The least and the greatest angle to the horizon of the directions in plane `n` that agree with the
    /// bearing, and whether there are any.
    fn angles(&self, n: usize) -> ([f64; 2], bool) {
        let along = (self.width * n as f64 - PI).cos();
        let [low, high] = self.heard.cosines;
        // Along the axis lies the cosine of the angle to the horizon, times this.
        let cosines = match along {
            _ if along > 1e-12 => [low / along, high / along],
            _ if along < -1e-12 => [high / along, low / along],
            _ if low <= 0.0 && high >= 0.0 => [0.0, 1.0],
            _ => [2.0, 2.0],
        };
        let angle = |cosine: f64| cosine.clamp(0.0, 1.0).acos().min(FRAC_PI_2 - ZENITH);
        ([angle(cosines[1]), angle(cosines[0])], cosines[0] <= 1.0 && cosines[1] >= 0.0)
    }

    /// Traces the rays of plane `n`: so many below the horizon, then as many above it.
    fn plane(&self, n: usize, rays: usize) -> Plane {
        let Heard { array, path, .. } = *self.heard;
        let ([near, steep], is_heard) = self.angles(n);
        let mut reach = vec![NOTHING; 2 * rays * self.steps];
        let (sin, cos) = (self.width * n as f64 - PI).sin_cos();
        let [x, y] = array.axis;
        let ahead = [x * cos - y * sin, x * sin + y * cos];
        let floor = self.sea.floor();
        let section = Section::new(self.step, self.steps, |r| {
            floor.depth([0, 1].map(|d| array.position[d] + r * ahead[d]))
        });
        // Straight rays that go up never come to the floor.
        let upwards = path != Path::Bounce || !self.sea.sound().is_constant();
        let count = if upwards { 2 * rays } else { rays };
        for m in 0..count {
            let angle = near + (steep - near) * (m % rays) as f64 / (rays - 1) as f64;
            let sine = if m < rays { angle.sin() } else { -angle.sin() };
            let reach = reach[m..].iter_mut().step_by(2 * rays);
            section.trace(self.sea.sound(), array.depth, sine, path, reach);
        }
        Plane { reach, is_heard }
    }

    /// The depths of a beam in a step, between the rays that pass these. Where one of them has ended or not begun, rays between
    /// them may pass beyond the others, but no farther than rays are apart.
    fn beam<'r>(&self, step: usize, rays: impl Iterator<Item = &'r [f64; 2]>) -> [f64; 2] {
        // Rays are a step apart at the farthest place.
        let apart = (step + 1) as f64 * self.step * self.step / self.farthest;
        let (mut all, mut more) = (NOTHING, 0.0);
        for [least, most] in rays {
            all = [all[0].min(*least), all[1].max(*most)];
            more = if least > most { apart } else { more };
        }
        [all[0] - more, all[1] + more]
    }

    /// The sector between two planes.
    fn between(&self, left: &Plane, right: &Plane) -> Sector {
        let mut sector = Sector::default();
        if !left.is_heard && !right.is_heard {
            return sector;
        }
        let rays = left.reach.len() / self.steps / 2;
        let mut found = Stretches::default();
        let steps = left.reach.chunks_exact(2 * rays).zip(right.reach.chunks_exact(2 * rays));
        sector.ends.resize(self.before.min(self.steps), 0);
        for (step, (left, right)) in steps.enumerate().skip(self.before) {
            found.clear();
            // Beams below the horizon, then those above it.
            for side in [0..rays, rays..2 * rays] {
                let (left, right) = (left[side.clone()].windows(2), right[side].windows(2));
                for (left, right) in left.zip(right) {
                    found.add(self.beam(step, left.iter().chain(right)));
                }
            }
            sector.stretches.extend_from_slice(found.merged());
            sector.ends.push(sector.stretches.len());
        }
        sector
    }
}
