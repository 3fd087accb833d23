//! Parameters of the oscillation by certified least squares, and quantities derived from them: the paper's
//! Table 3 and the derived parameters.

use results::ComparisonResult;

use super::parts::WordTable;
use super::verdict::passed;
use crate::format::{
    count, duration, exact, fixed, interval, percent, quantity, significant, with_uncertainty,
};
use crate::tables::{Fact, fact};

/// Returns the parameters of the oscillation from the envelope and certified least squares.
pub(super) fn parameters(result: &ComparisonResult) -> WordTable {
    let (oracle, derived) = (&result.oracle, &result.derived);
    let (amplitude, unit) = initial_amplitude(result);
    let rows = [
        ("Period T", significant(derived.period_s, 6), "s"),
        ("Frequency f", significant(derived.frequency_hz, 6), "Hz"),
        ("Angular frequency ω", significant(result.envelope.omega_rad_s, 6), "rad/s"),
        ("Decay rate λ", with_uncertainty(oracle.decay_rate, oracle.std_error), "1/s"),
        ("Initial amplitude A₀", significant(amplitude, 4), unit),
        ("Fit quality R²", fixed(oracle.r_squared, 4), NONE),
        ("Damping ratio ζ", with_uncertainty(oracle.zeta, oracle.zeta_std_error), NONE),
        ("95 % interval of ζ", interval(oracle.zeta_interval_95), NONE),
        ("ζ to eight digits, whatever its standard error", significant(oracle.zeta, 8), NONE),
    ];
    WordTable {
        id: "oscillation",
        title: "Table 3: oscillation parameters".to_owned(),
        note: "By certified least squares of ln A on t; λ = −slope, ζ = λ/√(λ² + ω²) (in the paper's pipeline λ/ω), and A₀ is \
               the amplitude at the first peak. The standard errors and the interval assume independent residuals and \
               take ω as known."
            .to_owned(),
        columns: ["Parameter", "Value ± standard error", "Unit"],
        rows: rows.map(|(name, value, unit)| [name.to_owned(), value, unit.to_owned()]).into(),
        is_prose: false,
    }
}

/// Placeholder for a missing unit.
const NONE: &str = "–";

/// Returns the amplitude at the first peak; that of an angle is in degrees.
fn initial_amplitude(result: &ComparisonResult) -> (f64, &str) {
    let amplitude = result.oracle.log_amplitude.exp();
    match result.data.unit.as_str() {
        "rad" => (amplitude.to_degrees(), "degrees"),
        unit => (amplitude, unit),
    }
}

/// Returns the quantities that follow from frequency, decay rate and moment of inertia.
pub(super) fn derived(result: &ComparisonResult) -> WordTable {
    let (oracle, derived) = (&result.oracle, &result.derived);
    // To first order, every quantity proportional to λ or to 1/λ has λ's relative standard error.
    let relative = (oracle.std_error / oracle.decay_rate).abs();
    let with = |value: f64| with_uncertainty(value, value.abs() * relative);
    let stiffness = significant(derived.stiffness_n_m_per_rad, 4);
    let damping = with(derived.damping_n_m_s_per_rad);
    let critical = significant(derived.critical_damping_n_m_s_per_rad, 4);
    let mechanical = if derived.per_unit_of_inertia {
        vec![
            ("Stiffness per unit of inertia", stiffness, "1/s²", "k/I = (λ/ζ)²"),
            ("Damping per unit of inertia", damping, "1/s", "c/I = 2·λ"),
            ("Critical damping per unit of inertia", critical, "1/s", "2·λ/ζ"),
        ]
    } else {
        vec![
            ("Moment of inertia I", significant(derived.inertia_kg_m2, 4), "kg·m²", "as configured"),
            ("Stiffness k", stiffness, "N·m/rad", "k = I·(λ/ζ)²"),
            ("Damping coefficient c", damping, "N·m·s/rad", "c = 2·I·λ"),
            ("Critical damping", critical, "N·m·s/rad", "c_crit = 2·√(k·I)"),
        ]
    };
    let others = [
        ("Quality factor Q", with(derived.quality_factor), "", "Q = 1/(2ζ)"),
        ("Cycles to 1/e of the amplitude", with(derived.cycles_to_one_over_e), "", "ω/(2π·λ)"),
        ("Half-life of the amplitude", with(derived.half_life_s), "s", "ln 2/λ"),
        ("Time constant of the amplitude", with(derived.time_constant_s), "s", "1/λ"),
    ];
    WordTable {
        id: "derived",
        title: "Derived parameters".to_owned(),
        note: "The standard errors follow from that of λ to first order. I and ω are taken as known, so \
               quantities that depend only on them have no standard error. A record does not determine I: it \
               comes from the configuration (compare.inertia_kg_m2); without it, the numbers are per unit of \
               inertia."
            .to_owned(),
        columns: ["Parameter", "Value ± standard error", "Formula"],
        rows: mechanical
            .into_iter()
            .chain(others)
            .map(|(name, value, unit, formula)| [name.to_owned(), quantity(&value, unit), formula.to_owned()])
            .collect(),
        is_prose: false,
    }
}

/// Returns the summary of the comparison for one card.
pub(super) fn summary(result: &ComparisonResult) -> Vec<Fact> {
    let oracle = &result.oracle;
    let (amplitude, unit) = initial_amplitude(result);
    let (within, held) = passed(result);
    vec![
        fact("Damping ratio ζ", with_uncertainty(oracle.zeta, oracle.zeta_std_error)),
        fact("Decay rate λ", quantity(&with_uncertainty(oracle.decay_rate, oracle.std_error), "1/s")),
        fact("Frequency f", quantity(&significant(result.derived.frequency_hz, 4), "Hz")),
        fact("Initial amplitude A₀", quantity(&significant(amplitude, 4), unit)),
        fact("Fit quality R²", fixed(oracle.r_squared, 4)),
        fact("Quality factor Q", significant(result.derived.quality_factor, 4)),
        fact("Methods within tolerance", format!("{within} of {held}")),
        fact("Stated tolerance", quantity(&exact(result.tolerance_percent), "%")),
        fact("Largest difference in ζ", percent(result.max_error_percent)),
        fact("Seeds of methods that draw", format!("{} from {} on", count(result.seeds), result.seed)),
        fact("Time for all fits", duration(result.seconds)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::sample;

    #[test]
    fn an_angle_is_given_in_degrees_and_a_length_as_it_is() {
        let mut result = sample::result();
        let table = parameters(&result);
        assert_eq!(table.rows[4][1..], ["34.06".to_owned(), "degrees".to_owned()]);
        result.data.unit = "m".into();
        let table = parameters(&result);
        assert_eq!(table.rows[4][1..], ["0.5945".to_owned(), "m".to_owned()]);
    }

    #[test]
    fn what_follows_from_the_decay_rate_shares_its_relative_standard_error() {
        let table = derived(&sample::result());
        let plain = |row: usize| table.rows[row][1].replace('\u{a0}', " ");
        assert_eq!(plain(4), "57.1 ± 1.3");
        assert_eq!(plain(7), "5.24 ± 0.12 s");
        assert_eq!(plain(1), "0.2380 N·m/rad");
    }
}
