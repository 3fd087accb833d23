#![allow(clippy::print_stdout)]

use super::job::Job;
use super::nuisances::{Nuisances, Scatter};
use super::plan::TrialPlan;
use super::recalibration::Absorbed;
use super::setup::Setup;
use super::situation::Motions;
use crate::effects::{Size, TrialEffect, find};
use crate::{Bank, Hidden};
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Nominal, Start, System, SystemEffect};
use nalgebra::{DMatrix, DVector};
use record::{ReadOptions, read_text};
use settings::Document;
use std::collections::BTreeMap;
use std::path::Path;

const BANKS: &[&str] = &[
    "none",
    "calibration",
    "single",
    "pair",
    "left_out",
    "foreign",
    "releases",
    "driven",
    "stressed",
    "composite",
];

/// Plans trials of short records, so that a test can make many.
fn plan(counts: &[(&str, usize)], overrides: &[&str]) -> TrialPlan {
    let mut document = Document::parse("test.toml", "").unwrap();
    let short = ["record.seconds=6", "record.rate_hz=120", "system.lowest_frequency_hz=2"];
    let counts: Vec<String> = counts.iter().map(|(bank, count)| format!("trials.{bank}={count}")).collect();
    let all = short.iter().copied().chain(counts.iter().map(String::as_str));
    for argument in all.chain(overrides.iter().copied()) {
        document.apply_override(argument).unwrap();
    }
    TrialPlan::resolve(&document).unwrap()
}

fn all_banks(count: usize, overrides: &[&str]) -> TrialPlan {
    plan(&BANKS.iter().map(|bank| (*bank, count)).collect::<Vec<_>>(), overrides)
}

/// Returns the trial properties of a case's hidden effects.
fn effects(hidden: &Hidden) -> Vec<&'static TrialEffect> {
    hidden.effects.iter().map(|effect| find(&effect.id).unwrap()).collect()
}

fn shipped(name: &str) -> Document {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(name);
    Document::parse(name, &std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn every_bank_makes_cases_that_read_back() {
    for seed in ["seed=1", "seed=2"] {
        let plan = all_banks(4, &[seed]);
        assert_eq!(plan.len(), 4 * BANKS.len());
        for index in 0..plan.len() {
            let case = plan.case(index).unwrap();
            assert_eq!(case.hidden.bank, plan.job(index).unwrap().bank);
            let nominal: Nominal = toml::from_str(&case.nominal).unwrap();
            let rounds = case.hidden.nuisances.iter().any(|id| id == "sensor_quantization");
            assert_eq!(nominal.sensor_resolution().is_some(), rounds);
            for text in &case.records {
                let (record, source) = read_text("record", text.as_bytes(), &ReadOptions::default()).unwrap();
                assert!(record.len() > 300, "{}", record.len());
                assert_eq!(source.findings, Vec::<String>::new());
            }
            let text = serde_json::to_string(&case.hidden).unwrap();
            assert_eq!(serde_json::from_str::<Hidden>(&text).unwrap(), case.hidden);
        }
    }
}

#[test]
fn a_case_depends_on_seed_bank_and_number_alone() {
    let few = all_banks(2, &[]);
    let more = all_banks(5, &[]);
    for index in 0..few.len() {
        let job = few.job(index).unwrap();
        let other = (0..more.len()).find(|&other| more.job(other).unwrap() == job).unwrap();
        let (one, two) = (few.case(index).unwrap(), more.case(other).unwrap());
        assert_eq!(few.case(index).unwrap(), one);
        assert_eq!((&one.records, &one.nominal, &one.hidden), (&two.records, &two.nominal, &two.hidden));
    }
    let other_seed = all_banks(2, &["seed=1"]);
    let any = few.case(0).unwrap();
    assert!((0..few.len()).all(|index| other_seed.case(index).unwrap().records != any.records));
}

#[test]
fn nothing_outside_the_truth_tells_the_bank() {
    let plan = all_banks(200, &[]);
    // Numbers: the mean of a bank's shuffled numbers is normal with a known standard deviation.
    let cases = plan.len() as f64;
    for job in [Bank::None, Bank::Calibration, Bank::Single, Bank::Pair, Bank::LeftOut, Bank::Foreign] {
        let own: Vec<f64> = (0..plan.len())
            .filter(|&index| plan.job(index).unwrap().bank == job)
            .map(|index| index as f64)
            .collect();
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let deviation = cases / 12.0_f64.sqrt() / (own.len() as f64).sqrt();
        assert!((mean - 0.5 * (cases - 1.0)).abs() < 4.0 * deviation, "{job:?} {mean}");
    }
    // Texts: except for numbers and an input column, the files of all cases have the same lines.
    let plan = all_banks(2, &[]);
    let mut headers = std::collections::BTreeSet::new();
    let mut keys = std::collections::BTreeSet::new();
    for index in 0..plan.len() {
        let case = plan.case(index).unwrap();
        assert_eq!(case.id, format!("{index:06}"));
        for text in case.records {
            headers.insert(text.lines().take(3).collect::<Vec<_>>().join("\n").replace(",torque_nm", ""));
        }
        for line in case.nominal.lines() {
            keys.insert(line.split('=').next().unwrap().trim().to_owned());
        }
    }
    assert_eq!(headers.len(), 1, "{headers:?}");
    let known = ["damping", "inertia", "rest_angle", "sensor_resolution", "stiffness"];
    assert_eq!(keys.iter().filter(|key| !key.starts_with('#')).collect::<Vec<_>>(), known);
}

/// Pearson's test of homogeneity over banks; also checks that records get what is drawn.
#[test]
fn nuisances_are_alike_in_every_bank() {
    let banks = [Bank::None, Bank::Calibration, Bank::Single, Bank::Pair, Bank::Foreign, Bank::Stressed];
    let draws = 1000;
    let mut counts = [[0.0; 6]; 6];
    for (row, bank) in counts.iter_mut().zip(banks) {
        for number in 0..draws {
            let drawn = Nuisances::draw(&Job { bank, number }.seed(0).0);
            let clock = match drawn.clock {
                None => 0,
                Some(Scatter::Batching { .. }) => 1,
                Some(Scatter::Jitter(_)) => 2,
            };
            row[2 * clock + usize::from(drawn.encoder_step.is_some())] += 1.0;
        }
    }
    let mut statistic = 0.0;
    for column in 0..6 {
        let expected = counts.iter().map(|row| row[column]).sum::<f64>() / 6.0;
        statistic += counts.iter().map(|row| (row[column] - expected).powi(2) / expected).sum::<f64>();
    }
    // 25 degrees of freedom: 99.9 % of such tables stay below.
    assert!(statistic < 52.62, "{statistic}");

    let plan = all_banks(3, &[]);
    for index in 0..plan.len() {
        let hidden = plan.case(index).unwrap().hidden;
        let replaced = effects(&hidden).into_iter().filter_map(|effect| effect.nuisance);
        let drawn = Nuisances::draw(&plan.job(index).unwrap().seed(0).0).beside(replaced);
        let has = |id: &str| hidden.nuisances.iter().any(|known| known == id);
        assert_eq!(has("sensor_quantization"), drawn.encoder_step.is_some());
        assert_eq!(has("timestamp_batching"), matches!(drawn.clock, Some(Scatter::Batching { .. })));
        assert_eq!(has("timestamp_jitter"), matches!(drawn.clock, Some(Scatter::Jitter(_))));
    }
}

/// Checks the detectability by an independent computation: motions of the reference integrator, derivatives
/// by finite differences, and a projection by singular values.
#[test]
fn sizes_are_as_detectable_as_wanted() {
    let plan = plan(&[("single", 26), ("releases", 14)], &["trials.detectabilities=[6]"]);
    let mut checked = 0;
    for index in 0..plan.len() {
        let job = plan.job(index).unwrap();
        let hidden = plan.case(index).unwrap().hidden;
        let effect = &hidden.effects[0];
        let known = find(&effect.id).unwrap();
        if matches!(known.size, Size::Solved(_)) {
            assert!((effect.detectability / 6.0 - 1.0).abs() < 0.02, "{effect:?}");
        }
        if hidden.records[0].system.effects().is_empty() || hidden.records[0].excitation.is_some() {
            continue;
        }
        let white = (0..40)
            .map(|attempt| {
                let motions = if job.bank == Bank::Releases { Motions::Releases } else { Motions::Release };
                Setup::draw(&plan, job, attempt, motions, &[known]).unwrap()
            })
            .find(|setup| setup.situation.nominal == *hidden.records[0].system.nominal())
            .unwrap()
            .white;
        let found = projected(&hidden, !known.moves_rest_angle) / white;
        assert!((found / 6.0 - 1.0).abs() < 0.02, "{} {found}", effect.id);
        checked += 1;
    }
    assert!(checked > 20, "{checked}");
}

/// Checks the part of one effect of a pair that neither recalibration nor the other effect absorbs.
#[test]
fn each_of_a_pair_is_as_detectable_as_wanted_beyond_the_other() {
    let plan = plan(&[("pair", 54)], &["trials.detectabilities=[12]"]);
    let mut checked = 0;
    for index in 0..plan.len() {
        let job = plan.job(index).unwrap();
        let hidden = plan.case(index).unwrap().hidden;
        let stand_in: &'static [SystemEffect] = match &hidden.effects[..] {
            [one, other] if [&one.id, &other.id].iter().all(|id| *id != "flexible_coupling") => {
                let ids = [one.id.as_str(), other.id.as_str()];
                match ids.iter().find(|id| ["quadratic_drag", "cubic_stiffness"].contains(id)) {
                    Some(&"quadratic_drag") => &[SystemEffect::QuadraticDrag],
                    Some(&"cubic_stiffness") => &[SystemEffect::CubicStiffness],
                    _ => continue,
                }
            }
            _ => continue,
        };
        let truth = &hidden.records[0];
        if truth.excitation.is_some() || truth.system.effects().len() < 2 {
            continue;
        }
        let effects = effects(&hidden);
        let setup = (0..40)
            .map(|attempt| Setup::draw(&plan, job, attempt, Motions::Release, &effects).unwrap())
            .find(|setup| setup.situation.nominal == *truth.system.nominal())
            .unwrap();
        let motions = setup.situation.motions(truth.system.effects()).unwrap();
        let absorbed = Absorbed { stand_ins: stand_in, ..Absorbed::BY_RECALIBRATION };
        let found = setup.detectability(motions, absorbed).unwrap();
        // The larger the sizes, the less linear the problem; an error of a factor of two would mean that the
        // effects cancel.
        assert!((found / 12.0 - 1.0).abs() < 0.2, "{:?} {found}", hidden.effects);
        checked += 1;
    }
    assert!(checked > 5, "{checked}");
}

/// Returns ‖P·Δ‖ of a case with effects in the system.
fn projected(hidden: &Hidden, rest_angle: bool) -> f64 {
    let truth = &hidden.records[0];
    let times: Vec<f64> =
        (0..truth.sampling.samples).map(|index| index as f64 / truth.sampling.rate_hz).collect();
    let starts: Vec<Start> = hidden.records.iter().map(|record| record.start).collect();
    let of = |system: &System, starts: &[Start]| -> DVector<f64> {
        let all = starts.iter().flat_map(|start| {
            simulate(system, *start, None, &times, &Tolerance::default()).unwrap().position
        });
        DVector::from_iterator(times.len() * starts.len(), all)
    };
    let nominal = *truth.system.nominal();
    let plain = |nominal: Nominal| System::new(nominal, Vec::new()).unwrap();
    let mut added = of(&truth.system, &starts) - of(&plain(nominal), &starts);
    // The projection is iterated, because an effect that changes the frequency causes a large phase change.
    let mut at = nominal.coefficients();
    let mut begin = starts;
    for _ in 0..4 {
        let mut columns = Vec::new();
        let mut moves: Vec<(usize, f64)> = vec![(0, 1e-4 * at.damping), (1, 1e-6 * at.stiffness)];
        if rest_angle {
            moves.push((2, 1e-5));
        }
        let system = |change: Option<(usize, f64)>| {
            let mut changed = at;
            match change {
                Some((0, by)) => changed.damping += by,
                Some((1, by)) => changed.stiffness += by,
                Some((_, by)) => changed.rest_angle += by,
                None => {}
            }
            plain(nominal.with_coefficients(changed).unwrap())
        };
        for &(which, by) in &moves {
            let difference = of(&system(Some((which, by))), &begin) - of(&system(Some((which, -by))), &begin);
            columns.push(difference / (2.0 * by));
        }
        for record in 0..begin.len() {
            for velocity in [false, true] {
                let moved = |by: f64| {
                    let mut begin = begin.clone();
                    if velocity {
                        begin[record].velocity += by;
                    } else {
                        begin[record].position += by;
                    }
                    of(&system(None), &begin)
                };
                columns.push((moved(1e-4) - moved(-1e-4)) / 2e-4);
            }
        }
        let scaled: Vec<DVector<f64>> = columns.iter().map(|column| column / column.norm()).collect();
        let solution = DMatrix::from_columns(&scaled).svd(true, true).solve(&added, 1e-12).unwrap();
        let step: Vec<f64> =
            solution.iter().zip(&columns).map(|(part, column)| part / column.norm()).collect();
        at.damping += step[0];
        at.stiffness += step[1];
        at.rest_angle += if rest_angle { step[2] } else { 0.0 };
        for (record, start) in begin.iter_mut().enumerate() {
            start.position += step[moves.len() + 2 * record];
            start.velocity += step[moves.len() + 2 * record + 1];
        }
        let target = of(&truth.system, &hidden.records.iter().map(|record| record.start).collect::<Vec<_>>());
        added = target - of(&plain(nominal.with_coefficients(at).unwrap()), &begin);
    }
    added.norm()
}

#[test]
fn banks_without_their_folders_are_left_out_and_said_to_be() {
    let plan =
        plan(&[("none", 3), ("measured_cases", 5), ("engine_cases", 7)], &["trials.measured=no/such/folder"]);
    assert_eq!(plan.len(), 3);
    let [measured, engine] = plan.left_out_banks() else { panic!("{:?}", plan.left_out_banks()) };
    assert_eq!((measured.bank, measured.cases), (Bank::Measured, 5));
    assert!(measured.reason.contains("no/such/folder"), "{}", measured.reason);
    assert_eq!((engine.bank, engine.cases), (Bank::Engine, 7));
    assert!(engine.reason.contains("trials.engine"), "{}", engine.reason);
}

fn fixture(name: &str) -> String {
    format!("{}/src/make/fixtures/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn an_effect_is_laid_under_a_residual() {
    let folder = format!("trials.measured={}", fixture("residuals"));
    let plan = plan(&[("measured_cases", 13)], &[&folder, "trials.detectabilities=[12]"]);
    assert_eq!((plan.len(), plan.left_out_banks()), (13, &[][..]));
    for index in 0..plan.len() {
        let case = plan.case(index).unwrap();
        let effect = &case.hidden.effects[0];
        assert!((effect.detectability / 12.0 - 1.0).abs() < 0.02, "{effect:?}");
        assert!((case.hidden.noise / 3e-4 - 1.0).abs() < 0.1, "{}", case.hidden.noise);
        assert_eq!(case.hidden.nuisances, ["timestamp_batching"]);
        let (record, _) = read_text("record", case.records[0].as_bytes(), &ReadOptions::default()).unwrap();
        assert_eq!(record.len(), 900);
        // Without the motion, the residual remains, up to its rounding.
        let truth = &case.hidden.records[0];
        if truth.chain.effects().count() == 0 {
            let times: Vec<f64> = (0..900).map(|index| f64::from(index) / truth.sampling.rate_hz).collect();
            let clean =
                simulate(&truth.system, truth.start, None, &times, &Tolerance::default()).unwrap().position;
            let rest: Vec<f64> = record.values().iter().zip(&clean).map(|(one, other)| one - other).collect();
            let rms = (rest.iter().map(|value| value * value).sum::<f64>() / 900.0).sqrt();
            assert!((2.9e-4..3.6e-4).contains(&rms), "{rms:e}");
        }
    }
}

#[test]
fn cases_of_a_physics_engine_are_written_like_every_other() {
    let folder = format!("trials.engine={}", fixture("engine"));
    let plan = plan(&[("engine_cases", 5), ("none", 1)], &[&folder]);
    // As many cases as the folder holds.
    assert_eq!((plan.len(), plan.left_out_banks()), (2, &[][..]));
    let cases: Vec<_> = (0..2).map(|index| plan.case(index).unwrap()).collect();
    let [engine] = cases.iter().filter(|case| case.hidden.bank == Bank::Engine).collect::<Vec<_>>()[..]
    else {
        panic!("one case of the engine");
    };
    assert_eq!(engine.hidden.effects[0].id, "coulomb_friction");
    let head = |index: usize| cases[index].records[0].lines().take(3).collect::<Vec<_>>();
    assert_eq!(head(0), head(1));
}

#[test]
fn the_shipped_configuration_hides_everything_at_every_size() {
    let plan = TrialPlan::resolve(&shipped("trials.toml")).unwrap();
    assert!(plan.len() >= 5000, "{}", plan.len());
    assert_eq!(plan.detectabilities, [3.0, 6.0, 12.0, 25.0, 50.0, 100.0]);
    let mut counts = BTreeMap::<Bank, usize>::new();
    for index in 0..plan.len() {
        *counts.entry(plan.job(index).unwrap().bank).or_default() += 1;
    }
    for (bank, count) in counts {
        let whole = TrialPlan::variety(bank) * plan.detectabilities.len();
        let plain = [Bank::None, Bank::Calibration, Bank::Engine].contains(&bank);
        assert!(
            plain || count >= whole,
            "configs/trials.toml: {bank:?} has {count} cases; {whole} are needed to hide every effect at every size"
        );
    }
    let quick = TrialPlan::resolve(&shipped("trials-quick.toml")).unwrap();
    assert!((90..=120).contains(&quick.len()), "{}", quick.len());
}

/// Run with `cargo test --release -p trials how_long -- --ignored --nocapture`.
#[test]
#[ignore = "minutes without optimization"]
fn how_long_a_hundred_cases_take() {
    let mut document = shipped("trials-quick.toml");
    for argument in option_env!("TRIALS").unwrap_or_default().split_whitespace() {
        document.apply_override(argument).unwrap();
    }
    let plan = TrialPlan::resolve(&document).unwrap();
    let mut by_bank = BTreeMap::<Bank, (usize, f64, f64)>::new();
    for index in 0..plan.len() {
        let clock = std::time::Instant::now();
        let case = plan.case(index).unwrap();
        let seconds = clock.elapsed().as_secs_f64();
        let bank = plan.job(index).unwrap().bank;
        let entry = by_bank.entry(bank).or_default();
        *entry = (entry.0 + 1, entry.1 + seconds, entry.2.max(seconds));
        let told: Vec<String> = case
            .hidden
            .effects
            .iter()
            .map(|effect| format!("{} {:?} d {:.3}", effect.id, effect.parameters, effect.detectability))
            .collect();
        println!("{bank:?} {seconds:.3} s {} {:?}", told.join(" + "), case.hidden.foreign);
    }
    for (bank, (count, seconds, worst)) in by_bank {
        println!("{bank:?}: {count} cases, {:.3} s each, worst {worst:.3} s", seconds / count as f64);
    }
}
