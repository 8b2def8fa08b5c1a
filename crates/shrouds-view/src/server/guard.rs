//! Who is let in: requests for this machine by its own name, from the page itself, with the token.

use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, COOKIE, HOST, ORIGIN, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::Shared;
use crate::error::Error;

/// What a page from here may do: nothing comes from elsewhere, and nobody frames it.
const POLICY: &str = "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; \
    connect-src 'self' ws:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// What a request must have.
pub(super) struct Guard {
    port: u16,
    /// 128 random bits in hexadecimal digits.
    token: String,
}

impl Guard {
    pub(super) fn new(port: u16) -> Result<Self, Error> {
        Ok(Self { port, token: random()? })
    }

    pub(super) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    /// The cookie that stands for the token. Cookies do not heed ports, so its name has ours.
    pub(super) fn cookie(&self) -> String {
        format!("{}={}; HttpOnly; SameSite=Strict; Path=/", self.cookie_name(), self.token)
    }

    fn cookie_name(&self) -> String {
        format!("shrouds-{}", self.port)
    }

    /// Why a request is not let in.
    fn refusal(&self, headers: &HeaderMap, uri: &Uri) -> Option<(StatusCode, &'static str)> {
        let text = |name| headers.get(name).map(|value: &HeaderValue| value.to_str().unwrap_or(""));
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let Some(host) = text(HOST).filter(|host| hosts.iter().any(|known| known == host)) else {
            return Some((StatusCode::MISDIRECTED_REQUEST, "this is not the host you asked for"));
        };
        if text(ORIGIN).is_some_and(|origin| origin != format!("http://{host}")) {
            return Some((StatusCode::FORBIDDEN, "pages from elsewhere are not served"));
        }
        let given = query(uri, "token");
        let knows = match &given {
            Some(token) => self.is_token(token),
            None => headers.get_all(COOKIE).iter().any(|value| self.is_cookie(value)),
        };
        let advice = "the token is missing or wrong; use the address that the program printed";
        (!knows).then_some((StatusCode::FORBIDDEN, advice))
    }

    fn is_cookie(&self, value: &HeaderValue) -> bool {
        let pairs = value.to_str().unwrap_or("").split(';').filter_map(|pair| pair.split_once('='));
        let name = self.cookie_name();
        pairs
            .map(|(name, value)| (name.trim(), value.trim()))
            .any(|(given, token)| given == name && self.is_token(token))
    }

    /// Takes as long wherever the first difference is.
    fn is_token(&self, given: &str) -> bool {
        let (ours, given) = (self.token.as_bytes(), given.as_bytes());
        let differences = ours.iter().zip(given).fold(0, |sum, (a, b)| sum | (a ^ b));
        ours.len() == given.len() && differences == 0
    }
}

/// 128 random bits in hexadecimal digits.
pub(super) fn random() -> Result<String, Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|cause| Error::Serve {
        what: "the system gives no random numbers for the token".into(),
        cause: cause.to_string(),
    })?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The value of a name in the query of an address, unescaped.
pub(super) fn query(uri: &Uri, name: &str) -> Option<String> {
    let pairs = uri.query()?.split('&').filter_map(|pair| pair.split_once('='));
    pairs.into_iter().find(|(key, _)| *key == name).map(|(_, value)| unescaped(value))
}

/// Text with `%XX` and `+` resolved; what is no text becomes �.
fn unescaped(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, others @ ..] = rest {
        let escaped = others.get(..2).filter(|_| *first == b'%');
        let escaped = escaped.and_then(|digits| str::from_utf8(digits).ok());
        match escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &others[2..];
            }
            None => {
                bytes.push(if *first == b'+' { b' ' } else { *first });
                rest = others;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Stands before all handlers.
pub(super) async fn check(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let refusal = shared.guard.refusal(request.headers(), request.uri());
    let mut response = match refusal {
        Some((status, why)) => (status, why).into_response(),
        None => next.run(request).await,
    };
    add_headers(&mut response);
    response
}

fn add_headers(response: &mut Response<Body>) {
    let more: [(HeaderName, &'static str); 5] = [
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (REFERRER_POLICY, "no-referrer"),
        (CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    for (name, value) in more {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_need_host_origin_and_token() {
        let guard = Guard { port: 8000, token: "ab12".into() };
        let refusal = |headers: &[(HeaderName, &str)], uri: &'static str| {
            let headers =
                headers.iter().map(|(name, value)| (name.clone(), value.parse().unwrap()));
            guard.refusal(&headers.collect(), &Uri::from_static(uri)).map(|(status, _)| status)
        };
        let ours = (HOST, "127.0.0.1:8000");
        assert_eq!(refusal(std::slice::from_ref(&ours), "/?token=ab12"), None);
        assert_eq!(refusal(&[(HOST, "localhost:8000")], "/?a=b&token=ab12"), None);
        let cookie = (COOKIE, "x=1; shrouds-8000=ab12");
        assert_eq!(refusal(&[ours.clone(), cookie.clone()], "/"), None);
        for uri in ["/", "/?token=", "/?token=ab1", "/?token=ab123", "/?token=AB12"] {
            assert_eq!(
                refusal(std::slice::from_ref(&ours), uri),
                Some(StatusCode::FORBIDDEN),
                "{uri}"
            );
        }
        let forbidden = Some(StatusCode::FORBIDDEN);
        assert_eq!(refusal(&[ours.clone(), cookie], "/?token=no"), forbidden);
        assert_eq!(refusal(&[ours.clone(), (COOKIE, "shrouds-8001=ab12")], "/"), forbidden);
        for host in ["127.0.0.1", "127.0.0.1:80", "evil.example:8000", "[::1]:8000"] {
            let status = Some(StatusCode::MISDIRECTED_REQUEST);
            assert_eq!(refusal(&[(HOST, host)], "/?token=ab12"), status, "{host}");
        }
        for (origin, expected) in [
            ("http://127.0.0.1:8000", None),
            ("http://localhost:8000", forbidden),
            ("https://127.0.0.1:8000", forbidden),
            ("http://evil.example", forbidden),
            ("null", forbidden),
        ] {
            assert_eq!(refusal(&[ours.clone(), (ORIGIN, origin)], "/?token=ab12"), expected);
        }
    }

    #[test]
    fn queries_are_unescaped() {
        let uri = Uri::from_static("/upload?name=a%20b%2Bc+d.nii%2&x=%C3%A4&y=%ff");
        assert_eq!(query(&uri, "name").as_deref(), Some("a b+c d.nii%2"));
        assert_eq!(query(&uri, "x").as_deref(), Some("ä"));
        assert_eq!(query(&uri, "y").as_deref(), Some("\u{fffd}"));
        assert_eq!(query(&uri, "z"), None);
    }

    #[test]
    fn tokens_are_random() {
        let [one, two] = [random().unwrap(), random().unwrap()];
        assert!(one.len() == 32 && one != two);
    }
}
