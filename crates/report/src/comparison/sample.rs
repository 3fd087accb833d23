//! A made-up comparison for the tests.

use results::{
    Ablation, AblationRow, Caution, ComparisonResult, Derived, EnvelopeRow, Estimand, Family, MethodEstimate,
    MethodOutcome, MethodRow, Origin, Reached,
};

use crate::sample::{Sample, table};
use crate::{ReportError, RunTexts, render};

const INERTIA: f64 = 5e-4;

/// Name, title, errors of the first and of the worst seed in percent, standard error, seeds, steps,
/// parameters, seconds.
type Line = (&'static str, &'static str, f64, f64, Option<f64>, u64, u64, usize, f64);

const LINES: [Line; 21] = [
    ("ols", "Ordinary least squares", 0.0, 0.0, Some(2.053e-4), 1, 0, 2, 1.1e-6),
    ("polyfit", "Polynomial fit of degree 1", 2.0e-14, 2.0e-14, None, 1, 0, 2, 6.3e-6),
    ("normal-equations", "Normal equations", 1.3e-13, 1.3e-13, None, 1, 0, 2, 8.4e-7),
    ("qr", "QR decomposition", 2.0e-14, 2.0e-14, None, 1, 0, 2, 5.2e-6),
    ("svd", "SVD least squares", 3.2e-14, 3.2e-14, None, 1, 0, 2, 7.9e-6),
    ("gradient-descent", "Gradient descent", 0.046_366, 0.046_366, None, 1, 10_000, 2, 2.1e-3),
    ("l-bfgs", "L-BFGS-B", 9.2e-6, 9.2e-6, None, 1, 14, 2, 3.7e-5),
    ("differential-evolution", "Differential evolution", 5.8e-6, 8.1e-4, None, 5, 300, 2, 4.4e-2),
    ("levenberg-marquardt", "Levenberg–Marquardt", 1.1e-12, 1.1e-12, Some(2.053e-4), 1, 4, 2, 2.2e-5),
    ("trust-region", "Trust region reflective", 4.1e-13, 4.1e-13, None, 1, 5, 2, 3.1e-5),
    ("weighted", "Weighted regression", 0.0, 0.0, Some(2.053e-4), 1, 0, 2, 1.4e-6),
    ("sindy", "SINDy", 3.3e-10, 3.3e-10, None, 1, 3, 3, 9.1e-4),
    ("pinn", "Physics-informed neural network", 3.1e-7, 2.7e-5, None, 5, 2_060, 1_186, 12.34),
    ("neural-ode", "Neural ordinary differential equation", 4.6e-9, 7.7e-8, None, 5, 411, 41, 3.82),
    ("lstm", "Long short-term memory network", 2.2e-6, 6.4e-3, None, 5, 900, 297, 21.7),
    ("symbolic", "Symbolic regression", 0.0, 0.0, None, 0, 0, 0, 0.0),
    ("weak-sindy", "Weak SINDy", 8.8e-9, 8.8e-9, None, 1, 3, 3, 1.2e-3),
    ("bayesian", "Bayesian regression", 1.4e-4, 9.6e-3, Some(2.091e-4), 5, 4_000, 2, 0.327),
    ("envelope-matching", "Envelope matching", 2.9e-8, 2.9e-8, None, 1, 37, 4, 5.6e-3),
    ("gaussian-process", "Gaussian process", 7.4e-7, 7.4e-7, Some(3.3e-4), 1, 52, 3, 1.9e-2),
    ("transformer", "Transformer", 1.7e-6, 3.9e-2, None, 5, 1_500, 4_737, 48.2),
];

fn estimate(line: &Line, zeta: f64, omega: f64) -> MethodEstimate {
    let (id, _, error, worst, std_error, seeds, steps, parameters, seconds) = *line;
    let (reached, because) = match id {
        "gradient-descent" => (Reached::BudgetSpent, "all 10 000 steps were taken"),
        "differential-evolution" => (Reached::BudgetSpent, "all 300 generations were bred"),
        _ if steps == 0 => (Reached::Converged, "solved in closed form"),
        _ => (Reached::Converged, "the gradient fell below 1e-12 of its first value"),
    };
    let zeta = zeta * (1.0 - error / 100.0);
    MethodEstimate {
        decay_rate: zeta * omega,
        zeta,
        zeta_std_error: std_error,
        error_percent: error,
        median_error_percent: f64::midpoint(error, worst),
        worst_error_percent: worst,
        digits_of_agreement: (-(worst / 100.0).log10()).clamp(0.0, 15.7),
        seeds,
        steps,
        parameters,
        seconds,
        reached,
        stopped_because: because.into(),
        pass: true,
        ablations: match id {
            "pinn" => vec![
                AblationRow {
                    ablation: Ablation::LearnedPartAtZero,
                    error_percent: Some(0.0),
                    failure: None,
                },
                AblationRow { ablation: Ablation::NoiseForInput, error_percent: Some(98.7), failure: None },
            ],
            _ => Vec::new(),
        },
    }
}

/// Returns a comparison of 21 methods, one of which gives no estimate.
pub(crate) fn result() -> ComparisonResult {
    let run = Sample::new().result;
    let (omega, oracle) = (run.envelope.omega_rad_s, run.oracle);
    let results = (1..)
        .zip(&LINES)
        .map(|(number, line)| MethodRow {
            number: Some(number),
            id: line.0.into(),
            title: line.1.into(),
            estimand: Estimand::LeastSquares,
            excused: false,
            family: if number <= 11 { Family::Classical } else { Family::Learned },
            outcome: if line.0 == "symbolic" {
                MethodOutcome::Failed {
                    reason: "the budget of 200 generations ran out before any expression of two constants \
                             was left"
                        .into(),
                }
            } else {
                MethodOutcome::Estimate(estimate(line, oracle.zeta, omega))
            },
        })
        .collect();
    let stiffness = INERTIA * omega.powi(2);
    ComparisonResult {
        schema: run.schema,
        task: "compare".into(),
        seed: 7,
        seeds: 5,
        derived: Derived {
            period_s: run.envelope.period_s,
            frequency_hz: 1.0 / run.envelope.period_s,
            inertia_kg_m2: INERTIA,
            per_unit_of_inertia: false,
            stiffness_n_m_per_rad: stiffness,
            damping_n_m_s_per_rad: 2.0 * INERTIA * oracle.decay_rate,
            critical_damping_n_m_s_per_rad: 2.0 * (stiffness * INERTIA).sqrt(),
            quality_factor: 0.5 / oracle.zeta,
            cycles_to_one_over_e: 0.5 / oracle.zeta / std::f64::consts::PI,
            half_life_s: std::f64::consts::LN_2 / oracle.decay_rate,
            time_constant_s: 1.0 / oracle.decay_rate,
        },
        data: run.data,
        envelope: run.envelope,
        oracle,
        results,
        libraries: Vec::new(),
        max_error_percent: 0.046_366,
        tolerance_percent: 0.1,
        pass: false,
        seconds: 163.2,
        modes: Vec::new(),
        pipelines: run.pipelines,
        disagreement: None,
        truth: None,
        cautions: vec![
            Caution {
                statement: "Q = 1/(2ζ) ≈ 57 cycles to decay to 1/e".into(),
                finding: "The amplitude falls to 1/e in Q/π = 18.2 cycles. In Q = 57.1 cycles it falls to \
                          exp(−π) = 4.3 %."
                    .into(),
            },
            Caution {
                statement: "The agreement of all methods validates the damping ratio".into(),
                finding: "The methods differ by at most 4.6e-2 % because all of them solve the same small \
                          problem. Another pipeline or clock moves ζ by 2.9 %, and one standard error is \
                          2.3 %."
                    .into(),
            },
        ],
    }
}

/// Returns a comparison in which every method is within the tolerance.
pub(crate) fn passing() -> ComparisonResult {
    let mut result = result();
    let line = ("symbolic", "Symbolic regression", 6.1e-8, 3.2e-5, None, 5, 120, 2, 1.76);
    let found = estimate(&line, result.oracle.zeta, result.envelope.omega_rad_s);
    if let Some(row) = result.results.iter_mut().find(|row| row.id == "symbolic") {
        row.outcome = MethodOutcome::Estimate(found);
    }
    result.pass = true;
    result
}

/// Folder of a comparison, which tests change before they make its report.
pub(crate) struct Folder {
    pub(crate) run: Sample,
    pub(crate) result: ComparisonResult,
}

impl Folder {
    pub(crate) fn new() -> Self {
        let mut run = Sample::new();
        run.name = "compare-20250314T092653Z-a1b2c3".into();
        for row in &mut run.envelope {
            row.estimate = row.oracle;
        }
        Self { run, result: result() }
    }

    pub(crate) fn envelope(&mut self) -> &mut Vec<EnvelopeRow> {
        &mut self.run.envelope
    }

    pub(crate) fn render(&self) -> Result<String, ReportError> {
        render(&RunTexts {
            name: &self.run.name,
            config: &self.run.config,
            result: &serde_json::to_string_pretty(&self.result).unwrap(),
            trace: "",
            envelope: &table(&self.run.envelope),
            predictions: "",
            series: "",
            environment: &self.run.environment,
            reader: crate::Reader::CommandLine,
        })
    }
}

/// Writes the sample pages into the folder that `REPORT_SAMPLES` names, for visual inspection.
#[test]
// As its namesake for a single run: touches a disk only when called by name.
#[allow(clippy::disallowed_methods)]
#[ignore = "writes files; for looking at the page after a change of its template"]
fn write_samples() {
    let folder = std::path::PathBuf::from(std::env::var_os("REPORT_SAMPLES").unwrap());
    let mut sample = Folder::new();
    std::fs::write(folder.join("comparison.html"), sample.render().unwrap()).unwrap();
    std::fs::write(folder.join("comparison.md"), super::markdown(&sample.result)).unwrap();

    sample.result = passing();
    sample.result.data.origin = Origin::Simulated;
    std::fs::write(folder.join("comparison-pass.html"), sample.render().unwrap()).unwrap();

    // Extreme values that a page has to withstand.
    sample.run.name = "x".repeat(200);
    sample.result.data.origin = Origin::Unstated;
    for row in &mut sample.result.results {
        row.title = format!("{} of a name that goes on and on and on and on", row.title);
    }
    if let MethodOutcome::Estimate(found) = &mut sample.result.results[3].outcome {
        found.error_percent = f64::NAN;
        found.worst_error_percent = f64::INFINITY;
        found.pass = false;
        found.reached = Reached::Diverged;
    }
    sample.result.results[5].outcome = MethodOutcome::Failed { reason: "z".repeat(300).into() };
    sample.result.cautions[0].statement = "w".repeat(300);
    let html = sample.render().unwrap().replace("<details", "<details open");
    std::fs::write(folder.join("comparison-stress.html"), html).unwrap();
}
