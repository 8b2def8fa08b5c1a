//! How many bytes a surface has when it is packed: found on a thread that nobody waits for.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use serde_json::json;
use shrouds::Shroud;
use shrouds_codec::geometry::{MAX_PLANES, PlaneEncoder};
use shrouds_codec::pack;

use super::control::Control;
use super::numbers::packing;
use super::page::Page;
use super::request::ViewNumber;
use super::surface::Surface;
use super::worker::{Ended, Worker};

/// For how many bits a vertex the size of a packed file is told.
const BITS: [usize; 5] = [0, 1, 2, 4, 8];

/// The way to the thread of a session that packs surfaces, one after the other. It ends when this is
/// dropped and the page is gone.
pub(super) struct Sizes(Sender<Job>);

/// A surface as it was when its sizes were asked for.
struct Job {
    surface: Arc<Surface>,
    shroud: Arc<Shroud>,
    control: Arc<Control>,
    /// See [`Control::begin_packing`].
    number: u64,
}

/// Why the other sizes are not told.
enum Stopped {
    /// Nobody wants them any more.
    Unwanted,
    Failed(shrouds_codec::Error),
}

impl<E: Into<shrouds_codec::Error>> From<E> for Stopped {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

impl Sizes {
    pub(super) fn new(page: Page) -> Self {
        let (jobs, waiting) = channel();
        thread::spawn(move || work(&page, &waiting));
        Self(jobs)
    }
}

impl Worker {
    /// Begins to find the sizes of a view; they come as events.
    pub(super) fn sizes(&self, id: u64, view: ViewNumber) -> Result<(), Ended> {
        let surface = self.surface(view)?.clone();
        let control = self.control(view).clone();
        let number = control.begin_packing();
        self.answer(id, &json!({}))?;
        let job = Job { shroud: surface.now(), surface, control, number };
        // Without its thread the session is over.
        self.sizes.0.send(job).map_err(|_| Ended::Closed)
    }
}

fn work(page: &Page, jobs: &Receiver<Job>) {
    while let Ok(job) = jobs.recv() {
        if let Err(Stopped::Failed(error)) = job.work(page) {
            page.warn(&format!("the surface cannot be packed: {error}"));
        }
    }
}

impl Job {
    /// Tells one size after the other, as long as they are those of the surface that is shown.
    fn work(&self, page: &Page) -> Result<(), Stopped> {
        self.go_on(page)?;
        let volume = &self.surface.source.occupancy;
        let settings = packing(&self.surface);
        let bare = pack(volume, &settings, io::sink())?.bytes;
        self.tell(page, 0, bare)?;
        let mut encoder = PlaneEncoder::new(&self.shroud.surface, &self.shroud.delta)?;
        for bits in 1..=MAX_PLANES {
            self.go_on(page)?;
            encoder.code_next();
            if BITS.contains(&bits) {
                self.tell(page, bits, bare + encoder.planes().bytes(volume.grid(), &settings)?)?;
            }
        }
        Ok(())
    }

    fn go_on(&self, page: &Page) -> Result<(), Stopped> {
        let is_wanted = self.control.is_packing(self.number) && !page.is_gone();
        if is_wanted { Ok(()) } else { Err(Stopped::Unwanted) }
    }

    fn tell(&self, page: &Page, bits: usize, bytes: u64) -> Result<(), Stopped> {
        self.go_on(page)?;
        let [view, revision] = self.surface.header();
        let share = bits as f64 / MAX_PLANES as f64;
        let size = json!({
            "view": view, "revision": revision, "bits": bits, "bytes": bytes, "share": share,
        });
        page.event("size", size).map_err(|_| Stopped::Unwanted)
    }
}
