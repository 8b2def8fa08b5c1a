//! The sockets of pages: text in, text and frames out.

use std::pin::pin;

use axum::extract::State;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade, close_code};
use axum::response::Response;
use futures_util::{SinkExt, StreamExt};

use super::{MOST_SESSIONS, Outbox, Shared};

/// Longest message of a page, in bytes.
const LONGEST: usize = 1 << 20;

pub(super) async fn open(State(shared): State<Shared>, upgrade: WebSocketUpgrade) -> Response {
    let upgrade = upgrade.max_message_size(LONGEST).max_frame_size(LONGEST);
    upgrade.on_upgrade(move |socket| async move {
        match shared.places.clone().try_acquire_owned() {
            Ok(_place) => converse(socket, &shared).await,
            Err(_) => refuse(socket).await,
        }
    })
}

/// Hands messages over in both directions until the page goes or breaks the rules.
async fn converse(socket: WebSocket, shared: &Shared) {
    let (mut to_page, mut from_page) = socket.split();
    let (out, messages) = Outbox::new();
    let session = shared.host.open(out.clone(), shared.files.clone());
    let writer = tokio::spawn(async move {
        let mut messages = pin!(messages);
        while let Some(message) = messages.next().await {
            if to_page.send(message).await.is_err() {
                break;
            }
        }
    });
    while let Some(Ok(message)) = from_page.next().await {
        match message {
            Message::Text(text) => session.message(&text),
            Message::Binary(_) => session.message(""),
            Message::Close(_) => break,
            Message::Ping(_) | Message::Pong(_) => {}
        }
        if out.is_closed() {
            break;
        }
    }
    // With its receiver goes the session's way to say anything, and whoever waits there goes on.
    writer.abort();
    drop(session);
}

async fn refuse(mut socket: WebSocket) {
    let reason = format!("{MOST_SESSIONS} pages are open already; close one of them");
    let frame = CloseFrame { code: close_code::AGAIN, reason: reason.into() };
    // If the page does not hear it there is nobody to tell.
    let _ = socket.send(Message::Close(Some(frame))).await;
}
