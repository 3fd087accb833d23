//! Trials on simulated and on measured records.

use crate::calibrate::better_hold;
use crate::candidate::Candidate;
use crate::noise::floor;
use crate::observations::Observations;
use crate::score::score;
use crate::search::{Breadth, search};
use crate::segments::{MOST_SEARCHED, cut};
use dynamics::Nominal;
use record::{Clock, ClockChoice, CsvColumns, Format, ReadOptions, read_file};
use std::path::Path;

fn shared(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name)
}

fn nominal(name: &str) -> Nominal {
    toml::from_str(&std::fs::read_to_string(shared(name)).unwrap()).unwrap()
}

fn explore(observations: &[Observations], nominal: &Nominal) {
    let clock = std::time::Instant::now();
    let kept: Vec<Vec<bool>> = observations.iter().map(|o| vec![true; o.len()]).collect();
    let data = cut(observations, &kept, nominal).unwrap().thinned(MOST_SEARCHED);
    println!("{} segments {} samples {:?} period {:?}", data.segments.len(), data.samples(), data.facts, data.period_s);
    let (data, base) = better_hold(&data, nominal).unwrap();
    let rms = |squares: f64, freedom: f64| (squares / freedom).sqrt();
    let deg = if data.quantity == record::Quantity::Position { 180.0 / std::f64::consts::PI } else { 1.0 };
    println!("nominal {:.5} calibrated {:.5} {:?} [{:.2} s]", rms(base.nominal.squares, base.nominal.freedom()) * deg, rms(base.calibrated.squares, base.calibrated.freedom()) * deg, base.calibrated.point.globals, clock.elapsed().as_secs_f64());
    let candidates: Vec<Candidate> = Candidate::ALL.iter().copied().filter(|c| c.applies(&data.facts, true, nominal.stiffness() > 0.0)).collect();
    let breadth = Breadth { most_effects: 3, singles: 8, pairs: 8, beam: 3, additions: 4 };
    let pool = search(&data, &base.calibrated, &candidates, &breadth, 5.0);
    let time = pool.autocorrelation_time();
    println!("tau {time:.2} fits {} rejected {:?} [{:.2} s]", pool.fits.len(), pool.rejected.iter().map(|r| r.iter().map(|c| c.id()).collect::<Vec<_>>()).collect::<Vec<_>>(), clock.elapsed().as_secs_f64());
    for fit in pool.ranked(time).into_iter().take(14) {
        let floor = floor(&data, &fit.residuals);
        println!("{:10.2} rms {:.5} floor {:.5} tau {:.1} {:?} {:?}{}", score(fit, time), rms(fit.squares, fit.freedom()) * deg, floor.value * deg, fit.autocorrelation_time(), fit.hypothesis.ids(), fit.point.globals, if fit.converged { "" } else { " NOT" });
    }
}

fn read(name: &str, options: &ReadOptions) -> Observations {
    let (record, _) = read_file(&shared(name), options).unwrap();
    let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
    Observations::new(&record, &clock)
}

fn columns(time: &str, value: &str, input: Option<&str>) -> ReadOptions {
    let mut columns = CsvColumns::default();
    columns.time = (!time.is_empty()).then(|| time.to_owned());
    columns.angle = Some(value.to_owned());
    columns.input = input.map(str::to_owned);
    ReadOptions { columns, ..ReadOptions::default() }
}

#[test]
#[ignore]
fn rig() {
    let options = ReadOptions { format: Format::HostLog, ..ReadOptions::default() };
    explore(&[read("horizontal-pendulum/80P.txt", &options)], &nominal("horizontal-pendulum/nominal.toml"));
}

#[test]
#[ignore]
fn encoder() {
    explore(&[read("encoder-pendulum/record-a.csv", &columns("time", "angle", None))], &nominal("encoder-pendulum/nominal.toml"));
}

#[test]
#[ignore]
fn servo() {
    explore(&[read("servo-pendulum/swing-a.csv", &columns("time_s", "angle_rad", None))], &nominal("servo-pendulum/nominal-a.toml"));
    explore(&[read("servo-pendulum/swing-b.csv", &columns("time_s", "angle_rad", None))], &nominal("servo-pendulum/nominal-b.toml"));
}

#[test]
#[ignore]
fn drive() {
    explore(&[read("positioning-drive/record.csv", &columns("t", "qm_m", Some("vir_V")))], &nominal("positioning-drive/nominal.toml"));
}
