//! Stored form of a diagnosis, for files and scripts.

use crate::actuator;
use crate::read::Given;
use diagnosis::{
    Calibrated, Diagnosis, EffectClass, KnownRow, ParameterEstimate, Series, Status, Swing, backbone, surface,
};
use dynamics::{Effect, Quantity, Units};
use experiment::Servo;
use export::{Repaired, equation_latex, equation_text};
use results::{
    Backbone, BackbonePoint, CalibratedRow, Calibration, ChainFinding, ChainSummary, ClassRow,
    DIAGNOSIS_SCHEMA, DiagnosisResult, DiagnosisVerdict, EffectRow, Equation, KindRow, KnownEffectRow,
    NextExperiment, ParameterRow, RivalRow, SeriesRow, SurfaceCell,
};

/// Records, nominal simulator and repaired simulator that belong to a diagnosis.
pub(crate) struct Beside<'a> {
    pub(crate) given: &'a [Given],
    /// File of the nominal simulator.
    pub(crate) nominal: &'a str,
    pub(crate) nominal_digest: &'a str,
    pub(crate) seed: u64,
    pub(crate) seconds: f64,
    pub(crate) repaired: &'a Repaired,
    /// Inner loop of a joint.
    pub(crate) actuator: Option<&'a Servo>,
}

/// Builds the content of `diagnosis.json`.
pub(crate) fn result(found: &Diagnosis, beside: &Beside<'_>) -> DiagnosisResult {
    let first = beside.given.first();
    let quantity = first.map_or(record::Quantity::Position, |given| given.quantity);
    let units = beside.repaired.units;
    let mut result = DiagnosisResult {
        schema: DIAGNOSIS_SCHEMA.to_owned(),
        verdict: verdict(found),
        effects: effects(found),
        gap: found.gap.clone(),
        place: found.place.clone(),
        // Without a record there is no reason for a clock.
        measuring_chain: chain(found, first.map_or("", |given| &given.row.clock_reason)),
        calibration: calibration(found, units),
        next_experiment: next_experiment(found),
        seconds: beside.seconds,
        stages: found.stages.clone(),
        modes: beside
            .given
            .iter()
            .map(|given| &given.modes)
            .find(|modes| !modes.is_empty())
            .into_iter()
            .flatten()
            .cloned()
            .collect(),
        actuator: None,
        records: beside.given.iter().map(|given| given.row.clone()).collect(),
        nominal: beside.nominal.to_owned(),
        nominal_digest: beside.nominal_digest.to_owned(),
        seed: beside.seed,
        quantity: quantity.name().to_owned(),
        samples_used: found.samples_used,
        rivals: rivals(found),
        detectability: found.detectability.clone(),
        classes: found.classes.iter().map(class_row).collect(),
        left_over: Some(found.left_over),
        sets: found.sets.clone(),
        rejected: found.rejected.iter().map(|set| owned(set)).collect(),
        equation: Equation { text: equation_text(beside.repaired), latex: equation_latex(beside.repaired) },
        units: [Quantity::Position, Quantity::Velocity, Quantity::Torque]
            .map(|quantity| quantity.unit(units).to_owned()),
        backbone: if beside.repaired.driven() { Backbone::default() } else { backbones(&found.series) },
        surface: surface_cells(found, quantity),
    };
    if let Some(servo) = beside.actuator {
        actuator::add(&mut result, servo, beside.repaired.system.nominal().input_gain());
    }
    result.verdict.summary = report::verdict_sentence(&result);
    result
}

/// Builds the verdict; its sentence is added later, since it follows from the whole result.
fn verdict(found: &Diagnosis) -> DiagnosisVerdict {
    let own = &found.verdict;
    DiagnosisVerdict {
        status: own.status,
        effects: owned(&own.effects),
        confidence: own.confidence,
        left_over: Some(own.left_over),
        equivalent: own.equivalent.iter().map(|class| owned(class)).collect(),
        summary: String::new(),
    }
}

fn chain(found: &Diagnosis, clock_reason: &str) -> ChainSummary {
    let chain = &found.measuring_chain;
    let findings = chain.findings.iter().map(|finding| ChainFinding {
        effect: finding.effect.map(str::to_owned),
        text: finding.text.clone(),
    });
    ChainSummary {
        clock: chain.clock.to_owned(),
        clock_reason: clock_reason.to_owned(),
        sample_rate_hz: chain.sample_rate_hz,
        resolution: chain.resolution,
        noise: chain.noise,
        findings: findings.collect(),
    }
}

fn rivals(found: &Diagnosis) -> Vec<RivalRow> {
    let row = |row: &diagnosis::Rivalry| RivalRow {
        effect: row.effect.to_owned(),
        rival: row.rival.to_owned(),
        distance: row.distance,
    };
    found.rivals.iter().map(row).collect()
}

fn owned(ids: &[&'static str]) -> Vec<String> {
    ids.iter().map(|id| (*id).to_owned()).collect()
}

/// Converts a class of effects into its stored row.
fn class_row(class: &EffectClass) -> ClassRow {
    ClassRow {
        id: class.id.to_owned(),
        probability: class.probability,
        gap_share: class.gap_share,
        kinds: class.kinds.iter().map(|kind| KindRow { id: kind.id.to_owned(), share: kind.share }).collect(),
        kind_is_told: class.kind_is_told,
        error_without: class.error_without,
        error_with: class.error_with,
        stability: class.stability,
        evidence: class.evidence,
    }
}

/// Returns the name of an id in words.
#[must_use]
pub fn title(id: &str) -> String {
    match Status::of_row(id) {
        Some(Status::None) => "nothing is missing",
        Some(Status::Calibration) => "only the coefficients were off",
        Some(Status::Unknown) => "something that no known effect explains",
        Some(Status::Effect) | None => Effect::find(id).map_or(id, |effect| effect.description().title),
    }
    .to_owned()
}

/// Returns the title of an effect's row. Beside named effects, the rows of the other statuses are about what the named
/// ones leave.
fn row_title(effect: &diagnosis::EffectProbability, verdict: Status) -> String {
    match (Status::of_row(effect.id), effect.gap_share, verdict) {
        (Some(Status::Unknown), Some(_), _) => {
            "something that no known effect explains: a position-dependent torque"
        }
        (Some(Status::Unknown), None, Status::Effect) => {
            "beside the named effects, something that no known effect explains"
        }
        (Some(Status::None), _, Status::Effect) => "nothing is missing in the motion",
        (Some(Status::Calibration), _, Status::Effect) => "in the motion, only the coefficients were off",
        _ => return title(effect.id),
    }
    .to_owned()
}

fn effects(found: &Diagnosis) -> Vec<EffectRow> {
    let row = |effect: &diagnosis::EffectProbability| EffectRow {
        id: effect.id.to_owned(),
        title: row_title(effect, found.verdict.status),
        probability: effect.probability,
        parameters: effect
            .parameters
            .iter()
            .map(|parameter| {
                let row = ParameterRow {
                    value: parameter.estimate.value,
                    unit: parameter.unit.clone(),
                    interval_95: parameter.estimate.interval_95,
                    determined: parameter.determined,
                };
                (parameter.name.to_owned(), row)
            })
            .collect(),
        gap_share: effect.gap_share,
    };
    found.effects.iter().map(row).collect()
}

fn calibration(found: &Diagnosis, units: Units) -> Calibration {
    let row = |name: &str, quantity: Quantity| {
        let own: Option<&Calibrated> = found.calibration.iter().find(|row| row.name == name);
        CalibratedRow {
            nominal: own.map_or(f64::NAN, |row| row.nominal),
            unit: quantity.unit(units).to_owned(),
            recalibrated: own.and_then(|row| row.recalibrated),
            repaired: own.and_then(|row| row.repaired),
            determined: own.and_then(|row| row.determined),
        }
    };
    Calibration {
        inertia: row("inertia", Quantity::Inertia),
        damping: row("damping", Quantity::Damping),
        stiffness: row("stiffness", Quantity::Stiffness),
        rest_angle: row("rest_angle", Quantity::Position),
        effects: found.known.iter().map(|known| known_effect(known, units)).collect(),
    }
}

fn known_effect(known: &KnownRow, units: Units) -> KnownEffectRow {
    let stated = known
        .nominal
        .into_iter()
        .flat_map(|active| active.effect().description().parameters.iter().zip(active.values().to_vec()));
    let parameters = stated.map(|(parameter, nominal)| {
        let of = |rows: &[ParameterEstimate]| rows.iter().find(|own| own.name == parameter.name).cloned();
        let repaired = of(&known.repaired);
        let row = CalibratedRow {
            nominal,
            unit: repaired
                .as_ref()
                .map_or_else(|| parameter.quantity.unit(units).to_owned(), |own| own.unit.clone()),
            recalibrated: of(&known.recalibrated).map(|own| own.estimate),
            repaired: repaired.as_ref().map(|own| own.estimate),
            determined: repaired.map(|own| own.determined),
        };
        (parameter.name.to_owned(), row)
    });
    KnownEffectRow {
        id: known.id.to_owned(),
        recalibrate: known.recalibrate,
        parameters: parameters.collect(),
    }
}

fn next_experiment(found: &Diagnosis) -> NextExperiment {
    let finite = |distance: f64| Some(distance).filter(|distance| distance.is_finite());
    match &found.next_experiment {
        Some(experiment) => NextExperiment {
            text: experiment.text.clone(),
            separates: owned(&experiment.separates),
            distance: finite(experiment.distance),
            considered: experiment.considered.iter().map(|(text, d)| (text.clone(), finite(*d))).collect(),
        },
        None => NextExperiment {
            text: no_experiment(found).to_owned(),
            separates: Vec::new(),
            distance: None,
            considered: Vec::new(),
        },
    }
}

/// Explains why no experiment is proposed.
fn no_experiment(found: &Diagnosis) -> &'static str {
    match found.verdict.status {
        Status::None | Status::Calibration => {
            "none is needed: no effect was named, so there is nothing to confirm."
        }
        Status::Effect => "none is needed: no other effect explains these records as well as what was named.",
        Status::Unknown => {
            "These data suggest none, because no known effect explains what is missing. A second release \
             from another amplitude shows whether it depends on amplitude or on time."
        }
    }
}

fn backbones(series: &Series) -> Backbone {
    let predicted = |residuals: &[f64]| -> Vec<f64> {
        series.observed.iter().zip(residuals).map(|(observed, residual)| observed - residual).collect()
    };
    let points = |values: &[f64]| -> Vec<BackbonePoint> {
        let point = |swing: Swing| BackbonePoint {
            amplitude: swing.amplitude,
            frequency: swing.frequency,
            decay_rate: Some(swing.decay_rate).filter(|rate| rate.is_finite()),
        };
        backbone(series, values).into_iter().map(point).collect()
    };
    Backbone {
        measured: points(&series.observed),
        nominal: points(&predicted(&series.nominal_residual)),
        repaired: points(&predicted(&series.repaired_residual)),
    }
}

/// Computes the restoring force that the recalibrated law lacks, by cells of the phase plane. A coefficient
/// that the data do not determine keeps its nominal value.
fn surface_cells(found: &Diagnosis, quantity: record::Quantity) -> Vec<SurfaceCell> {
    let value = |name: &str| {
        let row = found.calibration.iter().find(|row| row.name == name)?;
        Some(row.recalibrated.map_or(row.nominal, |interval| interval.value))
    };
    let recalibrated = || {
        Some(dynamics::Coefficients {
            inertia: value("inertia")?,
            damping: value("damping")?,
            stiffness: value("stiffness")?,
            rest_angle: value("rest_angle")?,
            input_gain: 1.0,
        })
    };
    // If a coefficient of the law is missing, the missing force cannot be computed.
    let Some(coefficients) = recalibrated() else { return Vec::new() };
    surface(&found.series, quantity, &coefficients)
        .into_iter()
        .map(|cell| SurfaceCell {
            bounds: cell.bounds,
            measured: cell.measured,
            missing: cell.missing,
            samples: cell.samples,
        })
        .collect()
}

/// Returns the rows of `series.csv`.
#[must_use]
pub fn series_rows(series: &Series) -> Vec<SeriesRow> {
    let mut rows = Vec::with_capacity(series.time_s.len());
    let mut segment = 0;
    let driven = series.input_torque.iter().any(|torque| *torque != 0.0);
    for (index, (&time_s, &observed)) in series.time_s.iter().zip(&series.observed).enumerate() {
        while series.segment_starts.get(segment).is_some_and(|start| *start <= index) {
            segment += 1;
        }
        let less = |residuals: &[f64]| residuals.get(index).map_or(f64::NAN, |residual| observed - residual);
        let record = segment.checked_sub(1).and_then(|segment| series.segment_records.get(segment));
        rows.push(SeriesRow {
            record: record.map_or(1, |record| record + 1),
            segment,
            time_s,
            observed,
            nominal: less(&series.nominal_residual),
            recalibrated: less(&series.recalibrated_residual),
            repaired: less(&series.repaired_residual),
            input_torque: series.input_torque.get(index).copied().filter(|_| driven),
        });
    }
    rows
}
