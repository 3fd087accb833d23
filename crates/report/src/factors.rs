//! Detection of mistaken units: known factors between units, found in the coefficients of a diagnosis.

use crate::format::significant;
use results::{CalibratedRow, Calibration};
use std::f64::consts::{PI, TAU};

/// Largest relative difference between a ratio and a known factor; looked-up coefficients are off by a few
/// percent as well.
const NEAR: f64 = 0.1;

/// A factor between two units, and the questions that it raises: about the whole record, and about one
/// coefficient.
struct Known {
    factor: f64,
    whole: &'static str,
    single: &'static str,
}

const KNOWN: &[Known] = &[
    Known {
        factor: 9.806_65,
        whole: "is a force or a torque in kgf (kg on a scale), or an acceleration in g, on one side and in SI units on the \
                other? If it is the record's, set --input-unit to 'kgf m' or kgf, or --unit to g",
        single: "with kgf in place of N",
    },
    Known {
        factor: 180.0 / PI,
        whole: "is an angle in degrees on one side and in radians on the other? If it is the record's, set --unit or \
                --input-unit to deg",
        single: "per degree in place of per radian",
    },
    Known {
        factor: 1e3,
        whole: "are mm, ms or mN m on one side and m, s or N m on the other? If they are the record's, set --unit, \
                --time-unit or --input-unit",
        single: "with g, mm or mN in place of kg, m or N",
    },
    Known {
        factor: TAU,
        whole: "are turns, or Hz, on one side and radians, or rad/s, on the other? If they are the record's, set --unit or \
                --input-unit to turn",
        single: "per turn in place of per radian, or with Hz in place of rad/s",
    },
];

/// Returns the known factor nearest to a ratio or its inverse, within a tenth.
fn known(ratio: f64) -> Option<&'static Known> {
    let size = ratio.max(1.0 / ratio);
    let off = |known: &&Known| (size / known.factor).ln().abs();
    KNOWN
        .iter()
        .min_by(|one, other| off(one).total_cmp(&off(other)))
        .filter(|known| (size / known.factor - 1.0).abs() < NEAR)
}

/// Returns a sentence if a driven record's coefficients are off by a known factor: all alike, if the input or
/// the observed quantity is in another unit, or only the inertia or the stiffness. Without an input only
/// ratios of coefficients can be found, and a period that far off is refused.
pub(crate) fn of_units(calibration: &Calibration) -> Option<String> {
    let ratio = |row: &CalibratedRow| {
        let found = row.repaired.as_ref().or(row.recalibrated.as_ref())?.value / row.nominal;
        Some(found).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
    };
    // The inertia is determined only if an input drives the system.
    let inertia = ratio(&calibration.inertia)?;
    let stiffness = ratio(&calibration.stiffness).unwrap_or(inertia);
    let alike = (stiffness / inertia - 1.0).abs() < NEAR;
    let side = |ratio: f64, many: bool| {
        let (size, verb) = (significant(ratio.max(1.0 / ratio), 3), if many { "are" } else { "is" });
        let way = if ratio < 1.0 { "smaller" } else { "larger" };
        format!("{verb} {size} times {way} than the simulator states")
    };
    if alike {
        let known = known(inertia)?;
        return Some(format!("All coefficients {}: {}.", side(inertia, true), known.whole));
    }
    let unchanged = |ratio: f64| (ratio.ln()).abs() < 2.0_f64.ln();
    let (name, off) = match (unchanged(inertia), unchanged(stiffness)) {
        (false, true) => ("inertia", inertia),
        (true, false) => ("stiffness", stiffness),
        _ => return None,
    };
    let known = known(off)?;
    Some(format!("The {name} {}: is it stated in another unit, {}?", side(off, false), known.single))
}

#[cfg(test)]
mod tests {
    use super::of_units;
    use results::{CalibratedRow, Calibration, WithInterval};

    fn row(nominal: f64, ratio: f64) -> CalibratedRow {
        let value = ratio * nominal;
        let found = Some(WithInterval { value, interval_95: [0.99 * value, 1.01 * value] });
        CalibratedRow { nominal, unit: String::new(), recalibrated: found, repaired: found, determined: None }
    }

    fn with(inertia: f64, stiffness: f64) -> Calibration {
        Calibration {
            inertia: row(0.3, inertia),
            damping: row(0.2, inertia),
            stiffness: row(20.0, stiffness),
            rest_angle: row(0.0, 1.0),
            effects: Vec::new(),
        }
    }

    #[test]
    fn factors_of_units_are_named_and_others_are_not() {
        for (factor, words) in [
            (9.81, "in kgf (kg on a scale)"),
            (57.3, "degrees on one side"),
            (1e3, "mm, ms or mN m"),
            (std::f64::consts::TAU, "turns, or Hz"),
        ] {
            for factor in [factor, 1.04 * factor, 1.0 / factor] {
                let said = of_units(&with(factor, 1.02 * factor)).unwrap();
                let way = if factor < 1.0 { "times smaller" } else { "times larger" };
                assert!(said.contains(words) && said.contains(way), "{factor}: {said}");
            }
        }
        for factor in [1.0, 1.3, 2.0, 4.0, 7.5, 20.0, 100.0, 300.0] {
            assert_eq!(of_units(&with(factor, factor)), None, "{factor}");
        }
    }

    #[test]
    fn one_coefficient_may_be_in_another_unit() {
        let said = of_units(&with(1.05, 57.0)).unwrap();
        assert!(said.starts_with("The stiffness is 57.0 times larger"), "{said}");
        assert!(said.contains("per degree in place of per radian"), "{said}");
        let said = of_units(&with(1.0 / 9.8, 0.95)).unwrap();
        assert!(said.starts_with("The inertia is 9.80 times smaller") && said.contains("kgf"), "{said}");
        assert_eq!(of_units(&with(5.0, 20.0)), None);
    }

    /// The inertia of a free swing is held, so a common factor cannot be found.
    #[test]
    fn a_free_record_tells_no_factor() {
        let mut free = with(9.81, 9.81);
        free.inertia = CalibratedRow { recalibrated: None, repaired: None, ..free.inertia };
        assert_eq!(of_units(&free), None);
    }
}
