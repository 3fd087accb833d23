//! Border between the module and the browser: bytes in, bytes out.
//!
//! The browser asks for room ([`room`]), writes bytes into it, and calls [`add_file`] or [`ask`]. The answer to a request
//! lies at [`answer`]. Plain exports suffice for this; bindings made by a tool would add a step to the build and a program
//! of the same version to install.

#![allow(unsafe_code, reason = "the attributes that name exports and imports; there is no unsafe block")]

use crate::{Dropped, Host};
use std::cell::RefCell;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Returns the milliseconds since some moment.
    safe fn now() -> f64;
    /// Tells the stage of the work that begins, as UTF-8.
    safe fn stage(address: *const u8, length: usize);
    /// Tells that the module failed, as UTF-8. It cannot be used any more.
    safe fn failed(address: *const u8, length: usize);
}

#[derive(Default)]
struct State {
    dropped: Dropped,
    room: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

struct Browser;

impl Host for Browser {
    fn seconds(&self) -> f64 {
        1e-3 * now()
    }

    fn stage(&self, text: &str) {
        stage(text.as_ptr(), text.len());
    }
}

/// Prepares the module: a failure is told with its place.
#[unsafe(no_mangle)]
extern "C" fn begin() {
    std::panic::set_hook(Box::new(|panic| {
        let text = panic.to_string();
        failed(text.as_ptr(), text.len());
    }));
}

/// Makes room for bytes from the browser and returns its address.
#[unsafe(no_mangle)]
extern "C" fn room(length: usize) -> *mut u8 {
    STATE.with_borrow_mut(|state| {
        state.room = vec![0; length];
        state.room.as_mut_ptr()
    })
}

/// Takes the room as a file: its bytes, then its name of this length.
#[unsafe(no_mangle)]
extern "C" fn add_file(name_length: usize) {
    STATE.with_borrow_mut(|state| {
        let mut bytes = std::mem::take(&mut state.room);
        let name = bytes.split_off(bytes.len().saturating_sub(name_length));
        state.dropped.add(String::from_utf8_lossy(&name).into_owned(), bytes);
    });
}

/// Takes the room as a request, answers it, and returns the length of the answer.
#[unsafe(no_mangle)]
extern "C" fn ask() -> usize {
    STATE.with_borrow_mut(|state| {
        let request = std::mem::take(&mut state.room);
        // The last answer is read; its memory serves the next.
        state.answer = Vec::new();
        state.answer = state.dropped.ask(&request, &Browser).into_bytes();
        state.answer.len()
    })
}

/// Returns the address of the last answer.
#[unsafe(no_mangle)]
extern "C" fn answer() -> *const u8 {
    STATE.with_borrow(|state| state.answer.as_ptr())
}
