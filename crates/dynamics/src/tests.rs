//! Tests of the registry, and of every law against its description.

use crate::fixtures::{at, moment};
use crate::scalar::{Dual, Scalar};
use crate::{
    Active, Class, MOST_HIDDEN, Moment, Nominal, REGISTRY, Start, System, SystemEffect, UNNAMED, Values,
};
use num_complex::Complex64;
use std::collections::BTreeSet;

#[test]
fn descriptions_are_complete() {
    let unique: BTreeSet<&str> = REGISTRY.iter().map(|effect| effect.id()).collect();
    assert_eq!(unique.len(), REGISTRY.len());
    for effect in REGISTRY.iter().chain(UNNAMED) {
        let description = effect.description();
        let id = description.id;
        for text in [
            description.title,
            description.equation,
            description.latex,
            description.tell_tale,
            description.reference,
        ] {
            assert!(!text.is_empty(), "{id}");
        }
        assert!(!description.parameters.is_empty() && description.parameters.len() <= crate::MOST_PARAMETERS);
        let names: BTreeSet<&str> = description.parameters.iter().map(|parameter| parameter.name).collect();
        assert_eq!(names.len(), description.parameters.len(), "{id}");
        for parameter in description.parameters {
            assert!(!parameter.symbol.is_empty() && !parameter.meaning.is_empty(), "{id}");
        }
        for other in description.confused_with {
            assert!(REGISTRY.iter().any(|effect| effect.id() == *other), "{id}: {other}");
            assert_ne!(*other, id);
        }
        assert!(description.hidden_states <= MOST_HIDDEN, "{id}");
        // Active::new refuses values that are too few, too many or out of range.
        Active::new(id, description.example).unwrap();
    }
    let hidden: usize = SystemEffect::ALL.iter().map(|effect| effect.description().hidden_states).sum();
    assert!(hidden <= crate::SYSTEM_HIDDEN);
}

fn values(effect: SystemEffect) -> Values<f64> {
    match effect {
        SystemEffect::StribeckFriction => [0.4, 0.9, 1.1, 0.0],
        SystemEffect::EndStop => [0.3, 50.0, 0.2, 0.0],
        SystemEffect::Hysteresis => [0.7, 0.9, 0.4, 1.7],
        _ => [0.7, 0.9, 1.3, 0.0],
    }
}

#[test]
fn duals_agree_with_the_complex_step_in_every_law() {
    const STEP: f64 = 1e-40;
    fn evaluate<S: Scalar>(effect: SystemEffect, state: (f64, f64, i8), shift: S, which: usize) -> [S; 3] {
        let mut own = values(effect).map(S::from);
        if let Some(value) = which.checked_sub(12).and_then(|index| own.get_mut(index)) {
            *value = *value + shift;
        }
        let at = moment(state.0, state.1, state.2, shift, which);
        let [first, second] = effect.hidden_rate(&own, &at);
        [effect.torque(&own, &at), first, second]
    }
    for &effect in SystemEffect::ALL {
        for region in -3..=3 {
            for (position, velocity) in [(0.5, 0.8), (-0.6, -1.2)] {
                for which in 0..16 {
                    let state = (position, velocity, region);
                    let complex = evaluate(effect, state, Complex64::new(0.0, STEP), which);
                    let dual = evaluate(effect, state, Dual::<1>::variable(0.0, 0), which);
                    for (complex, dual) in complex.iter().zip(dual) {
                        let derivative = complex.im / STEP;
                        let error = (derivative - dual.partials[0]).abs();
                        assert!(error <= 1e-13 * (1.0 + derivative.abs()), "{effect:?} {which}");
                        assert!((complex.re - dual.value).abs() <= 1e-14 * (1.0 + dual.value.abs()));
                    }
                }
            }
        }
    }
}

#[test]
fn dissipative_laws_take_energy_out_whatever_the_state() {
    let dissipative = |effect: &&SystemEffect| effect.description().class == Class::Dissipative;
    assert!(SystemEffect::ALL.iter().any(|effect| dissipative(&effect)));
    for effect in SystemEffect::ALL.iter().filter(dissipative) {
        let own = values(*effect);
        for velocity in [-3.0, -0.2, 0.2, 3.0] {
            let mut at = at(0.5, velocity, 0);
            // A contact that slides; energy that it stores while bending is returned.
            at.hidden = [velocity.signum(), 0.0];
            let power = effect.torque(&own, &at) * velocity;
            assert!(power < 0.0, "{effect:?} at {velocity}: {power}");
        }
    }
}

/// Of laws in several files; an effect's own file is the place for further ones.
#[test]
fn the_signs_are_those_of_the_equations() {
    use SystemEffect::{
        AsymmetricStiffness, Backlash, CommandDerivative, ConstantTorque, CoulombFriction, CubicStiffness,
        DampingDrift, DirectionalFriction, DriveDeadBand, EndStop, FlexibleCoupling, FrictionDrift, Gravity,
        Hysteresis, InputDelay, InputSaturation, LoadFriction, PeriodicForcing, PositionTorque,
        QuadraticDrag, SpeedTorqueLimit, StiffnessDrift, StribeckFriction, TorqueLimit, UnlistedDamping,
        UnlistedStiffness,
    };
    let at = at(0.5, 0.8, 0);
    // Depth beyond the stop at 0.3.
    let depth = 0.2;
    // Torque of a servo's drive: input, spring and damping.
    let drive = 1.7 - 5.0 * 0.4 - 0.6 * 0.8;
    let expected = [
        (CoulombFriction, 0, -0.7),
        (StribeckFriction, 0, -0.4),
        (StribeckFriction, 1, -(0.4 + 0.5 * (-(0.8 / 1.1_f64).powi(2)).exp())),
        (QuadraticDrag, 0, -0.7 * 0.8 * 0.8),
        (CubicStiffness, 0, -0.7 * 0.4_f64.powi(3)),
        (AsymmetricStiffness, 0, -0.7 * 0.4_f64.powi(2)),
        (Gravity, 0, -0.7 * 1.4_f64.sin()),
        (ConstantTorque, 0, 0.7),
        (Backlash, 0, 5.0 * 0.4),
        (Backlash, 1, 5.0 * 0.7),
        (Backlash, -1, -5.0 * 0.7),
        (Hysteresis, 0, -0.7 * 0.3),
        (EndStop, 1, 0.0),
        (EndStop, 2, -50.0 * depth * (1.0 + 0.2 * 0.8)),
        (EndStop, 3, 0.0),
        (StiffnessDrift, 0, -5.0 * 0.7 * 2.3 * 0.4),
        (DampingDrift, 0, -0.6 * 0.7 * 2.3 * 0.8),
        (PositionTorque, 0, -0.7 * (0.9 * 0.5 + 1.3_f64).sin()),
        (UnlistedDamping, 0, -(0.7 * 0.8_f64.powi(3) + 0.9 * 0.16 * 0.8)),
        (UnlistedStiffness, 0, -0.7 * 0.4_f64.powi(5)),
        (PeriodicForcing, 0, 0.7 * (0.9 * 2.3 + 1.3_f64).sin()),
        (FlexibleCoupling, 0, 0.9 * (0.3 - 0.5) + 1.3 * (-0.8 - 0.8)),
        (CommandDerivative, 0, 0.7 * 0.8),
        (InputDelay, 0, 0.0),
        (InputSaturation, 0, 0.0),
        (InputSaturation, 1, 0.7 - 1.7),
        (InputSaturation, -1, -0.7 - 1.7),
        (TorqueLimit, 0, 0.0),
        (TorqueLimit, 1, 0.7 - drive),
        (TorqueLimit, -1, -0.7 - drive),
        (LoadFriction, 1, -(0.7 + 0.9 * drive)),
        (LoadFriction, -1, -(0.7 - 0.9 * drive)),
        (DirectionalFriction, 0, -(0.7 + 0.45)),
        (FrictionDrift, 0, -0.7 * (0.9 * 2.3_f64).exp()),
        (DriveDeadBand, 0, -(1.7 - 5.0 * 0.4)),
        (DriveDeadBand, 1, -5.0 * 0.7),
        (DriveDeadBand, -1, 5.0 * 0.7),
        (SpeedTorqueLimit, 0, 0.0),
        (SpeedTorqueLimit, 1, 0.7 * (1.0 - 0.8 / 0.9) - drive),
        (SpeedTorqueLimit, -1, -0.7 - drive),
    ];
    for (effect, region, expected) in expected {
        let found = effect.torque(&values(effect), &Moment { region, ..at });
        assert!((found - expected).abs() < 1e-14, "{effect:?} {region}: {found}, not {expected}");
    }
    let [rate, _] = Hysteresis.hidden_rate(&values(Hysteresis), &at);
    assert!((rate - (0.8 - 0.8 * 0.3) / 0.9).abs() < 1e-14);
    for (region, part) in [(2, -1.0 + 0.4), (3, 1.0 + 0.4)] {
        let size = 0.3 * f64::from(2 * region - 5);
        let power = size * (1.0 + 0.7 * (size - 1.0) - 0.5 * 0.7 * 0.3 * (size - 1.0).powi(2));
        let [rate, _] = Hysteresis.hidden_rate(&values(Hysteresis), &Moment { region, ..at });
        assert!((rate - 0.8 * (1.0 - power * part) / 0.9).abs() < 1e-14, "{region}: {rate}");
    }
    let [velocity, acceleration] = FlexibleCoupling.hidden_rate(&values(FlexibleCoupling), &at);
    let expected = -(0.9 * (0.3 - 0.5) + 1.3 * (-0.8 - 0.8)) / 0.7;
    assert!(velocity == -0.8 && (acceleration - expected).abs() < 1e-14);
}

#[test]
fn a_region_has_positive_margins_in_its_inside() {
    for &effect in SystemEffect::ALL {
        let own = values(effect);
        for position in [-1.4, -0.3, 0.05, 0.25, 0.5, 1.5] {
            for velocity in [-8.0, -0.3, 0.4, 9.0] {
                let mut at = at(position, velocity, 0);
                at.region = effect.region(&own, &at);
                for (edge, margin) in effect.margins(&own, &at).into_iter().enumerate() {
                    let Some(margin) = margin else { continue };
                    assert!(margin > 0.0, "{effect:?} {position} {velocity}: {margin}");
                    assert_ne!(effect.beyond(at.region, edge), at.region, "{effect:?}");
                }
            }
        }
    }
}

#[test]
fn the_contact_never_pulls() {
    let effect = SystemEffect::EndStop;
    for stop in [0.3, -0.2] {
        let own = [stop, 50.0, 0.2, 0.0];
        for position in [-1.0, -0.21, 0.0, 0.31, 0.9] {
            for velocity in [-40.0, -4.0, 0.0, 4.0, 40.0] {
                let mut at = at(position, velocity, 0);
                at.region = effect.region(&own, &at);
                let push = -effect.torque(&own, &at) * (stop - 0.1_f64).signum();
                assert!(push >= 0.0, "{stop} {position} {velocity}: {push}");
            }
        }
    }
}

/// Nominal coefficients, an effect, and the words of the error that rejects them.
type Refused<'a> = ([f64; 4], (&'a str, &'a [f64]), &'a str);

#[test]
fn impossible_parameters_are_named_with_their_range() {
    let refusal = |nominal: [f64; 4], effects: &[(&str, &[f64])]| {
        let [inertia, damping, stiffness, rest_angle] = nominal;
        let system = Nominal::new(inertia, damping, stiffness, rest_angle).and_then(|nominal| {
            let effects = effects.iter().map(|(id, values)| Active::new(id, values));
            System::new(nominal, effects.collect::<Result<_, _>>()?)
        });
        let released = system.and_then(|system| system.check_release(Start::release(0.3)));
        released.unwrap_err().to_string()
    };
    let plain = [1.0, 0.2, 484.0, 0.0];
    let above = "expected a finite number above 0";
    let cases: &[Refused<'_>] = &[
        ([-1.0, 0.2, 484.0, 0.0], ("gravity", &[1.0, 0.0]), &format!("nominal `inertia` is -1; {above}")),
        (
            [1.0, 0.2, f64::NAN, 0.0],
            ("gravity", &[1.0, 0.0]),
            "nominal `stiffness` is NaN; expected a finite",
        ),
        (plain, ("periodic_forcing", &[1.0, 0.0, 0.0]), &format!("`frequency` is 0; {above}")),
        (plain, ("coulomb_friction", &[-0.1]), "`torque` is -0.1; expected a finite number"),
        (plain, ("stribeck_friction", &[0.5, 0.4, 1.0]), "`static_torque` is 0.4, but must be at least 0.5"),
        (plain, ("backlash", &[0.31]), "the dead zone of `backlash`, ±0.31, is wider than the release, 0.3"),
        (plain, ("end_stop", &[0.0, 1e4, 0.1]), "`angle` is 0, but must be above or below 0"),
        (plain, ("sensor_lag", &[0.1]), "`sensor_lag` belongs to the measurement chain"),
        (plain, ("gravity", &[1.0]), "`gravity` takes 2 values, not 1"),
        (plain, ("columb_friction", &[1.0]), "unknown effect `columb_friction`; known are coulomb_friction"),
    ];
    for (nominal, effect, expected) in cases {
        let message = refusal(*nominal, &[*effect]);
        assert!(message.contains(expected), "no `{expected}` in: {message}");
    }
    let twice = refusal(plain, &[("coulomb_friction", &[0.1]), ("coulomb_friction", &[0.2])]);
    assert_eq!(twice, "`coulomb_friction` is given twice; combine the two into one");
}
