//! A headless Chromium, driven by its DevTools protocol through a pipe: JSON messages separated by zero
//! bytes.

use report::plot::Hue;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const NAMES: &[&str] = &["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Shell command that starts the browser. The protocol uses file descriptors 3 and 4, which the shell copies
/// from its standard input and output. A browser that hangs is stopped.
const START: &str = "exec 3<&0 4>&1 </dev/null >/dev/null 2>&1; exec timeout 600 \"$@\"";

const AUDIT: &str = include_str!("audit.js");

/// Viewport and color scheme of a page.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    /// Width in CSS pixels.
    pub(crate) width: u32,
    /// Color scheme, `light` or `dark`.
    pub(crate) scheme: &'static str,
}

/// Views of a phone and a desktop, each in light and dark.
pub(crate) const VIEWS: [View; 4] = [
    View { width: 390, scheme: "light" },
    View { width: 390, scheme: "dark" },
    View { width: 1440, scheme: "light" },
    View { width: 1440, scheme: "dark" },
];

/// Browser with one page.
pub(crate) struct Chromium {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    calls: u64,
    session: String,
    runs_scripts: bool,
    /// Events since the page was opened last.
    events: Vec<Value>,
    _profile: TempDir,
}

impl Chromium {
    /// Starts a browser. `None`, with a notice, if there is none.
    pub(crate) fn start() -> Option<Self> {
        let is_there = |name: &&&str| {
            let asked = "command -v timeout && command -v \"$0\"";
            let answer = Command::new("sh").args(["-c", asked, name]).output();
            answer.is_ok_and(|answer| answer.status.success())
        };
        let Some(name) = NAMES.iter().find(is_there) else {
            let line = "SKIPPED: there is no Chromium here (Debian: apt-get install chromium), so no report was opened in a browser\n";
            std::io::stderr().write_all(line.as_bytes()).unwrap();
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let mut child = Command::new("sh")
            .args(["-c", START, "sh", name, "--headless", "--remote-debugging-pipe", "--no-sandbox"])
            .args(["--disable-gpu", "--disable-dev-shm-usage", "--disable-extensions", "--no-first-run"])
            .args(["--disable-background-networking", "--force-color-profile=srgb"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (input, output) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        let mut browser = Self {
            child,
            input,
            output,
            calls: 0,
            session: String::new(),
            runs_scripts: true,
            events: Vec::new(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attached =
            browser.call("Target.attachToTarget", json!({ "targetId": target["targetId"], "flatten": true }));
        browser.session = attached["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Opens a page and returns its faults: console messages, network requests, and visible faults.
    pub(crate) fn faults(&mut self, page: &Path, view: View) -> Vec<String> {
        self.open(page, view);
        let seen = self.visible_faults(view);
        let mut faults = self.said(&address(page));
        faults.extend(seen);
        faults
    }

    /// Returns console messages and requests since the page at this address was opened; those of its own are none.
    pub(crate) fn said(&self, own: &str) -> Vec<String> {
        self.events.iter().filter_map(|event| said(event, own)).collect()
    }

    /// Forgets what was said and requested so far.
    pub(crate) fn forget(&mut self) {
        self.events.clear();
    }

    /// Returns the visible faults of the page as it is displayed now.
    pub(crate) fn visible_faults(&mut self, view: View) -> Vec<String> {
        let decoration = [Hue::Grid.light(), Hue::Shade.light()];
        let given = json!({ "width": view.width, "scripts": self.runs_scripts, "decoration": decoration });
        let seen = self.evaluate(&format!("({AUDIT})({given})"));
        seen.as_array().unwrap().iter().map(|fault| fault.as_str().unwrap().to_owned()).collect()
    }

    /// Opens a page and waits until it is loaded.
    pub(crate) fn open(&mut self, page: &Path, view: View) {
        self.visit(&address(page), view);
    }

    /// Opens the page at an address and waits until it is loaded.
    pub(crate) fn visit(&mut self, url: &str, view: View) {
        self.set_view(view);
        self.events.clear();
        let opened = self.call("Page.navigate", json!({ "url": url }));
        assert!(opened.get("errorText").is_none(), "{url}: {opened}");
        self.wait_for("Page.loadEventFired");
    }

    /// Sets viewport and color scheme.
    pub(crate) fn set_view(&mut self, view: View) {
        self.call(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": view.width, "height": 900, "deviceScaleFactor": 1, "mobile": view.width < 600 }),
        );
        let scheme = json!([{ "name": "prefers-color-scheme", "value": view.scheme }]);
        self.call("Emulation.setEmulatedMedia", json!({ "features": scheme }));
    }

    /// Waits until an expression is true, and returns the seconds that this took.
    pub(crate) fn wait_until(&mut self, expression: &str, most: Duration) -> f64 {
        let start = Instant::now();
        while self.evaluate(expression) != true {
            assert!(start.elapsed() < most, "after {most:?}, this is not true: {expression}");
            std::thread::sleep(Duration::from_millis(20));
        }
        start.elapsed().as_secs_f64()
    }

    /// Chooses files in an element for files, which a selector names.
    pub(crate) fn choose(&mut self, selector: &str, files: &[&Path]) {
        let asked = json!({ "expression": format!("document.querySelector({selector:?})") });
        let found = self.call("Runtime.evaluate", asked);
        // The browser reads no file whose path goes up.
        let files: Vec<PathBuf> = files.iter().map(|file| file.canonicalize().unwrap()).collect();
        self.call(
            "DOM.setFileInputFiles",
            json!({ "files": files, "objectId": found["result"]["objectId"] }),
        );
    }

    /// Returns the elements that can be operated and have no name for a screen reader.
    pub(crate) fn nameless(&mut self) -> Vec<String> {
        const OPERATED: [&str; 8] =
            ["button", "textbox", "combobox", "slider", "checkbox", "radio", "Iframe", "spinbutton"];
        let tree = self.call("Accessibility.getFullAXTree", json!({}));
        let nodes = tree["nodes"].as_array().unwrap().iter();
        let is_nameless = |node: &&Value| {
            let role = node["role"]["value"].as_str().unwrap_or_default();
            OPERATED.contains(&role) && node["name"]["value"].as_str().unwrap_or_default().trim().is_empty()
        };
        nodes.filter(is_nameless).map(|node| node["role"]["value"].to_string()).collect()
    }

    /// Returns the value of an expression; a promise is awaited.
    pub(crate) fn evaluate(&mut self, expression: &str) -> Value {
        let asked = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", asked);
        assert!(answer.get("exceptionDetails").is_none(), "{answer}");
        answer["result"]["value"].clone()
    }

    /// Enables or disables the scripts of pages that are opened later.
    pub(crate) fn run_scripts(&mut self, runs: bool) {
        self.call("Emulation.setScriptExecutionDisabled", json!({ "value": !runs }));
        self.runs_scripts = runs;
    }

    /// Sends a mouse event at a position in the window, in CSS pixels: `mouseMoved`, `mousePressed` or
    /// `mouseReleased`. `clicks` is 2 for the second click of a double click, and 0 while no button is
    /// pressed.
    pub(crate) fn mouse(&mut self, kind: &str, at: [f64; 2], clicks: u32) {
        let held = u32::from(kind != "mouseReleased");
        let button = if kind == "mouseMoved" && clicks == 0 { "none" } else { "left" };
        self.call(
            "Input.dispatchMouseEvent",
            json!({ "type": kind, "x": at[0], "y": at[1], "button": button, "clickCount": clicks,
                    "buttons": if button == "left" { held } else { 0 } }),
        );
    }

    /// Presses and releases `Enter` or `Tab`.
    pub(crate) fn press(&mut self, key: &str) {
        let (text, code) = if key == "Enter" { ("\r", 13) } else { ("", 9) };
        self.call(
            "Input.dispatchKeyEvent",
            json!({ "type": "keyDown", "key": key, "code": key, "text": text,
            "windowsVirtualKeyCode": code }),
        );
        self.call("Input.dispatchKeyEvent", json!({ "type": "keyUp", "key": key, "code": key }));
    }

    /// Sets the folder for files that a page's buttons save.
    pub(crate) fn download_to(&mut self, folder: &Path) {
        let asked = json!({ "behavior": "allow", "downloadPath": folder, "eventsEnabled": true });
        self.call("Browser.setDownloadBehavior", asked);
    }

    /// Waits until a download is complete.
    pub(crate) fn wait_for_download(&mut self) {
        loop {
            let event = self.wait_for("Browser.downloadProgress");
            match event["params"]["state"].as_str() {
                Some("completed") => return,
                Some("inProgress") => (),
                other => panic!("{other:?}"),
            }
        }
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.calls += 1;
        let mut message = json!({ "id": self.calls, "method": method, "params": params });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.clone().into();
        }
        let mut text = message.to_string().into_bytes();
        text.push(0);
        self.input.write_all(&text).unwrap();
        loop {
            let message = self.read();
            if message["id"] == self.calls {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].clone();
            }
            self.events.push(message);
        }
    }

    /// Returns the next event of a name, including stored ones.
    fn wait_for(&mut self, method: &str) -> Value {
        if let Some(at) = self.events.iter().position(|event| event["method"] == method) {
            return self.events.remove(at);
        }
        loop {
            let message = self.read();
            if message["method"] == method {
                return message;
            }
            self.events.push(message);
        }
    }

    fn read(&mut self) -> Value {
        let mut text = Vec::new();
        self.output.read_until(0, &mut text).unwrap();
        assert_eq!(text.pop(), Some(0), "the browser ended");
        serde_json::from_slice(&text).unwrap()
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        let _ = self.input.write_all(b"{\"id\":0,\"method\":\"Browser.close\"}\0");
        let _ = self.child.wait();
    }
}

fn address(page: &Path) -> String {
    let safe = |byte: u8| byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte);
    let bytes = page.as_os_str().as_encoded_bytes().iter();
    let path: String = bytes
        .map(|&byte| if safe(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect();
    format!("file://{path}")
}

/// Returns the fault of a page that an event reports; `None` if it reports none.
fn said(event: &Value, own: &str) -> Option<String> {
    let params = &event["params"];
    match event["method"].as_str()? {
        "Runtime.exceptionThrown" => Some(format!("console: {}", params["exceptionDetails"])),
        "Runtime.consoleAPICalled" => Some(format!("console: {}", params["args"])),
        "Log.entryAdded" => Some(format!("console: {}", params["entry"]["text"])),
        "Network.requestWillBeSent" => {
            let url = params["request"]["url"].as_str()?;
            let inside = ["data:", "blob:"].iter().any(|scheme| url.starts_with(scheme));
            (url != own && !inside).then(|| format!("request: {url}"))
        }
        _ => None,
    }
}
