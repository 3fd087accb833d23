//! Thinning of the knots of an input that is sampled faster than the motion responds.
//!
//! An integration takes at least one step from knot to knot. A drive's command comes at a thousand samples a
//! second and its motion responds below 10 Hz: cubic polynomials over many samples move it the same way. A
//! fit decides how many samples one knot may stand for: as many as change its prediction by no more than a
//! small part of its residual.
//!
//! The error of such polynomials grows with the eighth power of the knot spacing, that of straight lines with the
//! fourth, and that of means with the second.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::residuals;

/// Maximum number of samples that one knot stands for.
const MOST: usize = 64;

/// Largest change of a fit's prediction, relative to the fit's residual (both RMS).
const PART: f64 = 0.01;

impl Data {
    /// Returns the number of input samples that one knot may stand for without a noticeable change of the
    /// prediction: a power of two, 1 where there is nothing to spare.
    pub(crate) fn spare_knots(&self, at: &Fit) -> usize {
        let Some(change) = self.change(at) else { return 1 };
        // From the cheapest prediction on.
        let mut counts = std::iter::successors(Some(MOST), |count| (*count > 2).then_some(count / 2));
        counts.find(|&count| change(count) <= PART).unwrap_or(1)
    }

    /// Returns `true` if a fit made with one knot for `count` samples does not hold with all knots: they
    /// change its prediction by more than its residual (RMS), or this change cannot be computed.
    pub(crate) fn spoils(&self, count: usize, at: &Fit) -> bool {
        self.change(at).is_none_or(|change| change(count) > 1.0)
    }

    /// Returns a function that maps the number of samples per knot to the change of the prediction, relative
    /// to the residual of the fit (both RMS); `None` if no record is driven or the fit's residuals cannot be
    /// computed.
    fn change(&self, at: &Fit) -> Option<impl Fn(usize) -> f64> {
        let exact = self.driven().then(|| residuals(self, at).ok())??;
        let left = at.squares / at.samples().max(1) as f64 * self.samples() as f64;
        Some(move |count: usize| {
            residuals(&self.with_fewer_knots(count), at).map_or(f64::INFINITY, |own| {
                let pairs = own.iter().zip(&exact);
                let change: f64 = pairs.map(|(own, exact)| (own - exact).norm_squared()).sum();
                (change / left).sqrt()
            })
        })
    }

    /// Returns the same data with one knot of the inputs for every `count` samples.
    pub(crate) fn with_fewer_knots(&self, count: usize) -> Self {
        let inputs = self.inputs.iter().map(|input| input.as_ref().map(|own| own.thinned(count)));
        Self { inputs: inputs.collect(), ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use crate::data::observations::Observations;
    use crate::data::segments::cut;
    use crate::fit::calibrate::baseline;
    use crate::fit::levenberg_marquardt::residuals;
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Hold, Input, Nominal, Start, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    /// A swing at 0.5 Hz driven by a sine of 0.2 Hz, and by a fast sine of amplitude `fast`; 500 samples a
    /// second.
    fn observed(fast: f64) -> Observations {
        let nominal = Nominal::new(1.0, 0.4, 10.0, 0.0).unwrap();
        let times: Vec<f64> = (0..10_000).map(|i| f64::from(i) * 0.002).collect();
        let torque: Vec<f64> = times.iter().map(|t| (1.26 * t).sin() + fast * (700.0 * t).sin()).collect();
        let input = Input::new(times.clone(), torque.clone(), Hold::Linear).unwrap();
        let system = System::new(nominal, Vec::new()).unwrap();
        let motion =
            simulate(&system, Start::release(0.1), Some(&input), &times, &Tolerance::default()).unwrap();
        let noise = StandardNormal.sample_iter(Seed::new(3).child("noise").generator());
        let values =
            motion.position.iter().zip(noise).map(|(x, noise): (&f64, f64)| x + 1e-3 * noise).collect();
        let record = Record::new(times, values, Some(torque), Quantity::Position, "rad").unwrap();
        let clock = Clock::new(&record, ClockChoice::Host).unwrap();
        Observations::new(&record, &clock)
    }

    fn spare(fast: f64) -> usize {
        let nominal = Nominal::new(1.0, 0.4, 10.0, 0.0).unwrap();
        let record = observed(fast);
        let data =
            cut(std::slice::from_ref(&record), &[vec![true; record.len()]], &(&nominal).into()).unwrap();
        let fit = baseline(&data, &(&nominal).into()).unwrap().calibrated;
        let count = data.spare_knots(&fit);
        let square =
            |data| residuals(data, &fit).unwrap().iter().map(nalgebra::DVector::norm_squared).sum::<f64>();
        let ratio = square(&data.with_fewer_knots(count)) / square(&data);
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
        count
    }

    #[test]
    fn a_slow_input_needs_few_knots_and_a_fast_one_all() {
        assert!(spare(0.0) >= 8);
        assert_eq!(spare(2000.0), 1);
    }
}
