//! Test of amortized reading that every amortized network must pass; the modules of these networks include
//! this file.
//!
//! It uses the network of `super::AMORTIZED_ENTRY` and its settings in `super::FIELDS`.

use super::{AMORTIZED_ENTRY, FIELDS};
use conformance::least_squares;
use envelope::Envelope;
use estimator::{Cancel, FitContext, Silent};
use neural::amortized::Prior;
use seed::Seed;
use settings::{Document, Resolved, Section};

/// The network is trained with the default settings. It then reads envelopes drawn from the prior on another
/// branch of the seed; the number of peaks of each is drawn as well.
#[test]
#[allow(clippy::print_stdout, reason = "the figures, for whoever asks with --nocapture")]
fn over_a_thousand_fresh_envelopes_it_is_nearly_as_good_as_least_squares_and_calibrated() {
    let section = [Section { name: "estimator", fields: FIELDS }];
    let settings = Resolved::new(&Document::default(), &section).unwrap();
    let estimator = (AMORTIZED_ENTRY.build)(&settings).unwrap();
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0).child(AMORTIZED_ENTRY.id), None, &Silent, &cancel);
    let reader = estimator.pretrain(&context).unwrap().unwrap();
    let prior: Prior = settings.section("estimator").unwrap();
    let mut generator = Seed::new(0).child("fresh").generator();
    let (mut own, mut best, mut held) = (0.0, 0.0, 0);
    for _ in 0..1000 {
        // s from −1 to 1 stands for 20 s.
        let (sequence, [_, rate]) = prior.sequences(1, &mut generator).remove(0);
        let times = sequence.times.iter().map(|s| 10.0 * (s + 1.0)).collect();
        let envelope = Envelope::new(times, sequence.values, 21.8).unwrap();
        let (truth, line) = (rate / 10.0, least_squares(&envelope));
        let estimate = reader.fit(&envelope, &context).unwrap();
        let [low, high] = estimate.uncertainty.unwrap().interval_95;
        // Each error is divided by the standard error of its least-squares line, so that the worst envelopes
        // do not dominate.
        own += ((estimate.decay_rate - truth) / line.std_error).powi(2);
        best += ((line.decay_rate - truth) / line.std_error).powi(2);
        held += u32::from((low..=high).contains(&truth));
    }
    let (ratio, share) = (f64::sqrt(own / best), f64::from(held) / 1000.0);
    println!("error {ratio:.4} of least squares', {:.1} % of the intervals hold λ", 100.0 * share);
    // A thousand envelopes determine the ratio to about 1 %. A result better than the efficient estimator
    // would be luck or a fault.
    assert!((0.97..1.1).contains(&ratio), "{ratio}");
    assert!((0.935..0.965).contains(&share), "{share}");
}
