//! Where a contact can come from.

use crate::containment::contact::Heard;
use crate::containment::fan::Fan;
use crate::containment::sea::Sea;
use crate::containment::step::Membership;
use crate::containment::straight;
use crate::containment::stretches::{Column, Columns};
use crate::error::Error;
use crate::volume::{Occupancy, Operation};

/// The lattice points of a volume of the sea that a contact can have come from; or in whose cells there
/// is a place that it can have come from.
///
/// # Errors
/// [`Error::DifferentLattices`] when the volume is not on the lattice of the sea.
pub(super) fn intersect(
    volume: &Occupancy,
    sea: &Sea,
    heard: &Heard,
    membership: Membership,
) -> Result<Occupancy, Error> {
    let Some([xs, ys, _]) = volume.bounding_box() else { return Ok(volume.clone()) };
    let part = [xs, ys];
    let columns = Columns::of(sea.grid(), part, membership);
    let [least, most] = heard.range.map(|range| range * range);
    let in_range = |column: &Column| {
        let [near, far] = column.squares(heard.array.position);
        far >= least && near <= most
    };
    let annulus = match sea.plain() {
        Some(floor) => columns.volume(|column, found| {
            if in_range(column) {
                straight::hear(heard, floor, column, found);
            }
        }),
        None => {
            let fan = Fan::new(heard, sea, columns.area());
            columns.volume(|column, found| {
                if in_range(column) {
                    fan.hear(column, found);
                }
            })
        }
    };
    volume.combine(Operation::Intersect, &annulus)
}
