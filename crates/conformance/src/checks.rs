//! Checks of the battery.

use crate::envelopes::{bent, exponential, scattered};
use crate::line::least_squares;
use crate::{Check, Subject, query_times};
use envelope::Envelope;
use estimator::{Ablation, Entry, Estimand, Estimate, FitError, Reached, Tag};
use seed::Seed;
use settings::{Document, Kind, Resolved, Section};

/// Every check, in the order of reports.
pub const CHECKS: &[Check] = &[
    Check { name: "out_of_range_settings_are_refused_by_name", applies: always, run: ranges },
    Check { name: "the_envelope_is_left_alone", applies: always, run: left_alone },
    Check { name: "odd_envelopes_give_numbers_or_typed_errors", applies: always, run: odd },
    Check { name: "the_same_seed_gives_the_same_bits", applies: always, run: same_bits },
    Check { name: "pretrained_it_gives_the_same_bits", applies: amortized, run: pretrained },
    Check { name: "another_seed_takes_another_way", applies: seeded, run: other_way },
    Check { name: "threads_do_not_change_a_bit", applies: always, run: threads },
    Check { name: "a_louder_record_decays_as_fast", applies: method, run: louder },
    Check { name: "a_slower_clock_slows_the_decay", applies: method, run: slower },
    Check { name: "an_added_decay_is_added", applies: method, run: added },
    Check { name: "it_does_not_start_at_the_answer", applies: iterative, run: untrained },
    Check { name: "with_its_learned_part_at_zero_it_is_wrong", applies: ablated, run: at_zero },
    Check { name: "reading_noise_it_is_wrong", applies: ablated, run: on_noise },
    Check { name: "away_from_its_end_it_states_no_interval", applies: always, run: no_interval },
    Check { name: "it_recovers_a_pure_exponential", applies: method, run: pure },
    Check { name: "its_error_falls_with_the_square_root_of_the_peaks", applies: method, run: falls },
    Check { name: "it_beats_the_null_estimator", applies: method, run: beats_null },
    Check { name: "it_agrees_with_least_squares", applies: least_squares_itself, run: agrees },
    Check { name: "what_it_estimates_is_not_least_squares", applies: own_estimand, run: differs },
    Check { name: "it_is_nearly_as_good_as_least_squares", applies: amortized, run: nearly_as_good },
    Check { name: "its_predictions_are_its_fitted_function", applies: always, run: predictions },
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

fn amortized(entry: &Entry) -> bool {
    entry.has(Tag::Amortized)
}

fn ablated(entry: &Entry) -> bool {
    entry.has(Tag::Ablation)
}

fn least_squares_itself(entry: &Entry) -> bool {
    matches!(entry.estimand(), Estimand::LeastSquares | Estimand::Approximation)
}

fn own_estimand(entry: &Entry) -> bool {
    entry.estimand() == Estimand::Own
}

fn method(entry: &Entry) -> bool {
    !entry.has(Tag::Null)
}

/// Bar of the paper: largest relative error against least squares.
const BAR: f64 = 1e-3;

/// Largest distance of an amortized method from least squares, in standard errors of least squares. An error
/// of this size, independent of the line's, makes the total error a tenth larger: √(1 + 0.458²) = 1.1.
const AMORTIZED_BAR: f64 = 0.458;

/// Largest violation of an equivariance by an amortized method, in standard errors of least squares. The
/// method looks at the residuals repeatedly until one look moves λ by less than a hundredth of its stated
/// error; the omitted looks add up to a few hundredths.
const AMORTIZED_EQUIVARIANCE: f64 = 0.05;

fn given(envelope: Option<Envelope>) -> Result<Envelope, String> {
    envelope.ok_or_else(|| "the battery's own envelope is unusable".to_owned())
}

fn fitted(subject: &Subject<'_>, envelope: &Envelope, seed: u64) -> Result<Estimate, String> {
    subject.fit(envelope, seed, None).map_err(|error| error.to_string())
}

/// Checks that |a/b − 1| is at most `bar`.
fn close(what: &str, found: f64, expected: f64, bar: f64) -> Result<(), String> {
    let off = (found / expected - 1.0).abs();
    if off <= bar { Ok(()) } else { Err(format!("{what}: {found} for {expected}, off by {off:.1e}")) }
}

/// Returns the relative size of `share` standard errors of the least-squares line on an envelope.
fn relative(envelope: &Envelope, share: f64) -> f64 {
    let line = least_squares(envelope);
    (share * line.std_error / line.decay_rate).abs()
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
    // A few steps run all code that could change the envelope.
    subject.fit_anew(&envelope, 0, Some(2)).map_err(|error| error.to_string())?;
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
            // A refusal is a valid answer; a broken backend is not.
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
        .chain(estimate.predictions.iter().map(|prediction| prediction.log_amplitude))
        .chain(estimate.predictions.iter().filter_map(|prediction| prediction.std_error))
        .all(f64::is_finite);
    if finite { Ok(()) } else { Err(format!("{name}: not finite: {estimate:?}")) }
}

/// Compares a fit from scratch with the stored one that the other checks use.
fn same_bits(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let steps = subject.short();
    let one = subject.fit(&envelope, 0, steps);
    if one == subject.fit_anew(&envelope, 0, steps) {
        Ok(())
    } else {
        Err("two fits with one seed differ".to_owned())
    }
}

/// Compares a whole training, from the first step through the calibration, with few of each: both ways train as long.
fn pretrained(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let brief = Subject::brief(subject.entry).map_err(|error| error.to_string())?;
    let read = brief.fit(&envelope, 0, None);
    if !read.as_ref().is_ok_and(|estimate| estimate.uncertainty.is_some()) {
        return Err(format!("a training of few steps is not brought to its end: {read:?}"));
    }
    if read == brief.fit_anew(&envelope, 0, None) {
        Ok(())
    } else {
        Err("trained beforehand it reads something else".to_owned())
    }
}

/// Two seeds may start alike, since a drawn expression can be a constant; eight seeds do not.
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
    let steps = subject.short();
    let alone = [0, 1].map(|seed| subject.fit(&envelope, seed, steps));
    let together = std::thread::scope(|scope| {
        let envelope = &envelope;
        let handles = [0, 1].map(|seed| scope.spawn(move || subject.fit_anew(envelope, seed, steps)));
        handles.map(|handle| handle.join().ok())
    });
    if together == alone.map(Some) { Ok(()) } else { Err("side by side, fits differ".to_owned()) }
}

/// Returns the bent envelope with times and logarithms changed.
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

/// Largest violation of an equivariance by a trained method: the accuracy that it trains to.
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
    let steeper = changed(|time, log| (time, log - 0.1 * time))?;
    let other = fitted(subject, &steeper, 0)?;
    let bar = match amortized(subject.entry) {
        true => relative(&steeper, AMORTIZED_EQUIVARIANCE),
        false => EQUIVARIANCE,
    };
    close("λ with 0.1/s added", other.decay_rate, one.decay_rate + 0.1, bar)
}

/// A start that is computed from the data could pass for a training.
fn untrained(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let truth = least_squares(&envelope).decay_rate;
    for seed in 0..20 {
        let estimate = subject.fit(&envelope, seed, Some(0)).map_err(|error| error.to_string())?;
        let off = (estimate.decay_rate / truth - 1.0).abs();
        if off <= WRONG {
            return Err(format!("seed {seed}: untrained, yet off by {off:.1e} only"));
        }
        if estimate.steps != 0 {
            return Err(format!("seed {seed}: {} steps on a budget of none", estimate.steps));
        }
    }
    Ok(())
}

/// Smallest relative distance from the least-squares slope that counts as wrong.
const WRONG: f64 = 0.01;

/// Checks that the estimator is wrong without its learned part. If it is not, that part contributed nothing,
/// and a waiver has to say so.
fn without(subject: &Subject<'_>, ablation: Ablation) -> Result<(), String> {
    let envelope = given(bent())?;
    let truth = least_squares(&envelope).decay_rate;
    for seed in 0..3 {
        let estimate = subject.ablated(&envelope, seed, ablation).map_err(|error| error.to_string())?;
        let off = (estimate.decay_rate / truth - 1.0).abs();
        if off <= WRONG {
            return Err(format!("seed {seed}: {}, yet off by {off:.1e} only", ablation.name()));
        }
        if amortized(subject.entry) {
            // Each seed needs a training of its own, so that one seed has to do.
            break;
        }
    }
    Ok(())
}

fn at_zero(subject: &Subject<'_>) -> Result<(), String> {
    without(subject, Ablation::LearnedPartAtZero)
}

fn on_noise(subject: &Subject<'_>) -> Result<(), String> {
    without(subject, Ablation::NoiseForInput)
}

/// Returns an envelope of 69 peaks, every ninth far off its exponential, so that least squares and robust
/// methods differ.
fn with_outliers() -> Option<Envelope> {
    let clean = exponential(69, 0.0, 0.19)?;
    let off = |(at, log): (usize, &f64)| if at % 9 == 4 { log - 0.02 * at as f64 } else { *log };
    let logs = clean.log_amplitudes().iter().enumerate().map(off).collect();
    Envelope::new(clean.times_s().to_vec(), logs, clean.omega_rad_s()).ok()
}

/// Checks that an estimator with an estimand of its own differs from least squares on a bent envelope or on
/// one with outliers.
fn differs(subject: &Subject<'_>) -> Result<(), String> {
    for envelope in [bent(), with_outliers()] {
        let envelope = given(envelope)?;
        let estimate = fitted(subject, &envelope, 0)?;
        if (estimate.decay_rate / least_squares(&envelope).decay_rate - 1.0).abs() > BAR {
            return Ok(());
        }
    }
    Err("it equals least squares on a bent envelope and on one with outliers; drop the tag".to_owned())
}

/// Checks that an interval is stated only for a converged fit, not for a state in which the budget ran out.
fn no_interval(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    for steps in [0, 1, 2, 3] {
        let estimate = subject.fit(&envelope, 0, Some(steps)).map_err(|error| error.to_string())?;
        let reached = estimate.stop.reached;
        let stated =
            estimate.uncertainty.is_some() || estimate.predictions.iter().any(|p| p.std_error.is_some());
        if stated && reached != Reached::Converged {
            return Err(format!("after {steps} steps it is {}, and states an interval", reached.name()));
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

/// Checks that the error falls by √8 with eight times the peaks over the same span, within the scatter of
/// twenty draws.
fn falls(subject: &Subject<'_>) -> Result<(), String> {
    const DRAWS: u64 = 20;
    // Enough for every method; a method whose time grows as the cube of the peaks waits for the larger number alone.
    const FEWEST: usize = 12;
    let rate = 0.2;
    let error = |peaks: usize| -> Result<f64, String> {
        let mut squares = 0.0;
        for draw in 0..DRAWS {
            let seed = Seed::new(draw).child("falls");
            let dense = given(scattered(peaks, rate * FEWEST as f64 / peaks as f64, 0.1, &seed))?;
            let estimate =
                subject.read(&dense, subject.seed_of_draw(draw), None).map_err(|error| error.to_string())?;
            squares += (estimate.decay_rate * peaks as f64 / FEWEST as f64 - rate).powi(2);
        }
        Ok((squares / DRAWS as f64).sqrt())
    };
    let ratio = error(FEWEST)? / error(8 * FEWEST)?;
    // log(ratio)/log(8) is 1/2; its standard error over 20 + 20 draws is about 0.1.
    let exponent = ratio.ln() / 8_f64.ln();
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

/// Checks the value of λ. An amortized method is held to the accuracy of its training and to one seed, since every seed needs
/// a training; [`agrees_from_another_seed`] has a second one.
fn agrees(subject: &Subject<'_>) -> Result<(), String> {
    if amortized(subject.entry) {
        agrees_from(subject, 0)
    } else {
        (0..3).try_for_each(|seed| agrees_from(subject, seed))
    }
}

/// Checks the value of λ of an amortized method that was trained from a second seed, which takes as long as all its other checks.
///
/// # Errors
/// A sentence with both values, if they differ by more than the accuracy of the training.
pub fn agrees_from_another_seed(subject: &Subject<'_>) -> Result<(), String> {
    agrees_from(subject, 1)
}

fn agrees_from(subject: &Subject<'_>, seed: u64) -> Result<(), String> {
    let envelope = given(bent())?;
    let truth = least_squares(&envelope).decay_rate;
    let bar = if amortized(subject.entry) { relative(&envelope, AMORTIZED_BAR) } else { BAR };
    let estimate = fitted(subject, &envelope, seed)?;
    close(&format!("λ, seed {seed}"), estimate.decay_rate, truth, bar)
}

/// Checks the distance from least squares, in standard errors, over 200 envelopes of each of three lengths:
/// its root mean square has to be within the bar, which makes the total error a tenth larger than the
/// efficient one.
fn nearly_as_good(subject: &Subject<'_>) -> Result<(), String> {
    for (peaks, rate, scatter) in [(20, 0.5, 0.05), (69, 0.19, 0.1), (250, 0.02, 0.02)] {
        let (mut squares, draws) = (0.0, 200);
        for draw in 0..draws {
            let envelope = given(scattered(peaks, rate, scatter, &Seed::new(draw).child("nearly")))?;
            let estimate = subject.read(&envelope, 0, None).map_err(|error| error.to_string())?;
            let times = envelope.times_s();
            let middle = times.iter().sum::<f64>() / peaks as f64;
            let known = scatter / times.iter().map(|time| (time - middle).powi(2)).sum::<f64>().sqrt();
            squares += ((estimate.decay_rate - least_squares(&envelope).decay_rate) / known).powi(2);
        }
        let apart = (squares / draws as f64).sqrt();
        if apart > AMORTIZED_BAR {
            return Err(format!("{peaks} peaks: {apart:.3} standard errors from least squares"));
        }
    }
    Ok(())
}

/// Largest difference in ln A between a prediction at a peak and the fitted function there: rounding.
const PREDICTION: f64 = 1e-9;

fn predictions(subject: &Subject<'_>) -> Result<(), String> {
    let envelope = given(bent())?;
    let estimate = fitted(subject, &envelope, 0)?;
    let (asked, given) = (query_times(&envelope).len(), estimate.predictions.len());
    if given != asked {
        return Err(format!("{given} predictions for {asked} times"));
    }
    for (at, (prediction, fitted)) in
        estimate.predictions.iter().zip(&estimate.fitted_log_amplitudes).enumerate()
    {
        let off = (prediction.log_amplitude - fitted).abs();
        if off.is_nan() || off > PREDICTION {
            return Err(format!("peak {at}: {} predicted, {fitted} fitted", prediction.log_amplitude));
        }
    }
    let stated = estimate.predictions.iter().filter_map(|prediction| prediction.std_error);
    let (finite, count) =
        (estimate.predictions.iter().all(|one| one.log_amplitude.is_finite()), stated.clone().count());
    if !finite || !stated.clone().all(|error| error.is_finite() && error > 0.0) {
        return Err("a prediction or its standard deviation is not finite".to_owned());
    }
    if count == 0 || count == asked { Ok(()) } else { Err(format!("{count} standard deviations of {asked}")) }
}
