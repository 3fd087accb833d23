//! Finding of a sensor whose readings lag behind the motion in either direction.
//!
//! Such a lag adds a square wave that does not decay with the swing. Its harmonics look like stiffness, and its phase
//! like drifting clocks and springs, so it is fitted before physical effects. It takes none of a set's places, because
//! quantization steps are visible without a fit.

use crate::answer::Finding;
use crate::data::segments::Data;
use crate::fit::fitted::Fit;

/// Returns the finding that states the hysteresis; `None` if the fit has none.
pub(crate) fn finding(data: &Data, fit: &Fit) -> Option<Finding> {
    let width = fit.hypothesis.measurement(&data.facts, &fit.point.globals).reading?;
    let steps = width / data.facts.resolution;
    Some(Finding {
        effect: None,
        text: format!("readings lag behind the motion by {steps:.2} of a step, in both directions"),
    })
}

#[cfg(test)]
mod tests {
    use crate::fixtures::record;
    use crate::model::encoder_hysteresis::readings;
    use crate::{Diagnosis, Observations, Settings, Status, diagnose};
    use dynamics::chain::{Chain, Observed};
    use dynamics::{Active, Nominal, System};
    use record::{Clock, ClockChoice};

    const WIDTH: f64 = 0.02;

    /// Diagnosis of 15 s of a swing with drag, 260 samples a second, through an encoder of 4096 steps a turn
    /// with a hysteresis of `steps` steps in either direction and noise of a tenth of a step.
    fn diagnosed(steps: f64) -> Diagnosis {
        let step = std::f64::consts::TAU / 4096.0;
        let nominal = Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap();
        let drag = Active::new("quadratic_drag", &[0.02]).unwrap();
        let system = System::new(nominal, vec![drag]).unwrap();
        let encoder = Active::new("sensor_quantization", &[step, steps * step]).unwrap();
        let chain = Chain::new(Observed::Position, 0.1 * step, vec![encoder]).unwrap();
        let record = record(&system, 0.7, 3900, &chain, 11);
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        diagnose(&[Observations::new(&record, &clock)], &nominal, &Settings::default(), &|| 0.0).unwrap()
    }

    #[test]
    fn an_encoders_hysteresis_is_found_beside_a_torque() {
        let answer = diagnosed(0.5);
        assert_eq!(answer.verdict.status, Status::Effect);
        assert_eq!(answer.verdict.effects, ["quadratic_drag", "sensor_quantization"]);
        let row = answer.effects.iter().find(|row| row.id == "sensor_quantization").unwrap();
        let value = |name: &str| row.parameters.iter().find(|own| own.name == name).unwrap().estimate.value;
        let half = 0.5 * std::f64::consts::TAU / 4096.0;
        assert!((value("step") / (2.0 * half) - 1.0).abs() < 1e-6);
        assert!((value("hysteresis") / half - 1.0).abs() < 0.1, "{} {half}", value("hysteresis"));
        let ratio = answer.gap.repaired / answer.gap.noise_floor;
        assert!(ratio < 1.05, "{ratio}");
    }

    #[test]
    fn an_encoder_without_hysteresis_gets_none() {
        let answer = diagnosed(0.0);
        assert_eq!(answer.verdict.effects, ["quadratic_drag", "sensor_quantization"]);
        let row = answer.effects.iter().find(|row| row.id == "sensor_quantization").unwrap();
        assert!(row.parameters.is_empty() && row.gap_share.is_none(), "{row:?}");
    }

    /// Differences between readings and values of a swing of amplitude 0.3 that begins at some phase.
    fn swing(phase: f64) -> Vec<f64> {
        let values: Vec<f64> = (0..400).map(|i| 0.3 * (phase + 0.05 * f64::from(i)).cos()).collect();
        let (rate, curvature) = (-0.3 * phase.sin(), -0.3 * phase.cos());
        let all = readings(values.iter().copied(), WIDTH, rate, curvature);
        all.iter().zip(&values).map(|(reading, value)| reading.value - value).collect()
    }

    /// Wherever a steady swing begins, it is read as if it had gone on for long, except for the change of the
    /// curvature since the reversal.
    #[test]
    fn the_first_reading_is_that_of_a_swing_that_has_gone_on() {
        let long = swing(0.0);
        for start in 0..126 {
            let own = swing(0.05 * f64::from(start));
            for (own, long) in own.iter().zip(long.iter().skip(start as usize)).take(60).skip(1) {
                assert!((own - long).abs() < 0.1 * WIDTH, "{start}: {own} {long}");
            }
        }
    }

    /// The third and fifth harmonic of a square wave are 4/(3π) and 4/(5π) of its size, the width.
    #[test]
    fn a_swing_is_shifted_against_its_motion() {
        let count = 4000;
        let phases: Vec<f64> = (0..count).map(|i| std::f64::consts::TAU * f64::from(i) / 1000.0).collect();
        let values = phases.iter().map(|phase| phase.cos());
        let width = 1e-4;
        let all = readings(values.clone(), width, 0.0, -1.0);
        for order in [3.0, 5.0] {
            let sum: f64 = all
                .iter()
                .zip(values.clone())
                .zip(&phases)
                .map(|((reading, value), phase)| (reading.value - value) * (order * phase).sin())
                .sum();
            let harmonic = 2.0 * sum / f64::from(count);
            let expected = 4.0 / (order * std::f64::consts::PI) * width;
            assert!((harmonic / expected - 1.0).abs() < 0.05, "{order}: {harmonic} {expected}");
        }
    }

    #[test]
    fn a_readings_derivative_by_the_width_is_that_of_its_value() {
        let values = || (0..300).map(|i| 0.3 * (-0.01 * f64::from(i)).exp() * (0.07 * f64::from(i)).sin());
        let at = |width: f64| readings(values(), width, 0.021, 0.0);
        let h = 1e-9;
        for ((own, above), below) in at(WIDTH).iter().zip(at(WIDTH + h)).zip(at(WIDTH - h)) {
            let difference = (above.value - below.value) / (2.0 * h);
            assert!((difference - own.by_width).abs() < 1e-6, "{own:?} {difference}");
        }
    }
}
