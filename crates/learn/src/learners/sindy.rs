//! Sparse identification of the dynamics from states (SINDy).
//!
//! Velocity and acceleration are estimated by local polynomials. The acceleration is regressed on a library
//! of terms with sequential thresholding. An ensemble of resampled regressions gives the inclusion share of
//! each term. Finally the weights are refitted to trajectories, which removes the bias caused by noise in the
//! regressors.
//!
//! Brunton, Proctor, Kutz, PNAS 113 (2016) 3932; Fasel, Kutz, Brunton, Brunton, Proceedings of the Royal
//! Society A 478 (2022) 20210904 (ensembles).

use super::library::{Finishing, Regression, Term, finish, inclusion, restore, thresholded};
use crate::data::{DataSet, local_states};
use crate::expression::{Expression, Variable};
use crate::linear::least_squares;
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner, Place};
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use settings::{Default, Field, Kind as Value, Origin, Resolved, SettingsError};

/// Identifier.
const ID: &str = "sindy";

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Sparse identification (SINDy)",
    summary: "Finds the terms of the torque in a library by thresholded regression of accelerations, then refits their \
              weights to trajectories.",
    reference: "Brunton, Proctor, Kutz, PNAS 113 (2016) 3932-3937",
    kind: Kind::Regressor,
    fields: FIELDS,
    build: |resolved| {
        Ok(Box::new(Sindy { settings: SparseSettings::read(resolved, ID)? }) as Box<dyn Learner>)
    },
    restore: |stored| restore(ID, stored),
};

/// Settings shared by the sparse learners. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SparseSettings {
    /// Names of the candidate terms.
    pub library: Vec<String>,
    /// Further candidate terms, as expressions.
    pub terms: Vec<String>,
    /// Contribution to the acceleration, relative to the whole, below which a term is left out.
    pub threshold: f64,
    /// Number of members of the ensemble; 0 for none.
    pub members: usize,
    /// `true` if weights are refitted to trajectories.
    pub refit: bool,
    /// Largest number of training samples used by a refit.
    pub refit_samples: usize,
    /// Largest number of steps of a refit.
    pub max_steps: u64,
}

/// Keys shared by the sparse learners.
pub(crate) const FIELDS: &[Field] = &[
    Field::new(
        "library",
        Value::Texts { at_least: 1, at_most: 10 },
        Default::Texts(&[
            "1",
            "theta",
            "theta_dot",
            "theta^2",
            "theta^3",
            "sign(theta_dot)",
            "theta_dot*|theta_dot|",
            "sin(theta)",
            "u",
        ]),
    )
    .meaning(
        "Candidate terms of the acceleration; besides those of the default there is \
                \"cos(theta)\". \"u\" is left out where records have no input.",
    ),
    Field::new("terms", Value::Texts { at_least: 0, at_most: 100 }, Default::Texts(&[])).meaning(
        "Further candidates, as expressions of theta, theta_dot and u: \"sin(2*theta)\", \
                \"theta*|theta_dot|\".",
    ),
    Field::new("threshold", Value::Float { min: 0.0, max: 1.0 }, Default::Float(0.002))
        .unit("share of the acceleration")
        .meaning("Least contribution of a term; terms below it are removed repeatedly.")
        .source("small, since the refit tells true terms from others by their errors"),
    Field::new("members", Value::Integer { min: 0, max: 10_000 }, Default::Integer(50))
        .meaning("Number of resampled regressions for the inclusion probabilities; 0 for none.")
        .source("Fasel et al. 2022"),
    Field::new("refit", Value::Boolean, Default::Boolean(true))
        .meaning("Whether weights are refitted to whole trajectories and superfluous terms taken out."),
    Field::new("refit_samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(20_000))
        .unit("samples")
        .meaning("Most training samples of a refit; if there are more, evenly spaced pieces are used."),
    Field::new("max_steps", Value::Integer { min: 1, max: 1_000_000 }, Default::Integer(40))
        .unit("steps")
        .meaning("Most steps of each refit."),
];

impl SparseSettings {
    /// Reads the settings from a learner's section.
    ///
    /// # Errors
    /// [`SettingsError::UnknownName`] for an unknown term.
    pub(crate) fn read(resolved: &Resolved, section: &str) -> Result<Self, SettingsError> {
        Self::checked(resolved, section, resolved.section(section)?)
    }

    /// Reads the settings as [`Self::read`] does, for a law whose terms are stated rather than searched.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(crate) fn of_terms(
        resolved: &Resolved,
        section: &str,
        library: Vec<String>,
    ) -> Result<Self, SettingsError> {
        let terms = Vec::new();
        let settings =
            Self { library, terms, threshold: 0.0, members: 0, refit: true, refit_samples: 0, max_steps: 0 };
        Self::checked(resolved, section, settings)
    }

    fn checked(resolved: &Resolved, section: &str, settings: Self) -> Result<Self, SettingsError> {
        let is_known = |name: &String| Term::ALL.iter().any(|term| term.name() == name.as_str());
        for text in &settings.terms {
            if let Err(problem) = text.parse::<Expression>() {
                let key = format!("{section}.terms");
                let own = resolved.settings().iter().find(|setting| setting.key() == key);
                return Err(SettingsError::BadValue {
                    origin: own.map_or(Origin::Default, |setting| setting.origin.clone()),
                    key,
                    found: text.clone(),
                    expected: format!("expressions; {problem}"),
                    unit: String::new(),
                });
            }
        }
        if let Some(unknown) = settings.library.iter().find(|name| !is_known(name)) {
            let key = format!("{section}.library");
            let own = resolved.settings().iter().find(|setting| setting.key() == key);
            let origin = own.map_or(Origin::Default, |setting| setting.origin.clone());
            let known = Term::ALL.iter().map(|term| term.name().into_owned()).collect();
            return Err(SettingsError::unknown_name(origin, "library term", unknown, known));
        }
        Ok(settings)
    }

    /// Returns the terms that apply to the data: no input term without an input, no sine or cosine of a
    /// displacement, and no sine if the swings are so small that a spring and its cubic term give the same
    /// law.
    pub(crate) fn terms(&self, data: &DataSet) -> Vec<Term> {
        let has = |term: &Term| self.library.iter().any(|name| *name == term.name());
        let same = has(&Term::Position) && has(&Term::Cube) && sine_is_cubic(data);
        let applies = |term: &Term| match term {
            Term::Input => data.is_driven(),
            Term::Sine => data.unit == "rad" && !same,
            Term::Cosine => data.unit == "rad",
            Term::Own(expression) => data.is_driven() || !expression.reads(Variable::Input),
            _ => true,
        };
        let own = self.terms.iter().filter_map(|text| text.parse().ok()).map(Term::Own);
        Term::ALL.into_iter().filter(has).chain(own).filter(applies).collect()
    }

    pub(crate) fn finishing(&self) -> Finishing {
        Finishing { refit: self.refit, samples: self.refit_samples, most_steps: self.max_steps }
    }

    /// Fits a model, starting from a regression.
    pub(crate) fn learn(
        &self,
        learner: &'static str,
        regression: &Regression,
        data: &DataSet,
        context: &Context<'_>,
    ) -> Result<Fitted, LearnError> {
        let weights = thresholded(regression, self.threshold);
        let inclusion = if self.members > 0 {
            inclusion(regression, self.threshold, self.members, &context.seed)
        } else {
            Vec::new()
        };
        finish(learner, data, context, &self.finishing(), (&regression.terms, &weights, &inclusion))
    }
}

/// Relative residual of a sine after θ and θ³ are fitted to it, below which the sine is no separate term.
const SAME: f64 = 2e-4;

/// Returns `true` if sin θ is a sum of θ and θ³ at the training positions.
fn sine_is_cubic(data: &DataSet) -> bool {
    let stride = (data.training_samples() / 1000).max(1);
    let positions: Vec<f64> =
        data.train.iter().flat_map(|part| part.values().iter().copied()).step_by(stride).collect();
    let rows: Vec<f64> = positions.iter().flat_map(|x| [*x, x * x * x]).collect();
    let rows = DMatrix::from_row_slice(positions.len(), 2, &rows);
    let sines = DVector::from_iterator(positions.len(), positions.iter().map(|x| x.sin()));
    let Some(weights) = least_squares(&rows, &sines) else { return true };
    (&rows * weights - &sines).norm() < SAME * sines.norm()
}

/// The learner.
#[derive(Debug, Clone, PartialEq)]
pub struct Sindy {
    /// Settings.
    pub settings: SparseSettings,
}

impl Learner for Sindy {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let regression = regression(data, self.settings.terms(data));
        self.settings.learn(ID, &regression, data, context)
    }
}

/// Half-width of the local polynomials, in periods: wide enough to average noise, narrow enough for degree 4.
const HALF_WIDTH: f64 = 1.0 / 8.0;

/// Largest number of rows of a regression.
const MOST_ROWS: usize = 20_000;

/// Builds the regression of local accelerations on terms. Groups are half periods.
fn regression(data: &DataSet, terms: Vec<Term>) -> Regression {
    let stride = (data.training_samples() / MOST_ROWS).max(1);
    let (mut rows, mut right, mut groups, mut group) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for part in &data.train {
        let mut begun = f64::NEG_INFINITY;
        for state in local_states(part, HALF_WIDTH * data.period_s).into_iter().step_by(stride) {
            if state.time_s - begun > 0.5 * data.period_s {
                begun = state.time_s;
                group += 1;
            }
            let place = Place {
                position: state.position,
                velocity: state.velocity,
                direction: state.velocity.signum(),
                input: state.input,
            };
            rows.extend(terms.iter().map(|term| term.value(&place)));
            right.push(state.acceleration);
            groups.push(group);
        }
    }
    Regression {
        rows: DMatrix::from_row_slice(right.len(), terms.len(), &rows),
        right: DVector::from_vec(right),
        terms,
        groups,
    }
}
