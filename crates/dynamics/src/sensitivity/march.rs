//! Integration from step to step by Taylor series.

#![allow(clippy::indexing_slicing, reason = "`prepare_response` makes a row for every sample")]

use super::columns::Coupling;
use super::expansion::expand;
use super::free::Place;
use super::graph::{INPUT, INPUT_RATE, MOST_STATES, STATE, TIME};
use super::model::Model;
use super::response::{FullState, Response};
use super::series::{LENGTH, Series, head, slope, value};
use crate::error::DynamicsError;
use crate::field::{Mode, SYSTEM_HIDDEN, State};
use crate::input::{Cubic, Input};
use crate::system::{Drive, Start};
use std::ops::Range;

/// Maximum number of steps in a row without a change of time; beyond it the run is stuck.
const MOST_EVENTS_AT_ONCE: usize = 64;

/// Running integration.
pub(crate) struct March<'a> {
    pub(super) model: &'a mut Model,
    pub(super) drive: Drive<'a>,
    pub(super) times: &'a [f64],
    pub(super) response: &'a mut Response,
    pub(super) next: usize,
    pub(super) time: f64,
    pub(super) state: [f64; MOST_STATES],
    pub(super) mode: Mode,
    /// Largest size so far of each state variable.
    pub(super) scale: [f64; MOST_STATES],
    /// Size of the last step, in seconds.
    pub(super) size: f64,
    pub(super) end: f64,
    /// Position beyond which the motion counts as diverging.
    pub(super) bound: f64,
    /// Number of steps since time last changed.
    pub(super) at_once: usize,
}

impl<'a> March<'a> {
    pub(super) fn new(
        model: &'a mut Model,
        start: FullState,
        input: Option<&'a Input>,
        times: &'a [f64],
        response: &'a mut Response,
    ) -> Self {
        let (time, end) = crate::times::ends(times);
        let drive = Drive::new(input, model.field.nominal.input_gain, model.delay, time);
        let hidden = start.hidden.unwrap_or_else(|| model.field.relaxed(start.position, start.velocity));
        let mut state = [0.0; MOST_STATES];
        for (slot, value) in state.iter_mut().zip([start.position, start.velocity].into_iter().chain(hidden))
        {
            *slot = value;
        }
        let mut march = Self {
            drive,
            times,
            response,
            next: 0,
            time,
            state,
            mode: Mode { direction: 1.0, regions: [0; crate::field::MOST_EFFECTS] },
            scale: state.map(f64::abs),
            size: 0.0,
            end,
            bound: Start { position: start.position, velocity: start.velocity }.bound(),
            at_once: 0,
            model,
        };
        march.mode = march.model.field.mode(&march.point());
        let frequency = (march.model.field.nominal.stiffness / march.model.field.nominal.inertia).sqrt();
        march.size = if frequency > 0.0 { 0.1 / frequency } else { 1e-3 * (end - time) };
        march.scale_hidden(frequency);
        march.start_columns(start.hidden.is_none());
        march.prepare_response();
        march
    }

    /// Scales a hidden state that acts by its torque alone: to the value that moves the body as far as the
    /// spring does.
    fn scale_hidden(&mut self, frequency: f64) {
        let [position, velocity, ..] = self.scale;
        let reach = position.max(velocity / frequency.max(f64::MIN_POSITIVE)) * frequency * frequency;
        let point = self.point();
        let (still, _) = self.model.field.rates(&point, &self.mode);
        for term in &self.model.field.terms {
            if term.effect.description().hidden_states != 1 {
                continue;
            }
            let mut moved = point;
            if let Some(slot) = moved.hidden.get_mut(term.hidden) {
                *slot += 1.0;
            }
            let (own, _) = self.model.field.rates(&moved, &self.mode);
            let felt = (own - still).abs();
            if let Some(slot) = self.scale.get_mut(2 + term.hidden)
                && felt > 0.0
                && reach.is_finite()
            {
                *slot = slot.max(reach / felt);
            }
        }
    }

    fn start_columns(&mut self, relaxed: bool) {
        self.model.columns.clear();
        for (column, place) in self.model.free.iter().enumerate() {
            let Place::Start(variable) = *place else { continue };
            if let Some(slot) = self.model.columns.first_mut(column, variable) {
                *slot = 1.0;
            }
            if relaxed && variable < 2 {
                // A relaxed hidden state follows the body; the map is linear, so that its values are its
                // derivatives.
                let (position, velocity) = if variable == 0 { (1.0, 0.0) } else { (0.0, 1.0) };
                for (index, value) in self.model.field.relaxed(position, velocity).into_iter().enumerate() {
                    if let Some(slot) = self.model.columns.first_mut(column, 2 + index) {
                        *slot = value;
                    }
                }
            }
        }
    }

    fn prepare_response(&mut self) {
        let (samples, columns) = (self.times.len(), self.model.columns.count());
        let settings = self.model.settings;
        // The run writes every entry; values of an earlier run need no clearing.
        let sized = |list: &mut Vec<f64>, length: usize| {
            list.resize(length, 0.0);
        };
        let response = &mut *self.response;
        response.columns = columns;
        response.steps = 0;
        response.events = 0;
        sized(&mut response.position, samples);
        sized(&mut response.position_sensitivity, samples * columns);
        let velocities = if settings.velocity { samples } else { 0 };
        sized(&mut response.velocity, velocities);
        let accelerations = if settings.acceleration { samples } else { 0 };
        sized(&mut response.acceleration, accelerations);
        let by_rate = if settings.rate_sensitivities { columns } else { 0 };
        sized(&mut response.velocity_sensitivity, velocities * by_rate);
        sized(&mut response.acceleration_sensitivity, accelerations * by_rate);
        sized(&mut response.end_sensitivity, self.model.states * columns);
    }

    pub(super) fn run(mut self) -> Result<(), DynamicsError> {
        while self.next < self.times.len() {
            self.cross_knots();
            let before = self.time;
            self.step()?;
            self.at_once = if self.time > before { 0 } else { self.at_once + 1 };
            if self.at_once > MOST_EVENTS_AT_ONCE {
                return Err(DynamicsError::StepTooSmall { time_s: self.time, step_s: 0.0 });
            }
            self.response.steps += 1;
            if self.response.steps > self.model.settings.most_steps {
                return Err(DynamicsError::TooManySteps { steps: self.response.steps, time_s: self.time });
            }
        }
        let [position, velocity, hidden @ ..] = self.state;
        self.response.end = FullState { position, velocity, hidden: Some(hidden) };
        let columns = self.model.columns.count();
        let rows = self.response.end_sensitivity.chunks_mut(columns.max(1)).enumerate();
        for (variable, row) in rows {
            self.model.columns.write(variable, 0.0, 0, row);
        }
        Ok(())
    }

    pub(super) fn point(&self) -> State<f64> {
        let [position, velocity, hidden @ ..] = self.state;
        let input = self.drive.torque(self.time);
        State { time: self.time, position, velocity, hidden, input }
    }

    /// Returns the rates of the state at the present point, in the present mode.
    pub(super) fn rates(&self) -> [f64; MOST_STATES] {
        let point = self.point();
        let (acceleration, hidden) = self.model.field.rates(&point, &self.mode);
        let mut rates = [0.0; MOST_STATES];
        let all = [point.velocity, acceleration].into_iter().chain(hidden);
        for (rate, value) in rates.iter_mut().zip(all) {
            *rate = value;
        }
        rates
    }

    /// Passes the input's knots at the present time.
    fn cross_knots(&mut self) {
        while self.drive.until() <= self.time {
            let before = self.rates();
            self.drive.advance();
            self.mode = self.model.field.mode(&self.point());
            let after = self.rates();
            // Only a free delay moves a knot.
            for (column, place) in self.model.free.iter().enumerate() {
                if !matches!(place, Place::Delay(_)) {
                    continue;
                }
                for (variable, (before, after)) in before.iter().zip(after).enumerate() {
                    if let Some(slot) = self.model.columns.first_mut(column, variable) {
                        *slot += before - after;
                    }
                }
            }
        }
    }

    /// Makes one step, of full size or to the first edge.
    fn step(&mut self) -> Result<(), DynamicsError> {
        let number = self.model.piece(&self.mode);
        debug_assert!(number < self.model.graphs.len(), "the piece was just found or written down");
        let room = (self.drive.until().min(self.end) - self.time).max(0.0);
        let [raw, raw_rate] = self.drive.raw(self.time);
        let Model { graphs, states, settings, .. } = &mut *self.model;
        let Some(piece) = graphs.get_mut(number) else { return Ok(()) };
        let graph = &mut piece.graph;
        let (states, most) = (*states, settings.degree);
        graph.set_leaf(TIME, &[self.time, 1.0]);
        graph.set_leaf(INPUT, &raw);
        graph.set_leaf(INPUT_RATE, &raw_rate);
        for (variable, &value) in self.state.iter().enumerate().take(states) {
            graph.set_leaf(STATE + variable, &[value]);
        }
        let mut series = [[0.0; LENGTH]; MOST_STATES];
        for (series, &value) in series.iter_mut().zip(&self.state) {
            let [first, ..] = series;
            *first = value;
        }
        // While stuck, the state's own series tell nothing about the torque's.
        let reach = if self.mode.sticks() { f64::INFINITY } else { room };
        let degree = expand(graph, &mut series, states, most, reach, &self.scale, settings.tolerance);
        let mut size = self.step_size(&series, degree, number).min(room);
        // The first step's guess of the variables' reach may have been too large.
        while self.response.steps == 0 && size < 0.5 * self.size {
            self.size = size;
            size = self.step_size(&series, degree, number).min(room);
        }
        size = self.without_defect(&series, degree, size);
        if size <= f64::EPSILON * self.time.abs() && room > 4.0 * f64::EPSILON * self.time.abs() {
            return Err(DynamicsError::StepTooSmall { time_s: self.time, step_s: size });
        }
        let edge = self.first_edge(number, degree, size);
        if let Some((_, time)) = edge {
            size = time;
        } else {
            self.size = size.max(f64::MIN_POSITIVE);
        }
        if size > 0.0 || self.times.get(self.next).is_some_and(|&next| next <= self.time) {
            self.vary(number, degree);
            self.record(&series, degree, size, edge.is_some());
            self.model.columns.advance(size, degree);
        }
        for ((slot, series), scale) in self.state.iter_mut().zip(&series).zip(&mut self.scale).take(states) {
            *slot = value(head(series, degree + 1), size);
            *scale = scale.max(slot.abs());
        }
        self.time = if size >= room { self.drive.until().min(self.end) } else { self.time + size };
        let [position, ..] = self.state;
        if !position.is_finite() || position.abs() > self.bound {
            return Err(DynamicsError::Diverged { time_s: self.time, position });
        }
        if let Some((edge, _)) = edge {
            self.cross(edge, number);
        }
        Ok(())
    }

    /// Solves the variational equation along the step.
    fn vary(&mut self, number: usize, degree: usize) {
        let Model { graphs, states, free, columns, couplings, .. } = &mut *self.model;
        if free.is_empty() {
            return;
        }
        let Some(piece) = graphs.get_mut(number) else { return };
        let graph = &mut piece.graph;
        couplings.clear();
        let slopes = |[_, slope, second, third]: Cubic| [slope, 2.0 * second, 3.0 * third];
        let [raw, raw_rate] = self.drive.raw(self.time);
        let delayed = [(INPUT, slopes(raw)), (INPUT_RATE, slopes(raw_rate))];
        let mut links = [None; MOST_STATES];
        for (rate, link) in links.iter_mut().enumerate().take(*states) {
            let Some(node) = graph.rates.get(rate).copied() else { continue };
            *link = graph.link(node);
            if link.is_some() {
                continue;
            }
            columns.clear_sources(rate, degree);
            graph.differentiate(node, degree - 1);
            for state in 0..*states {
                let partial = graph.derivative(STATE + state);
                if partial.is_empty() {
                    continue;
                }
                let mut series = [0.0; LENGTH];
                for (slot, value) in series.iter_mut().zip(partial) {
                    *slot = *value;
                }
                couplings.push(Coupling { rate, state, length: partial.len(), series });
            }
            for (column, place) in free.iter().enumerate() {
                match *place {
                    Place::Leaf(leaf) => columns.add_source(column, rate, graph.derivative(leaf), 1.0, 0),
                    Place::Delay(_) => {
                        for (leaf, slopes) in delayed {
                            let by_input = graph.derivative(leaf);
                            for (from, slope) in slopes.into_iter().enumerate().take(degree) {
                                let kept = by_input.len().min(degree - from);
                                columns.add_source(column, rate, head(by_input, kept), -slope, from);
                            }
                        }
                    }
                    Place::Start(_) => {}
                }
            }
        }
        columns.propagate(couplings, head(&links, *states), degree);
    }

    /// Writes the samples that fall into the step.
    fn record(&mut self, series: &[Series; MOST_STATES], degree: usize, size: f64, to_edge: bool) {
        let settings = self.model.settings;
        let columns = self.model.columns.count();
        let [position, velocity, ..] = series;
        let (position, velocity) = (head(position, degree + 1), head(velocity, degree + 1));
        // The last step of a run has to include the last sample, whatever the rounding.
        let last = !to_edge && size >= self.end - self.time;
        while let Some(&time) = self.times.get(self.next) {
            let after = (time - self.time).max(0.0);
            if after > size && !last {
                break;
            }
            let sample = self.next;
            let row = sample * columns..(sample + 1) * columns;
            let response = &mut *self.response;
            put(&mut response.position, sample, value(position, after));
            self.model.columns.write(0, after, degree, part(&mut response.position_sensitivity, &row));
            if settings.velocity {
                put(&mut response.velocity, sample, value(velocity, after));
            }
            if settings.velocity && settings.rate_sensitivities {
                self.model.columns.write(1, after, degree, part(&mut response.velocity_sensitivity, &row));
            }
            if settings.acceleration {
                put(&mut response.acceleration, sample, slope(velocity, after));
            }
            if settings.acceleration && settings.rate_sensitivities {
                let slots = part(&mut response.acceleration_sensitivity, &row);
                self.model.columns.write_slope(1, after, degree, slots);
            }
            self.next += 1;
        }
    }
}

/// Returns a sample's row of a table that `prepare_response` has sized.
fn part<'a>(table: &'a mut [f64], row: &Range<usize>) -> &'a mut [f64] {
    &mut table[row.clone()]
}

fn put(list: &mut [f64], index: usize, value: f64) {
    debug_assert!(index < list.len(), "{index} of {}", list.len());
    if let Some(slot) = list.get_mut(index) {
        *slot = value;
    }
}

const _: () = assert!(MOST_STATES == 2 + SYSTEM_HIDDEN);
