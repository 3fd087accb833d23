//! The modes of a record that has several, in words, rows and JSON.

use identify::{Estimated, Mode};
use report::format::{percent, with_uncertainty};
use report::{half_power_width, quality_factor};
use results::Resonance;
use workflow::resonance;

pub(super) fn uncertain(estimated: Estimated) -> String {
    format!("{} (standard error)", with_uncertainty(estimated.value, estimated.std_error))
}

/// Returns the rows on the sharpness of a resonance.
pub(super) fn sharpness(resonance: &Resonance) -> [Vec<String>; 2] {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    [
        row("quality factor 1/(2ζ)", quality_factor(resonance)),
        row("half-power width 2ζf, Hz", half_power_width(resonance)),
    ]
}

/// Returns a row of the table for each of several modes.
pub(super) fn rows(modes: &[Mode]) -> Vec<Vec<String>> {
    let several = Some(modes).filter(|modes| modes.len() > 1);
    let row = |(at, mode): (usize, &Mode)| {
        let [frequency, ratio] = [mode.frequency_hz, mode.damping_ratio].map(uncertain);
        let share = percent(100.0 * mode.share);
        if mode.is_steady {
            return vec!["steady line".to_owned(), format!("{frequency}, Hz; {share} of the power")];
        }
        let sharpness = resonance(mode.frequency_hz, mode.damping_ratio).map(|found| {
            format!("; Q {}, half-power width {} Hz", quality_factor(&found), half_power_width(&found))
        });
        let sharpness = sharpness.unwrap_or_default();
        let numbers = format!("{frequency}, Hz; damping ratio {ratio}{sharpness}; {share} of the power");
        vec![format!("mode {}", at + 1), numbers]
    };
    several.into_iter().flatten().enumerate().map(row).collect()
}
