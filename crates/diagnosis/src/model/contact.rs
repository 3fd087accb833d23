//! Deflection of a contact that bends before it slides, at the start of a segment in the middle of a swing.

/// Hidden state of Dahl's law and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bent {
    pub(crate) z: f64,
    pub(crate) by_deflection: f64,
    pub(crate) by_quadrature: f64,
    pub(crate) by_displacement: f64,
}

/// Computes the hidden state z of Dahl's law in a steady swing, at a deflection and a velocity over the
/// frequency, both in the unit of the displacement δ.
///
/// From a reversal on, z = s − (s − z₀)·exp(−path/δ) with the direction s; in a steady swing of amplitude A
/// it runs between ±tanh(A/δ).
pub(crate) fn bent(deflection: f64, quadrature: f64, displacement: f64) -> Bent {
    let amplitude = libm::hypot(deflection, quadrature);
    let direction = if quadrature < 0.0 { -1.0 } else { 1.0 };
    let path = (amplitude + direction * deflection).max(0.0) / displacement;
    let reversal = libm::tanh(amplitude / displacement);
    let left = libm::exp(-path);
    // Derivatives by the amplitude over δ, and by the path over δ.
    let (by_reversal, by_path) = (-(1.0 - reversal * reversal) * left, (1.0 + reversal) * left);
    let cosine = if amplitude > 0.0 { deflection / amplitude } else { 0.0 };
    let sine = if amplitude > 0.0 { quadrature / amplitude } else { 0.0 };
    let each = direction / displacement;
    Bent {
        z: direction * (1.0 - (1.0 + reversal) * left),
        by_deflection: each * (by_reversal * cosine + by_path * (cosine + direction)),
        by_quadrature: each * (by_reversal + by_path) * sine,
        by_displacement: -each * (by_reversal * amplitude / displacement + by_path * path),
    }
}

#[cfg(test)]
mod tests {
    use super::bent;

    #[test]
    fn derivatives_are_those_of_the_state() {
        for (x, y, d) in [(0.3, 0.2, 0.1), (-0.31, 0.02, 0.1), (0.2, -0.3, 0.4), (-0.3, -0.01, 0.05)] {
            let h = 1e-6;
            let at = bent(x, y, d);
            let by = |ahead: f64, behind: f64| (ahead - behind) / (2.0 * h);
            assert!((at.by_deflection - by(bent(x + h, y, d).z, bent(x - h, y, d).z)).abs() < 1e-7);
            assert!((at.by_quadrature - by(bent(x, y + h, d).z, bent(x, y - h, d).z)).abs() < 1e-7);
            assert!((at.by_displacement - by(bent(x, y, d + h).z, bent(x, y, d - h).z)).abs() < 1e-7);
        }
    }

    /// At a reversal the state is the same on either side, and at rest nothing is bent.
    #[test]
    fn a_reversal_is_no_jump() {
        let (before, after) = (bent(-0.3, -1e-12, 0.1).z, bent(-0.3, 1e-12, 0.1).z);
        assert!(
            (before - after).abs() < 1e-9 && (before + (3.0_f64).tanh()).abs() < 1e-2,
            "{before} {after}"
        );
        let rest = bent(0.0, 0.0, 0.1);
        assert_eq!(rest.z, 0.0);
        assert!(rest.by_deflection.is_finite() && rest.by_quadrature.is_finite());
    }
}
