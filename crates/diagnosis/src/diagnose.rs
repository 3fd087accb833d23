//! Diagnosis from observations, stage by stage.

use crate::answer::Diagnosis;
use crate::data::observations::Observations;
use crate::error::DiagnosisError;
use crate::fit::fitted::Fit;
use crate::measurement::clock_rates::ClockRates;
use crate::settings::Settings;
use crate::stages::{
    Judged, Known, Measured, Question, Refined, Remaining, Request, Searched, Stage, Stopwatch, answer,
};
use dynamics::{Hold, NominalSimulator};
use std::cell::OnceCell;

/// Largest number of corrections of the clocks, and of the knots of an input: after a correction, the search
/// may find sets that ask for a little more.
const CORRECTIONS: usize = 2;

/// Data, question and search result of the first stages.
struct Sought {
    measured: Measured,
    question: Question,
    searched: Searched,
}

impl Sought {
    /// Runs the first stages. `hold` is the behavior of the input between its samples, if it is decided; the
    /// search starts from the `known` set, if there is one.
    fn of(
        request: &Request<'_>,
        hold: Option<Hold>,
        known: Option<Known>,
        watch: &mut Stopwatch<'_>,
    ) -> Result<Self, DiagnosisError> {
        let measured = watch.after(Stage::MeasurementChain, Measured::of(request)?)?;
        let question = watch.after(Stage::Calibration, Question::of(request, &measured, hold)?)?;
        let searched = Searched::of(request, &question, measured.is_whole, known);
        let sought = Self { measured, question, searched: watch.after(Stage::Search, searched)? };
        sought.with_enough_input(request, watch)
    }

    /// Repeats the search with as many knots of the input as the found sets need. The recalibrated simulator,
    /// which may hardly follow the input, chose how few knots there are. Sets that do follow it are distorted
    /// by too few knots, and other effects compensate for that.
    fn with_enough_input(
        mut self,
        request: &Request<'_>,
        watch: &mut Stopwatch<'_>,
    ) -> Result<Self, DiagnosisError> {
        for _ in 0..CORRECTIONS {
            let (Some(set), by) = (self.searched.best(), self.searched.interval.by) else { break };
            let Some(question) = self.question.finer(request, by, set)? else { break };
            let searched = Searched::of(request, &question, self.measured.is_whole, None);
            self = Self { question, searched: watch.after(Stage::Search, searched)?, ..self };
        }
        Ok(self)
    }

    /// Repeats the search with another behavior of the input between its samples, if that comes closer. The
    /// recalibrated simulator, which lacks the missing effects, chose among them, which differ by up to half a
    /// sampling interval. So the found sets are compared under all.
    fn with_the_best_hold(
        mut self,
        request: &Request<'_>,
        watch: &mut Stopwatch<'_>,
    ) -> Result<Self, DiagnosisError> {
        for hold in self.question.other_holds().filter(|_| request.settings.hold.is_none()) {
            let other = Question::of(request, &self.measured, Some(hold))?;
            let Some(known) = self.searched.better_on(&self.question, &other) else { continue };
            let searched = Searched::of(request, &other, self.measured.is_whole, Some(known));
            let sought = Self { question: other, searched: watch.after(Stage::Search, searched)?, ..self };
            self = sought.with_enough_input(request, watch)?;
        }
        Ok(self)
    }

    /// Returns `true` if this search has come closer than another one by more than `price` nats.
    fn is_closer(&self, other: &Self, price: f64) -> bool {
        self.searched.is_closer(&other.searched, other.question.candidates.len(), price)
    }

    /// Returns the clocks corrected for the rate errors that a found set shows, and this set; `None` if no
    /// set shows any.
    fn clocks_corrected(&self, clocks: &ClockRates) -> Option<(ClockRates, Fit)> {
        let sets = (&self.searched.interval, &self.searched.found);
        clocks.corrected(&self.question.coarse, sets, self.question.candidates.len())
    }
}

/// Diagnoses the gap between a nominal simulator and records of one system.
///
/// `seconds` is a stopwatch: it returns seconds since any fixed moment. The cost is linear in the number of
/// samples up to 20,000. Beyond that, samples or whole segments are left out, and the answer states the share
/// used. The same input gives the same bits with any number of threads (times apart).
///
/// `simulator` is the nominal oscillator, alone or with known effects: these are part of every hypothesis and
/// are not candidates.
///
/// # Errors
/// [`DiagnosisError`] for records without usable information, or records of another system.
pub fn diagnose(
    records: &[Observations],
    simulator: impl Into<NominalSimulator>,
    settings: &Settings,
    seconds: &dyn Fn() -> f64,
) -> Result<Diagnosis, DiagnosisError> {
    diagnose_watched(records, simulator, settings, seconds, &|_| true)
}

/// Diagnoses as [`diagnose`] does, with a callback. `goes_on` is called after each stage but the
/// last; if it returns `false`, the diagnosis ends.
///
/// # Errors
/// The errors of [`diagnose`], and [`DiagnosisError::Interrupted`].
pub fn diagnose_watched(
    records: &[Observations],
    simulator: impl Into<NominalSimulator>,
    settings: &Settings,
    seconds: &dyn Fn() -> f64,
    goes_on: &dyn Fn(Stage) -> bool,
) -> Result<Diagnosis, DiagnosisError> {
    let simulator = &simulator.into();
    let mut watch = Stopwatch::new(seconds, goes_on);
    let mut clocks = ClockRates::as_stamped(records);
    let request = Request { records, simulator, settings };
    let mut sought =
        Sought::of(&request, settings.hold, None, &mut watch)?.with_the_best_hold(&request, &mut watch)?;
    for _ in 0..CORRECTIONS {
        let Some((corrected, set)) = sought.clocks_corrected(&clocks) else { break };
        let request = Request { records: &corrected.records, simulator, settings };
        let (hold, by) = (sought.question.hold(), sought.searched.interval.by);
        let other = Sought::of(&request, hold, Some(Known { by, set }), &mut watch)?;
        if !other.is_closer(&sought, corrected.price) {
            break;
        }
        (sought, clocks) = (other, corrected);
    }
    let Sought { mut measured, question, searched } = sought;
    measured.findings.extend(clocks.finding());
    let request = Request { records: &clocks.records, simulator, settings };
    let refined = watch.after(Stage::Fits, Refined::of(question, searched)?)?;
    let work = refined.context(&request);
    let completed = OnceCell::new();
    let judged = Judged::of(&request, &measured, &refined, &work, &completed)?;
    let judged = watch.after(Stage::HeldOutParts, judged)?;
    let unit = records.first().map_or("", |record| record.unit);
    let remaining = watch.after(Stage::LeftOver, Remaining::of(&work, &refined, &judged, unit)?)?;
    let mut answer = answer(request, &measured, &refined, &work, &judged, &remaining)?;
    answer.stages = watch.last(Stage::Explanation);
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use crate::{Diagnosis, Observations, Settings, diagnose};
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Coordinate, Hold, Input, Nominal, Start, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    /// Diagnoses exact readings of an angle under a torque, with noise of a size.
    fn answer(
        nominal: &Nominal,
        times: Vec<f64>,
        torque: Vec<f64>,
        exact: &[f64],
        (size, seed): (f64, u64),
    ) -> Diagnosis {
        let mut generator = Seed::new(seed).child("noise").generator();
        let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
        let values = exact.iter().map(|x| x + size * noise()).collect();
        let record = Record::new(times, values, Some(torque), Quantity::Position, "rad").unwrap();
        let observed = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
        diagnose(&[observed], nominal, &Settings::default(), &|| 0.0).unwrap()
    }

    /// Diagnoses a stiffening spring under chirps of the given forces, logged exactly. Returns the names, and
    /// the repaired simulator's error over the noise.
    fn chirped(forces: &[f64]) -> (Vec<&'static str>, f64) {
        let nominal = Nominal::new(0.5, 0.4, 80.0, 0.0).unwrap();
        let nominal = nominal.with_coordinate(Coordinate::Displacement);
        let bend = Active::new("cubic_stiffness", &[9000.0]).unwrap();
        let system = System::new(nominal, vec![bend]).unwrap();
        let times: Vec<f64> = (0..3000).map(|at| 0.005 * f64::from(at)).collect();
        let mut generator = Seed::new(3).child("noise").generator();
        let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
        let record = |force: &f64| {
            let phase = |t: f64| std::f64::consts::TAU * (1.2 + 0.06 * t) * t;
            let force: Vec<f64> = times.iter().map(|&t| force * phase(t).sin()).collect();
            let input = Input::new(times.clone(), force.clone(), Hold::Linear).unwrap();
            let start = Start::release(0.0);
            let motion = simulate(&system, start, Some(&input), &times, &Tolerance::default()).unwrap();
            let values = motion.position.iter().map(|x| x + 2e-5 * noise()).collect();
            let record = Record::new(times.clone(), values, Some(force), Quantity::Position, "m").unwrap();
            let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
            Observations::new(&record, &clock)
        };
        let records: Vec<Observations> = forces.iter().map(record).collect();
        let answer =
            diagnose(&records, &nominal, &Settings { most_effects: 2, ..Settings::default() }, &|| 0.0)
                .unwrap();
        (answer.verdict.effects, answer.gap.repaired / answer.gap.noise_floor)
    }

    /// Without the cubic term, the recalibrated simulator comes closer if the input is held between its
    /// samples, and half an interval of delay would then have to be explained.
    #[test]
    fn what_the_input_does_between_its_samples_is_asked_beside_the_effects() {
        let (names, ratio) = chirped(&[0.4]);
        assert_eq!(names, ["cubic_stiffness"]);
        assert!(ratio < 1.1, "{ratio}");
    }

    /// A torque that is held between its samples drives a swing with drag. The recalibrated simulator, which
    /// lacks the drag, comes closer if the torque is linear between its samples. Half an interval of delay
    /// then makes up for it, and the closest set is not the drag without a delay.
    #[test]
    fn a_held_input_is_no_delay() {
        let nominal = Nominal::new(5e-4, 1.9e-4, 0.24, 0.0).unwrap();
        let drag = Active::new("quadratic_drag", &[4e-5]).unwrap();
        let system = System::new(nominal, vec![drag]).unwrap();
        let times: Vec<f64> = (0..4800).map(|at| 0.0025 * f64::from(at)).collect();
        let phase = |t: f64| std::f64::consts::TAU * (1.0 + 0.5 * 5.0 / 12.0 * t) * t;
        let torque: Vec<f64> = times.iter().map(|&t| 0.01 * phase(t).sin()).collect();
        let input = Input::new(times.clone(), torque.clone(), Hold::Zero).unwrap();
        let tolerance = Tolerance::default();
        let motion = simulate(&system, Start::release(0.5), Some(&input), &times, &tolerance).unwrap();
        let answer = answer(&nominal, times, torque, &motion.position, (2e-4, 4));
        assert_eq!(answer.verdict.effects, ["quadratic_drag"]);
    }

    /// Each of the two follows the motion as well as the other, so that neither is needed; one of them is.
    #[test]
    fn a_short_delay_that_a_lag_imitates_is_named() {
        let nominal = Nominal::new(1.0, 1.84, 245.0, 0.0).unwrap();
        let delay = Active::new("input_delay", &[0.0023]).unwrap();
        let system = System::new(nominal, vec![delay]).unwrap();
        let times: Vec<f64> = (0..170).map(|at| 0.021 * f64::from(at)).collect();
        let torque: Vec<f64> =
            times.iter().map(|t| 25.0 * (11.0 * t).sin() + 20.0 * (19.0 * t + 1.0).sin()).collect();
        let input = Input::new(times.clone(), torque.clone(), Hold::Zero).unwrap();
        let tolerance = Tolerance::default();
        let motion = simulate(&system, Start::release(0.0), Some(&input), &times, &tolerance).unwrap();
        for noise in [(2e-4, 1), (2e-4, 6), (4e-4, 4)] {
            let answer = answer(&nominal, times.clone(), torque.clone(), &motion.position, noise);
            let named = answer.verdict.effects;
            let is_told = named == ["input_delay"] || named == ["sensor_lag"];
            assert!(is_told, "{noise:?}: {named:?}: {:?}", answer.classes);
        }
    }

    /// A torque in steps, read by a sensor with a lag of a sixth of a radian. Between readings the lag is run in
    /// forty steps, each exact for a straight motion.
    #[test]
    fn a_lag_is_no_delay() {
        let (nominal, constant) = (Nominal::new(1.0, 1.0, 200.0, 0.0).unwrap(), 0.012);
        let system = System::new(nominal, Vec::new()).unwrap();
        let fine: Vec<f64> = (0..80_000).map(|at| f64::from(at) / 4000.0).collect();
        let level = |step: usize| 60.0 * (12.9 * step as f64).sin();
        let torque: Vec<f64> = (0..2000).map(|at| if at < 30 { 0.0 } else { level(at / 30) }).collect();
        let times: Vec<f64> = fine.iter().copied().step_by(40).collect();
        let input = Input::new(times.clone(), torque.clone(), Hold::Zero).unwrap();
        let (start, tolerance) = (Start::release(0.0), Tolerance::default());
        let motion = simulate(&system, start, Some(&input), &fine, &tolerance).unwrap();
        let keep = (-1.0 / 4000.0_f64 / constant).exp();
        let mut reading = 0.0;
        let read = motion.position.windows(2).map(|ends| {
            let behind = constant * 4000.0 * (ends[1] - ends[0]);
            reading = ends[1] - behind + (reading - ends[0] + behind) * keep;
            reading
        });
        let read: Vec<f64> = std::iter::once(0.0).chain(read).step_by(40).collect();
        let answer = answer(&nominal, times, torque, &read, (1e-3, 5));
        assert_eq!(answer.verdict.effects, ["sensor_lag"]);
        let found = answer.effects.iter().find(|row| row.id == "sensor_lag").unwrap();
        let found = found.parameters.first().unwrap().estimate.value;
        assert!((found / constant - 1.0).abs() < 0.03, "{found}");
    }

    /// The closest linear oscillator is one that the input does not move: no set begun there converges. An
    /// input with as few knots as this oscillator allows distorts the sets that do.
    #[test]
    fn a_spring_whose_bend_outweighs_it_is_found_under_an_input() {
        let (names, ratio) = chirped(&[6.0, 9.0]);
        assert_eq!(names, ["cubic_stiffness"]);
        assert!(ratio < 1.1, "{ratio}");
    }
}
