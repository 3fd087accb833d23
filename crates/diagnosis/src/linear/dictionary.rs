//! Dictionary of the first-order changes of the observed values by every candidate, at a fit.

#![allow(
    clippy::indexing_slicing,
    reason = "entries, columns and coefficients are indices of this dictionary"
)]

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::linear::projection::Projection;
use crate::linear::second_mode::driven_modes;
use crate::linear::tangent::{Path, matrix, stack};
use crate::matrices::solve;
use crate::model::candidate::Candidate;
use crate::model::candidates::{Lines, Mode};
use crate::noise::periodogram::Line;
use crate::residual::spectrum::{decaying_lines, frequencies, lines};
use dynamics::{Coefficients, DynamicsError};
use nalgebra::{DMatrix, DVector};
use record::Quantity;
use std::ops::Range;

/// Candidate at one shape: columns whose coefficients are its linear parameters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) candidate: Candidate,
    /// Fit parameters at which the columns are computed.
    pub(crate) shape: Vec<f64>,
    pub(crate) columns: Range<usize>,
    /// `true` if the coefficients cannot be negative.
    positive: bool,
}

/// All entries at a fit, projected on the complement of what the fit can still move.
#[derive(Debug, Clone)]
pub(crate) struct Dictionary {
    pub(crate) entries: Vec<Entry>,
    /// Projected columns.
    pub(crate) columns: DMatrix<f64>,
    /// Products of the columns with one another.
    pub(crate) products: DMatrix<f64>,
    /// Products of the columns with the projected residual.
    pub(crate) scores: DVector<f64>,
    /// Candidates without columns, with parameters at which a fit begins and the approximate gain in squares.
    pub(crate) further: Vec<(Candidate, Vec<f64>, f64)>,
    /// Number of frequencies that the lines of the residual were chosen from.
    pub(crate) frequencies: f64,
}

/// Part of a column's norm that has to remain after the projection. If calibration and start states imitate a
/// column to this precision, the records cannot show it, and the remainder is the error of the linearization.
pub(crate) const INVISIBLE: f64 = 1e-4;

/// First-order gain of a set of entries.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gain {
    pub(crate) entries: Vec<usize>,
    /// Decrease of the squares.
    pub(crate) squares: f64,
    /// Coefficients of the entries' columns, in order.
    pub(crate) coefficients: Vec<f64>,
}

/// Residual of a fit, in the form that candidates search for lines.
struct Residual<'a> {
    data: &'a Data,
    residuals: &'a [&'a [f64]],
    paths: &'a [Path],
    projection: &'a Projection,
    /// Residual of all segments, projected on the complement of what the fit can still move.
    projected: &'a DMatrix<f64>,
}

impl Lines for Residual<'_> {
    fn steady(&self, most: usize) -> Vec<f64> {
        lines(self.data, self.residuals, most).into_iter().map(|line| line.frequency).collect()
    }

    fn decaying(&self, most: usize) -> Vec<Mode> {
        let lines = decaying_lines(self.data, self.residuals, most).into_iter();
        let mode = |(line, rate): (Line, f64)| Mode {
            frequency: line.frequency,
            rate,
            inertia: None,
            gain: line.gain,
        };
        lines.map(mode).collect()
    }

    fn driven(&self, most: usize) -> Vec<Mode> {
        driven_modes(self.data, self.paths, self.projection, self.projected, most)
    }

    fn longest_span(&self) -> f64 {
        self.data.longest_span()
    }
}

/// Computes the columns of a candidate at a shape, on one path.
fn columns(
    candidate: Candidate,
    shape: &[f64],
    path: &Path,
    data: &Data,
    nominal: &Coefficients<f64>,
) -> Vec<Vec<f64>> {
    let respond = |torque: &[f64]| path.response(torque, data.quantity);
    let command = data.inputs.get(path.record).and_then(Option::as_ref);
    candidate.columns(shape, &path.along(data.quantity, &data.facts, nominal, command, &respond))
}

impl Dictionary {
    /// Builds the dictionary of the given candidates at a fit, without those in the fit's hypothesis.
    pub(crate) fn at(data: &Data, fit: &Fit, candidates: &[Candidate]) -> Result<Self, DynamicsError> {
        let projection = Projection::at(data, fit)?;
        let paths = Path::of(data, fit)?;
        let others: Vec<Candidate> =
            candidates.iter().copied().filter(|c| !fit.hypothesis.candidates.contains(c)).collect();
        let system = fit.hypothesis.system(&data.facts, &fit.point.globals)?;
        Ok(Self::from_paths(data, fit, &paths, &projection, &system.nominal().coefficients(), &others))
    }

    fn from_paths(
        data: &Data,
        fit: &Fit,
        paths: &[Path],
        projection: &Projection,
        nominal: &Coefficients<f64>,
        candidates: &[Candidate],
    ) -> Self {
        let residuals: Vec<&[f64]> = fit.residuals.iter().map(|e| e.as_slice()).collect();
        let stacked: Vec<f64> = fit.stacked().collect();
        let mut residual = DMatrix::from_vec(stacked.len(), 1, stacked);
        projection.apply(&mut residual);
        let shown = Residual { data, residuals: &residuals, paths, projection, projected: &residual };
        let mut entries = Vec::new();
        let mut further = Vec::new();
        let mut all: Vec<Vec<f64>> = Vec::new();
        for &candidate in candidates {
            for shape in candidate.shapes_for(&data.facts, &shown) {
                let by_path: Vec<Vec<Vec<f64>>> =
                    paths.iter().map(|path| columns(candidate, &shape, path, data, nominal)).collect();
                let count = by_path.iter().map(Vec::len).fold(0, usize::max);
                let from = all.len();
                for column in 0..count {
                    all.push(by_path.iter().flat_map(|columns| &columns[column]).copied().collect());
                }
                let positive = candidate.is_non_negative();
                entries.push(Entry { candidate, shape, columns: from..from + count, positive });
            }
            let starts = candidate.starts(&data.facts, nominal.inertia, &shown).into_iter();
            further.extend(starts.map(|(parameters, gain)| (candidate, parameters, gain)));
        }
        let mut columns = matrix(projection.rows(), &all);
        let raw: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
        projection.apply(&mut columns);
        for (mut column, raw) in columns.column_iter_mut().zip(raw) {
            if column.norm() <= INVISIBLE * raw {
                column.fill(0.0);
            }
        }
        Self {
            products: columns.tr_mul(&columns),
            scores: columns.tr_mul(&residual).column(0).clone_owned(),
            columns,
            entries,
            further,
            frequencies: frequencies(data),
        }
    }

    /// Creates a dictionary of entries with given columns, one after the other, `counts` of each entry.
    /// `columns` and `residual` are projected, `raw` are the columns before that.
    pub(crate) fn of_columns(
        entries: Vec<(Candidate, Vec<f64>)>,
        counts: &[usize],
        raw: &DMatrix<f64>,
        mut columns: DMatrix<f64>,
        residual: &DMatrix<f64>,
    ) -> Self {
        for (mut column, raw) in columns.column_iter_mut().zip(raw.column_iter()) {
            if column.norm() <= INVISIBLE * raw.norm() {
                column.fill(0.0);
            }
        }
        let mut from = 0;
        let entry = |((candidate, shape), count): ((Candidate, Vec<f64>), &usize)| {
            let columns = from..from + count;
            from += count;
            Entry { positive: candidate.is_non_negative(), candidate, shape, columns }
        };
        Self {
            entries: entries.into_iter().zip(counts).map(entry).collect(),
            products: columns.tr_mul(&columns),
            scores: columns.tr_mul(residual).column(0).clone_owned(),
            columns,
            further: Vec::new(),
            frequencies: 1.0,
        }
    }

    /// Returns the candidate of a gain's first entry.
    pub(crate) fn candidate(&self, gain: &Gain) -> Option<Candidate> {
        gain.entries.first().and_then(|&index| self.entries.get(index)).map(|entry| entry.candidate)
    }

    /// Returns the number of frequencies that a gain is the best of: 1 for entries without a frequency.
    pub(crate) fn looked(&self, gain: &Gain) -> f64 {
        let mut entries = gain.entries.iter().filter_map(|&index| self.entries.get(index));
        let by_frequency = entries.any(|entry| entry.candidate.is_chosen_by_frequency());
        if by_frequency { self.frequencies } else { 1.0 }
    }

    /// Returns the joint gain of some entries, with non-negative sizes if their laws require it; `None` if an
    /// entry loses its size.
    pub(crate) fn gain(&self, entries: &[usize]) -> Option<Gain> {
        let chosen: Vec<&Entry> = entries.iter().filter_map(|index| self.entries.get(*index)).collect();
        let all: Vec<(usize, bool)> = chosen
            .iter()
            .flat_map(|entry| entry.columns.clone().map(|column| (column, entry.positive)))
            .collect();
        // A size that comes out negative is set to zero, and the others are solved for again.
        let visible = |at: &usize| all.get(*at).is_some_and(|own| self.products[(own.0, own.0)] > 0.0);
        let mut kept: Vec<usize> = (0..all.len()).filter(visible).collect();
        let solution = loop {
            let columns: Vec<usize> = kept.iter().filter_map(|&at| all.get(at).map(|own| own.0)).collect();
            if columns.is_empty() {
                return None;
            }
            let products = self.products.select_rows(&columns).select_columns(&columns);
            let scores = DMatrix::from_iterator(columns.len(), 1, columns.iter().map(|&c| self.scores[c]));
            let solution = solve(&products, &scores)?;
            let below = |(place, at): (usize, &usize)| {
                let positive = all.get(*at).is_some_and(|own| own.1);
                let value = solution[place];
                (positive && value < 0.0).then_some((place, value * products[(place, place)].sqrt()))
            };
            let worst = kept.iter().enumerate().filter_map(below).min_by(|a, b| a.1.total_cmp(&b.1));
            match worst {
                Some((place, _)) => _ = kept.remove(place),
                None => break solution,
            }
        };
        let mut coefficients = vec![0.0; all.len()];
        let mut squares = 0.0;
        for (at, value) in kept.iter().zip(solution.iter()) {
            if let (Some(slot), Some(own)) = (coefficients.get_mut(*at), all.get(*at)) {
                *slot = *value;
                squares += value * self.scores[own.0];
            }
        }
        let mut from = 0;
        for entry in chosen {
            let own = coefficients.get(from..from + entry.columns.len())?;
            from += own.len();
            // The last column is the one that makes the candidate differ from a simpler one.
            if own.last().is_none_or(|size| *size == 0.0) {
                return None;
            }
        }
        (squares.is_finite() && squares > 0.0).then(|| Gain {
            entries: entries.to_vec(),
            squares,
            coefficients,
        })
    }

    /// Returns the fit parameters that an entry's coefficients stand for.
    pub(crate) fn parameters(&self, entry: usize, coefficients: &[f64]) -> Vec<f64> {
        let entry = &self.entries[entry];
        entry.candidate.linear_parameters(&entry.shape, coefficients)
    }
}

/// State of the motion at a sample, on which a torque or a sensor error without a name may depend.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) time: f64,
    /// Torque of the input; 0 without an input.
    pub(crate) input: f64,
}

/// Function of the motion.
pub(crate) type Smooth = Box<dyn Fn(Moment) -> f64 + Sync>;

/// Place at which functions of the motion act: as torques, or added to the sensor's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Acting {
    Torque,
    Sensor,
}

/// Returns the change of the observed values by functions of the motion, not projected; used for effects
/// without a name.
pub(crate) fn columns_of(
    paths: &[Path],
    quantity: Quantity,
    functions: &[Smooth],
    acting: Acting,
) -> Vec<Vec<f64>> {
    functions
        .iter()
        .map(|function| {
            stack(paths, |path| {
                let motion = path.motion.position.iter().zip(&path.motion.velocity);
                let along: Vec<f64> = motion
                    .zip(path.times.iter().zip(&path.input))
                    .map(|((&position, &velocity), (&time, &input))| {
                        function(Moment { position, velocity, time, input })
                    })
                    .collect();
                match acting {
                    Acting::Torque => path.response(&along, quantity),
                    Acting::Sensor => along,
                }
            })
        })
        .collect()
}
