use super::{Derivatives, Simulator};
use crate::data::observations::Observations;
use crate::data::segments::{Data, cut};
use crate::model::candidate::Candidate;
use crate::model::candidates::hysteresis::Hysteresis;
use crate::model::candidates::sensor_quantization::SensorQuantization;
use crate::model::hypothesis::{Calibrated, Hypothesis};
use dynamics::Nominal;
use record::{Clock, ClockChoice, Quantity, Record};

const STEP: f64 = 0.01;

/// 10 s of a decaying swing of 0.3 rad at 100 samples a second, rounded to hundredths.
fn data() -> (Data, Nominal) {
    let times: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0).collect();
    let values = times.iter().map(|t| STEP * (30.0 * (-0.1 * t).exp() * (6.0 * t).cos()).round()).collect();
    let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
    let observations = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
    let nominal = Nominal::new(1.0, 0.2, 36.0, 0.0).unwrap();
    let kept = [vec![true; observations.len()]];
    (cut(std::slice::from_ref(&observations), &kept, &(&nominal).into()).unwrap(), nominal)
}

/// Except for the first reading: its derivatives take the turning point before it as fixed.
#[test]
fn a_held_readings_derivatives_are_those_of_its_values() {
    let (data, nominal) = data();
    let candidates = vec![Candidate::new(&SensorQuantization)];
    let calibrated = vec![Calibrated::Damping, Calibrated::Stiffness, Calibrated::RestAngle];
    let hypothesis = Hypothesis { nominal, known: Vec::new(), calibrated, candidates };
    let globals = [0.2, 36.0, 0.01, 0.4 * STEP];
    let mut simulator = Simulator::new(&data, &hypothesis, &globals, Derivatives::All).unwrap();
    for segment in &data.segments {
        let at = simulator.predict(segment, &segment.guess).unwrap();
        for column in 0..6 {
            let mut shifted = |by: f64| {
                let (mut start, mut globals) = (segment.guess, globals);
                let parameter = start.iter_mut().chain(&mut globals).nth(column).unwrap();
                *parameter += by;
                simulator.set(&globals).unwrap();
                simulator.predict(segment, &start).unwrap().residual
            };
            let h = 1e-7;
            let difference = (shifted(-h) - shifted(h)) / (2.0 * h);
            let own = at.jacobian.column(column);
            for (row, (own, difference)) in own.iter().zip(difference.iter()).enumerate().skip(10) {
                assert!((own - difference).abs() < 1e-3, "{row} {column}: {own} {difference}");
            }
        }
    }
}

/// Segments begin in the middle of a swing, with a contact that is bent as far as the fit says.
#[test]
fn a_bent_contacts_derivatives_are_those_of_its_values() {
    let (data, nominal) = data();
    let candidates = vec![Candidate::new(&Hysteresis)];
    let calibrated = vec![Calibrated::Damping, Calibrated::Stiffness, Calibrated::RestAngle];
    let hypothesis = Hypothesis { nominal, known: Vec::new(), calibrated, candidates };
    let globals = [0.2, 36.0, 0.01, 0.3, 0.02];
    let mut simulator = Simulator::new(&data, &hypothesis, &globals, Derivatives::All).unwrap();
    for (number, segment) in data.segments.iter().enumerate() {
        let mut guess = segment.guess;
        guess[1] += 0.05 * number as f64;
        let at = simulator.predict(segment, &guess).unwrap();
        for column in 0..7 {
            let mut shifted = |by: f64| {
                let (mut start, mut globals) = (guess, globals);
                let parameter = start.iter_mut().chain(&mut globals).nth(column).unwrap();
                *parameter += by;
                simulator.set(&globals).unwrap();
                simulator.predict(segment, &start).unwrap().residual
            };
            let h = 1e-6;
            let difference = (shifted(-h) - shifted(h)) / (2.0 * h);
            simulator.set(&globals).unwrap();
            let own = at.jacobian.column(column);
            let off = (own - &difference).amax() / difference.amax();
            assert!(off < 1e-6, "segment {number} column {column}: {off}");
        }
    }
}
