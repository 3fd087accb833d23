//! Tests of interactive plots and tables: zoom, values at the pointer, legends, sorting. They use real mouse
//! events.

use super::chromium::{Chromium, VIEWS, View};
use std::path::Path;

/// Tests the interactive plots of a page, on a phone and on a desktop.
pub(super) fn try_all(browser: &mut Chromium, page: &Path) {
    for view in [VIEWS[0], VIEWS[2]] {
        browser.open(page, view);
        let live = browser
            .evaluate("[...document.querySelectorAll('figure')].filter((f) => f.plot).map((f) => f.id)");
        let live: Vec<String> = serde_json::from_value(live).unwrap();
        let data = browser.evaluate("document.querySelectorAll('script.live').length");
        assert_eq!(
            data.as_u64(),
            Some(live.len() as u64),
            "{}: every plot with data responds",
            page.display()
        );
        for id in &live {
            let place = format!("{} {id} {view:?}", page.display());
            hover_and_zoom(browser, id, &place);
            toggle(browser, id, &place);
        }
        contents(browser, view);
    }
}

/// Tests that a drag across the middle zooms in, a double click zooms out, and the pointer shows values.
fn hover_and_zoom(browser: &mut Chromium, id: &str, place: &str) {
    let find = format!(
        "(() => {{ const over = document.getElementById('{id}').querySelector('.u-over');
            over.scrollIntoView({{ block: 'center' }});
            const {{ left, top, width, height }} = over.getBoundingClientRect();
            return [left, top, width, height]; }})()"
    );
    let [left, top, width, height]: [f64; 4] = serde_json::from_value(browser.evaluate(&find)).unwrap();
    let at = |x: f64, y: f64| [left + x * width, top + y * height];
    let span = format!(
        "(() => {{ const {{ min, max }} = document.getElementById('{id}').plot.u.scales.x; return max - min; }})()"
    );
    let span = |browser: &mut Chromium| browser.evaluate(&span).as_f64().unwrap();
    let whole = span(browser);

    // Somewhere along the plot a series is near enough to the pointer to show a value.
    let shown = format!(
        "(() => {{ const box = document.getElementById('{id}').querySelector('.values');
            const [it, of] = [box, document.documentElement].map((element) => element.getBoundingClientRect());
            return box.hidden ? null : [box.textContent, it.left >= 0 && it.right <= innerWidth ? 'inside' : 'cut']; }})()"
    );
    let found = (1..20).find_map(|step| {
        browser.mouse("mouseMoved", at(f64::from(step) / 20.0, 0.5), 0);
        browser.evaluate(&shown).as_array().cloned()
    });
    let found = found.unwrap_or_else(|| panic!("{place}: no value under the pointer"));
    assert!(
        found[0].as_str().unwrap().contains(|letter: char| letter.is_ascii_digit()),
        "{place}: {found:?}"
    );
    assert_eq!(found[1], "inside", "{place}: {found:?}");

    browser.mouse("mouseMoved", at(0.4, 0.5), 0);
    browser.mouse("mousePressed", at(0.4, 0.5), 1);
    browser.mouse("mouseMoved", at(0.5, 0.5), 1);
    browser.mouse("mouseMoved", at(0.6, 0.5), 1);
    browser.mouse("mouseReleased", at(0.6, 0.5), 1);
    let part = span(browser);
    assert!((part / whole - 0.2).abs() < 0.03, "{place}: a drag over a fifth leaves {part} of {whole}");
    for clicks in [1, 2] {
        browser.mouse("mousePressed", at(0.5, 0.5), clicks);
        browser.mouse("mouseReleased", at(0.5, 0.5), clicks);
    }
    let again = span(browser);
    assert!((again / whole - 1.0).abs() < 1e-9, "{place}: a double click leaves {again} of {whole}");
}

/// Tests that the first entry of a legend hides its series and shows it again.
fn toggle(browser: &mut Chromium, id: &str, place: &str) {
    let press = format!(
        "(() => {{ const figure = document.getElementById('{id}');
            const button = figure.querySelector('.legend button');
            const shown = () => figure.plot.u.series.filter((series) => series.show).length;
            const before = shown();
            button.click();
            const without = [shown() < before, button.getAttribute('aria-pressed')];
            button.click();
            return [...without, shown() === before, button.getAttribute('aria-pressed')]; }})()"
    );
    let found = browser.evaluate(&press);
    assert_eq!(found, serde_json::json!([true, "false", true, "true"]), "{place}");
}

/// Tests that every entry of the contents leads to its section; on a desktop the contents stay visible.
fn contents(browser: &mut Chromium, view: View) {
    let found = browser.evaluate(
        "(() => { const contents = document.querySelector('nav.contents');
            if (!contents) return [0, 0, true];
            const links = [...contents.querySelectorAll('a')];
            scrollTo(0, document.body.scrollHeight / 2);
            const top = contents.getBoundingClientRect().top;
            return [links.length, links.filter((link) => document.getElementById(link.hash.slice(1))).length, top > -1 && top < 900];
        })()",
    );
    assert_eq!(found[0], found[1], "{found}");
    assert!(view.width < 1000 || found[2] == true, "the contents have left the window: {found}");
}

/// Tests that a click on a heading sorts by its column and another click reverses the order; the Enter key
/// does the same.
pub(super) fn sort(browser: &mut Chromium, page: &Path) {
    browser.open(page, VIEWS[2]);
    let found = browser.evaluate(
        "(() => { const results = [];
            for (const table of document.querySelectorAll('table.rows')) {
                [...table.tHead.rows[0].cells].forEach((head, column) => {
                    const button = head.querySelector('button');
                    if (!button) return;
                    const read = () => [...table.tBodies[0].rows].map((row) => row.cells[column])
                        .map((cell) => cell && cell.colSpan === 1 ? cell.textContent.trim() : '');
                    button.click();
                    const [up, said] = [read(), head.getAttribute('aria-sort')];
                    button.click();
                    results.push({ column: head.textContent, up, said, down: read(), then: head.getAttribute('aria-sort') });
                });
            }
            return results; })()",
    );
    let columns = found.as_array().unwrap();
    assert!(columns.len() > 5, "{}: {found}", page.display());
    let mut numeric = 0;
    for column in columns {
        assert_eq!([&column["said"], &column["then"]], ["ascending", "descending"], "{column}");
        let read = |key: &str| -> Vec<String> {
            let cells: Vec<String> = serde_json::from_value(column[key].clone()).unwrap();
            cells.into_iter().filter(|cell| !cell.is_empty() && cell != "–").collect()
        };
        let numbers =
            |cells: &[String]| -> Option<Vec<f64>> { cells.iter().map(|cell| cell.parse().ok()).collect() };
        if let (Some(up), Some(down)) = (numbers(&read("up")), numbers(&read("down"))) {
            assert!(up.is_sorted() && down.is_sorted_by(|a, b| a >= b), "{column}");
            numeric += usize::from(up.len() > 2);
        }
    }
    assert!(numeric > 0, "{}: no column of plain numbers: {found}", page.display());
    browser.open(page, VIEWS[2]);
    let focused = "(() => { const button = document.querySelector('table.rows thead button'); button.focus();
        return document.activeElement === button; })()";
    assert_eq!(browser.evaluate(focused), true);
    browser.press("Enter");
    let sorted = browser.evaluate("document.activeElement.closest('th').getAttribute('aria-sort')");
    assert_eq!(sorted, "ascending");
}
