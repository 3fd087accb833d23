//! The little of HTTP that a static page needs: GET and HEAD of the files in one folder.

use std::io::Read;
use std::path::Path;

/// Longest head of a request, in bytes.
const LONGEST: usize = 16_384;

/// Request of a browser.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Request {
    /// Path without its query; empty for a method that is not understood.
    pub(super) path: String,
    /// `true` if only the head of the answer is wanted.
    pub(super) is_head: bool,
    /// Host by which the browser knows this server.
    pub(super) host: String,
}

impl Request {
    /// Reads the head of a request; `None` if none comes.
    pub(super) fn read(stream: &mut impl Read) -> Option<Self> {
        let mut head = Vec::new();
        let mut part = [0; 1024];
        while !head.windows(4).any(|end| end == b"\r\n\r\n") {
            let read = stream.read(&mut part).ok().filter(|read| *read > 0)?;
            head.extend_from_slice(part.get(..read)?);
            if head.len() > LONGEST {
                return None;
            }
        }
        Some(Self::parse(&String::from_utf8_lossy(&head)))
    }

    fn parse(head: &str) -> Self {
        let mut lines = head.lines();
        let first: Vec<&str> = lines.next().map(|line| line.split(' ').collect()).unwrap_or_default(); // No line, no words.
        let host = lines.filter_map(|line| line.split_once(':'));
        let mut host = host.filter(|(name, _)| name.eq_ignore_ascii_case("host"));
        let host = host.next().map_or_else(String::new, |(_, value)| value.trim().to_owned());
        match first.as_slice() {
            [method @ ("GET" | "HEAD"), target, _] => {
                let path = target.split(['?', '#']).next().map_or_else(String::new, str::to_owned);
                Self { path, is_head: *method == "HEAD", host }
            }
            _ => Self { host, ..Self::default() },
        }
    }
}

/// Answer to a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    status: &'static str,
    kind: &'static str,
    pub(super) body: Vec<u8>,
}

impl Answer {
    /// Returns the answer to a request for a file in the folder. Only plain names in this folder are known, and only to a
    /// page of this address: another site whose name was pointed here gets nothing.
    pub(super) fn to(request: &Request, folder: &Path, port: u16) -> Self {
        let refused = |status: &'static str| Self {
            status,
            kind: "text/plain; charset=utf-8",
            body: format!("{status}\n").into_bytes(),
        };
        let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
        if !hosts.contains(&request.host) {
            return refused("421 Misdirected Request");
        }
        let Some(name) = request.path.strip_prefix('/') else { return refused("405 Method Not Allowed") };
        let name = if name.is_empty() { "index.html" } else { name };
        let is_plain =
            !name.starts_with('.') && name.chars().all(|sign| sign.is_alphanumeric() || ".-_".contains(sign));
        let kind = kind(name).filter(|_| is_plain);
        match kind.and_then(|kind| Some((kind, std::fs::read(folder.join(name)).ok()?))) {
            Some((kind, body)) => Self { status: "200 OK", kind, body },
            None => refused("404 Not Found"),
        }
    }

    /// Returns the head of the answer.
    pub(super) fn head(&self) -> Vec<u8> {
        let Self { status, kind, body } = self;
        let length = body.len();
        format!(
            "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\
             Cache-Control: no-cache\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\n\r\n"
        )
        .into_bytes()
    }
}

/// Returns the media type of a file of the page; `None` for any other.
fn kind(name: &str) -> Option<&'static str> {
    Some(match name.rsplit_once('.')?.1 {
        "html" => "text/html; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "wasm" => "application/wasm",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{Answer, Request};

    fn status(head: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        let page = folder.path().join("page");
        std::fs::create_dir(&page).unwrap();
        std::fs::write(page.join("index.html"), "<p>").unwrap();
        std::fs::write(folder.path().join("secret.html"), "no").unwrap();
        let request = Request::read(&mut head.as_bytes()).unwrap();
        Answer::to(&request, &page, 80).status.to_owned()
    }

    #[test]
    fn offers_the_files_of_its_folder_and_nothing_else() {
        let get = |path: &str| status(&format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n"));
        assert_eq!(get("/"), "200 OK");
        assert_eq!(get("/index.html?x=1"), "200 OK");
        for path in
            ["/../secret.html", "/..%2fsecret.html", "//etc/passwd", "/.hidden.html", "/none.js", "/x.toml"]
        {
            assert_eq!(get(path), "404 Not Found", "{path}");
        }
    }

    #[test]
    fn refuses_other_methods_and_other_hosts() {
        assert_eq!(status("POST / HTTP/1.1\r\nHost: localhost:80\r\n\r\n"), "405 Method Not Allowed");
        for host in ["example.org", "127.0.0.1:81", ""] {
            assert_eq!(status(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n")), "421 Misdirected Request");
        }
        assert_eq!(Request::read(&mut "GET / HTTP/1.1\r\n".as_bytes()), None);
    }
}
