//! Counted findings with the first few as examples.

/// How many of something were found, and the first few of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found<T> {
    /// How many there are.
    pub count: u64,
    /// The smallest of them in ascending order, at most [`Found::<T>::SHOWN`].
    pub first: Vec<T>,
}

impl<T> Default for Found<T> {
    fn default() -> Self {
        Self { count: 0, first: Vec::new() }
    }
}

impl<T> Found<T> {
    /// The largest number of examples kept.
    pub const SHOWN: usize = 8;

    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

impl<T: Ord> Found<T> {
    pub(crate) fn push(&mut self, item: T) {
        self.count += 1;
        self.keep(item);
    }

    /// All findings of several blocks as one.
    pub(crate) fn gather(blocks: impl IntoIterator<Item = Self>) -> Self {
        let mut all = Self::default();
        for block in blocks {
            all.count += block.count;
            block.first.into_iter().for_each(|item| all.keep(item));
        }
        all
    }

    fn keep(&mut self, item: T) {
        if self.first.len() == Self::SHOWN && self.first.last().is_some_and(|last| item >= *last) {
            return;
        }
        let place = self.first.partition_point(|other| *other < item);
        self.first.insert(place, item);
        self.first.truncate(Self::SHOWN);
    }
}
