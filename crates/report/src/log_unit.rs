//! Conversion of a diagnosis into the unit of its logs, for reports. Files keep SI units.

use record::Unit;
use results::{CalibratedRow, DiagnosisResult, MapCell, ParameterRow, SeriesRow, WithInterval};

/// Unit of the logs of a diagnosis, and what converts into it.
pub(crate) struct LogUnit {
    unit: Unit,
    /// Factor from the unit of the results to that of the logs.
    observed: f64,
    /// SI unit of positions and their unit in the log; `None` if the log's unit tells none, as rpm or g.
    position: Option<(String, String)>,
}

impl LogUnit {
    /// Returns the unit of the logs, if they share one and the result has another.
    pub(crate) fn of(result: &DiagnosisResult) -> Option<Self> {
        let mut units = result.records.iter().map(|record| record.reading.value.unit.as_deref());
        let first = units.next()??;
        let unit = Unit::parse(first).filter(|unit| unit.si() == result.gap.unit)?;
        let is_shared = units.all(|other| other == Some(first));
        let [position, ..] = &result.units;
        let symbol = unit.symbol();
        let own = symbol.strip_suffix("/s^2").or(symbol.strip_suffix("/s")).unwrap_or(symbol);
        let tells = |own: &str| Unit::parse(own).is_some_and(|own| own.si() == *position);
        let own = if unit.is_signal() { Some(symbol) } else { Some(own).filter(|own| tells(own)) };
        let position = own.map(|own| (position.clone(), own.to_owned()));
        let differs = unit.symbol() != unit.si() || unit.is_signal();
        (is_shared && differs).then_some(Self { unit, observed: 1.0 / unit.to_si(), position })
    }

    /// Returns a sentence on the units of a report.
    pub(crate) fn note(&self) -> String {
        let symbol = self.unit.symbol();
        if self.unit.is_signal() {
            return format!(
                "Sizes are in {symbol}, the unit of the sensor's signal; the saved files are in SI units, with 1 {} for one meter.",
                self.unit.si()
            );
        }
        let what = if self.position.is_some() { "Errors and positions" } else { "Errors" };
        format!(
            "{what} are in {symbol}, the unit of the log; coefficients and the saved files are in SI units (1 {symbol} = {} {}).",
            crate::format::significant(self.unit.to_si(), 6),
            self.unit.si()
        )
    }

    /// Converts a result.
    pub(crate) fn convert(&self, result: &mut DiagnosisResult) {
        let times = |value: &mut f64| *value *= self.observed;
        let gap = &mut result.gap;
        gap.unit = self.unit.symbol().to_owned();
        [&mut gap.nominal, &mut gap.recalibrated, &mut gap.repaired, &mut gap.ceiling, &mut gap.noise_floor]
            .into_iter()
            .chain(&mut gap.noise_floor_interval_95)
            .chain(&mut gap.last_third)
            .for_each(times);
        times(&mut result.measuring_chain.noise);
        result.measuring_chain.resolution.iter_mut().for_each(times);
        for class in &mut result.classes {
            [&mut class.error_without, &mut class.error_with].into_iter().for_each(times);
        }
        let curves = &mut result.backbone;
        for point in [&mut curves.measured, &mut curves.nominal, &mut curves.repaired].into_iter().flatten() {
            times(&mut point.amplitude);
        }
        let place = &mut result.place;
        for cell in [&mut place.time, &mut place.amplitude, &mut place.phase, &mut place.frequency]
            .into_iter()
            .flatten()
        {
            [&mut cell.value, &mut cell.repaired, &mut cell.band].into_iter().for_each(times);
        }
        for record in &mut result.records {
            let whole = record.reading.whole.iter_mut();
            whole.flat_map(|whole| &mut whole.outline).for_each(|[_, value]| times(value));
        }
        self.convert_positions(result);
    }

    /// Converts rows of the series.
    pub(crate) fn convert_series(&self, rows: &mut [SeriesRow]) {
        for row in rows {
            for value in [&mut row.observed, &mut row.nominal, &mut row.recalibrated, &mut row.repaired] {
                *value *= self.observed;
            }
        }
    }

    fn convert_positions(&self, result: &mut DiagnosisResult) {
        let Some((_, own)) = &self.position else { return };
        if self.unit.is_signal() {
            result.units.iter_mut().for_each(|unit| self.relabel(unit));
        }
        let [position, velocity, _] = &mut result.units;
        (*position, *velocity) = (own.clone(), format!("{own}/s"));
        let scaled = |bounds: &mut [f64; 2]| bounds.iter_mut().for_each(|end| *end *= self.observed);
        let cells: [&mut Vec<MapCell>; 2] = [&mut result.place.amplitude, &mut result.place.phase];
        cells.into_iter().flatten().flat_map(|cell| &mut cell.bounds).for_each(scaled);
        for cell in &mut result.surface {
            cell.bounds.iter_mut().for_each(scaled);
            [&mut cell.measured, &mut cell.missing].into_iter().for_each(|value| *value *= self.observed);
        }
        let calibration = &mut result.calibration;
        let known = calibration.effects.iter_mut().flat_map(|effect| effect.parameters.values_mut());
        let plain = [
            &mut calibration.inertia,
            &mut calibration.damping,
            &mut calibration.stiffness,
            &mut calibration.rest_angle,
        ];
        plain.into_iter().chain(known).for_each(|row| self.convert_coefficient(row));
        for parameter in result.effects.iter_mut().flat_map(|effect| effect.parameters.values_mut()) {
            self.convert_parameter(parameter);
        }
    }

    fn convert_coefficient(&self, row: &mut CalibratedRow) {
        if !self.converts(&mut row.unit) {
            return;
        }
        row.nominal *= self.observed;
        for found in [&mut row.recalibrated, &mut row.repaired].into_iter().flatten() {
            let WithInterval { value, interval_95: [low, high] } = found;
            [value, low, high].into_iter().for_each(|number| *number *= self.observed);
        }
    }

    fn convert_parameter(&self, parameter: &mut ParameterRow) {
        if self.converts(&mut parameter.unit) {
            let [low, high] = &mut parameter.interval_95;
            [&mut parameter.value, low, high].into_iter().for_each(|number| *number *= self.observed);
        }
    }

    /// Writes the unit of a coefficient as the log has it; returns `true` if its value is to be converted too, as that of
    /// a position or of an observed quantity.
    fn converts(&self, unit: &mut String) -> bool {
        let (si, own) = match &self.position {
            Some((si, own)) if unit == si => (si.as_str(), own.as_str()),
            _ => (self.unit.si(), self.unit.symbol()),
        };
        let converts = unit == si;
        if converts {
            own.clone_into(unit);
        } else {
            self.relabel(unit);
        }
        converts
    }

    /// Writes the unit of a signal in place of the meter that it stands for.
    fn relabel(&self, unit: &mut String) {
        if !self.unit.is_signal() {
            return;
        }
        let parts = unit.split_inclusive(|sign: char| !sign.is_alphabetic());
        let relabeled = parts.map(|part| {
            let name = part.trim_end_matches(|sign: char| !sign.is_alphabetic());
            if name == "m" { part.replacen('m', self.unit.si(), 1) } else { part.to_owned() }
        });
        *unit = relabeled.collect();
    }
}

#[cfg(test)]
mod tests {
    use super::LogUnit;
    use crate::diagnosis::small;
    use results::DiagnosisResult;

    fn read(unit: &str, gap: &str, units: [&str; 3], coefficient: &str) -> DiagnosisResult {
        let mut result: DiagnosisResult = serde_json::from_value(small()).unwrap();
        let mut record: serde_json::Value = serde_json::json!({
            "path": "log.csv", "digest": "", "origin": "measured", "samples": 9, "duration_s": 1.0, "clock": "host",
            "clock_reason": "", "findings": [],
        });
        record["reading"] = serde_json::to_value(record::Reading::default()).unwrap();
        record["reading"]["value"]["unit"] = unit.into();
        result.records = vec![serde_json::from_value(record).unwrap()];
        gap.clone_into(&mut result.gap.unit);
        result.units = units.map(str::to_owned);
        let [position, ..] = units;
        position.clone_into(&mut result.calibration.rest_angle.unit);
        for parameter in result.effects.iter_mut().flat_map(|effect| effect.parameters.values_mut()) {
            coefficient.clone_into(&mut parameter.unit);
        }
        result
    }

    #[test]
    fn errors_and_positions_of_a_log_in_degrees_are_degrees_and_torques_stay() {
        let mut result = read("deg", "rad", ["rad", "rad/s", "N m"], "N m");
        LogUnit::of(&result).unwrap().convert(&mut result);
        assert_eq!(result.gap.unit, "deg");
        assert!((result.gap.nominal - 0.1_f64.to_degrees()).abs() < 1e-12);
        assert_eq!(result.units, ["deg", "deg/s", "N m"]);
        assert!((result.calibration.rest_angle.nominal - 0.3_f64.to_degrees()).abs() < 1e-12);
        assert_eq!(result.calibration.stiffness.nominal, 0.3);
        assert_eq!(result.effects[0].parameters["torque"].value, 1.0);
    }

    #[test]
    fn the_meter_that_a_signal_stands_for_is_written_as_its_unit() {
        let mut result = read("mV", "V", ["m", "m/s", "m/s^2"], "1/(m^2 s^2)");
        LogUnit::of(&result).unwrap().convert(&mut result);
        assert_eq!(result.units, ["mV", "mV/s", "V/s^2"]);
        assert_eq!(result.effects[0].parameters["torque"].unit, "1/(V^2 s^2)");
        assert!((result.gap.nominal - 100.0).abs() < 1e-9);
    }

    #[test]
    fn a_rate_tells_the_unit_of_positions_unless_it_counts_turns() {
        let mut result = read("deg/s", "rad/s", ["rad", "rad/s", "N m"], "rad");
        LogUnit::of(&result).unwrap().convert(&mut result);
        assert_eq!(result.units[0], "deg");
        let mut result = read("rpm", "rad/s", ["rad", "rad/s", "N m"], "rad");
        LogUnit::of(&result).unwrap().convert(&mut result);
        assert_eq!((result.gap.unit.as_str(), result.units[0].as_str()), ("rpm", "rad"));
        assert!(LogUnit::of(&read("rad", "rad", ["rad", "rad/s", "N m"], "rad")).is_none());
    }
}
