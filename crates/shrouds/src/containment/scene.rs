//! All that is known before the first step.

use crate::containment::contact::Contact;
use crate::containment::sea::Sea;
use crate::containment::step::{Membership, Steps};
use crate::containment::track::{Array, Track};
use crate::error::Error;

/// A sea, an array on its way, what it hears, and how fast the target can be.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    sea: Sea,
    track: Track,
    contacts: Vec<Contact>,
    target_speed: f64,
}

impl Scene {
    /// A scene with a target that goes no faster than `target_speed`, in m/s.
    ///
    /// # Errors
    /// [`Error::Scene`] when the speed is negative or not finite; when contacts do not follow each other in
    /// time, lie beyond the track's times or have a bearing, half width or range that means nothing; when
    /// the array is not in the water at a contact, or farther from the lattice than that is wide.
    pub fn new(
        sea: Sea,
        track: Track,
        contacts: Vec<Contact>,
        target_speed: f64,
    ) -> Result<Self, Error> {
        if !(target_speed >= 0.0 && target_speed.is_finite()) {
            let problem = format!("its speed is {target_speed}: give 0 or more metres per second");
            return Err(Error::Scene { part: "the target".into(), problem });
        }
        let scene = Self { sea, track, contacts, target_speed };
        for n in 0..scene.contacts.len() {
            if let Some(problem) = scene.problem(n) {
                return Err(Error::Scene { part: format!("contact {}", n + 1), problem });
            }
        }
        Ok(scene)
    }

    /// The sea.
    pub fn sea(&self) -> &Sea {
        &self.sea
    }

    /// The way of the array.
    pub fn track(&self) -> &Track {
        &self.track
    }

    /// What was heard, in the order of time.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The target's greatest speed in m/s.
    pub fn target_speed(&self) -> f64 {
        self.target_speed
    }

    /// The regions after each contact, as lattice points count that `membership` says.
    pub fn steps(&self, membership: Membership) -> Steps<'_> {
        Steps::new(self, membership)
    }

    /// The array when contact `n` was heard; there always is one.
    pub(super) fn array(&self, n: usize) -> Option<Array> {
        self.track.at(self.contacts[n].time)
    }

    /// What is wrong with a contact, if anything.
    fn problem(&self, n: usize) -> Option<String> {
        let contact = &self.contacts[n];
        if let Some(problem) = contact.problem() {
            return Some(problem);
        }
        let time = contact.time;
        if n > 0 && time < self.contacts[n - 1].time {
            return Some(format!("its time, {time} s, is before that of the one above it"));
        }
        let Some(array) = self.array(n) else {
            return Some(format!("the platform has no position at {time} s: give it a waypoint"));
        };
        if !self.sea.is_near(array.position) {
            return Some(format!("at {time} s the array is too far away from the sea's lattice"));
        }
        let floor = self.sea.floor().depth(array.position);
        let in_water = array.depth >= 0.0 && array.depth < floor;
        (!in_water).then(|| {
            format!("at {time} s the array is {} m deep, but the sea floor {floor} m", array.depth)
        })
    }
}
