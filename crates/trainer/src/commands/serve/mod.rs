//! `trainer serve`: the page, for this computer alone.

mod http;

use crate::error::{ServeError, TrainerError};
use crate::outcome::Outcome;
use crate::own_program::own_program;
use crate::terminal::console;
use clap::Args;
use http::{Answer, Request};
use std::io::Write;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Offers the page on which a log is dropped, on this computer alone: 127.0.0.1.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crates/web/build                             builds the page once
  trainer serve                                offers it and prints its address
  trainer serve --port 8080

The folder consists of plain files, which any file server can offer as well. The page computes in the browser; the
logs dropped on it are sent nowhere, not even to this program. Ctrl-C ends it.")]
pub(crate) struct ServeArguments {
    /// Port on 127.0.0.1 [default: one that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Folder of the page [default: web, here or where the program was built]
    #[arg(long, value_name = "DIR")]
    page: Option<PathBuf>,
}

/// File without which the page is not built.
const MODULE: &str = "ringdown.wasm";
/// Time that a browser has to send its request or to take the answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// Serves the page until the program is ended.
pub(crate) fn command(arguments: &ServeArguments) -> Result<Outcome, TrainerError> {
    let folder = arguments.page.clone().unwrap_or_else(page_folder);
    if !folder.join(MODULE).is_file() {
        return Err(ServeError::NotBuilt { folder: folder.display().to_string() }.into());
    }
    let port = arguments.port;
    let refused = |error: std::io::Error| ServeError::Port { port, problem: error.to_string() };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
    let port = listener.local_addr().map_err(refused)?.port();
    console::result(&format!("http://127.0.0.1:{port}/"));
    console::remark("Open this address in a browser; Ctrl-C ends it.");
    for stream in listener.incoming().flatten() {
        let folder = folder.clone();
        std::thread::spawn(move || answer(stream, &folder, port));
    }
    Ok(Outcome::Done)
}

/// Returns the page's folder: in the working directory, or in the checkout in which the program was built.
fn page_folder() -> PathBuf {
    let here = PathBuf::from("web");
    let program = own_program().unwrap_or_default();
    let mut built = program.ancestors().map(|folder| folder.join("web"));
    let is_page = |folder: &PathBuf| folder.join("index.html").is_file();
    if is_page(&here) { here } else { built.find(is_page).unwrap_or(here) }
}

/// Answers one request; what goes wrong on the way to the browser is the browser's matter.
fn answer(mut stream: TcpStream, folder: &Path, port: u16) {
    let _ = stream.set_read_timeout(Some(PATIENCE));
    let _ = stream.set_write_timeout(Some(PATIENCE));
    let Some(request) = Request::read(&mut stream) else { return };
    let answer = Answer::to(&request, folder, port);
    let _ = stream.write_all(&answer.head()).and_then(|()| match request.is_head {
        true => Ok(()),
        false => stream.write_all(&answer.body),
    });
}
