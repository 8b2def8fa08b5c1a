//! The page, which is part of the program.

use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_TYPE, SET_COOKIE};
use axum::response::{IntoResponse, Response};

use super::Shared;

const INDEX: &[u8] = include_bytes!("../../web/dist/index.html");
const SCRIPT: &[u8] = include_bytes!("../../web/dist/assets/page.js");
const STYLE: &[u8] = include_bytes!("../../web/dist/assets/page.css");

/// The page itself; what it asks for next has the cookie.
pub(super) async fn index(State(shared): State<Shared>) -> Response {
    let headers = [
        (CONTENT_TYPE, "text/html; charset=utf-8".to_owned()),
        (SET_COOKIE, shared.guard.cookie()),
    ];
    (headers, INDEX).into_response()
}

pub(super) async fn asset(Path(name): Path<String>) -> Response {
    let (kind, bytes) = match name.as_str() {
        "page.js" => ("text/javascript; charset=utf-8", SCRIPT),
        "page.css" => ("text/css; charset=utf-8", STYLE),
        _ => return (StatusCode::NOT_FOUND, "there is no such file").into_response(),
    };
    ([(CONTENT_TYPE, kind)], bytes).into_response()
}
