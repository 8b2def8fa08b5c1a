//! Whom the server lets in, and what it survives.

use serde_json::json;

use super::client::Bed;
use crate::common::Folder;

#[test]
fn the_page_needs_token_host_and_origin() {
    let bed = Bed::start(&Folder::new(), "");
    let index = bed.request("GET /", &[]);
    assert_eq!(index.status, 200);
    assert!(index.body.starts_with(b"<!doctype html>"));
    let cookie = format!("shrouds-{}={}; HttpOnly; SameSite=Strict", bed.port, bed.token);
    assert!(index.head.to_lowercase().contains("content-security-policy: default-src 'self'"));
    assert!(index.head.contains(&cookie), "{}", index.head);
    let host = format!("Host: 127.0.0.1:{}", bed.port);
    let with_cookie = format!("GET /assets/page.js HTTP/1.1\r\n{host}\r\nCookie: {cookie}");
    assert_eq!(bed.http(&with_cookie, &[]).status, 200);
    assert_eq!(bed.http(&format!("GET / HTTP/1.1\r\n{host}"), &[]).status, 403);
    assert_eq!(bed.http(&format!("GET /ws HTTP/1.1\r\n{host}"), &[]).status, 403);
    let elsewhere = format!("GET /?token={} HTTP/1.1\r\nHost: evil.example", bed.token);
    assert_eq!(bed.http(&elsewhere, &[]).status, 421);
    assert_eq!(bed.request("GET /assets/../../Cargo.toml", &[]).status, 404);
    assert_eq!(bed.request("GET /download/0", &[]).status, 404);
    assert!(bed.try_page(&[("origin", "http://evil.example")]).is_err());
    assert!(bed.try_page(&[("host", "evil.example")]).is_err());
    let ours = format!("http://127.0.0.1:{}", bed.port);
    assert!(bed.try_page(&[("origin", &ours)]).is_ok());
}

#[test]
fn four_pages_at_once() {
    let bed = Bed::start(&Folder::new(), "");
    let mut pages: Vec<_> = (0..4).map(|_| bed.page()).collect();
    for page in &mut pages {
        page.ask(json!({ "do": "hello" }));
    }
    assert!(bed.page().next().is_none(), "the fifth is closed");
    drop(pages.pop());
    // The place is free once the server has seen that.
    let goes_on = (0..200).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(20));
        let mut page = bed.page();
        page.say(json!({ "do": "hello" }));
        page.next().is_some()
    });
    assert!(goes_on);
}
