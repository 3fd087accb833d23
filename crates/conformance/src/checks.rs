//! The checks.

use crate::envelopes::{bent, exponential, scattered};
use crate::{Check, Subject};
use envelope::Envelope;
use estimator::{Entry, Estimate, FitError, Tag};
use seed::Seed;
use settings::{Document, Kind, Resolved, Section};

/// Every check, in the order of reading.
pub const CHECKS: &[Check] = &[
    Check { name: "out_of_range_settings_are_refused_by_name", applies: always, run: ranges },
    Check { name: "the_envelope_is_left_alone", applies: always, run: left_alone },
    Check { name: "odd_envelopes_give_numbers_or_typed_errors", applies: always, run: odd },
    Check { name: "the_same_seed_gives_the_same_bits", applies: always, run: same_bits },
    Check { name: "another_seed_takes_another_way", applies: seeded, run: other_way },
    Check { name: "threads_do_not_change_a_bit", applies: always, run: threads },
    Check { name: "a_louder_record_decays_as_fast", applies: method, run: louder },
    Check { name: "a_slower_clock_slows_the_decay", applies: method, run: slower },
    Check { name: "an_added_decay_is_added", applies: method, run: added },
    Check { name: "untrained_it_is_wrong", applies: iterative, run: untrained },
    Check { name: "it_recovers_a_pure_exponential", applies: method, run: pure },
    Check { name: "its_error_falls_with_the_square_root_of_the_peaks", applies: method, run: falls },
    Check { name: "it_beats_the_null_estimator", applies: method, run: beats_null },
    Check { name: "it_agrees_with_least_squares", applies: method, run: agrees },
];

fn always(_: &Entry) -> bool {
    true
}

fn seeded(entry: &Entry) -> bool {
    entry.has(Tag::Seeded)
}

fn iterative(entry: &Entry) -> bool {
    entry.has(Tag::Iterative)
}

fn method(entry: &Entry) -> bool {
    !entry.has(Tag::Null)
}

/// The paper's bar: largest relative error against least squares.
const BAR: f64 = 1e-3;

fn given(envelope: Option<Envelope>) -> Result<Envelope, String> {
    envelope.ok_or_else(|| "the battery's own envelope is unusable".to_owned())
}

fn fitted(subject: &Subject<'_>, envelope: &Envelope, seed: u64) -> Result<Estimate, String> {
    subject.fit(envelope, seed, None).map_err(|error| error.to_string())
}

/// |a/b − 1| at most `bar`.
fn close(what: &str, found: f64, expected: f64, bar: f64) -> Result<(), String> {
    let off = (found / expected - 1.0).abs();
    if off <= bar { Ok(()) } else { Err(format!("{what}: {found} for {expected}, off by {off:.1e}")) }
}

fn ranges(subject: &Subject<'_>) -> Result<(), String> {
    let sections = [Section { name: "estimator", fields: subject.entry.fields }];
    for field in subject.entry.fields {
        let bad = match field.kind {
            Kind::Integer { min, .. } if min > i64::MIN => (min - 1).to_string(),
            Kind::Float { max, .. } if max < f64::MAX => format!("{:e}", max * 2.0 + 1.0),
            Kind::Choice(_) => "no-such-word".to_owned(),
            Kind::Integers { .. } | Kind::Floats { .. } | Kind::Texts { .. } => "[]".to_owned(),
            Kind::Boolean => "3".to_owned(),
            _ => continue,
        };
        let mut document = Document::default();
        document
            .apply_override(&format!("estimator.{}={bad}", field.key))
            .map_err(|error| error.to_string())?;
        match Resolved::new(&document, &sections) {
            Err(error) if error.to_string().contains(field.key) => {}
            Err(error) => return Err(format!("`{}` = {bad}: {error}", field.key)),
            Ok(_) => return Err(format!("`{}` = {bad} is accepted", field.key)),
        }
    }
    Ok(())
}

fn left_alone(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let before = envelope.clone();
    fitted(subject, &envelope, 0)?;
    if envelope == before { Ok(()) } else { Err("the envelope has changed".to_owned()) }
}

fn odd(subject: &Subject<'_>) -> Result<(), String> {
    let envelopes = [
        ("three peaks", exponential(3, 0.0, 0.2)),
        ("four peaks", exponential(4, 0.0, 0.2)),
        ("constant", exponential(50, 0.3, 0.0)),
        ("growing", exponential(50, 0.3, -0.2)),
        ("dying within a peak", exponential(30, 0.0, 50.0)),
        ("hardly decaying", exponential(50, 0.0, 1e-9)),
        ("huge", exponential(50, 600.0, 0.2)),
        ("tiny", exponential(50, -600.0, 0.2)),
        ("far apart", Envelope::new(vec![0.0, 1e6, 2e6, 3e6, 4e6], vec![4.0, 3.0, 2.5, 1.0, 0.0], 1.0).ok()),
        (
            "crowded",
            Envelope::new(vec![0.0, 1e-9, 2e-9, 3e-9, 1.0], vec![0.0, 0.1, -0.1, 0.0, -1.0], 1.0).ok(),
        ),
        ("noise alone", scattered(40, 0.0, 1.0, &Seed::new(3))),
    ];
    for (name, envelope) in envelopes {
        match subject.fit(&given(envelope)?, 0, None) {
            Ok(estimate) => numbers(name, &estimate)?,
            // A refusal is an answer; a broken backend is not.
            Err(FitError::Backend { problem }) => return Err(format!("{name}: {problem}")),
            Err(_) => {}
        }
    }
    Ok(())
}

fn numbers(name: &str, estimate: &Estimate) -> Result<(), String> {
    let uncertainty = estimate
        .uncertainty
        .iter()
        .flat_map(|known| [known.std_error, known.interval_95[0], known.interval_95[1]]);
    let finite = [estimate.decay_rate, estimate.log_amplitude]
        .into_iter()
        .chain(uncertainty)
        .chain(estimate.fitted_log_amplitudes.iter().copied())
        .all(f64::is_finite);
    if finite { Ok(()) } else { Err(format!("{name}: not finite: {estimate:?}")) }
}

fn same_bits(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let (one, other) = (fitted(subject, &envelope, 5)?, fitted(subject, &envelope, 5)?);
    if one == other { Ok(()) } else { Err("two fits with one seed differ".to_owned()) }
}

/// Two seeds may start alike (a drawn expression can be a constant); eight do not.
fn other_way(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let start = |seed| {
        let estimate = subject.fit(&envelope, seed, Some(0)).map_err(|error| error.to_string())?;
        Ok::<u64, String>(estimate.decay_rate.to_bits())
    };
    let first = start(0)?;
    for seed in 1..8 {
        if start(seed)? != first {
            return Ok(());
        }
    }
    Err("eight seeds start at the same estimate".to_owned())
}

fn threads(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let fit = |seed| fitted(subject, &envelope, seed);
    let alone = [fit(0)?, fit(1)?];
    let together = std::thread::scope(|scope| {
        let handles = [0, 1].map(|seed| scope.spawn(move || fit(seed)));
        handles.map(|handle| handle.join().unwrap_or_else(|_| Err("a thread died".to_owned())))
    });
    let [one, other] = together;
    if [one?, other?] == alone { Ok(()) } else { Err("side by side, fits differ".to_owned()) }
}

/// The bent envelope with other times and logarithms.
fn changed(change: impl Fn(f64, f64) -> (f64, f64)) -> Result<Envelope, String> {
    let envelope = given(bent())?;
    let (times, logs) = envelope
        .times_s()
        .iter()
        .zip(envelope.log_amplitudes())
        .map(|(&time, &log)| change(time, log))
        .unzip();
    Envelope::new(times, logs, envelope.omega_rad_s()).map_err(|error| error.to_string())
}

/// How far a trained method may miss an equivariance: the accuracy it trains to, not more.
const EQUIVARIANCE: f64 = 1e-4;

fn louder(subject: &Subject<'_>) -> Result<(), String> {
    let one = fitted(subject, &given(bent())?, 0)?;
    let other = fitted(subject, &changed(|time, log| (time, log + 2.5))?, 0)?;
    close("λ of a louder record", other.decay_rate, one.decay_rate, EQUIVARIANCE)
}

fn slower(subject: &Subject<'_>) -> Result<(), String> {
    let one = fitted(subject, &given(bent())?, 0)?;
    let other = fitted(subject, &changed(|time, log| (3.0 * time, log))?, 0)?;
    close("λ on a slower clock", 3.0 * other.decay_rate, one.decay_rate, EQUIVARIANCE)
}

fn added(subject: &Subject<'_>) -> Result<(), String> {
    let one = fitted(subject, &given(bent())?, 0)?;
    let other = fitted(subject, &changed(|time, log| (time, log - 0.1 * time))?, 0)?;
    close("λ with 0.1/s added", other.decay_rate, one.decay_rate + 0.1, EQUIVARIANCE)
}

fn untrained(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let truth = least_squares(&envelope);
    for seed in 0..20 {
        let estimate = subject.fit(&envelope, seed, Some(0)).map_err(|error| error.to_string())?;
        let off = (estimate.decay_rate / truth - 1.0).abs();
        if off <= 0.01 {
            return Err(format!("seed {seed}: untrained, yet off by {off:.1e} only"));
        }
        if estimate.steps != 0 {
            return Err(format!("seed {seed}: {} steps on a budget of none", estimate.steps));
        }
    }
    Ok(())
}

fn pure(subject: &Subject<'_>) -> Result<(), String> {
    for (peaks, rate) in [(69, 0.191), (12, 1.5), (200, 0.01)] {
        let estimate = fitted(subject, &given(exponential(peaks, -0.6, rate))?, 0)?;
        close(&format!("λ of {peaks} noise-free peaks"), estimate.decay_rate, rate, BAR)?;
    }
    Ok(())
}

/// Sixteen times the peaks over the same span: a quarter of the error, within what twelve draws tell.
fn falls(subject: &Subject<'_>) -> Result<(), String> {
    let rate = 0.2;
    let error = |peaks: usize| -> Result<f64, String> {
        let mut squares = 0.0;
        for draw in 0..12 {
            let seed = Seed::new(draw).child("falls");
            let dense = given(scattered(peaks, rate * 20.0 / peaks as f64, 0.1, &seed))?;
            let estimate = fitted(subject, &dense, draw)?;
            squares += (estimate.decay_rate * peaks as f64 / 20.0 - rate).powi(2);
        }
        Ok((squares / 12.0).sqrt())
    };
    let ratio = error(20)? / error(320)?;
    // log(ratio)/log(16) is 1/2; its standard error over 12 + 12 draws is about 0.1.
    let exponent = ratio.ln() / 16_f64.ln();
    if (0.2..0.8).contains(&exponent) {
        Ok(())
    } else {
        Err(format!("the error falls as the peaks to the power of −{exponent:.2}"))
    }
}

fn beats_null(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let estimate = fitted(subject, &envelope, 0)?;
    let squares = |fit: &dyn Fn(usize) -> f64| -> f64 {
        envelope.log_amplitudes().iter().enumerate().map(|(at, log)| (log - fit(at)).powi(2)).sum()
    };
    let fitted = &estimate.fitted_log_amplitudes;
    if fitted.len() != envelope.len() {
        return Err(format!("{} fitted values for {} peaks", fitted.len(), envelope.len()));
    }
    let mean = envelope.log_amplitudes().iter().sum::<f64>() / envelope.len() as f64;
    let own = squares(&|at| fitted.get(at).copied().unwrap_or(f64::NAN));
    let null = squares(&|_| mean);
    if own < null { Ok(()) } else { Err(format!("squares {own:.3e}, those of a constant {null:.3e}")) }
}

fn agrees(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let truth = least_squares(&envelope);
    for seed in 0..3 {
        let estimate = fitted(subject, &envelope, seed)?;
        close(&format!("λ, seed {seed}"), estimate.decay_rate, truth, BAR)?;
    }
    Ok(())
}

/// Minus the slope of the least-squares line: the textbook's formula, good to ten digits here.
fn least_squares(envelope: &Envelope) -> f64 {
    let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
    let count = times.len() as f64;
    let mean_time = times.iter().sum::<f64>() / count;
    let mean_log = logs.iter().sum::<f64>() / count;
    let product: f64 = times.iter().zip(logs).map(|(t, y)| (t - mean_time) * (y - mean_log)).sum();
    let square: f64 = times.iter().map(|t| (t - mean_time).powi(2)).sum();
    -product / square
}
