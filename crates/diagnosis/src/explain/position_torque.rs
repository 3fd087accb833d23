//! Torque without a name that repeats along the position, in the left-over beside the named effects.
//!
//! Magnets, balls in a bearing and the turns of a screw pull back and forth as a body moves on. No effect of
//! the vocabulary does so, and a record does not tell these causes apart, so that such a torque gets no name.
//! But a simulator that includes it follows the motion more closely, and its wavenumber helps to find the
//! cause: it tells how often the torque repeats in a turn.
//!
//! The search for it runs after all names are given. Before, such a torque only takes part as an alternative
//! to named effects ([`crate::search::nameless`]).

use crate::error::DiagnosisError;
use crate::evidence::context::{Context, Held};
use crate::evidence::held_out::{Both, HeldOut};
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::Moving;
use crate::noise::statistics::{quantile, resampled};
use crate::search::position_torque::{beside, evidence};
use crate::sets::shooting_interval::shortened;
use crate::sets::weights::EVEN;
use results::WithInterval;

/// Torque without a name, fitted beside the named effects.
pub(crate) struct Unnamed {
    /// Fits of the named set with the torque: on the shooting interval that judged the set, and on the
    /// segments as cut.
    pub(crate) followed: Fit,
    pub(crate) fitted: Fit,
    pub(crate) after: HeldOut,
    /// Mean square on the last third of the data, after a fit to the first two thirds.
    pub(crate) last_third: f64,
    /// Log evidence for the torque, in nats.
    pub(crate) evidence: f64,
    /// Squares that the torque explains, and their share in what the set explains with it.
    pub(crate) squares: f64,
    pub(crate) share: WithInterval,
}

/// Searches for the torque, and fits it if its gain to first order makes it more probable than not. It is
/// accepted if the fit too makes it more probable than not and predicts held-out parts better.
///
/// # Errors
/// Returns an error if the motion cannot be computed.
pub(crate) fn unnamed(work: &Context<'_>, held: &Held<'_>) -> Result<Option<Unnamed>, DiagnosisError> {
    let (data, named) = (work.data, held.repaired);
    let Some(followed) = beside(data, named, named.autocorrelation_time(), EVEN)? else { return Ok(None) };
    let evidence = evidence(data, &followed, named, followed.autocorrelation_time());
    if evidence < EVEN {
        return Ok(None);
    }
    let segments = work.segments.data;
    let Ok(fitted) = shortened(segments, data, &followed) else { return Ok(None) };
    let both = Both { longer: data, followed: &followed, segments, fitted: &fitted };
    let predicted = rayon::join(|| both.interleaved(Moving::All), || both.last_third(Moving::All));
    let (Ok(after), Ok(last_third)) = predicted else { return Ok(None) };
    if after.mean_square() >= held.after.mean_square() {
        return Ok(None);
    }
    let squares = named.squares - followed.squares;
    let share = share(work, named, &followed);
    Ok(Some(Unnamed { followed, fitted, after, last_third, evidence, squares, share }))
}

/// Returns the torque's share in all that is explained beyond recalibration, with an interval from a
/// bootstrap over segments.
fn share(work: &Context<'_>, named: &Fit, followed: &Fit) -> WithInterval {
    let squares = |fit: &Fit| -> Vec<f64> {
        work.data.by_part(&fit.residuals).iter().map(|part| part.norm_squared()).collect()
    };
    let before = squares(&work.base.calibrated);
    let [between, after] = [squares(named), squares(followed)];
    let all: Vec<usize> = (0..before.len()).collect();
    let of = |picked: &[usize]| -> f64 {
        let sum = |values: &[f64]| -> f64 { picked.iter().filter_map(|&index| values.get(index)).sum() };
        let whole = sum(&before) - sum(&after);
        if whole > 0.0 { ((sum(&between) - sum(&after)) / whole).clamp(0.0, 1.0) } else { 0.0 }
    };
    let seed = work.settings.seed.child("unnamed share");
    let draws: Vec<f64> = resampled(all.len(), 400, &seed).map(|drawn| of(&drawn)).collect();
    WithInterval { value: of(&all), interval_95: [quantile(&draws, 0.025), quantile(&draws, 0.975)] }
}

#[cfg(test)]
mod tests {
    use crate::{Diagnosis, Observations, Settings, Status, diagnose};
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Nominal, Start, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    const NOISE: f64 = 5e-4;

    /// Diagnosis of 15 s of a swing with some effects, 130 samples a second.
    fn diagnosed(effects: &[(&str, &[f64])]) -> Diagnosis {
        let nominal = Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap();
        let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
        let system = System::new(nominal, active).unwrap();
        let times: Vec<f64> = (0..1950).map(|i| f64::from(i) / 130.0).collect();
        let motion = simulate(&system, Start::release(0.7), None, &times, &Tolerance::default()).unwrap();
        let mut generator = Seed::new(5).child("noise").generator();
        let noise = StandardNormal.sample_iter(&mut generator);
        let values: Vec<f64> =
            motion.position.iter().zip(noise).map(|(x, noise): (&f64, f64)| x + NOISE * noise).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        diagnose(
            &[Observations::new(&record, &clock)],
            &nominal,
            &Settings { most_effects: 2, ..Settings::default() },
            &|| 0.0,
        )
        .unwrap()
    }

    /// Wavenumber and torque of the effect without a name, with their intervals.
    fn torque(answer: &Diagnosis) -> Option<[results::WithInterval; 2]> {
        let row = answer.effects.iter().find(|row| row.id == "unknown")?;
        let of = |name: &str| row.parameters.iter().find(|own| own.name == name).map(|own| own.estimate);
        row.gap_share?;
        Some([of("wavenumber")?, of("torque")?])
    }

    fn holds(interval: results::WithInterval, value: f64) -> bool {
        // 1.5 times the full width of a 95 % interval: three half-widths.
        let [low, high] = interval.interval_95;
        (interval.value - value).abs() < 1.5 * (high - low)
    }

    #[test]
    fn a_torque_along_the_position_alone_is_unknown_and_described() {
        let answer = diagnosed(&[("unknown", &[0.4, 20.0, 0.7])]);
        assert_eq!(answer.verdict.status, Status::Unknown);
        assert!(answer.verdict.effects.is_empty(), "{:?}", answer.verdict.effects);
        let [wavenumber, size] = torque(&answer).unwrap();
        assert!(holds(wavenumber, 20.0) && (wavenumber.value - 20.0).abs() < 0.2, "{wavenumber:?}");
        assert!(holds(size, 0.4) && (size.value / 0.4 - 1.0).abs() < 0.1, "{size:?}");
        let ratio = answer.gap.repaired / answer.gap.noise_floor;
        assert!(ratio < 1.05, "{ratio}");
    }

    #[test]
    fn beside_a_larger_effect_it_takes_no_name_from_that() {
        let answer = diagnosed(&[("quadratic_drag", &[0.05]), ("unknown", &[0.1, 20.0, 0.7])]);
        assert_eq!(answer.verdict.status, Status::Effect);
        assert_eq!(answer.verdict.effects.first(), Some(&"quadratic_drag"));
        let [wavenumber, _] = torque(&answer).unwrap();
        assert!((wavenumber.value - 20.0).abs() < 0.5, "{wavenumber:?}");
        let shares: f64 =
            answer.effects.iter().filter_map(|row| row.gap_share).map(|share| share.value).sum();
        assert!((shares - 1.0).abs() < 1e-9, "{shares}");
        let ratio = answer.gap.repaired / answer.gap.noise_floor;
        assert!(ratio < 1.05, "{ratio}");
    }

    #[test]
    fn where_none_acts_none_is_described() {
        for effects in [&[][..], &[("quadratic_drag", &[0.05][..])], &[("coulomb_friction", &[0.3][..])]] {
            assert_eq!(torque(&diagnosed(effects)), None, "{effects:?}");
        }
    }
}
