//! Tests of the page on which a log is dropped, offered by `trainer serve` and opened in a real browser: it says what the
//! program says, makes no request once it is loaded, and survives what is no log. Skipped with a notice if there is no
//! Chromium, or no wasm32 target to build the page with.

use crate::browser::chromium::{Chromium, VIEWS, View};
use crate::field::{LOGS, field, look};
use crate::support::{Shipped, number, root, simulated, trainer};
use report::format::with_uncertainty;
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

const DESKTOP: View = View { width: 1440, scheme: "light" };
/// Longest wait for a look at a log, and for a diagnosis, on a busy machine.
const SOON: Duration = Duration::from_secs(60);
const LATER: Duration = Duration::from_secs(300);
/// Largest difference, as a part of the number, between the bounds of noise in the maps of the gap as the page and the program
/// have them: quantiles that a library finds by iteration, with the exponentials and logarithms of the machine.
const OF_BAND: f64 = 1e-10;

/// Builds the page once; `false`, with a notice, without the target.
fn is_built() -> bool {
    static BUILT: OnceLock<bool> = OnceLock::new();
    *BUILT.get_or_init(|| {
        let root_of_rust = Command::new("rustc").args(["--print", "sysroot"]).output().unwrap().stdout;
        let root_of_rust = PathBuf::from(String::from_utf8(root_of_rust).unwrap().trim());
        if !root_of_rust.join("lib/rustlib/wasm32-unknown-unknown/lib").is_dir() {
            let line = "SKIPPED: the page is not built, since its target is not installed: rustup target add wasm32-unknown-unknown\n";
            std::io::stderr().write_all(line.as_bytes()).unwrap();
            return false;
        }
        let built = Command::new(root().join("crates/web/build")).arg("--quiet").output().unwrap();
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        true
    })
}

/// The page in a browser, and the program that offers it.
struct Page {
    browser: Chromium,
    server: Child,
    address: String,
    scratch: tempfile::TempDir,
}

impl Page {
    fn open() -> Option<Self> {
        let browser = Chromium::start()?;
        if !is_built() {
            return None;
        }
        let mut server = Command::new(env!("CARGO_BIN_EXE_trainer"))
            .arg("serve")
            .current_dir(root())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut address = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut address).unwrap();
        let address = address.trim().to_owned();
        assert!(address.starts_with("http://127.0.0.1:"), "{address}");
        let mut page = Self { browser, server, address, scratch: tempfile::tempdir().unwrap() };
        page.visit(DESKTOP);
        Some(page)
    }

    /// Opens the page and waits until it has loaded its module; from then on it may request nothing.
    fn visit(&mut self, view: View) {
        self.browser.visit(&self.address, view);
        self.browser.wait_until("document.documentElement.dataset.ready === 'true'", SOON);
        let console: Vec<String> =
            self.browser.said(&self.address).into_iter().filter(|said| said.starts_with("console")).collect();
        assert!(console.is_empty(), "{console:?}");
        self.browser.forget();
    }

    fn text(&mut self, selector: &str) -> String {
        let found =
            self.browser.evaluate(&format!("document.querySelector({selector:?})?.textContent ?? ''"));
        found.as_str().unwrap().to_owned()
    }

    /// Drops files, and waits until the page has said something about them.
    fn drop(&mut self, files: &[&Path]) {
        self.browser.evaluate("document.getElementById('status').textContent = ''");
        self.browser.choose("#files", files);
        let said = "!['', 'Ready.'].includes(document.getElementById('status').textContent) &&
            !document.getElementById('status').textContent.startsWith('Reading ')";
        self.browser.wait_until(said, SOON);
    }

    /// Diagnoses what was dropped, and returns `diagnosis.json`, saved by its button.
    fn diagnosis(&mut self) -> Value {
        self.browser.evaluate("document.getElementById('diagnose').click()");
        let ended = "!document.getElementById('answer').hidden || !document.getElementById('refusal').hidden";
        self.browser.wait_until(ended, LATER);
        assert_eq!(self.text("#refusal"), "");
        serde_json::from_str(&self.saved("diagnosis.json")).unwrap()
    }

    /// Returns a file of the diagnosis, saved by its button.
    fn saved(&mut self, name: &str) -> String {
        self.browser.download_to(self.scratch.path());
        self.browser.evaluate(&format!(
            "[...document.querySelectorAll('#take button')].find((button) => button.textContent === '{name}').click()"
        ));
        self.browser.wait_for_download();
        let file = self.scratch.path().join(name);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::remove_file(file).unwrap();
        text
    }

    /// Moves the focus by the tabulator until an expression on the focused element is true, and presses Enter there.
    fn press_at(&mut self, element: &str) {
        for _ in 0..200 {
            if self.browser.evaluate(&format!("(({element}) === document.activeElement)")) == true {
                return self.browser.press("Enter");
            }
            self.browser.press("Tab");
        }
        panic!("the tabulator does not reach {element}");
    }

    /// Checks that the page has said nothing on the console and requested nothing since it was loaded.
    fn is_quiet(&mut self) {
        assert_eq!(self.browser.said(&self.address), Vec::<String>::new());
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Compares two JSON values; returns the places at which they differ, if only in a number's last digit.
fn differences(one: &Value, other: &Value, place: &str, found: &mut Vec<String>) {
    match (one, other) {
        (Value::Object(a), Value::Object(b)) => {
            for key in a.keys().chain(b.keys().filter(|key| !a.contains_key(*key))) {
                // Times, the names under which the files were given, and what contains them.
                if ["seconds", "stages", "path", "nominal"].contains(&key.as_str()) {
                    continue;
                }
                let [a, b] = [a, b].map(|own| own.get(key).unwrap_or(&Value::Null));
                differences(a, b, &format!("{place}/{key}"), found);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            a.iter()
                .zip(b)
                .enumerate()
                .for_each(|(at, (a, b))| differences(a, b, &format!("{place}/{at}"), found));
        }
        (Value::Number(a), Value::Number(b)) if place.ends_with("/band") => {
            let [a, b] = [a, b].map(|own| own.as_f64().unwrap());
            if (a - b).abs() > OF_BAND * b.abs() {
                found.push(format!("{place}: {a} and {b}"));
            }
        }
        _ if one == other => {}
        _ => found.push(format!("{place}: {one} and {other}")),
    }
}

/// Diagnoses records with the program, on one thread.
fn by_the_program(records: &[&Path], nominal: &Path) -> Value {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("out");
    let mut arguments = vec!["diagnose"];
    arguments.extend(records.iter().map(|path| path.to_str().unwrap()));
    arguments.extend(["--nominal", nominal.to_str().unwrap(), "--threads", "1", "--quiet", "--out"]);
    arguments.push(out.to_str().unwrap());
    let output = trainer(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&std::fs::read(out.join("diagnosis.json")).unwrap()).unwrap()
}

#[test]
fn the_shipped_record_is_diagnosed_as_by_the_program() {
    let Some(mut page) = Page::open() else { return };
    let folder = root().join("experiments/default-record");
    let [record, nominal] = ["record.csv", "nominal.toml"].map(|name| folder.join(name));
    page.drop(&[&record, &nominal]);
    assert!(page.text("dl.key").contains("3.461333"), "{}", page.text("dl.key"));
    let found = page.diagnosis();
    let mut apart = Vec::new();
    differences(&found, &Shipped::get().answer(), "", &mut apart);
    assert!(apart.is_empty(), "{} numbers differ:\n{}", apart.len(), apart.join("\n"));
    let report =
        "document.getElementById('report').contentDocument.querySelector('.verdict .label')?.textContent";
    page.browser.wait_until(&format!("{report} === 'Missing effect'"), SOON);
    assert_eq!(page.text("#command"), "trainer diagnose record.csv --nominal nominal.toml");
    page.is_quiet();
    for view in VIEWS {
        page.browser.set_view(view);
        assert_eq!(page.browser.visible_faults(view), Vec::<String>::new(), "{view:?}");
    }
    assert_eq!(page.browser.nameless(), Vec::<String>::new());
    // Regression: a link within the report replaced it by a blocked page, and the frame never shrank again.
    let height = "document.getElementById('report').getBoundingClientRect().height";
    let first = page.browser.evaluate(height).as_f64().unwrap();
    page.browser.evaluate("document.getElementById('report').style.width = '300px'");
    page.browser.wait_until(&format!("{height} > {}", 1.05 * first), SOON);
    page.browser.evaluate("document.getElementById('report').style.width = ''");
    page.browser.wait_until(&format!("Math.abs({height} - {first}) < 2"), SOON);
    page.browser.evaluate(
        "document.getElementById('report').contentDocument.querySelector('a[href^=\"#\"]').click()",
    );
    page.browser.wait_until(&format!("{report} === 'Missing effect'"), SOON);
    page.is_quiet();
}

/// Two records of a driven joint at once.
#[test]
fn driven_records_are_diagnosed_together_as_by_the_program() {
    let Some(mut page) = Page::open() else { return };
    let scratch = tempfile::tempdir().unwrap();
    let more = "input_gain = 1.0\nrecord.rate_hz = 130.0\nrecord.seconds = 6.0\nstart.position = 0.1\nsensor.noise = 1e-3\n\
                input.waveform = \"chirp\"\ninput.amplitude = 90.0\ninput.frequency_hz = 1.0\ninput.end_frequency_hz = 6.0\n\
                [[effects]]\nid = \"coulomb_friction\"\nparameters.torque = 9.0\n";
    let file = simulated(scratch.path(), more, &["simulate.records=2"]);
    let records = [0, 1].map(|number| PathBuf::from(file(&format!("record-00{number}.csv"))));
    let records: Vec<&Path> = records.iter().map(PathBuf::as_path).collect();
    let nominal = PathBuf::from(file("nominal.toml"));
    page.drop(&[&records[..], &[&nominal]].concat());
    assert_eq!(page.browser.evaluate("document.querySelectorAll('#logs article').length"), 2);
    assert_eq!(page.browser.evaluate("document.getElementById('estimate').hidden"), true);
    let found = page.diagnosis();
    let mut apart = Vec::new();
    differences(&found, &by_the_program(&records, &nominal), "", &mut apart);
    assert!(apart.is_empty(), "{} numbers differ:\n{}", apart.len(), apart.join("\n"));
    // The repaired simulator runs as its first lines say.
    let repaired = scratch.path().join("repaired.toml");
    let text = page.saved("repaired.toml");
    std::fs::write(&repaired, &text).unwrap();
    let input = text.split_once("simulate repaired.toml input.").unwrap().1.lines().next().unwrap();
    let input: Vec<String> = format!("input.{input}").split(' ').map(str::to_owned).collect();
    let out = scratch.path().join("again");
    let mut arguments =
        vec!["simulate", repaired.to_str().unwrap(), "--quiet", "--out", out.to_str().unwrap()];
    arguments.extend(input.iter().map(String::as_str));
    let output = trainer(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    page.is_quiet();
}

/// Logs of the kinds that people have: frequency and damping ratio, or the message, are those of `trainer init`.
#[test]
fn every_log_is_taken_for_what_the_program_takes_it_for() {
    let Some(mut page) = Page::open() else { return };
    for (name, options, ..) in LOGS.iter().filter(|(_, options, ..)| options.is_empty()) {
        let Some(path) = field(name) else { continue };
        page.drop(&[&path]);
        let shown = page.text("dl.key dd");
        match look(&path, options) {
            Ok(found) => {
                let of = |key: &str| number(&found, &format!("/oscillator/natural_frequency_hz/{key}"));
                assert_eq!(shown, format!("{} Hz", with_uncertainty(of("value"), of("std_error"))), "{name}");
            }
            Err(message) => {
                let said = page.text("#logs .warning");
                assert!(
                    !said.is_empty() && message.contains(&said[said.len() - 20..]),
                    "{name}: {said} and {message}"
                );
            }
        }
    }
    page.is_quiet();
}

#[test]
fn what_is_no_log_is_refused_in_a_sentence_and_the_page_goes_on() {
    let Some(mut page) = Page::open() else { return };
    let scratch = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = scratch.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let large = file("large.csv", b"");
    std::fs::File::options().write(true).open(&large).unwrap().set_len(200 << 20).unwrap();
    let picture = std::fs::read(root().join("book/src/report.png")).unwrap();
    for (path, said) in [
        (file("empty.csv", b""), "is empty"),
        (file("picture.png", &picture), "picture.png"),
        (file("words.txt", b"once upon a time\nthere was a log\n"), ""),
        (file("<img src=x onerror=alert(1)>.csv", b"time_s,angle_rad\n0,1\n0.1,x\n"), ""),
        (large, "200 MB"),
        (file("arm.urdf", b"<robot name='arm'/>"), "trainer diagnose LOG --nominal arm.urdf"),
        (file("arm.xml", b"<mujoco/>"), "robot"),
    ] {
        page.drop(&[&path]);
        let told = format!("{} {}", page.text("#status"), page.text("#logs"));
        assert!(told.contains(said) && told.len() > 40, "{}: {told}", path.display());
        assert!(page.browser.evaluate("document.getElementById('simulator').hidden") == true, "{told}");
    }
    page.drop(&[&root().join("experiments/default-record/record.csv"), &scratch.path().join("arm.urdf")]);
    assert!(page.text("dl.key").contains("3.461333"));
    assert!(page.text("#status").contains("robot"), "{}", page.text("#status"));
    page.is_quiet();
}

/// Regression: a second log of another system was taken for a recording of the same one without a word, and a simulator
/// that was dropped beside was lost when the logs were read again.
#[test]
fn logs_of_two_systems_are_told_apart_and_one_can_be_left_out() {
    let Some(mut page) = Page::open() else { return };
    let scratch = tempfile::tempdir().unwrap();
    let other = scratch.path().join("other.csv");
    let line = |at: u32| {
        let time = 0.005 * f64::from(at);
        format!("{time:.3},{:.2}\n", 30.0 * (-0.2 * time).exp() * (50.0 * time).cos())
    };
    std::fs::write(&other, format!("time_s,angle_deg\n{}", (0..2000).map(line).collect::<String>())).unwrap();
    let folder = root().join("experiments/default-record");
    page.drop(&[&folder.join("record.csv"), &other, &folder.join("nominal.toml")]);
    let said = page.text("#status");
    assert!(said.starts_with("Read as recordings of one system: record.csv, other.csv."), "{said}");
    assert!(page.text("#logs .warning").contains("3.46") && page.text("#logs .warning").contains("7.95"));
    page.browser
        .evaluate("[...document.querySelectorAll('#logs button')].find((button) => button.textContent === 'Leave out other.csv').click()");
    page.browser.wait_until("document.getElementById('status').textContent === 'Read: record.csv.'", SOON);
    assert_eq!(page.text("#logs .warning"), "");
    let nominal = page.browser.evaluate("document.getElementById('nominal').value");
    assert_eq!(nominal.as_str(), std::fs::read_to_string(folder.join("nominal.toml")).ok().as_deref());
    page.is_quiet();
}

/// From the log to the repaired simulator without a mouse.
#[test]
fn the_way_goes_by_the_keyboard_alone() {
    let Some(mut page) = Page::open() else { return };
    page.press_at("document.getElementById('shipped')");
    page.browser.wait_until("document.getElementById('status').textContent === 'Read: record.csv.'", SOON);
    page.press_at("document.getElementById('diagnose')");
    page.browser.wait_until("!document.getElementById('answer').hidden", LATER);
    page.browser.download_to(page.scratch.path());
    page.press_at("document.querySelector('#take .button')");
    page.browser.wait_for_download();
    assert!(page.scratch.path().join("repaired.toml").is_file());
    page.is_quiet();
}

#[test]
fn a_million_samples_are_read() {
    let Some(mut page) = Page::open() else { return };
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("long.csv");
    let line = |at: u32| {
        let time = 1e-4 * f64::from(at);
        format!("{time:.4},{:.6}\n", 0.5 * (-0.05 * time).exp() * (20.0 * time).cos())
    };
    std::fs::write(&file, format!("time_s,angle_rad\n{}", (0..1_000_000).map(line).collect::<String>()))
        .unwrap();
    page.drop(&[&file]);
    page.browser.wait_until("document.getElementById('status').textContent === 'Read: long.csv.'", SOON);
    assert!(page.text("dl.key").contains("3.1831"), "{}", page.text("dl.key"));
    page.is_quiet();
}

#[test]
fn a_diagnosis_is_cancelled_within_a_second() {
    let Some(mut page) = Page::open() else { return };
    page.browser.evaluate("document.getElementById('shipped').click()");
    page.browser.wait_until("!document.getElementById('simulator').hidden", SOON);
    page.browser.evaluate("document.getElementById('diagnose').click()");
    page.browser.wait_until("document.getElementById('stage').textContent.startsWith('searching')", LATER);
    let start = Instant::now();
    page.browser.evaluate("document.getElementById('cancel').click()");
    page.browser.wait_until("document.getElementById('status').textContent === 'Cancelled.'", SOON);
    assert!(start.elapsed() < Duration::from_secs(1), "{:?}", start.elapsed());
    // The next request starts another worker, which gets the files again.
    page.browser.evaluate("document.getElementById('options').requestSubmit()");
    page.browser.wait_until("document.getElementById('status').textContent === 'Read: record.csv.'", SOON);
    page.is_quiet();
}

/// A swing simulated in the page, read with another unit by hand, beside a simulator by numbers.
#[test]
fn an_example_is_simulated_and_read_differently_by_hand() {
    let Some(mut page) = Page::open() else { return };
    page.browser.evaluate("document.getElementById('simulate').click()");
    page.browser.wait_until("!document.getElementById('simulator').hidden", SOON);
    assert!(page.text("dl.key").contains("3.4997"), "{}", page.text("dl.key"));
    page.browser.evaluate(
        "document.getElementById('option-unit').value = 'deg'; document.getElementById('options').requestSubmit()",
    );
    page.browser.wait_until("document.querySelector('dl.facts')?.textContent.includes('in deg')", SOON);
    page.browser.evaluate("document.querySelector('input[value=swings]').click()");
    let nominal = page.browser.evaluate("document.getElementById('nominal').value");
    assert!(nominal.as_str().unwrap().contains("\nnatural_frequency = "), "{nominal}");
    // In coefficients it is the same oscillator, per unit of inertia: (2*pi*3.4997 Hz)^2.
    page.browser.evaluate("document.querySelector('input[value=coefficients]').click()");
    let stiffness = "Number(document.getElementById('nominal').value.match(/^stiffness = (.*)$/m)[1])";
    let stiffness = page.browser.evaluate(stiffness).as_f64().unwrap();
    assert!((stiffness - 483.53).abs() < 1.0, "{stiffness}");
    page.browser.evaluate(
        "{ const damping = document.getElementById('nominal-damping'); damping.value = '0,5'; \
         damping.dispatchEvent(new Event('input')) }",
    );
    let nominal = page.browser.evaluate("document.getElementById('nominal').value");
    assert!(nominal.as_str().unwrap().contains("\ndamping = 0.5\n"), "{nominal}");
    page.is_quiet();
}
