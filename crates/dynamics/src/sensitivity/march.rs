//! The march from step to step, by Taylor series.

use super::columns::Coupling;
use super::free::Place;
use super::graph::{Graph, INPUT, MOST_STATES, STATE, TIME};
use super::model::Model;
use super::response::{FullState, Response};
use super::series::{LENGTH, Series, slope, value};
use crate::edges::Edge;
use crate::error::DynamicsError;
use crate::field::{Mode, SYSTEM_HIDDEN, State};
use crate::input::Input;
use crate::system::{Drive, Start};

/// Steps in a row without any time passing, beyond which the march is stuck.
const MOST_EVENTS_AT_ONCE: usize = 64;

/// Parts of a step at which the sign of a margin is looked at.
const LOOKS: u32 = 8;

/// Parts of a step at which its defect is looked at.
const PARTS: [f64; 2] = [1.0, 0.6];

/// Largest defect of a step in units of the tolerance: what the first neglected term brings, times the degree.
const MOST_DEFECT: f64 = 20.0;

/// A coefficient of a margin this small, relative to all, is rounding: the step begins on the edge.
const ON_THE_EDGE: f64 = 1e-12;

/// A run under way.
pub(crate) struct March<'a> {
    model: &'a mut Model,
    drive: Drive<'a>,
    times: &'a [f64],
    response: &'a mut Response,
    next: usize,
    time: f64,
    state: [f64; MOST_STATES],
    mode: Mode,
    /// Largest size so far of each state variable.
    scale: [f64; MOST_STATES],
    /// Size of the last step, in seconds.
    size: f64,
    end: f64,
    /// Position beyond which the motion counts as running away.
    bound: f64,
}

impl<'a> March<'a> {
    pub(super) fn new(
        model: &'a mut Model,
        start: FullState,
        input: Option<&'a Input>,
        times: &'a [f64],
        response: &'a mut Response,
    ) -> Self {
        let time = times.first().copied().unwrap_or(0.0);
        let end = times.last().copied().unwrap_or(0.0);
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
            model,
        };
        march.mode = march.model.field.mode(&march.point());
        let frequency = (march.model.field.nominal.stiffness / march.model.field.nominal.inertia).sqrt();
        march.size = if frequency > 0.0 { 0.1 / frequency } else { 1e-3 * (end - time) };
        march.start_columns(start.hidden.is_none());
        march.prepare_response();
        march
    }

    fn start_columns(&mut self, relaxed: bool) {
        self.model.columns.clear();
        for (column, place) in self.model.free.iter().enumerate() {
            let Place::Start(variable) = *place else { continue };
            if let Some(slot) = self.model.columns.first_mut(column, variable) {
                *slot = 1.0;
            }
            if relaxed && variable < 2 {
                // What is relaxed follows the body; the map is linear, so that its values are its derivatives.
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
        // Every entry is written by the run; what is left of an earlier one needs no clearing.
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
        sized(&mut response.velocity_sensitivity, velocities * columns);
        let accelerations = if settings.acceleration { samples } else { 0 };
        sized(&mut response.acceleration, accelerations);
        sized(&mut response.acceleration_sensitivity, accelerations * columns);
        sized(&mut response.end_sensitivity, self.model.states * columns);
    }

    pub(super) fn run(mut self) -> Result<(), DynamicsError> {
        let mut at_once = 0;
        while self.next < self.times.len() {
            self.cross_knots();
            let before = self.time;
            self.step()?;
            at_once = if self.time > before { 0 } else { at_once + 1 };
            if at_once > MOST_EVENTS_AT_ONCE {
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

    fn point(&self) -> State<f64> {
        let [position, velocity, hidden @ ..] = self.state;
        let input = if self.drive.is_present() { self.drive.torque(self.time) } else { 0.0 };
        State { time: self.time, position, velocity, hidden, input }
    }

    /// Rates of the state at the present point, in the present mode.
    fn rates(&self) -> [f64; MOST_STATES] {
        let point = self.point();
        let (acceleration, hidden) = self.model.field.rates(&point, &self.mode);
        let mut rates = [0.0; MOST_STATES];
        let all = [point.velocity, acceleration].into_iter().chain(hidden);
        for (rate, value) in rates.iter_mut().zip(all) {
            *rate = value;
        }
        rates
    }

    /// Passes the input's knots that lie at the present time.
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

    /// One step, to its full size or to the first edge.
    fn step(&mut self) -> Result<(), DynamicsError> {
        let number = self.model.piece(&self.mode);
        let room = (self.drive.until().min(self.end) - self.time).max(0.0);
        let raw = if self.drive.is_present() { self.drive.raw(self.time) } else { (0.0, 0.0) };
        let Model { graphs, states, settings, .. } = &mut *self.model;
        let Some(piece) = graphs.get_mut(number) else { return Ok(()) };
        let graph = &mut piece.graph;
        let (states, most) = (*states, settings.degree);
        graph.set_leaf(TIME, self.time, 1.0);
        graph.set_leaf(INPUT, raw.0, raw.1);
        for (variable, &value) in self.state.iter().enumerate().take(states) {
            graph.set_leaf(STATE + variable, value, 0.0);
        }
        let mut series = [[0.0; LENGTH]; MOST_STATES];
        for (series, &value) in series.iter_mut().zip(&self.state) {
            let [first, ..] = series;
            *first = value;
        }
        let degree = expand(graph, &mut series, states, most, room, &self.scale, settings.tolerance);
        let mut size = self.step_size(&series, degree, number).min(room);
        while size > f64::EPSILON * self.time.abs()
            && PARTS.into_iter().any(|part| self.defect(&series, degree, part * size) > MOST_DEFECT)
        {
            size *= 0.7;
        }
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
            *slot = value(series.get(..=degree).unwrap_or_default(), size);
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

    /// The largest step for which the last two coefficients of every series are below the tolerance, and
    /// those behind them fall off.
    fn step_size(&self, series: &[Series; MOST_STATES], degree: usize, number: usize) -> f64 {
        let mut tails = Tails::default();
        for (series, &scale) in series.iter().zip(&self.scale).take(self.model.states) {
            tails.take(series, degree, self.reach(series, scale));
        }
        if self.mode.sticks()
            && let Some(piece) = self.model.graphs.get(number)
        {
            // Nothing moves but the torque: the step has to resolve it, or a break-away is missed.
            let holding = self.model.field.holding_torque().unwrap_or(1.0).abs();
            for (_, node) in &piece.graph.edges {
                tails.take(piece.graph.series(*node), degree, holding);
            }
        }
        tails.step_size(degree, self.model.settings.tolerance)
    }

    /// The size that errors of a variable are measured by: its largest so far, or, where it has not moved yet, how
    /// far its first terms take it.
    fn reach(&self, series: &Series, scale: f64) -> f64 {
        let [_, first, second, third, ..] = series;
        let time = self.size;
        scale.max(first.abs() * time).max(second.abs() * time * time).max(third.abs() * time * time * time)
    }

    /// By how much the series at the end of a step fails the equation of motion, over the step, in units of the
    /// tolerance. The coefficients alone do not betray a narrow peak ahead; this does.
    fn defect(&self, series: &[Series; MOST_STATES], degree: usize, size: f64) -> f64 {
        let states = self.model.states;
        let mut end = [0.0; MOST_STATES];
        for (slot, series) in end.iter_mut().zip(series).take(states) {
            *slot = value(series.get(..=degree).unwrap_or_default(), size);
        }
        let [position, velocity, hidden @ ..] = end;
        let time = self.time + size;
        let input = if self.drive.is_present() { self.drive.torque(time) } else { 0.0 };
        let point = State { time, position, velocity, hidden, input };
        let (acceleration, hidden) = self.model.field.rates(&point, &self.mode);
        let rates = [velocity, acceleration].into_iter().chain(hidden);
        let defects = series.iter().zip(rates).zip(&self.scale).take(states);
        defects
            .map(|((series, rate), &scale)| {
                let scale = self.reach(series, scale).max(f64::MIN_POSITIVE);
                let defect = slope(series.get(..=degree).unwrap_or_default(), size) - rate;
                defect.abs() * size / (scale * self.model.settings.tolerance)
            })
            .fold(0.0, f64::max)
    }

    /// The edge that the step meets first, and when after its beginning.
    fn first_edge(&self, number: usize, degree: usize, size: f64) -> Option<(Edge, f64)> {
        let piece = self.model.graphs.get(number)?;
        let mut first: Option<(Edge, f64)> = None;
        for &(edge, node) in &piece.graph.edges {
            let margin = piece.graph.series(node).get(..=degree).unwrap_or_default();
            let until = first.map_or(size, |(_, time)| time);
            if let Some(time) = crossing(margin, until, 4.0 * f64::EPSILON * self.time.abs()) {
                first = Some((edge, time));
            }
        }
        first
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
        let slope = if self.drive.is_present() { self.drive.raw(self.time).1 } else { 0.0 };
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
                    Place::Leaf(leaf) => columns.add_source(column, rate, graph.derivative(leaf), 1.0),
                    Place::Delay(_) => columns.add_source(column, rate, graph.derivative(INPUT), -slope),
                    Place::Start(_) => {}
                }
            }
        }
        columns.propagate(couplings, links.get(..*states).unwrap_or_default(), degree);
    }

    /// Writes the samples that fall into the step.
    fn record(&mut self, series: &[Series; MOST_STATES], degree: usize, size: f64, to_edge: bool) {
        let settings = self.model.settings;
        let columns = self.model.columns.count();
        let [position, velocity, ..] = series;
        let position = position.get(..=degree).unwrap_or_default();
        let velocity = velocity.get(..=degree).unwrap_or_default();
        // The last step of a run has to take the last sample along, whatever the rounding.
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
            let slots = response.position_sensitivity.get_mut(row.clone()).unwrap_or_default();
            self.model.columns.write(0, after, degree, slots);
            if settings.velocity {
                put(&mut response.velocity, sample, value(velocity, after));
                let slots = response.velocity_sensitivity.get_mut(row.clone()).unwrap_or_default();
                self.model.columns.write(1, after, degree, slots);
            }
            if settings.acceleration {
                put(&mut response.acceleration, sample, slope(velocity, after));
                let slots = response.acceleration_sensitivity.get_mut(row).unwrap_or_default();
                self.model.columns.write_slope(1, after, degree, slots);
            }
            self.next += 1;
        }
    }

    /// Passes to the piece behind an edge; the columns jump where the force does.
    fn cross(&mut self, edge: Edge, number: usize) {
        self.response.events += 1;
        if edge == Edge::Reversal {
            let [_, velocity, ..] = &mut self.state;
            *velocity = 0.0;
        }
        let before = self.rates();
        let old = self.mode;
        self.mode = self.model.field.behind(&self.point(), &old, edge);
        let after = self.rates();
        let [_, _, hidden @ ..] = &mut self.state;
        self.model.field.settle(&self.mode, hidden);
        let rates = before.iter().zip(&after);
        let jumps = rates
            .into_iter()
            .any(|(before, after)| (before - after).abs() > 1e-12 * before.abs().max(after.abs()));
        if jumps && !self.model.free.is_empty() {
            self.shift(edge, number);
            for column in 0..self.model.free.len() {
                let shift = self.model.shifts.get(column).copied().unwrap_or(0.0);
                for (variable, (before, after)) in before.iter().zip(after).enumerate().skip(1) {
                    if let Some(slot) = self.model.columns.first_mut(column, variable) {
                        *slot += (before - after) * shift;
                    }
                }
            }
        }
        if self.mode.sticks() {
            for column in 0..self.model.free.len() {
                if let Some(slot) = self.model.columns.first_mut(column, 1) {
                    *slot = 0.0;
                }
            }
        }
    }

    /// How much later each free quantity makes the event: −δm/ṁ with the margin m of the edge.
    fn shift(&mut self, edge: Edge, number: usize) {
        let point = self.point();
        let raw = if self.drive.is_present() { self.drive.raw(self.time) } else { (0.0, 0.0) };
        let Model { graphs, states, free, columns, shifts, .. } = &mut *self.model;
        let Some(piece) = graphs.get_mut(number) else { return };
        let graph = &mut piece.graph;
        let Some(&(_, node)) = graph.edges.iter().find(|(other, _)| *other == edge) else { return };
        graph.set_leaf(TIME, point.time, 1.0);
        graph.set_leaf(INPUT, raw.0, raw.1);
        for (variable, &value) in self.state.iter().enumerate().take(*states) {
            graph.set_leaf(STATE + variable, value, 0.0);
        }
        graph.extend(0);
        for variable in 0..*states {
            let rate = graph.rates.get(variable).map_or(0.0, |&node| graph.coefficient(node, 0));
            graph.set_state(variable, 1, rate);
        }
        graph.extend(1);
        let speed = graph.coefficient(node, 1);
        graph.differentiate(node, 0);
        for (column, (shift, place)) in shifts.iter_mut().zip(free.iter()).enumerate() {
            let mut moved: f64 = (0..*states)
                .map(|state| {
                    graph.derivative(STATE + state).first().unwrap_or(&0.0) * columns.first(column, state)
                })
                .sum();
            moved += match *place {
                Place::Leaf(leaf) => graph.derivative(leaf).first().copied().unwrap_or(0.0),
                Place::Delay(_) => -raw.1 * graph.derivative(INPUT).first().unwrap_or(&0.0),
                Place::Start(_) => 0.0,
            };
            // An edge that is only touched has no side to be shifted to.
            *shift = if speed == 0.0 { 0.0 } else { -moved / speed };
        }
    }
}

/// The largest of the last coefficients of several series, the highest degree first, each relative to its scale.
#[derive(Debug, Default)]
struct Tails([f64; 4]);

impl Tails {
    fn take(&mut self, series: &Series, degree: usize, scale: f64) {
        let last = series.get(..=degree).unwrap_or_default().iter().rev();
        for (largest, coefficient) in self.0.iter_mut().zip(last) {
            *largest = largest.max(coefficient.abs() / scale.max(f64::MIN_POSITIVE));
        }
    }

    fn step_size(&self, degree: usize, tolerance: f64) -> f64 {
        let [last, second, third, fourth] = self.0;
        let root = |coefficient: f64, degree: usize| {
            if coefficient > 0.0 {
                (tolerance / coefficient).powf(1.0 / degree as f64)
            } else {
                f64::INFINITY
            }
        };
        let size = root(last, degree).min(root(second, degree - 1));
        // Small last terms do not bound the rest where terms still grow with the degree, as before a narrow
        // peak: two degrees have to gain a factor of four.
        let (late, early) = (last * size + second, third * size + fourth);
        let growth = late * size * size / early.max(f64::MIN_POSITIVE);
        if size.is_finite() && growth > 0.25 { size * (0.25 / growth).sqrt() } else { size }
    }
}

fn put(list: &mut [f64], index: usize, value: f64) {
    if let Some(slot) = list.get_mut(index) {
        *slot = value;
    }
}

/// Expands the state into its series. Where the step cannot be long (`room`), a lower degree may do: it
/// returns the degree used.
fn expand(
    graph: &mut Graph,
    series: &mut [Series; MOST_STATES],
    states: usize,
    most: usize,
    room: f64,
    scale: &[f64; MOST_STATES],
    tolerance: f64,
) -> usize {
    let mut small = 0;
    let mut power = 1.0;
    for degree in 0..most {
        graph.extend(degree);
        let divisor = 1.0 / (degree + 1) as f64;
        power *= room;
        let mut negligible = true;
        for (variable, (series, scale)) in series.iter_mut().zip(scale).enumerate().take(states) {
            let rate = graph.rates.get(variable).copied();
            let coefficient = rate.map_or(0.0, |node| graph.coefficient(node, degree)) * divisor;
            graph.set_state(variable, degree + 1, coefficient);
            if let Some(slot) = series.get_mut(degree + 1) {
                *slot = coefficient;
            }
            negligible &= coefficient.abs() * power <= 0.1 * tolerance * scale;
        }
        small = if negligible { small + 1 } else { 0 };
        if small >= 2 && degree >= 3 {
            graph.extend(degree + 1);
            return degree + 1;
        }
    }
    graph.extend(most);
    most
}

/// When a margin, positive now, first becomes negative within a time; 0 where it is about to. `resolution` is
/// how exactly the present time is known.
fn crossing(margin: &[f64], until: f64, resolution: f64) -> Option<f64> {
    let mut power = 1.0;
    let mut total = 0.0;
    for coefficient in margin {
        total += coefficient.abs() * power;
        power *= until;
    }
    let (first, rest) = margin.split_first()?;
    // The rest cannot outweigh the first.
    if *first > total - first.abs() {
        return None;
    }
    // On the edge itself the lowest coefficients are rounding; what counts is how the margin goes on.
    let (mut lowest, mut rest, mut margin, mut power) = (*first, rest, margin, 1.0);
    while lowest.abs() * power
        <= ON_THE_EDGE * total + rest.first().map_or(0.0, |next| next.abs() * power * resolution)
    {
        margin = rest;
        (lowest, rest) = match rest.split_first() {
            Some((first, rest)) => (*first, rest),
            None => return None,
        };
        power *= until;
    }
    if lowest < 0.0 {
        return Some(0.0);
    }
    let mut from = 0.0;
    let mut falling = true;
    for look in 1..=LOOKS {
        let to = until * f64::from(look) / f64::from(LOOKS);
        let still_falling = slope(margin, to) < 0.0;
        if value(margin, to) < 0.0 {
            return Some(crate::root::bracketed(from, to, |time| value(margin, time)));
        }
        if falling && !still_falling {
            // A short visit behind the edge, between two looks.
            let lowest = crate::root::bracketed(from, to, |time| -slope(margin, time));
            if value(margin, lowest) < 0.0 {
                return Some(crate::root::bracketed(from, lowest, |time| value(margin, time)));
            }
        }
        falling = still_falling;
        from = to;
    }
    None
}

const _: () = assert!(MOST_STATES == 2 + SYSTEM_HIDDEN);
