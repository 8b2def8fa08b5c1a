//! From segments on lattice faces to curves.

use crate::gather::Indices;
use crate::network::{Network, REPEATED, Step};
use crate::parallel;
use crate::surface::{Crossing, Surface};
use crate::volume::Border;

/// Marks the end of a curve, or a place already walked over.
const NONE: u32 = u32::MAX;

impl Network {
    /// Joins the segments of the surface on the lattice faces to planar curves.
    pub fn trace(surface: &Surface) -> Self {
        let has_ends = surface.border() == Border::Open;
        let families = parallel::blocks(3, 1, |family| {
            Family::trace(&mut Links::find(surface, family.start), has_ends)
        });
        Self::join(families, surface.vertex_count(), 0)
    }

    /// Joins what follows each vertex in the planes normal to x, y and z to curves, some of which have
    /// ends. Behind the vertices on curves there are some more that lie on none.
    pub(crate) fn of_links(mut links: Vec<Links>, alone: usize) -> Self {
        let count = links[0].next.len();
        let families = parallel::pieces(&mut links, 1..=3, |_, links| {
            links.iter_mut().map(|links| Family::trace(links, true)).collect::<Vec<_>>()
        });
        Self::join(families.into_iter().flatten().collect(), count, alone)
    }

    /// Stores the curves of all families one after another.
    fn join(mut families: Vec<Family>, count: usize, alone: usize) -> Self {
        if alone > 0 {
            families.push(Family::of_one(count as u32));
        }
        let sum = |count: fn(&Family) -> usize| families.iter().map(count).sum::<usize>();
        let mut vertices = Vec::with_capacity(sum(|f| f.vertices.len()));
        let mut steps = Vec::with_capacity(vertices.capacity());
        let mut starts = Vec::with_capacity(sum(|f| f.starts.len()) + 1);
        let mut places = vec![[0; 2]; count + alone.min(1)];
        for family in &mut families {
            let before = vertices.len() as u32;
            starts.extend(family.starts.iter().map(|start| before + start));
            vertices.append(&mut family.vertices);
            steps.append(&mut family.steps);
            *family = Family::default();
        }
        starts.push((vertices.len() + REPEATED) as u32);
        for curve in starts.windows(2) {
            for place in curve[0] as usize..curve[1] as usize - 2 * REPEATED {
                let [v]: [u32; 1] = vertices[place];
                places[v as usize][steps[place].curve()] = place as u32;
            }
        }
        // What lies on no curve shares the place of one that is a curve by itself.
        let last = vertices.len().saturating_sub(REPEATED + 1) as u32;
        places.truncate(count);
        places.resize(count + alone, [last; 2]);
        let places = Indices::new(places, vertices.len());
        Self { vertices: Indices::new(vertices, count + alone), steps, places, starts }
    }
}

/// The curves in all planes normal to one axis.
#[derive(Default)]
struct Family {
    vertices: Vec<[u32; 1]>,
    steps: Vec<Step>,
    starts: Vec<u32>,
}

/// Where the curves of a family go from every vertex.
pub(crate) struct Links {
    next: Vec<u32>,
    steps: Vec<Step>,
}

impl Family {
    fn trace(links: &mut Links, has_ends: bool) -> Self {
        // Room for every vertex: memory that is not touched costs nothing.
        let count = links.next.len();
        let mut family = Self {
            vertices: Vec::with_capacity(count),
            steps: Vec::with_capacity(count),
            starts: Vec::new(),
        };
        if has_ends {
            for start in links.open_ends() {
                family.walk(links, start);
            }
        }
        for start in 0..links.next.len() as u32 {
            if links.next[start as usize] != NONE {
                family.walk(links, start);
            }
        }
        family
    }

    /// A single vertex that nothing follows.
    fn of_one(vertex: u32) -> Self {
        let count = 2 * REPEATED + 1;
        let steps = vec![Step::alone(0, false); count];
        Self { vertices: vec![[vertex]; count], steps, starts: vec![REPEATED as u32] }
    }

    /// Appends the curve from a vertex on and cuts the links it follows.
    fn walk(&mut self, links: &mut Links, start: u32) {
        let first = self.vertices.len() + REPEATED;
        self.vertices.extend([[start]; REPEATED]);
        self.steps.extend([links.steps[start as usize].unlinked(); REPEATED]);
        self.starts.push(first as u32);
        let mut here = start;
        loop {
            let next = std::mem::replace(&mut links.next[here as usize], NONE);
            let step = links.steps[here as usize];
            self.vertices.push([here]);
            self.steps.push(step);
            if next == NONE || next == start {
                break;
            }
            here = next;
        }
        self.repeat_ends(first);
    }

    /// Fills the places before and after the curve that starts at `first`.
    fn repeat_ends(&mut self, first: usize) {
        let end = self.vertices.len();
        let closed = self.steps[end - 1].is_linked();
        for n in 0..REPEATED {
            let place = if closed { first + n } else { end - 1 };
            self.vertices.push(self.vertices[place]);
            self.steps.push(self.steps[place]);
            if closed {
                let place = end - REPEATED + n;
                self.vertices[first - REPEATED + n] = self.vertices[place];
                self.steps[first - REPEATED + n] = self.steps[place];
            }
        }
    }
}

impl Links {
    /// Of crossings that nothing follows in the planes normal to an axis.
    pub(crate) fn none(crossings: &[Crossing], normal: usize) -> Self {
        let step = |crossing: &Crossing| match crossing.axis() {
            axis if axis == normal => Step::default(),
            axis => Step::last(normal, axis == (normal + 2) % 3),
        };
        Self { next: vec![NONE; crossings.len()], steps: crossings.iter().map(step).collect() }
    }

    /// Lets a vertex follow another one, whose place goes on by this step.
    pub(crate) fn join(&mut self, [from, to]: [u32; 2], step: Step) {
        self.next[from as usize] = to;
        self.steps[from as usize] = step;
    }

    fn find(surface: &Surface, normal: usize) -> Self {
        let count = surface.vertex_count();
        let mut links = Self { next: vec![NONE; count], steps: vec![Step::default(); count] };
        if surface.slice_count() == 1 && normal != 2 {
            // No curve leads across an image: every vertex is one by itself.
            for (step, crossing) in links.steps.iter_mut().zip(surface.crossings()) {
                if crossing.axis() != normal {
                    *step = Step::alone(normal, crossing.axis() == (normal + 2) % 3);
                }
            }
        }
        for k in 0..surface.slice_count() {
            surface.for_each_segment(normal, k, |segment| {
                let [from, to] = segment.vertices;
                let [here, there] = segment.run_second();
                links.next[from as usize] = to;
                links.steps[from as usize] = Step::new(normal, here, segment.shift());
                if links.next[to as usize] == NONE {
                    links.steps[to as usize] = Step::last(normal, there);
                }
            });
        }
        links
    }

    /// The vertices on curves that no curve leads to.
    fn open_ends(&self) -> Vec<u32> {
        let mut reached = vec![false; self.next.len()];
        for &next in self.next.iter().filter(|&&next| next != NONE) {
            reached[next as usize] = true;
        }
        let is_on_curve = |v: u32| self.steps[v as usize] != Step::default();
        let is_end = |&v: &u32| is_on_curve(v) && !reached[v as usize];
        (0..self.next.len() as u32).filter(is_end).collect()
    }
}
