//! Tests of reports in a real browser: no console messages, no network requests, nothing that overflows or is
//! illegible, on a phone and on a desktop, in light and in dark. Skipped with a notice if there is no
//! Chromium.

pub(crate) mod chromium;
mod instruments;

use crate::support::{Shipped, measured, root, simulated, trainer};
use chromium::{Chromium, VIEWS, View};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Runs the program into a new folder below `scratch`, and checks that the report can be made again from the
/// other files to the byte.
fn made(scratch: &TempDir, name: &str, arguments: &[&str]) -> PathBuf {
    let out = scratch.path().join(name);
    let output = trainer(&[arguments, &["--quiet", "--out", out.to_str().unwrap()]].concat());
    assert!(output.status.code().unwrap() <= 1, "{}", String::from_utf8_lossy(&output.stderr));
    made_again(&out);
    out
}

/// Checks that the report of a run can be made from its other files to the byte.
fn made_again(out: &Path) {
    let page = out.join("report.html");
    let before = std::fs::read(&page).unwrap();
    std::fs::remove_file(&page).unwrap();
    assert!(trainer(&["report", out.to_str().unwrap(), "--quiet"]).status.success());
    assert!(std::fs::read(&page).unwrap() == before, "{}: another page", page.display());
}

/// Both widths and both color schemes, for pages whose parts are seen in every view in the reports of smaller runs.
const BOTH: [View; 2] = [VIEWS[0], VIEWS[3]];

/// Checks a page in every view.
fn look_at(browser: &mut Chromium, page: &Path) {
    look_twice_at(browser, page, &VIEWS, |_| ());
}

/// Checks a page in the given views, and then runs a further check on it.
fn look_twice_at(browser: &mut Chromium, page: &Path, views: &[View], look: impl Fn(&mut Chromium)) {
    let mut faults = Vec::new();
    for &view in views {
        faults.extend(browser.faults(page, view).into_iter().map(|fault| format!("{view:?} {fault}")));
        look(browser);
    }
    assert!(faults.is_empty(), "{}:\n{}", page.display(), faults.join("\n"));
}

/// Tests the files that the plots of a page save: the CSV equals the page's data, the browser displays the
/// SVG without faults, and the PNG is an image of plausible size.
fn save(browser: &mut Chromium, page: &Path, least: usize) {
    let scratch = tempfile::tempdir().unwrap();
    browser.open(page, VIEWS[0]);
    let figures = browser.evaluate(
        "[...document.querySelectorAll('figure')].map((figure) => [figure.id, figure.querySelector('pre.csv').textContent])",
    );
    let figures: Vec<(String, String)> = serde_json::from_value(figures).unwrap();
    assert!(figures.len() >= least, "{}: {} plots", page.display(), figures.len());
    browser.download_to(scratch.path());
    let mut pictures = Vec::new();
    for (id, shown) in &figures {
        // Chromium asks for permission after ten files from one page.
        browser.open(page, VIEWS[0]);
        let [svg, png, csv] = ["svg", "png", "csv"].map(|kind| {
            browser.evaluate(&format!(
                "document.getElementById('{id}').querySelector('[data-save={kind}]').click()"
            ));
            browser.wait_for_download();
            scratch.path().join(format!("{id}.{kind}"))
        });
        let csv = std::fs::read_to_string(csv).unwrap();
        assert_eq!(csv, *shown, "{id}");
        let mut rows = csv::Reader::from_reader(csv.as_bytes());
        let width = rows.headers().unwrap().len();
        assert!(width > 1 && rows.records().all(|row| row.unwrap().len() == width), "{id}");
        let png = std::fs::read(png).unwrap();
        assert!(png.starts_with(b"\x89PNG") && png.len() > 3_000, "{id}.png: {} bytes", png.len());
        pictures.push(svg);
    }
    for view in VIEWS.into_iter().filter(|view| view.width > 960) {
        for svg in &pictures {
            let faults = browser.faults(svg, view);
            assert!(faults.is_empty(), "{} of {}: {view:?} {faults:?}", svg.display(), page.display());
        }
    }
}

/// Tests a page without its scripts: it has no faults, every plot is drawn, and there is no button without a
/// function.
fn without_scripts(browser: &mut Chromium, page: &Path) {
    browser.run_scripts(false);
    look_twice_at(browser, page, &BOTH, |browser| {
        let counted = "[document.querySelectorAll('figure').length, document.querySelectorAll('button, .stage').length,
            [...document.querySelectorAll('svg.plot')].filter((plot) => plot.getBoundingClientRect().width > 200).length]";
        let [figures, live, drawn] = serde_json::from_value(browser.evaluate(counted)).unwrap();
        let counts: [u64; 3] = [figures, live, drawn];
        assert_eq!(counts, [figures, 0, figures], "{}", page.display());
    });
    browser.run_scripts(true);
}

/// Makes a run and checks its report, which has at least this number of plots.
fn report_of(arguments: &[&str], plots: usize) {
    let scratch = tempfile::tempdir().unwrap();
    let page = made(&scratch, "run", arguments).join("report.html");
    is_sound(&page, plots);
}

/// Checks a report, which has at least this number of plots, in every way.
fn is_sound(page: &Path, plots: usize) {
    let Some(mut browser) = Chromium::start() else { return };
    look_at(&mut browser, page);
    save(&mut browser, page, plots);
    without_scripts(&mut browser, page);
    instruments::try_all(&mut browser, page);
}

#[test]
fn the_report_of_an_estimation() {
    report_of(&["configs/pinn.toml", "fit.seeds=3"], 5);
}

#[test]
fn the_report_of_a_comparison() {
    report_of(&["configs/compare.toml", "fit.seeds=2"], 3);
}

#[test]
fn the_report_of_the_papers_suite() {
    if measured("horizontal-pendulum/80P.txt").is_some() {
        report_of(&["configs/paper.toml"], 3);
    }
}

#[test]
fn the_report_of_a_study_of_prediction() {
    let few = ["predict.problems=dry-friction,shipped-record", "predict.draws=2", "predict.draws_seeded=1"];
    report_of(&[&["configs/beyond.toml", "predict.max_steps=20"], &few[..]].concat(), 4);
}

#[test]
fn the_report_of_a_diagnosis() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = Shipped::get().copy_below(scratch.path());
    made_again(&folder);
    is_sound(&folder.join("report.html"), 11);
}

#[test]
fn the_report_of_rigs() {
    let scratch = tempfile::tempdir().unwrap();
    let folders = crate::rigs::rigs(scratch.path(), &[40.0, 60.0]);
    let asked = ["diagnose", "--rigs", &folders[0], &folders[1]];
    let page = made(&scratch, "run", &asked).join("report.html");
    let Some(mut browser) = Chromium::start() else { return };
    look_at(&mut browser, &page);
    without_scripts(&mut browser, &page);
}

#[test]
fn the_report_of_trials() {
    report_of(&[&["configs/trials-quick.toml"], crate::documents::FEW_TRIALS].concat(), 1);
}

/// Tests a sweep with a run that fails, and a comparison of its runs with another one.
#[test]
fn the_tables_of_runs() {
    let scratch = tempfile::tempdir().unwrap();
    let axes =
        ["sweep", "configs/pinn.toml", "estimator=pinn,lstm,gaussian-process", "seed=0..2", "fit.seeds=1,2"];
    let sweep = made(&scratch, "sweep", &axes);
    let bad = scratch.path().join("bad.csv");
    std::fs::write(&bad, "time_s,angle_rad\n0,1\n0.1,x\n").unwrap();
    let paths = format!("data.path={},experiments/default-record/record.csv", bad.display());
    let failing = made(&scratch, "failing", &["sweep", "configs/ols.toml", &paths]);
    let arguments = ["compare", sweep.to_str().unwrap(), failing.to_str().unwrap()];
    let table = made(&scratch, "table", &arguments);
    let Some(mut browser) = Chromium::start() else { return };
    for folder in [&sweep, &failing, &table] {
        look_at(&mut browser, &folder.join("report.html"));
    }
    save(&mut browser, &sweep.join("report.html"), 2);
    instruments::sort(&mut browser, &table.join("report.html"));
}

/// Creates a fleet of a thousand cases: the answers for three simulated systems, repeated with other errors
/// and closures.
fn fleet_of_a_thousand(scratch: &Path) -> PathBuf {
    let (cases, answers) = (scratch.join("cases"), scratch.join("answers"));
    let friction = "name = \"arm\"\nrecord.rate_hz = 130.0\nrecord.seconds = 5.0\nstart.position = 0.7\nsensor.noise = 5e-4\n\
                    [[effects]]\nid = \"coulomb_friction\"\nparameters.torque = 2.0\n";
    let drag =
        friction.replace("coulomb_friction", "quadratic_drag").replace("torque = 2", "coefficient = 1");
    let plain = &friction[..friction.find("[[").unwrap()];
    for (number, more) in [friction, &drag, plain].into_iter().enumerate() {
        let case = cases.join(number.to_string());
        std::fs::create_dir_all(&case).unwrap();
        let file = simulated(&case, more, &[]);
        for name in ["record-000.csv", "nominal.toml"] {
            std::fs::copy(file(name), case.join(name)).unwrap();
        }
    }
    let asked =
        ["diagnose", "--batch", cases.to_str().unwrap(), "--out", answers.to_str().unwrap(), "--quiet"];
    let output = trainer(&asked);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json = |path: &Path| -> Value { serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap() };
    let fleet = scratch.join("fleet");
    for number in 0..1000_u32 {
        let from = answers.join((number % 3).to_string());
        let case = fleet.join(format!("2026-11-{:02}-arm-{number:04}", number % 30 + 1));
        std::fs::create_dir_all(&case).unwrap();
        let write = |name: &str, value: &Value| std::fs::write(case.join(name), value.to_string()).unwrap();
        if number % 100 == 50 {
            let message =
                format!("{}/record-000.csv:17:9: `zero` in column angle_rad is not a number", case.display());
            write("failed.json", &json!({ "id": case.file_name().unwrap().to_str(), "message": message }));
            continue;
        }
        let mut answer = json(&from.join("diagnosis.json"));
        let apart = if number % 100 == 99 { 5.0 } else { 1.0 + 0.01 * f64::from(number % 7) };
        for path in ["/gap/ratio_to_floor", "/gap/closure/value"] {
            let value = answer.pointer_mut(path).unwrap();
            *value = json!(value.as_f64().unwrap() * apart);
        }
        write("diagnosis.json", &answer);
        let mut file = json(&from.join("case.json"));
        let joint = ["shoulder", "elbow", "wrist"][number as usize % 3];
        let (robot, date) = (format!("r{}", number % 40), format!("2026-11-{:02}", number % 30 + 1));
        file["labels"] = json!({ "robot": robot, "date": date, "joint": joint });
        write("case.json", &file);
    }
    fleet
}

#[test]
fn the_report_of_a_thousand_diagnoses() {
    let scratch = tempfile::tempdir().unwrap();
    let fleet = fleet_of_a_thousand(scratch.path());
    let output = trainer(&["report", fleet.to_str().unwrap(), "--quiet"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = fleet.join("report.html");
    let Some(mut browser) = Chromium::start() else { return };
    look_twice_at(&mut browser, &page, &BOTH, |_| ());
    without_scripts(&mut browser, &page);
    instruments::sort(&mut browser, &page);
    let count = "(() => { const table = [...document.querySelectorAll('table.rows')].find((table) => table.tBodies[0].rows.length > 900);
        const links = [...table.querySelectorAll('a')].filter((link) => link.getAttribute('href').endsWith('/diagnosis.json'));
        return links.length; })()";
    assert_eq!(browser.evaluate(count), 990);
}

/// Names as hostile and as long as the file system allows.
#[test]
fn hostile_names_are_text() {
    let scratch = tempfile::tempdir().unwrap();
    let evil = "<script>throw 1<&script>\"'$x$&lt;<img src=x onerror=throw(2)>";
    let record = scratch.path().join(format!("{evil}{}.csv", "long".repeat(30)));
    // The test is of names: a short record does.
    let shipped = std::fs::read_to_string(root().join("experiments/default-record/record.csv")).unwrap();
    std::fs::write(&record, shipped.lines().take(2000).collect::<Vec<_>>().join("\n")).unwrap();
    let config = |base: &str| {
        let config = scratch.path().join(format!("{evil}-{base}"));
        // A JSON string is a TOML string.
        let text = |path: &Path| serde_json::to_string(path.to_str().unwrap()).unwrap();
        let base = text(&root().join("configs").join(base));
        let name = text(Path::new(evil));
        std::fs::write(&config, format!("base = {base}\nname = {name}\ndata.path = {}\n", text(&record)))
            .unwrap();
        config.to_str().unwrap().to_owned()
    };
    let run = made(&scratch, &format!("{evil}-run"), &[&config("pinn.toml"), "fit.max_steps=5"]);
    let comparison = made(&scratch, &format!("{evil}-all"), &[&config("compare.toml"), "fit.max_steps=5"]);
    let both = [run.to_str().unwrap(), comparison.to_str().unwrap()];
    let table = made(&scratch, &format!("{evil}-table"), &[&["compare"], &both[..]].concat());
    let sweep = made(&scratch, &format!("{evil}-sweep"), &["sweep", &config("ols.toml"), "seed=0,1"]);
    let nominal = "experiments/default-record/nominal.toml";
    let asked = ["diagnose", record.to_str().unwrap(), "--nominal", nominal];
    let diagnosis = made(&scratch, &format!("{evil}-gap"), &asked);
    let Some(mut browser) = Chromium::start() else { return };
    for folder in [&run, &comparison, &table, &sweep, &diagnosis] {
        look_twice_at(&mut browser, &folder.join("report.html"), &BOTH, |_| ());
        let title = browser.evaluate("document.querySelector('h1').textContent");
        assert_eq!(title.as_str(), folder.file_name().unwrap().to_str());
    }
    save(&mut browser, &run.join("report.html"), 5);
}

/// Tests a page with one fault of each kind, so that the checks above are known to find them.
#[test]
fn broken_pages_are_seen() {
    let Some(mut browser) = Chromium::start() else { return };
    let scratch = tempfile::tempdir().unwrap();
    let page = scratch.path().join("page.html");
    let narrow = View { width: 390, scheme: "light" };
    let dark = View { width: 1440, scheme: "dark" };
    let head = "<!DOCTYPE html><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
                <meta name=\"color-scheme\" content=\"light dark\">";
    let mut faults = |body: &str, view: View| {
        std::fs::write(&page, format!("{head}{body}")).unwrap();
        browser.faults(&page, view)
    };
    for view in [narrow, dark] {
        let sound = "<p>sound</p><svg width=\"200\" height=\"50\"><text x=\"9\" y=\"20\" fill=\"CanvasText\">1</text></svg>";
        assert_eq!(faults(sound, view), Vec::<String>::new());
    }
    for (body, view, kind) in [
        ("<div style=\"width:600px\">wide</div>", narrow, "overflow: the page is"),
        ("<div style=\"position:absolute;left:-50px\">out</div>", narrow, "overflow: div"),
        ("<div style=\"overflow:hidden;width:9px;white-space:nowrap\">cut off</div>", dark, "overflow: div"),
        (
            "<script>console.error('spoken')</script>",
            narrow,
            "console: [{\"type\":\"string\",\"value\":\"spoken\"}]",
        ),
        ("<script>throw new Error('thrown')</script>", narrow, "console: "),
        ("<img src=\"http://127.0.0.1:9/absent.png\">", narrow, "request: http://127.0.0.1:9/absent.png"),
        ("<link rel=stylesheet href=absent.css>", narrow, "request: file://"),
        ("<p style=\"color:#777\">pale</p>", dark, "pale: p \"pale\""),
        ("<p style=\"background:#222\">inverse</p>", narrow, "pale: p \"inverse\""),
        (
            "<svg width=\"200\" height=\"50\"><text x=\"9\" y=\"20\">black</text></svg>",
            dark,
            "pale: text \"black\"",
        ),
        (
            "<svg width=\"200\" height=\"50\"><line x2=\"90\" y2=\"9\" stroke=\"#ccc\"/></svg>",
            narrow,
            "pale: svg",
        ),
        (
            "<svg width=\"200\" height=\"50\"><path d=\"M0 0L90 9\" fill=\"none\" stroke=\"#333\"/></svg>",
            dark,
            "pale: svg",
        ),
        (
            "<svg width=\"200\" viewBox=\"0 0 800 50\"><text x=\"9\" y=\"20\">tiny</text></svg>",
            narrow,
            "small: text",
        ),
        (
            "<svg width=\"200\" height=\"50\"><text x=\"180\" y=\"20\">beyond</text></svg>",
            narrow,
            "cut: text",
        ),
        (
            "<svg width=\"200\" height=\"50\"><text y=\"20\">one</text><text x=\"9\" y=\"20\">two</text></svg>",
            narrow,
            "overlap: ",
        ),
        ("<figure><svg class=\"plot\" style=\"display:none\"></svg></figure>", narrow, "absent: figure"),
    ] {
        let found = faults(body, view);
        assert!(found.iter().any(|fault| fault.starts_with(kind)), "{body}: {found:?}");
    }
}
