//! A made-up run for the tests.

use results::{
    DataSummary, EnvelopeRow, EnvelopeSummary, EstimateSummary, EstimationResult, OracleSummary, Origin,
    PipelineOutcome, PipelineRow, RESULT_SCHEMA, Reached, Resonance, SeedRow, TraceRow, WithInterval,
};
use serde::Serialize;

use crate::{ReportError, RunTexts, render_run};

const OMEGA: f64 = 21.8166;
const DECAY_RATE: f64 = 0.190_961;

/// A run folder, which tests change before they make its report.
pub(crate) struct Sample {
    pub(crate) name: String,
    pub(crate) config: String,
    pub(crate) environment: String,
    pub(crate) result: EstimationResult,
    pub(crate) trace: Vec<TraceRow>,
    pub(crate) envelope: Vec<EnvelopeRow>,
    /// Texts that replace the ones written from the values above.
    pub(crate) result_text: Option<String>,
    pub(crate) trace_text: Option<String>,
    pub(crate) envelope_text: Option<String>,
}

impl Sample {
    pub(crate) fn new() -> Self {
        Self {
            name: "2025-03-14T09-26-53-pinn-pendulum-seed-7".into(),
            config: "# estimator and record\n[estimator]\nkind = \"pinn\"\nhidden = [32, 32]\n\
                     physics_weights = [1.0, 100.0]\n\n[record]\npath = \"data/pendulum.csv\"\n\
                     clock = \"uniform-index\"\n"
                .into(),
            environment: "{\n  \"version\": \"0.1.0\",\n  \"target\": \"x86_64-unknown-linux-gnu\",\
                          \n  \"threads\": 16\n}\n"
                .into(),
            result: result(),
            trace: trace(),
            envelope: envelope(),
            result_text: None,
            trace_text: None,
            envelope_text: None,
        }
    }

    pub(crate) fn json(&self) -> String {
        serde_json::to_string_pretty(&self.result).unwrap()
    }

    pub(crate) fn render(&self) -> Result<String, ReportError> {
        let or = |text: &Option<String>, written: String| text.clone().unwrap_or(written);
        render_run(&RunTexts {
            name: &self.name,
            config: &self.config,
            result: &or(&self.result_text, self.json()),
            trace: &or(&self.trace_text, table(&self.trace)),
            envelope: &or(&self.envelope_text, table(&self.envelope)),
            predictions: "",
            series: "",
            environment: &self.environment,
            reader: crate::Reader::CommandLine,
        })
    }
}

pub(crate) fn table<Row: Serialize>(rows: &[Row]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).unwrap();
    }
    String::from_utf8(writer.into_inner().unwrap()).unwrap()
}

/// Pseudo-random numbers, uniform on −1 to 1 and the same in every run.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(self.0 >> 33).unwrap()) / f64::from(u32::MAX >> 2) - 1.0
    }
}

fn envelope() -> Vec<EnvelopeRow> {
    let mut noise = Noise(7);
    let mut residual = 0.0;
    (0..69)
        .map(|index| {
            let time_s = f64::from(index) * 0.288;
            residual = 0.8 * residual + 0.16 * noise.next();
            let bend = 0.0045 * (time_s - 9.8).powi(2) - 0.15;
            let oracle = -0.52 - DECAY_RATE * time_s;
            EnvelopeRow {
                time_s,
                log_amplitude: oracle + bend + residual,
                oracle,
                estimate: oracle + 2e-10 * (time_s * 0.7).sin(),
            }
        })
        .collect()
}

fn trace() -> Vec<TraceRow> {
    let mut noise = Noise(11);
    let mut rows = Vec::new();
    let mut distance: f64 = -0.8;
    for (phase, steps, floor, rate) in [
        ("data only", 400, -2e-2, 0.985),
        ("physics weight 1", 600, 4e-4, 0.988),
        ("physics weight 100", 1_000, -6e-6, 0.990),
        ("L-BFGS", 60, -3.1e-9, 0.72),
    ] {
        for _ in 0..steps {
            let step = u64::try_from(rows.len()).unwrap();
            distance = floor + (distance - floor) * rate;
            let wobble: f64 = 1.0 + 0.25 * noise.next();
            rows.push(TraceRow {
                step,
                phase: phase.into(),
                loss: (0.04 + 30.0 * distance.powi(2))
                    * if phase.ends_with("100") { 0.6 } else { 1.0 }
                    * (1.0 + 0.02 * wobble),
                decay_rate: DECAY_RATE * (1.0 + distance * wobble),
            });
        }
    }
    rows
}

fn result() -> EstimationResult {
    EstimationResult {
        schema: RESULT_SCHEMA.into(),
        task: "estimate".into(),
        estimator: "pinn".into(),
        estimator_title: "Physics-informed neural network".into(),
        seed: 7,
        data: DataSummary {
            path: "data/pendulum/run-03/free-decay-from-30-degrees.csv".into(),
            digest: "sha256:9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".into(),
            origin: Origin::Measured,
            samples: 2_481,
            clock: "uniform-index".into(),
            clock_reason: "the time stamps jump by up to 41 ms, the sensor's own rate is steady".into(),
            believed_clock: "uniform-index".into(),
            believed_clock_reason: "the time stamps jump by up to 41 ms, the sensor's own rate is steady"
                .into(),
            sample_period_s: 1.0 / 119.998_2,
            sample_rate_hz: 119.998_2,
            sample_rate_std_error_hz: 0.000_41,
            resolution: Some(1.533_980_8e-3),
            unit: "rad".into(),
            findings: vec![
                "17 time stamps are equal to the one before".into(),
                "the angle moves in steps of 1.534 mrad: a 12-bit encoder".into(),
                "the last 3.2 s lie within two steps of the rest position".into(),
            ],
            reading: Default::default(),
        },
        envelope: EnvelopeSummary {
            pipeline: "paper".into(),
            pipeline_because: None,
            peaks: 69,
            samples: 24_810,
            period_s: 0.288_000_0,
            omega_rad_s: OMEGA,
            offset: -0.012_34,
            first_peak_s: 0.1417,
        },
        oracle: OracleSummary {
            decay_rate: DECAY_RATE,
            log_amplitude: -0.520_013,
            r_squared: 0.9645,
            zeta: 0.008_753,
            std_error: 0.004_478,
            scatter_factor: 1.0,
            interval_95: [0.182_023, 0.199_899],
            zeta_std_error: 0.000_205_3,
            zeta_interval_95: [0.008_343, 0.009_163],
            condition: 2.618,
            promised_digits: 14.9,
            residual_autocorrelation: 0.871,
        },
        estimate: EstimateSummary {
            decay_rate: DECAY_RATE * (1.0 + 3.1e-9),
            log_amplitude: -0.520_013,
            zeta: 0.008_753 * (1.0 + 3.1e-9),
            std_error: Some(0.004_478),
            interval_95: Some([0.182_023, 0.199_899]),
            zeta_std_error: Some(0.000_205_3),
            zeta_interval_95: Some([0.008_343, 0.009_163]),
            resonance: Resonance::of_swing(OMEGA, WithInterval::normal(0.008_753, 0.000_205_3)),
            reached: Reached::Converged,
            stopped_because: "the relative change of the loss stayed below 1e-12 for 20 steps".into(),
        },
        error_percent: 3.1e-7,
        tolerance_percent: 0.1,
        pass: true,
        seconds: 12.34,
        steps: 2_060,
        parameters: 1_186,
        seeds: [(7, 3.1e-7), (8, 1.2e-7), (9, 4.4e-7), (10, 2.7e-5), (11, 8.9e-8)]
            .into_iter()
            .map(|(seed, error_percent)| SeedRow {
                seed,
                decay_rate: DECAY_RATE * (1.0 + error_percent / 100.0),
                zeta: 0.008_753 * (1.0 + error_percent / 100.0),
                error_percent,
                reached: if seed == 10 { Reached::BudgetSpent } else { Reached::Converged },
                steps: 2_060,
                seconds: 12.34,
            })
            .collect(),
        worst_error_percent: 2.7e-5,
        disagreement: None,
        truth: None,
        modes: Vec::new(),
        pipelines: vec![
            pipeline("paper", "uniform-index", true, 69, 0.008_753, 0.9645),
            pipeline("paper", "host", false, 68, 0.008_811, 0.9581),
            pipeline("recommended", "uniform-index", false, 71, 0.008_502, 0.9712),
            PipelineRow {
                pipeline: "recommended".into(),
                clock: "host".into(),
                in_force: false,
                outcome: PipelineOutcome::Failed { reason: "the time stamps are not increasing".into() },
            },
        ],
    }
}

fn pipeline(
    pipeline: &str,
    clock: &str,
    in_force: bool,
    peaks: usize,
    zeta: f64,
    r_squared: f64,
) -> PipelineRow {
    PipelineRow {
        pipeline: pipeline.into(),
        clock: clock.into(),
        in_force,
        outcome: PipelineOutcome::Fit {
            peaks,
            omega_rad_s: OMEGA,
            decay_rate: zeta * OMEGA,
            zeta,
            zeta_std_error: 0.000_205_3,
            r_squared,
        },
    }
}

/// Writes the sample pages into the folder that `REPORT_SAMPLES` names, for visual inspection.
#[test]
// The only place of the crate that touches a disk, and only when called by name.
#[allow(clippy::disallowed_methods)]
#[ignore = "writes files; for looking at the page after a change of its template"]
fn write_samples() {
    let folder = std::path::PathBuf::from(std::env::var_os("REPORT_SAMPLES").unwrap());
    let mut sample = Sample::new();
    std::fs::write(folder.join("measured.html"), sample.render().unwrap()).unwrap();

    let result = &mut sample.result;
    result.data.origin = Origin::Simulated;
    result.data.findings.clear();
    result.estimate.reached = Reached::Interrupted;
    result.estimate.stopped_because = "the user asked for it".into();
    result.oracle.residual_autocorrelation = 0.02;
    result.seeds.truncate(1);
    std::fs::write(folder.join("simulated.html"), sample.render().unwrap()).unwrap();

    let result = &mut sample.result;
    result.data.origin = Origin::Unstated;
    result.estimate.reached = Reached::Converged;
    result.error_percent = 2.37;
    result.pass = false;
    sample.trace.clear();
    std::fs::write(folder.join("unstated.html"), sample.render().unwrap()).unwrap();

    // Extreme values that a page has to withstand.
    let mut sample = Sample::new();
    sample.name = "x".repeat(200);
    sample.result.estimator_title = "An estimator with a title that goes on and on and on".into();
    sample.result.data.path = "y/".repeat(200);
    sample.result.estimate.reached = Reached::Diverged;
    sample.result.data.findings = vec!["z".repeat(300)];
    sample.result.estimate.decay_rate = 1.234_567e-9;
    sample.result.estimate.std_error = Some(3.2e-12);
    sample.result.error_percent = 123_456.7;
    sample.trace = (0..60_000_u32)
        .map(|step| TraceRow {
            step: step.into(),
            phase: format!("phase {} of a schedule with long names", step / 5_000),
            loss: if step % 9_000 < 500 { f64::NAN } else { 1e-14 * f64::from(60_100 - step).powi(3) },
            decay_rate: DECAY_RATE + 1e-9 * f64::from(step % 977),
        })
        .collect();
    let html = sample.render().unwrap().replace("<details", "<details open");
    std::fs::write(folder.join("stress.html"), html).unwrap();
}
