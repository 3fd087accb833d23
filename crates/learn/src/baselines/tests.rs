//! Tests that baselines use the knowledge they are given and no more.

use super::*;
use crate::judge::{runs, score};
use crate::testing::{context, data_set, drag_and_cubic, making, record};
use crate::{Ahead, Model, Past};
use dynamics::{Nominal, System};

fn error(model: &dyn Model, data: &DataSet) -> f64 {
    score(model, &runs(model, data), data).free_run_rmse
}

#[test]
fn baselines_stand_in_the_order_of_what_they_know() {
    let system = drag_and_cubic();
    let data = data_set(&system, true, 2e-3);
    let of = |id: &str| {
        let baseline = BASELINES.iter().find(|baseline| baseline.id == id).unwrap();
        error((baseline.make)(&data, &context()).unwrap().model.as_ref(), &data)
    };
    let best = error(exact(&system, &data, &context()).unwrap().model.as_ref(), &data);
    assert!(best < 1.1 * data.noise, "{best}");
    assert!(2.0 * best < of("recalibrated") && of("recalibrated") < of("nominal"));
    assert!(of("arx") < of("persistence"));
}

#[test]
fn a_wrong_nominal_is_recalibrated_and_a_missing_one_said() {
    let truth = System::new(Nominal::new(1.0, 0.2, 40.0, 0.1).unwrap(), Vec::new()).unwrap();
    let records: Vec<_> = (0..6).map(|number| record(&truth, number, false, 1e-3)).collect();
    let believed = Nominal::new(1.0, 0.3, 37.0, 0.0).unwrap();
    let data = DataSet::new(&records, making(Some((&believed).into()))).unwrap();
    let fitted = recalibrated(&data, &context()).unwrap();
    for (own, expected) in fitted.model.coefficients().iter().zip([0.2, 40.0, 0.1]) {
        assert!((own.value - expected).abs() < 4.0 * own.std_error.unwrap(), "{own:?}");
    }
    let data = DataSet::new(&records, making(None)).unwrap();
    let problem = nominal(&data, &context()).map(|_| ()).unwrap_err().to_string();
    assert!(problem.contains("nominal = \"nominal.toml\""), "{problem}");
}

#[test]
fn a_past_shorter_than_the_order_is_refused() {
    let data = data_set(&drag_and_cubic(), true, 2e-3);
    let model = Arx::fit(&data).unwrap();
    let past = Past { times_s: &[0.0], values: &[1.0], input: Some(&[0.0]) };
    let refused = model.free_run(&past, &Ahead { times_s: &[0.02], input: Some(&[0.0]) });
    assert!(matches!(refused, Err(LearnError::ShortPast { samples: 1, .. })), "{refused:?}");
}
