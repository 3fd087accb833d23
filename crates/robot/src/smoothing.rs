//! Motion of a joint from its samples: position, velocity and acceleration by local quintics.
//!
//! At each sample a polynomial of fifth degree is fitted to the samples about it, by least squares (Savitzky and Golay's filter for
//! samples at any times). The number of samples is the one that predicts left-out samples best. A cubic of as many samples
//! flattens accelerations by several percent, which passes for an armature.
//!
//! # Reference
//! Savitzky, Golay, Analytical Chemistry 36 (1964) 1627. Fan, Gijbels, *Local Polynomial Modelling and Its
//! Applications* (1996).

/// Numbers of samples on each side of the middle one that are tried.
const HALF_WIDTHS: [usize; 12] = [4, 6, 8, 11, 15, 20, 27, 36, 48, 64, 85, 113];

/// Number of coefficients of a polynomial.
const COEFFICIENTS: usize = 6;

/// Number of samples, evenly spread, at which left-out samples are predicted.
const TRIED_AT: usize = 800;

/// Smoothed motion of one joint, by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Positions.
    pub position: Vec<f64>,
    /// Velocities, per second.
    pub velocity: Vec<f64>,
    /// Accelerations, per second squared.
    pub acceleration: Vec<f64>,
    /// Number of samples on each side of the middle one.
    pub half_width: usize,
}

/// Quintic about a sample: its first three derivatives, from the zeroth,, and the weight of the sample in its own prediction.
struct Local {
    derivatives: [f64; 3],
    weight: f64,
}

/// Fits the quintic about a sample to those within a half width; `None` if they do not determine one.
fn local(times: &[f64], values: &[f64], at: usize, half: usize) -> Option<Local> {
    let from = at.saturating_sub(half);
    let to = (at + half + 1).min(times.len());
    let (times_near, values_near) = (times.get(from..to)?, values.get(from..to)?);
    let middle = *times.get(at)?;
    let center = *values.get(at)?;
    let scale = times_near.iter().map(|time| (time - middle).abs()).fold(0.0, f64::max);
    if scale <= 0.0 {
        return None;
    }
    let mut powers = [0.0; 2 * COEFFICIENTS - 1];
    let mut right = [0.0; COEFFICIENTS];
    for (time, value) in times_near.iter().zip(values_near) {
        let x = (time - middle) / scale;
        let mut power = 1.0;
        for (index, slot) in powers.iter_mut().enumerate() {
            *slot += power;
            if let Some(slot) = right.get_mut(index) {
                *slot += power * (value - center);
            }
            power *= x;
        }
    }
    let row = |at: usize| -> Vec<f64> { powers.iter().skip(at).take(COEFFICIENTS).copied().collect() };
    let matrix: Vec<Vec<f64>> = (0..COEFFICIENTS).map(row).collect();
    let solved = dynamics::tree::solved(&matrix, right.to_vec()).ok()?;
    let mut first = vec![0.0; COEFFICIENTS];
    *first.first_mut()? = 1.0;
    let unit = dynamics::tree::solved(&matrix, first).ok()?;
    let [c0, c1, c2, ..] = <[f64; COEFFICIENTS]>::try_from(solved).ok()?;
    Some(Local { derivatives: [center + c0, c1 / scale, 2.0 * c2 / scale.powi(2)], weight: *unit.first()? })
}

/// Returns the mean square error of predictions of left-out samples.
fn left_out(times: &[f64], values: &[f64], half: usize) -> f64 {
    let step = times.len().div_ceil(TRIED_AT).max(1);
    let (mut squares, mut count) = (0.0, 0.0);
    for at in (half..times.len().saturating_sub(half)).step_by(step) {
        let (Some(own), Some(value)) = (local(times, values, at, half), values.get(at)) else { continue };
        let [position, ..] = own.derivatives;
        squares += ((value - position) / (1.0 - own.weight).max(1e-3)).powi(2);
        count += 1.0;
    }
    if count > 0.0 { squares / count } else { f64::INFINITY }
}

/// Smooths the samples of one joint. Times are in seconds, ascending; near the ends, polynomials are one-sided.
#[must_use]
pub fn smoothed(times: &[f64], values: &[f64]) -> Smoothed {
    let tried = HALF_WIDTHS.into_iter().filter(|half| 4 * half < times.len());
    let tried = tried.map(|half| (left_out(times, values, half), half));
    let best = tried.min_by(|one, other| one.0.total_cmp(&other.0));
    // A record of fewer samples than the narrowest window asks for takes that window.
    let half_width = best.map_or(4, |(_, half)| half);
    let mut motion =
        Smoothed { position: Vec::new(), velocity: Vec::new(), acceleration: Vec::new(), half_width };
    for (at, value) in values.iter().enumerate() {
        // Samples at one time determine no motion: it then stands still.
        let [position, velocity, acceleration] =
            local(times, values, at, half_width).map_or([*value, 0.0, 0.0], |own| own.derivatives);
        motion.position.push(position);
        motion.velocity.push(velocity);
        motion.acceleration.push(acceleration);
    }
    motion
}

#[cfg(test)]
mod tests {
    use super::smoothed;

    /// A sine with noise of a thousandth: speed and acceleration come out to a few percent, and a smoother motion
    /// or more noise takes a wider window.
    #[test]
    fn the_window_follows_motion_and_noise() {
        let of = |omega: f64, noise: f64| {
            let times: Vec<f64> = (0..2000).map(|at| f64::from(at) * 2e-3).collect();
            let mut state = 7_u64;
            let mut uniform = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
            };
            let values: Vec<f64> = times.iter().map(|t| (omega * t).sin() + noise * uniform()).collect();
            let motion = smoothed(&times, &values);
            let error = |found: &[f64], truth: &dyn Fn(f64) -> f64, unit: f64| {
                let squares: f64 =
                    times.iter().zip(found).skip(100).take(1800).map(|(t, x)| (x - truth(*t)).powi(2)).sum();
                (squares / 1800.0).sqrt() / unit
            };
            let speed = error(&motion.velocity, &|t| omega * (omega * t).cos(), omega);
            let rate = error(&motion.acceleration, &|t| -omega * omega * (omega * t).sin(), omega * omega);
            (motion.half_width, speed, rate)
        };
        let (narrow, speed, rate) = of(30.0, 1e-3);
        assert!(speed < 0.005 && rate < 0.03, "{speed} {rate}");
        assert!(of(30.0, 2e-2).0 > narrow && of(3.0, 1e-3).0 > narrow);
    }
}
