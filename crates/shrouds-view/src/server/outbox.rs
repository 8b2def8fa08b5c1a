//! What a session says to its page.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes};
use futures_util::stream::{Stream, select, unfold};
use tokio::sync::mpsc::{Receiver, Sender, channel};

use super::frame::Frame;

/// Messages that wait for the page; who has more to say waits, too.
const WAITING: usize = 32;
/// Short answers that wait for the page, beside those; a page with more of them does not listen.
const ANSWERS: usize = 1024;

/// The page is gone, or does not listen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the page is gone")]
pub struct Closed;

/// The way to the page. Messages arrive in the order in which they are sent, but for short answers, which
/// overtake the others.
#[derive(Clone)]
pub struct Outbox {
    messages: Sender<Message>,
    answers: Sender<Message>,
    is_deaf: Arc<AtomicBool>,
}

impl Outbox {
    /// An outbox and what comes out of it.
    pub(super) fn new() -> (Self, impl Stream<Item = Message>) {
        let (messages, of_messages) = channel(WAITING);
        let (answers, of_answers) = channel(ANSWERS);
        let out = select(stream(of_answers), stream(of_messages));
        (Self { messages, answers, is_deaf: Arc::default() }, out)
    }

    /// Sends a text, once there is room. Not for [`Session::message`](super::Session::message).
    ///
    /// # Errors
    /// [`Closed`] when the page is gone.
    pub fn text(&self, text: String) -> Result<(), Closed> {
        self.messages.blocking_send(Message::Text(Utf8Bytes::from(text))).map_err(|_| Closed)
    }

    /// Sends a short answer without waiting. A page that leaves a thousand of them is taken for gone.
    pub fn answer(&self, text: String) {
        if self.answers.try_send(Message::Text(Utf8Bytes::from(text))).is_err() {
            self.is_deaf.store(true, Ordering::Relaxed);
        }
    }

    /// Sends a frame, once there is room. Not for [`Session::message`](super::Session::message).
    ///
    /// # Errors
    /// [`Closed`] when the page is gone.
    pub fn frame(&self, frame: Frame) -> Result<(), Closed> {
        let bytes = Bytes::from(frame.into_bytes());
        self.messages.blocking_send(Message::Binary(bytes)).map_err(|_| Closed)
    }

    /// Sends a frame at once, or not at all.
    ///
    /// # Errors
    /// [`Closed`] when the page is gone or other messages wait.
    pub fn frame_at_once(&self, frame: Frame) -> Result<(), Closed> {
        let bytes = Bytes::from(frame.into_bytes());
        self.messages.try_send(Message::Binary(bytes)).map_err(|_| Closed)
    }

    /// Whether the page is gone.
    pub fn is_closed(&self) -> bool {
        self.messages.is_closed() || self.is_deaf.load(Ordering::Relaxed)
    }
}

fn stream(receiver: Receiver<Message>) -> impl Stream<Item = Message> {
    let next = |mut receiver: Receiver<Message>| async {
        receiver.recv().await.map(|message| (message, receiver))
    };
    Box::pin(unfold(receiver, next))
}
