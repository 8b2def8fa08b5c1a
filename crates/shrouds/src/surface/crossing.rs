//! A grid edge that the surface crosses.

/// A grid edge with one end inside and one end outside, packed into 64 bits.
///
/// The edge runs from its *low* lattice point one step along its axis to its *high* one.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Crossing(u64);

const FIELD: u32 = 20;
const MASK: u64 = (1 << FIELD) - 1;

impl Crossing {
    pub(super) fn new(low: [usize; 3], axis: usize, inside_low: bool) -> Self {
        let [i, j, k] = low.map(|x| x as u64);
        Self(
            i | j << FIELD
                | k << (2 * FIELD)
                | (axis as u64) << (3 * FIELD)
                | u64::from(inside_low) << (3 * FIELD + 2),
        )
    }

    /// The crossing `steps` further along x, with this bit for whether its low end is inside. This one
    /// begins its row and has its low end outside.
    #[inline]
    pub(super) fn along_row(self, steps: u64, inside_low: u64) -> Self {
        Self(self.0 | steps | inside_low << (3 * FIELD + 2))
    }

    /// The same crossing on a lattice that begins `first` points earlier along x, y, z.
    pub(crate) fn moved(self, first: [usize; 3]) -> Self {
        let low = self.low();
        let low = [0, 1, 2].map(|k| low[k] + first[k]);
        Self::new(low, self.axis(), self.inside_low())
    }

    /// Index `[i, j, k]` of the edge's low end in the surface's grid.
    #[inline]
    pub fn low(self) -> [usize; 3] {
        [0, FIELD, 2 * FIELD].map(|shift| (self.0 >> shift & MASK) as usize)
    }

    /// The axis the edge runs along: 0, 1 or 2.
    #[inline]
    pub fn axis(self) -> usize {
        (self.0 >> (3 * FIELD) & 3) as usize
    }

    /// Whether the low end is the inside one.
    #[inline]
    pub fn inside_low(self) -> bool {
        self.0 >> (3 * FIELD + 2) & 1 == 1
    }

    /// Index of the edge's inside end.
    pub fn inside(self) -> [usize; 3] {
        self.end(!self.inside_low())
    }

    /// Index of the edge's outside end.
    pub fn outside(self) -> [usize; 3] {
        self.end(self.inside_low())
    }

    fn end(self, high: bool) -> [usize; 3] {
        let mut point = self.low();
        point[self.axis()] += usize::from(high);
        point
    }

    /// Distance from the low end, in edge lengths, of the vertex with this δ (equation 3).
    #[inline]
    pub fn from_low(self, delta: f64) -> f64 {
        if self.inside_low() { 1.0 - delta } else { delta }
    }

    /// Index coordinates of the vertex with this δ (equation 3): 1 puts it at the inside end, 0 at
    /// the outside end.
    #[inline]
    pub fn position(self, delta: f64) -> [f64; 3] {
        let mut point = self.low().map(|x| x as f64);
        point[self.axis()] += self.from_low(delta);
        point
    }
}

impl std::fmt::Debug for Crossing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Crossing({:?} in, {:?} out)", self.inside(), self.outside())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_keeps_every_field() {
        for axis in 0..3 {
            for inside_low in [false, true] {
                let low = [(1 << 20) - 1, 0, 123_456];
                let crossing = Crossing::new(low, axis, inside_low);
                assert_eq!(
                    (crossing.low(), crossing.axis(), crossing.inside_low()),
                    (low, axis, inside_low)
                );
                assert_eq!(crossing.position(1.0), crossing.inside().map(|x| x as f64));
                assert_eq!(crossing.position(0.0), crossing.outside().map(|x| x as f64));
            }
        }
    }
}
