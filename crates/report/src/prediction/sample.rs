//! A made-up study of held-out prediction for the tests.

use results::{
    Coverage, ExponentialScores, Family, HeldOutScore, LawSummary, MethodScores, Origin, PairedComparison,
    PredictionCsvRow, PredictionOutcome, PredictionResult, PredictionRow, ProblemOutcome, ProblemRow,
    ProblemStudy, RESULT_SCHEMA, SplitKind, SplitSummary,
};

use crate::sample::{Sample, table};
use crate::{ReportError, RunTexts, render};

fn score(error: f64, has_truth: bool, pair: Option<(usize, usize)>) -> HeldOutScore {
    HeldOutScore {
        peaks: 480,
        not_finite: 0,
        rms_log_error: error,
        worst_rms_log_error: 2.0 * error,
        amplitude_error_percent: 105.0 * error,
        truth_rms_log_error: has_truth.then_some(0.7 * error),
        mean_log_density: Some(1.5 - 10.0 * error),
        coverage: Some(Coverage { held: 456, of: 480, interval_95: Some([0.921, 0.971]) }),
        against_exponential: pair.map(|(better, worse)| PairedComparison {
            better,
            worse,
            equal: 0,
            p_value: 1e-7,
            adjusted_p_value: 2e-6,
        }),
    }
}

fn row(id: &str, title: &str, error: f64, has_truth: bool, equation: Option<&str>) -> PredictionRow {
    let share = has_truth.then_some(Coverage { held: 18, of: 20, interval_95: Some([0.683, 0.988]) });
    PredictionRow {
        number: Some(12),
        id: id.into(),
        title: title.into(),
        family: Family::Learned,
        outcome: PredictionOutcome::Scored(Box::new(MethodScores {
            draws: if has_truth { 20 } else { 1 },
            failed_fits: 0,
            first_failure: None,
            fits: 40,
            converged: 40,
            interpolation: Some(score(0.5 * error, has_truth, Some((19, 1)))),
            extrapolation: Some(score(error, has_truth, has_truth.then_some((20, 0)))),
            covers_projected_slope: share,
            covers_viscous_rate: share,
            equation: equation.map(str::to_owned),
            commonest_form: equation.map(|_| ("d ln A/dt = -c - c/A".to_owned(), 4)),
            seconds: 3.1e-4,
        })),
    }
}

fn study(has_truth: bool) -> ProblemStudy {
    ProblemStudy {
        unit: "rad".into(),
        peaks: 72,
        duration_s: 10.22,
        data: (!has_truth).then(|| Sample::new().result.data),
        law: has_truth.then(|| LawSummary {
            equation: "Aₙ₊₁ = exp(−λT/2) Aₙ − Δ".into(),
            parameters: "A₀ = 0.5 rad, λ = 0.15 1/s".into(),
            exactness: "exact at the turning points".into(),
            viscous_rate: 0.15,
            projected_slope: 0.234_567,
            scatter: "Gaussian, 0.002 rad on the amplitude".into(),
            draws: [200, 20],
        }),
        exponential: ExponentialScores {
            interpolation: score(0.08, has_truth, None),
            extrapolation: score(0.3, has_truth, None),
        },
        methods: vec![
            row("sindy", "SINDy", 0.05, has_truth, Some("d ln A/dt = -0.15 - 0.0138/A")),
            row("gaussian-process", "Gaussian process", 0.2, has_truth, None),
            row("ols", "Ordinary least squares", 0.3, has_truth, None),
            PredictionRow {
                outcome: PredictionOutcome::Failed { reason: "sindy needs at least 8 peaks".into() },
                ..row("symbolic", "Symbolic regression", 1.0, has_truth, None)
            },
        ],
        comparisons: 4,
        verdict: vec![
            "Between other peaks better than the best exponential by more than chance: sindy.".into(),
        ],
    }
}

pub(crate) fn result() -> PredictionResult {
    let problem = |id: &str, title: &str, origin, outcome| ProblemRow {
        id: id.into(),
        title: title.into(),
        origin,
        outcome,
    };
    PredictionResult {
        schema: RESULT_SCHEMA.into(),
        task: "predict".into(),
        seed: 0,
        splits: SplitSummary { block_peaks: 3, every: 4, last_share: 1.0 / 3.0, significance: 0.05 },
        problems: vec![
            problem("dry", "Dry friction", Origin::Simulated, ProblemOutcome::Studied(Box::new(study(true)))),
            problem(
                "rig",
                "The paper's rig",
                Origin::Measured,
                ProblemOutcome::Studied(Box::new(study(false))),
            ),
            problem(
                "gone",
                "A lost record",
                Origin::Measured,
                ProblemOutcome::Absent { reason: "the record lost.csv is not there".into() },
            ),
        ],
        seconds: 41.7,
    }
}

fn rows() -> Vec<PredictionCsvRow> {
    let mut rows = Vec::new();
    for (problem, origin) in [("dry", Origin::Simulated), ("rig", Origin::Measured)] {
        for (method, bend) in
            [("best-exponential", 0.0), ("sindy", 0.02), ("gaussian-process", 0.01), ("ols", 0.0)]
        {
            rows.extend((0..72).map(|peak| {
                let time = 0.144 * f64::from(peak);
                let log = -0.7 - 0.2 * time - 0.02 * time * time;
                PredictionCsvRow {
                    problem: problem.into(),
                    origin,
                    split: SplitKind::Extrapolation,
                    method: method.into(),
                    time_s: time,
                    log_amplitude: log + 0.03 * (7.0 * time).sin(),
                    truth: (origin == Origin::Simulated).then_some(log),
                    held_out: peak >= 48,
                    predicted: -0.7 - 0.25 * time - bend * time * time,
                    std_error: Some(0.03),
                }
            }));
        }
    }
    rows
}

/// Folder of a study, which tests change before they make its report.
pub(crate) struct Folder {
    pub(crate) name: String,
    pub(crate) result: PredictionResult,
    pub(crate) rows: Vec<PredictionCsvRow>,
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self { name: "predict-20250314T092653Z-a1b2c3".into(), result: result(), rows: rows() }
    }

    pub(crate) fn render(&self) -> Result<String, ReportError> {
        render(&RunTexts {
            name: &self.name,
            config: "task = \"predict\"\n",
            result: &serde_json::to_string_pretty(&self.result).unwrap(),
            trace: "",
            envelope: "",
            predictions: &table(&self.rows),
            series: "",
            environment: "{}\n",
            reader: crate::Reader::CommandLine,
        })
    }
}
