use super::draws::Draws;
use super::integrator_tests::situation;
use crate::effects::{Size, Wanted, find};
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Coordinate};
use seed::Seed;

fn random_effect(id: &str, wanted: &Wanted<'_>, draws: &mut Draws) -> (Active, f64) {
    let effect = find(id).unwrap();
    let Size::Expected(of) = effect.size else { panic!("{id} is not random") };
    let found = of(wanted, draws);
    (Active::of(effect.effect, &found.values).unwrap(), found.detectability)
}

/// Returns ‖Δ‖² of a chain's only effect on values and timestamps, divided by the square of the stated
/// detectability and averaged over draws.
///
/// A timestamp error dt counts as an error θ̇·dt of the value. The mean error of all timestamps is not
/// counted, because another initial state absorbs it.
fn ratio(id: &str, wanted: f64, draws: u64) -> f64 {
    let situation = situation(false);
    let motion = situation.motions(&[]).unwrap().remove(0);
    let velocities: f64 = motion.velocity.iter().map(|velocity| velocity * velocity).sum();
    let white = 1.3e-3;
    let total: f64 = (0..draws)
        .map(|number| {
            let seed = Seed::new(number);
            let wanted =
                Wanted { situation: &situation, square_velocities: velocities, white, detectability: wanted };
            let (active, detectability) = random_effect(id, &wanted, &mut Draws::new(&seed));
            let chain = Chain::new(Observed::Position, 0.0, vec![active]).unwrap();
            let seen =
                chain.observe(&motion.sampled(), Coordinate::Angle, |id| seed.child(id).generator()).unwrap();
            let late = seen.stamps_s.iter().zip(&seen.times_s).map(|(stamp, time)| stamp - time);
            let mean = late.clone().sum::<f64>() / seen.stamps_s.len() as f64;
            let squares: f64 = late
                .zip(seen.values.iter().zip(&motion.position))
                .zip(&motion.velocity)
                .map(|((late, (value, clean)), velocity)| (value - clean - velocity * (late - mean)).powi(2))
                .sum();
            squares / (white * detectability).powi(2)
        })
        .sum();
    total / draws as f64
}

#[test]
fn random_effects_are_as_large_as_stated() {
    for (id, wanted, draws, bar) in [
        ("sensor_quantization", 25.0, 20, 0.05),
        ("timestamp_jitter", 25.0, 40, 0.05),
        // Chi-square distributed, with twelve degrees of freedom on average.
        ("outliers", 25.0, 1000, 0.1),
        ("timestamp_batching", 25.0, 60, 0.1),
    ] {
        let found = ratio(id, wanted, draws);
        assert!((found - 1.0).abs() < bar, "{id} {found}");
    }
}

#[test]
fn dropouts_lose_the_share_that_stands_for_their_size() {
    let situation = situation(false);
    for (wanted, share) in [(3.0, 0.006), (25.0, 0.05), (100.0, 0.2), (1000.0, 0.3)] {
        let mut draws = Draws::new(&Seed::new(1));
        let wanted =
            Wanted { situation: &situation, square_velocities: 1.0, white: 1e-3, detectability: wanted };
        let (active, detectability) = random_effect("dropouts", &wanted, &mut draws);
        assert!((active.values()[0] - share).abs() < 1e-12 && detectability == 0.0);
    }
}
