//! What a session says to its page.

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes};
use tokio::sync::mpsc::{Receiver, Sender, channel};

use super::frame::Frame;

/// Messages that wait for the page; who has more to say waits, too.
const WAITING: usize = 32;

/// The page is gone, or does not listen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the page is gone")]
pub struct Closed;

/// The way to the page. Messages arrive in the order in which they are sent.
#[derive(Clone)]
pub struct Outbox(Sender<Message>);

impl Outbox {
    /// An outbox and what comes out of it.
    pub(super) fn new() -> (Self, Receiver<Message>) {
        let (sender, receiver) = channel(WAITING);
        (Self(sender), receiver)
    }

    /// Sends a text, once there is room. Not for [`Session::message`](super::Session::message).
    ///
    /// # Errors
    /// [`Closed`] when the page is gone.
    pub fn text(&self, text: String) -> Result<(), Closed> {
        self.0.blocking_send(Message::Text(Utf8Bytes::from(text))).map_err(|_| Closed)
    }

    /// Sends a text at once, or not at all.
    ///
    /// # Errors
    /// [`Closed`] when the page is gone or does not listen.
    pub fn text_at_once(&self, text: String) -> Result<(), Closed> {
        self.0.try_send(Message::Text(Utf8Bytes::from(text))).map_err(|_| Closed)
    }

    /// Sends a frame, once there is room. Not for [`Session::message`](super::Session::message).
    ///
    /// # Errors
    /// [`Closed`] when the page is gone.
    pub fn frame(&self, frame: Frame) -> Result<(), Closed> {
        let bytes = Bytes::from(frame.into_bytes());
        self.0.blocking_send(Message::Binary(bytes)).map_err(|_| Closed)
    }

    /// Sends a frame at once, or not at all.
    ///
    /// # Errors
    /// [`Closed`] when the page is gone or does not listen.
    pub fn frame_at_once(&self, frame: Frame) -> Result<(), Closed> {
        self.0.try_send(Message::Binary(Bytes::from(frame.into_bytes()))).map_err(|_| Closed)
    }

    /// Whether the page is gone.
    pub fn is_closed(&self) -> bool {
        self.0.is_closed()
    }
}
