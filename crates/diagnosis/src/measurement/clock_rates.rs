//! Clocks of several records that run at rates of their own.
//!
//! Records of one system are often stamped by clocks that differ by up to some parts in a thousand; a clock that is fast by ε
//! makes every swing of its record longer by ε. One spring for all records then fits none of them, and whatever else can
//! bend a duration takes the place of what is missing. So the search is made on corrected clocks too, and what comes closer stays:
//! a law by which the frequency depends on the amplitude explains more than rates that stand in for it.

use crate::answer::Finding;
use crate::data::observations::Observations;
use crate::data::segments::Data;
use crate::evidence::likelihood::{Likelihood, View};
use crate::evidence::score::parameter_price;
use crate::fit::levenberg_marquardt::{Fit, solve};
use crate::model::matrices::element;
use crate::model::projection::Projection;
use crate::model::tangent::{Path, matrix};
use crate::noise::floor;
use dynamics::DynamicsError;
use nalgebra::DVector;

/// Largest difference of two rates that is put down to clocks: ten times what a poor oscillator has.
const LARGEST: f64 = 0.02;

/// Log evidence that the rates have to bring: what a flexible effect has to.
const ENOUGH: f64 = 30.0;

/// Records on the clock of the first.
#[derive(Debug, Clone)]
pub(crate) struct ClockRates {
    pub(crate) records: Vec<Observations>,
    /// By how much each record's clock is fast, relative to the first one's.
    rates: Vec<f64>,
    /// Log evidence that they have to bring.
    pub(crate) price: f64,
}

impl ClockRates {
    /// Clocks as they are stamped.
    pub(crate) fn as_stamped(records: &[Observations]) -> Self {
        Self { records: records.to_vec(), rates: vec![0.0; records.len()], price: 0.0 }
    }

    /// The records without the rates that a fit leaves; none where it leaves none.
    ///
    /// # Errors
    /// What the dynamics refuse.
    pub(crate) fn corrected(&self, data: &Data, fit: &Fit) -> Result<Option<Self>, DynamicsError> {
        let Some((further, price)) = rates(data, fit, self.records.len())? else { return Ok(None) };
        let stretched = |(old, new): (&f64, &f64)| (1.0 + old) * (1.0 + new) - 1.0;
        let rates: Vec<f64> = self.rates.iter().zip(&further).map(stretched).collect();
        if rates.iter().any(|rate| rate.abs() > LARGEST) {
            return Ok(None);
        }
        let mut records = self.records.clone();
        for (record, rate) in records.iter_mut().zip(&further) {
            for time in &mut record.times_s {
                *time /= 1.0 + rate;
            }
        }
        Ok(Some(Self { records, rates, price }))
    }

    /// What is said of the rates.
    pub(crate) fn finding(&self) -> Option<Finding> {
        let largest = self.rates.iter().copied().fold(0.0, |known: f64, rate| known.max(rate.abs()));
        let told: Vec<String> = self.rates.iter().map(|rate| format!("{:+.3} %", 100.0 * rate)).collect();
        (largest > 0.0).then(|| Finding {
            effect: None,
            text: format!(
                "the clocks of the records run at different rates ({} relative to the first), or the system was slower in \
                 some records at every amplitude: taken out of the stamps",
                told.join(", ")
            ),
        })
    }
}

/// By how much each record's clock is fast relative to the first one's; none where the residual does not ask for that.
/// Beside them the log evidence that they have to bring.
fn rates(data: &Data, fit: &Fit, records: usize) -> Result<Option<(Vec<f64>, f64)>, DynamicsError> {
    if records < 2 {
        return Ok(None);
    }
    let paths = Path::of(data, fit)?;
    let columns: Vec<Vec<f64>> = (1..records)
        .map(|record| {
            let of = |path: &Path| -> Vec<f64> {
                let (_, rate, _) = path.observed(data.quantity);
                let own = if path.record == record { -1.0 } else { 0.0 };
                // An acceleration's rate is not followed: nothing is found then.
                let rate = rate.iter().copied().chain(std::iter::repeat(0.0));
                path.times.iter().zip(rate).map(|(time, rate)| own * time * rate).collect()
            };
            paths.iter().flat_map(of).collect()
        })
        .collect();
    let projection = Projection::at(data, fit)?;
    let mut columns = matrix(projection.rows(), &columns);
    projection.apply(&mut columns);
    let stacked = fit.residuals.iter().flat_map(|residual| residual.iter().copied());
    let residual = DVector::from_iterator(columns.nrows(), stacked);
    let right =
        nalgebra::DMatrix::from_column_slice(columns.ncols(), 1, columns.tr_mul(&residual).as_slice());
    let Some(solution) = solve(&columns.tr_mul(&columns), &right) else { return Ok(None) };
    let left = &residual - &columns * solution.column(0);
    let by_segment = |all: &DVector<f64>| {
        let mut at = 0;
        let mut cut = |own: &DVector<f64>| {
            at += own.len();
            all.rows(at - own.len(), own.len()).clone_owned()
        };
        data.by_part(&fit.residuals.iter().map(&mut cut).collect::<Vec<_>>())
    };
    let (before, after) = (by_segment(&residual), by_segment(&left));
    let noise = floor::floor(data, &fit.residuals).value;
    let likelihood = Likelihood::of(data, &after, noise, View::Whole);
    // Whether they bring as much as they have to is for the search on the corrected clocks to say.
    let price = parameter_price(records - 1, likelihood.worth());
    if likelihood.log(&after) - likelihood.log(&before) <= price {
        return Ok(None);
    }
    let solved = (0..records - 1).map(|at| element(&solution.column(0).clone_owned(), at));
    Ok(Some((std::iter::once(0.0).chain(solved).collect(), price + ENOUGH)))
}

#[cfg(test)]
mod tests {
    use crate::data::observations::Observations;
    use crate::{Diagnosis, Settings, diagnose};
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Nominal, Start, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    /// Two releases of a system, the second from half as far and by a clock that is fast by `rate`.
    fn diagnosed(effects: &[(&str, &[f64])], rate: f64) -> Diagnosis {
        let nominal = Nominal::new(1.0, 0.3, 400.0, 0.0).unwrap();
        let effects = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
        let system = System::new(nominal, effects).unwrap();
        let times: Vec<f64> = (0..600).map(|at| f64::from(at) / 50.0).collect();
        let mut generator = Seed::new(5).child("noise").generator();
        let mut observe = |start: f64, rate: f64| {
            let motion =
                simulate(&system, Start::release(start), None, &times, &Tolerance::default()).unwrap();
            let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
            let values = motion.position.iter().map(|x| x + 3e-4 * noise()).collect();
            let stamps = times.iter().map(|time| time * (1.0 + rate)).collect();
            let record = Record::new(stamps, values, None, Quantity::Position, "rad").unwrap();
            Observations::new(&record, &Clock::new(&record, ClockChoice::Host).unwrap())
        };
        let records = [observe(0.4, 0.0), observe(0.2, rate)];
        diagnose(&records, &nominal, &Settings::default(), &|| 0.0).unwrap()
    }

    fn clocks(answer: &Diagnosis) -> Option<&str> {
        let all = &answer.measuring_chain.findings;
        all.iter().map(|own| own.text.as_str()).find(|text| text.contains("clocks of the records"))
    }

    #[test]
    fn a_clock_that_is_fast_is_no_effect() {
        let answer = diagnosed(&[], 2e-3);
        assert!(answer.verdict.effects.is_empty(), "{:?}", answer.verdict);
        let told = clocks(&answer).unwrap();
        let percent: f64 =
            told.split("+0.000 %, ").nth(1).unwrap().split(" %").next().unwrap().parse().unwrap();
        assert!((percent - 0.2).abs() < 0.01, "{told}");
    }

    /// A spring that bends makes the small swing slower too, and within each record as well.
    #[test]
    fn a_frequency_that_depends_on_the_amplitude_is_no_clock() {
        let answer = diagnosed(&[("cubic_stiffness", &[40.0])], 0.0);
        assert_eq!(clocks(&answer), None);
        assert_eq!(answer.verdict.effects, ["cubic_stiffness"]);
    }
}
