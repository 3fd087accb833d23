//! Commands that jump between two samples.

use record::median;

/// Change of an input, in median ones, from which it jumps.
const JUMPS: f64 = 20.0;

/// Fits the response to a command that jumps at any time up to one sample, `interval` seconds, before the new value is written,
/// and is held or changes evenly between its jumps; `None` for an input that does not jump. `fit` gives the sum of the squared
/// residuals and the answer to pushes at times, held or not.
///
/// The sum of the squared residuals is nearly a parabola in the time of the jumps.
pub(super) fn jumping<T>(
    pushes: &[(f64, f64)],
    interval: f64,
    fit: impl Fn(&[(f64, f64)], bool) -> Option<(f64, T)>,
) -> Option<(f64, T)> {
    let changes = pushes.iter().zip(pushes.iter().skip(1)).map(|(one, next)| (next.1 - one.1).abs());
    let least = JUMPS * median(changes.clone().collect())?;
    // A held input changes at every jump alone.
    let least = if least > 0.0 { least } else { f64::MIN_POSITIVE };
    if !changes.clone().any(|change| change >= least) {
        return None;
    }
    let nearest =
        |fits: &mut dyn Iterator<Item = (f64, T)>| fits.min_by(|one, other| one.0.total_cmp(&other.0));
    let fits = [true, false].map(|kept| {
        let fit = |part: f64| fit(&moved(pushes, part * interval, if kept { 0.0 } else { least }), kept);
        let [now, half, whole] = [fit(0.0)?, fit(0.5)?, fit(1.0)?];
        let slope = 4.0 * half.0 - whole.0 - 3.0 * now.0;
        let bend = 2.0 * (whole.0 - 2.0 * half.0 + now.0);
        let lowest = (bend > 0.0).then(|| (-0.5 * slope / bend).clamp(0.0, 1.0)).and_then(fit);
        nearest(&mut [now, half, whole].into_iter().chain(lowest))
    });
    nearest(&mut fits.into_iter().flatten())
}

/// Returns pushes whose changes of a size or more happen at once, some time before they are written.
fn moved(pushes: &[(f64, f64)], earlier: f64, least: f64) -> Vec<(f64, f64)> {
    let mut moved: Vec<(f64, f64)> = Vec::with_capacity(2 * pushes.len());
    for &(time, push) in pushes {
        if let Some(&(before, last)) = moved.last().filter(|(_, last)| (push - last).abs() >= least) {
            let at = (time - earlier).max(before);
            moved.extend([(at, last), (at, push)]);
        }
        moved.push((time, push));
    }
    moved
}

#[cfg(test)]
mod tests {
    use crate::identify;
    use rand_distr::{Distribution, Normal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    /// Regression: a step that came just after a sample was taken to come with the next one, and 1.2 Hz were 1.216 Hz.
    #[test]
    fn a_step_between_two_samples_is_placed() {
        let (zeta, omega): (f64, f64) = (0.35, 1.2 * std::f64::consts::TAU);
        let root = omega * (1.0 - zeta * zeta).sqrt();
        let (normal, mut draws) = (Normal::new(0.0, 4e-3).unwrap(), Seed::new(3).child("noise").generator());
        for at in [1.001, 1.005, 1.009] {
            let answer = |time: f64| match time - at {
                since if since < 0.0 => 0.0,
                since => {
                    let decay = (-zeta * omega * since).exp();
                    1.0 - decay * ((root * since).cos() + zeta * omega / root * (root * since).sin())
                }
            };
            let times: Vec<f64> = (0..600).map(|sample| 0.01 * f64::from(sample)).collect();
            let values = times.iter().map(|time| answer(*time) + normal.sample(&mut draws)).collect();
            let input = times.iter().map(|time| f64::from(u8::from(*time > at))).collect();
            let record = Record::new(times, values, Some(input), Quantity::Position, "rad").unwrap();
            let found = identify(&record, &Clock::new(&record, ClockChoice::Auto).unwrap()).unwrap();
            let (frequency, ratio) = (found.natural_frequency_hz().unwrap(), found.damping_ratio().unwrap());
            assert!((frequency.value - 1.2).abs() < 3.0 * frequency.std_error, "{at}: {frequency:?}");
            assert!((ratio.value - zeta).abs() < 3.0 * ratio.std_error, "{at}: {ratio:?}");
        }
    }

    /// Regression: the noise of a measured torque moved the simulated joint, and its damping ratio was 12 standard errors off.
    #[test]
    fn the_noise_of_a_measured_input_is_in_the_errors() {
        let (zeta, omega, interval) = (0.03, 8.0, 0.01);
        for seed in 0..4 {
            let mut draws = Seed::new(seed).child("noise").generator();
            let normal = Normal::new(0.0, 1.0).unwrap();
            let (mut x, mut v) = (0.0, 0.0);
            let (mut times, mut values, mut input) = (Vec::new(), Vec::new(), Vec::new());
            for sample in 0..2000 {
                let push = if sample < 400 { 30.0 } else { 0.0 };
                times.push(interval * f64::from(sample));
                values.push(x + 2e-3 * normal.sample(&mut draws));
                input.push(push + 0.2 * normal.sample(&mut draws));
                for _ in 0..20 {
                    let step = interval / 20.0;
                    let rate = |x: f64, v: f64| push - 2.0 * zeta * omega * v - omega * omega * x;
                    let (middle, speed) = (x + 0.5 * step * v, v + 0.5 * step * rate(x, v));
                    x += step * speed;
                    v += step * rate(middle, speed);
                }
            }
            let record = Record::new(times, values, Some(input), Quantity::Position, "rad").unwrap();
            let found = identify(&record, &Clock::new(&record, ClockChoice::Auto).unwrap()).unwrap();
            let ratio = found.damping_ratio().unwrap();
            assert!((ratio.value - zeta).abs() < 3.0 * ratio.std_error, "{seed}: {ratio:?}");
            assert!(ratio.std_error < 0.05 * zeta, "{seed}: {ratio:?}");
        }
    }
}
