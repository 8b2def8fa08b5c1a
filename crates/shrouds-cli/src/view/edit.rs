//! Changes of a volume by hand, and the way back.

/// What was changed, and what was taken back.
#[derive(Default)]
pub(super) struct Edits {}

impl Edits {
    pub(super) fn can_undo(&self) -> bool {
        false
    }

    pub(super) fn can_redo(&self) -> bool {
        false
    }
}
