//! Tests that unusable data sets are refused, each with its own message.

use super::*;
use crate::LearnError;
use crate::testing::{drag_and_cubic, friction_and_gravity, making, record};

fn records(count: usize) -> Vec<Trajectory> {
    (0..count).map(|number| record(&friction_and_gravity(), number, false, 1e-3)).collect()
}

fn refusal(records: &[Trajectory], change: impl FnOnce(&mut Making)) -> String {
    let mut making = making(None);
    change(&mut making);
    DataSet::new(records, making).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn bad_sets_are_refused_with_a_remedy() {
    assert!(refusal(&[], |_| ()).contains("name at least two"));
    assert!(refusal(&records(1), |_| ()).contains("record-0 is the only record"));
    assert!(refusal(&records(3), |making| making.split.test_records = 0).contains("set test_records to 1"));
    assert!(refusal(&records(3), |_| ()).contains("3 records and test_records = 2, validation_records = 1"));
    let mixed = [records(3), vec![record(&drag_and_cubic(), 4, true, 1e-3)]].concat();
    assert!(refusal(&mixed, |_| ()).contains("record-0 has no input column, record-4 has one"));
    let fast: Vec<f64> = (0..400).map(|at| f64::from(at) * 0.01).collect();
    let fast =
        Trajectory::new("fast", fast.clone(), fast.iter().map(|t| (5.0 * t).sin()).collect(), None).unwrap();
    let text = refusal(&[records(3), vec![fast]].concat(), |_| ());
    assert!(
        text.contains("sampled at 50.0000 Hz, fast at 100.0000 Hz") && text.contains("of its own"),
        "{text}"
    );
    assert!(refusal(&records(4), |making| making.warm_up_s = Some(5.0)).contains("lower warm_up_s"));
    let still =
        vec![
            Trajectory::new("still", (0..500).map(|at| f64::from(at) * 0.02).collect(), vec![0.5; 500], None)
                .unwrap();
            4
        ];
    assert!(refusal(&still, |_| ()).contains("set period_s"));
}

#[test]
fn numbers_that_are_none_are_refused_with_their_place() {
    let made = |times: &[f64], values: &[f64]| Trajectory::new("r", times.to_vec(), values.to_vec(), None);
    let error = made(&[0.0, 1.0, 2.0], &[0.0, f64::NAN, 0.0]).unwrap_err();
    assert!(matches!(error, LearnError::NotFinite { sample: 2, .. }), "{error}");
    assert!(error.to_string().contains("missing = \"drop\""));
    let error = made(&[0.0, 1.0, 1.0], &[0.0; 3]).unwrap_err();
    assert!(error.to_string().contains("time 1 s at sample 3 does not come after 1 s"), "{error}");
    assert!(matches!(
        made(&[0.0, 1.0], &[0.0]).unwrap_err(),
        LearnError::UnequalColumns { found: 1, times: 2, .. }
    ));
}

#[test]
fn parts_share_no_sample_and_scales_come_from_training_alone() {
    let all = records(6);
    let set = DataSet::new(&all, making(None)).unwrap();
    assert_eq!((set.train.len(), set.validation.len(), set.test.len()), (3, 1, 2));
    let louder: Vec<Trajectory> = all
        .iter()
        .enumerate()
        .map(|(number, one)| {
            let scale = if number < 3 { 1.0 } else { 7.0 };
            let values = one.values().iter().map(|value| scale * value).collect();
            Trajectory::new(one.name(), one.times_s().to_vec(), values, None).unwrap()
        })
        .collect();
    assert_eq!(DataSet::new(&louder, making(None)).unwrap().scale, set.scale);

    let mut by_time = making(None);
    by_time.split.kind = SplitKind::Time;
    by_time.warm_up_s = Some(0.3);
    let set = DataSet::new(&all[..1], by_time).unwrap();
    let ends = |part: &Trajectory| (part.times_s()[0], *part.times_s().last().unwrap());
    let [train, validation, test] = [&set.train, &set.validation, &set.test].map(|parts| ends(&parts[0]));
    assert!(train.1 < validation.0 && validation.1 < test.0, "{train:?} {validation:?} {test:?}");
    assert_eq!(set.train[0].len() + set.validation[0].len() + set.test[0].len(), 500);
}

#[test]
fn the_noise_and_the_period_are_read_from_the_record() {
    let set = DataSet::new(&records(6), making(None)).unwrap();
    assert!((set.noise / 1e-3 - 1.0).abs() < 0.1, "{}", set.noise);
    // The frequency is √(16 + 24) rad/s for small swings and lower for large ones.
    assert!((1.0..1.15).contains(&set.period_s), "{}", set.period_s);
}

#[test]
fn velocities_and_accelerations_come_out_on_uneven_times() {
    let times: Vec<f64> =
        (0..200).map(|at| 0.01 * f64::from(at) + 0.003 * f64::from(at * 7919 % 13) / 13.0).collect();
    let values = times.iter().map(|time| (6.0 * time).sin()).collect();
    for state in local_states(&Trajectory::new("r", times, values, None).unwrap(), 0.1) {
        let phase = 6.0 * state.time_s;
        assert!((state.velocity - 6.0 * phase.cos()).abs() < 0.02, "{state:?}");
        assert!((state.acceleration + 36.0 * phase.sin()).abs() < 1.5, "{state:?}");
    }
}

#[test]
fn windows_lie_within_their_trajectory() {
    let parts = records(2);
    let found = windows(&parts, 50, 100, 25);
    assert_eq!(found.len(), 2 * 15);
    assert!(
        found.iter().all(|window| window.to <= 500
            && window.now - window.from == 50
            && window.to - window.now == 100)
    );
    assert!(windows(&parts, 400, 101, 1).is_empty());
}
