//! Calibrated 95 % bands of free runs.
//!
//! A free run's error grows with the lead time and is proportional to the amplitude of the swing. Errors are
//! therefore divided by the local amplitude of the prediction and binned by lead time, over free runs on the
//! validation records. Errors within one record are correlated, so whole records are taken as exchangeable
//! with the next record: every record has the same weight, and one further record has this weight at
//! infinity. With twenty or more records, the 95 % quantile of this distribution is finite, and a band holds
//! 95 % of the observations of a new record, whatever the distribution of the errors. With fewer records, the
//! pooled quantile is used, raised by the upper 95 % limit of a mean of logarithms; the spread between
//! records is pooled over the bins. A single record cannot show how records differ, so the stated
//! [`ONE_RECORD`] is used. Beyond the longest lead time of the validation records, the half-width grows in
//! proportion to the lead time, as a phase error does.
//!
//! Lei, G'Sell, Rinaldo, Tibshirani, Wasserman, J. Am. Stat. Assoc. 113 (2018) 1094, section 2.2 and 5.2
//! (split conformal, locally weighted); Lee, Barber, Willett, arXiv:2306.06342 (2023) (records of dependent
//! scores, one more at infinity); Stankevičiūtė, Alaa, van der Schaar, NeurIPS 34 (2021) 6216 (quantiles by
//! horizon).

use serde::{Deserialize, Serialize};

/// Free run over a validation record.
pub(super) struct Calibration {
    /// Index of the record.
    pub(super) record: usize,
    /// Lead times, counted from the start of the run, in seconds.
    pub(super) leads_s: Vec<f64>,
    /// Predicted positions.
    pub(super) predicted: Vec<f64>,
    /// Observed positions.
    pub(super) observed: Vec<f64>,
}

/// Half-widths of 95 % bands by lead time, relative to the local amplitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Band {
    /// Centers of the bins of lead time, in seconds, increasing.
    leads_s: Vec<f64>,
    /// 95 % half-width divided by the local amplitude, for each bin.
    relative: Vec<f64>,
    /// Sensor noise, added to the local amplitude, in the unit of the positions.
    floor: f64,
    /// Rest position from which amplitudes are measured.
    center: f64,
    /// Length of the window of the local amplitude, in seconds.
    window_s: f64,
}

/// Nominal coverage of a band.
const LEVEL: f64 = 0.95;

/// Quantiles of the standard normal distribution for a one-sided 95 % limit and for a 95 % interval.
const ONE_SIDED: f64 = 1.645;
const TWO_SIDED: f64 = 1.96;

/// Assumed spread of the logarithm of the records' quantiles if there is only one record: they differ by a
/// factor of 1.5.
const ONE_RECORD: f64 = 0.4;

/// Largest number of bins of lead time, and smallest number of errors of each record in a bin.
const MOST_BINS: usize = 12;
const LEAST_ERRORS: usize = 20;

/// Largest relative half-width: two opposite swings differ by twice the amplitude.
const LARGEST: f64 = 2.0;

impl Band {
    /// Calibrates a band on free runs over validation records; `None` if these leave nothing to calibrate on.
    pub(super) fn calibrated(runs: &[Calibration], center: f64, floor: f64, period_s: f64) -> Option<Self> {
        let mut band = Self { leads_s: Vec::new(), relative: Vec::new(), floor, center, window_s: period_s };
        let records = runs.iter().map(|run| run.record).max()? + 1;
        let scored: Vec<(usize, f64, f64)> = runs.iter().flat_map(|run| band.scores(run)).collect();
        let longest = scored.iter().map(|(_, lead, _)| *lead).fold(0.0, f64::max);
        let bins = (scored.len() / records / LEAST_ERRORS).clamp(1, MOST_BINS);
        let of_bin = |bin: usize| -> Vec<Vec<f64>> {
            let within = |lead: f64| {
                let place = (lead / longest.max(f64::MIN_POSITIVE) * bins as f64) as usize;
                place.min(bins - 1) == bin
            };
            let of_record = |record: usize| {
                let own = scored.iter().filter(|(own, lead, _)| *own == record && within(*lead));
                own.map(|(_, _, score)| *score).collect()
            };
            (0..records).map(of_record).filter(|own: &Vec<f64>| !own.is_empty()).collect()
        };
        let scores: Vec<Vec<Vec<f64>>> = (0..bins).map(of_bin).collect();
        let spread = spread(&scores).unwrap_or(ONE_RECORD);
        for (bin, scores) in scores.iter().enumerate() {
            let count = scores.len() as f64;
            let found = quantile(scores, LEVEL * (count + 1.0) / count).or_else(|| {
                let raised = (ONE_SIDED * spread / count.sqrt()).exp();
                quantile(scores, LEVEL).map(|pooled| pooled * raised)
            });
            let Some(relative) = found else { continue };
            band.leads_s.push((bin as f64 + 0.5) * longest / bins as f64);
            band.relative.push(relative);
        }
        (!band.leads_s.is_empty()).then_some(band)
    }

    /// Returns one standard deviation per prediction; 1.96 times it is the half-width of the band.
    pub(super) fn std(&self, leads_s: &[f64], predicted: &[f64]) -> Vec<f64> {
        let amplitudes = self.amplitudes(leads_s, predicted);
        let pairs = leads_s.iter().zip(amplitudes);
        pairs.map(|(lead, amplitude)| self.relative_at(*lead) * amplitude / TWO_SIDED).collect()
    }

    /// Returns the relative half-width at a lead time: interpolated linearly between bins, proportional to
    /// the lead time beyond the last bin.
    fn relative_at(&self, lead_s: f64) -> f64 {
        let next = self.leads_s.partition_point(|&own| own < lead_s);
        let at = |place: usize| self.leads_s.get(place).copied().zip(self.relative.get(place).copied());
        let found = match (next.checked_sub(1).and_then(at), at(next)) {
            (Some((from, low)), Some((to, high))) => low + (high - low) * (lead_s - from) / (to - from),
            (Some((last, relative)), None) => relative * (lead_s / last).max(1.0),
            (None, Some((_, first))) => first,
            (None, None) => LARGEST,
        };
        // If the motion is mostly noise, a band may be wider than a swing.
        found.min(LARGEST.max(self.relative.iter().copied().fold(0.0, f64::max)))
    }

    /// Returns record, lead time and relative error of every sample of a run.
    fn scores(&self, run: &Calibration) -> Vec<(usize, f64, f64)> {
        let amplitudes = self.amplitudes(&run.leads_s, &run.predicted);
        let errors = run.observed.iter().zip(&run.predicted).map(|(a, b)| (a - b).abs());
        let scores = errors.zip(amplitudes).map(|(error, amplitude)| error / amplitude);
        let scored = run.leads_s.iter().zip(scores).filter(|(_, score)| score.is_finite());
        scored.map(|(lead, score)| (run.record, *lead, score)).collect()
    }

    /// Returns the local amplitude of a prediction at every time: √2 times the root mean square within half a
    /// window on either side, plus the floor.
    fn amplitudes(&self, leads_s: &[f64], predicted: &[f64]) -> Vec<f64> {
        let (mut sum, mut sums) = (0.0, vec![0.0]);
        for value in predicted {
            sum += (value - self.center).powi(2);
            sums.push(sum);
        }
        let amplitude = |lead: &f64| {
            let from = leads_s.partition_point(|own| *own < lead - 0.5 * self.window_s);
            let to = leads_s.partition_point(|own| *own <= lead + 0.5 * self.window_s);
            let square = sums.get(to).zip(sums.get(from)).map_or(f64::NAN, |(to, from)| to - from);
            (2.0 * square.max(0.0) / (to - from).max(1) as f64).sqrt() + self.floor
        };
        leads_s.iter().map(amplitude).collect()
    }
}

/// Returns the smallest score that is not exceeded by a share of the scores, with equal weight for every
/// record. `None` without scores, or if the share is above 1.
fn quantile(records: &[Vec<f64>], share: f64) -> Option<f64> {
    let weighted = |own: &Vec<f64>| {
        let weight = 1.0 / (own.len() * records.len()) as f64;
        own.iter().map(|score| (*score, weight)).collect::<Vec<_>>()
    };
    let mut all: Vec<(f64, f64)> = records.iter().flat_map(weighted).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    // Weights sum to 1 up to rounding.
    all.into_iter()
        .find(|(_, weight)| {
            sum += weight;
            sum >= share - 1e-9
        })
        .map(|(score, _)| score)
}

/// Returns the standard deviation of the logarithms of the records' own quantiles about the means of their
/// bins, pooled over bins; `None` if no bin has two records.
fn spread(bins: &[Vec<Vec<f64>>]) -> Option<f64> {
    let (mut squares, mut degrees) = (0.0, 0_usize);
    for records in bins {
        let own = records.iter().filter_map(|scores| quantile(std::slice::from_ref(scores), LEVEL));
        let logs: Vec<f64> = own.map(f64::ln).filter(|log| log.is_finite()).collect();
        if logs.len() < 2 {
            continue;
        }
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        squares += logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>();
        degrees += logs.len() - 1;
    }
    (degrees > 0).then(|| (squares / degrees as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::{Band, Calibration};
    use rand_distr::{Distribution, StandardNormal};
    use seed::Seed;

    /// Builds a decaying swing, predicted with a phase error that differs between records.
    fn run(record: usize, seconds: f64, seed: &Seed) -> Calibration {
        let mut generator = seed.child(&record.to_string()).generator();
        let mut normal = || -> f64 { StandardNormal.sample(&mut generator) };
        let drift = 0.02 * normal();
        let leads_s: Vec<f64> = (1..(50.0 * seconds) as usize).map(|at| 0.02 * at as f64).collect();
        let swing = |t: f64, phase: f64| 0.5 * (-0.1 * t).exp() * (6.0 * t + phase).cos();
        let predicted = leads_s.iter().map(|t| swing(*t, 0.0)).collect();
        let observed = leads_s.iter().map(|t| swing(*t, drift * t) + 1e-3 * normal()).collect();
        Calibration { record, leads_s, predicted, observed }
    }

    fn coverage(band: &Band, runs: &[Calibration]) -> f64 {
        let (mut held, mut count) = (0, 0);
        for run in runs {
            let std = band.std(&run.leads_s, &run.predicted);
            let errors = run.observed.iter().zip(&run.predicted).map(|(a, b)| (a - b).abs());
            held += errors.zip(&std).filter(|(error, std)| *error <= 1.96 * **std).count();
            count += std.len();
        }
        held as f64 / count as f64
    }

    /// Returns the mean coverage of fresh records by bands calibrated on a number of records, over 40 draws.
    fn mean_coverage(records: usize) -> f64 {
        let of_draw = |draw: u64| {
            let seed = Seed::new(draw);
            let runs: Vec<Calibration> = (0..records).map(|record| run(record, 20.0, &seed)).collect();
            let band = Band::calibrated(&runs, 0.0, 1e-3, 1.0).unwrap();
            let fresh: Vec<Calibration> =
                (0..20).map(|record| run(record, 20.0, &seed.child("fresh"))).collect();
            coverage(&band, &fresh)
        };
        (0..40).map(of_draw).sum::<f64>() / 40.0
    }

    #[test]
    fn bands_hold_on_fresh_records_whatever_the_number_that_they_come_from() {
        for (records, least, most) in [(2, 0.87, 0.99), (3, 0.91, 0.99), (8, 0.93, 0.99), (40, 0.94, 0.975)] {
            let found = mean_coverage(records);
            assert!((least..=most).contains(&found), "{records} records: {found}");
        }
    }

    #[test]
    fn beyond_what_was_seen_a_band_grows_with_the_lead() {
        let seed = Seed::new(3);
        let runs: Vec<Calibration> = (0..10).map(|record| run(record, 5.0, &seed)).collect();
        let band = Band::calibrated(&runs, 0.0, 1e-3, 1.0).unwrap();
        let fresh: Vec<Calibration> =
            (0..100).map(|record| run(record, 20.0, &seed.child("fresh"))).collect();
        let found = coverage(&band, &fresh);
        assert!(found > 0.92, "{found}");
        assert!(Band::calibrated(&[], 0.0, 1e-3, 1.0).is_none());
    }
}
