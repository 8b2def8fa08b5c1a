//! The server of the test bed: a page for a browser on this machine, and sessions for the page.
//!
//! In: a [`Host`] that makes a [`Session`] for every page. Out: the page, its text messages handed to
//! the session, and what the session puts into its [`Outbox`], texts and [`Frame`]s. This module knows
//! the way there and who may go it; what messages mean is for the session to know.
//!
//! Only this machine is served, on 127.0.0.1, and only who knows the token in the address: `guard` looks
//! at every request. Files come and go through a folder that is removed in the end (`files`). At most
//! [`MOST_SESSIONS`] pages have a session at once (`socket`). `docs/test-bed.md` has the messages.

mod files;
mod frame;
mod guard;
mod outbox;
mod page;
mod socket;

use std::net::{Ipv4Addr, TcpListener};
use std::pin::pin;
use std::sync::Arc;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::middleware::from_fn_with_state;
use axum::routing::{get, post};
use futures_util::future::select;
use tokio::runtime;
use tokio::sync::Semaphore;

pub use files::{Files, Upload};
pub use frame::{Frame, Topology};
pub use outbox::{Closed, Outbox};

use crate::error::Error;
use guard::Guard;

/// Pages that have a session at the same time.
pub const MOST_SESSIONS: usize = 4;

/// Makes sessions.
pub trait Host: Send + Sync {
    /// The session of a new page, which speaks through the outbox.
    fn open(&self, out: Outbox, files: Files) -> Box<dyn Session>;
}

/// One page and what belongs to it. Dropped when the page goes: all its work must end then.
pub trait Session: Send {
    /// Takes a text message. Called while others wait, so what takes time is for a thread of its own.
    fn message(&self, text: &str);
}

/// A server that listens and does not answer yet.
pub struct Server {
    listener: TcpListener,
    guard: Guard,
    files: Files,
}

/// What the handlers share.
#[derive(Clone)]
struct Shared {
    guard: Arc<Guard>,
    files: Files,
    host: Arc<dyn Host>,
    places: Arc<Semaphore>,
}

impl Server {
    /// Listens on a port of this machine, or on any that is free for 0.
    ///
    /// # Errors
    /// [`Error::Serve`] when the port is taken, or there is no room for files or no randomness.
    pub fn bind(port: u16) -> Result<Self, Error> {
        let fail = |cause: std::io::Error| Error::Serve {
            what: format!("cannot listen on port {port} of this machine"),
            cause: cause.to_string(),
        };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(fail)?;
        let port = listener.local_addr().map_err(fail)?.port();
        Ok(Self { listener, guard: Guard::new(port)?, files: Files::new()? })
    }

    /// Where a browser finds the page, token included.
    pub fn address(&self) -> String {
        self.guard.address()
    }

    /// Serves until the process is told to stop by Ctrl-C or its like; all sessions have been dropped
    /// then, and the folder is gone.
    ///
    /// # Errors
    /// [`Error::Serve`] when the system does not let it.
    pub fn run(self, host: Arc<dyn Host>) -> Result<(), Error> {
        let fail = |cause: std::io::Error| Error::Serve {
            what: "cannot serve".into(),
            cause: cause.to_string(),
        };
        let runtime = runtime::Builder::new_current_thread().enable_all().build().map_err(fail)?;
        let files = self.files.clone();
        let shared = Shared {
            guard: Arc::new(self.guard),
            files: self.files,
            host,
            places: Arc::new(Semaphore::new(MOST_SESSIONS)),
        };
        let ended = runtime.block_on(async {
            self.listener.set_nonblocking(true).map_err(fail)?;
            let listener = tokio::net::TcpListener::from_std(self.listener).map_err(fail)?;
            let serving = pin!(async { axum::serve(listener, routes(shared)).await.map_err(fail) });
            match select(serving, pin!(stopped())).await {
                futures_util::future::Either::Left((ended, _)) => ended,
                futures_util::future::Either::Right(_) => Ok(()),
            }
        });
        // Sessions go with it.
        drop(runtime);
        files.remove();
        ended
    }
}

fn routes(shared: Shared) -> Router {
    Router::new()
        .route("/", get(page::index))
        .route("/assets/{name}", get(page::asset))
        .route("/ws", get(socket::open))
        .route("/upload", post(files::upload))
        .route("/download/{id}", get(files::download))
        .layer(from_fn_with_state(shared.clone(), guard::check))
        .layer(DefaultBodyLimit::disable())
        .with_state(shared)
}

/// Waits for Ctrl-C, or where there is one for the signal to end.
async fn stopped() {
    let interrupt = pin!(async {
        // Without the signal there is no such way to stop, and serving goes on.
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    });
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let terminate = pin!(async {
            match signal(SignalKind::terminate()) {
                Ok(mut signal) => drop(signal.recv().await),
                Err(_) => std::future::pending().await,
            }
        });
        select(interrupt, terminate).await;
    }
    #[cfg(not(unix))]
    interrupt.await;
}
