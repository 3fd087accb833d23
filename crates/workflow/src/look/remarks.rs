//! Remarks on what a log shows, in sentences.

use super::looked::{CRITICAL, FEW_CYCLES, Looked};
use identify::{Mode, regular_part};

/// Relative error of a natural frequency above which it is doubtful whether anything swings: 24 simulated
/// records of noise, white or red, have 4 to 15 % or no frequency.
const HARDLY_KNOWN: f64 = 0.03;

/// Returns a remark on the modes of a record that has several.
fn several(modes: &[Mode]) -> Option<String> {
    (modes.len() > 1).then(|| {
        format!(
            "the record holds {} modes; the numbers above are those of the strongest, and so are those of an estimate, \
             before which the others are subtracted",
            modes.len()
        )
    })
}

impl Looked {
    /// Returns remarks on the motion: too few cycles, no swing, several modes, a hand that moved it, doubtful numbers.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let remarks = [
            self.few_cycles(),
            self.no_swing(),
            several(&self.modes),
            self.uneven(),
            self.one_sided(),
            self.hardly_known(),
            self.growth(),
        ];
        remarks.into_iter().flatten().collect()
    }

    /// Returns a warning if the swing grows, which no passive system does.
    fn growth(&self) -> Option<String> {
        let damping = self.oscillator.damping;
        (damping.value < 0.0 && damping.is_significant()).then(|| {
            "the swing grows: something adds energy to it, which no passive simulator can do; the written \
             damping is 0"
                .to_owned()
        })
    }

    /// Returns a warning if the frequency is so uncertain that the record may hold no swing.
    fn hardly_known(&self) -> Option<String> {
        let frequency = self.oscillator.natural_frequency_hz()?;
        let part = frequency.std_error / frequency.value;
        (part > HARDLY_KNOWN).then(|| {
            format!(
                "the natural frequency is known to {:.0} % only: the record may hold noise and no swing, or a swing that \
                 hardly oscillates",
                100.0 * part
            )
        })
    }

    /// Returns a remark if only a part of the record swings evenly, and not because of another mode.
    fn uneven(&self) -> Option<String> {
        let Looked { look, modes, .. } = self;
        let [from, to] = regular_part(&look.record, &look.clock).filter(|_| modes.len() < 2)?;
        // Times of the clock begin where the stamps do.
        let shift = look.record.stamps_s().first()? - look.clock.start_s();
        Some(format!(
            "amplitude or phase change unevenly outside {from:.2} s to {to:.2} s, as if a hand moved it or friction stopped it \
             there: --from {from:.2} --to {to:.2} read that part alone",
            from = from + shift,
            to = to + shift
        ))
    }

    /// Returns a remark if the values turn back at one level on one side.
    fn one_sided(&self) -> Option<String> {
        self.look.record.stands_on_one_side().then(|| {
            "the values turn back at one level on one side, while those of the other fall: a magnitude, a rectified or a clipped \
             signal does so. A magnitude has twice the frequency of its motion; name a column with a sign with --value"
                .to_owned()
        })
    }

    /// Returns a remark if the record comes to rest without a swing.
    fn no_swing(&self) -> Option<String> {
        let oscillator = &self.oscillator;
        if oscillator.input_gain.is_some() {
            return None;
        }
        match oscillator.damping_ratio() {
            Some(ratio) if ratio.value < CRITICAL => None,
            Some(_) => Some(
                "no oscillation: the record comes to rest without a swing, as a critically damped or overdamped system does"
                    .to_owned(),
            ),
            None => Some(
                "no oscillation: the record comes to rest without a swing, as an overdamped or critically damped system \
                 does, or it drifts, or is sampled less than two and a half times in a cycle; neither a frequency nor a damping ratio \
                 can be read from it"
                    .to_owned(),
            ),
        }
    }

    /// Returns a warning if the record is too short for its decay to show.
    fn few_cycles(&self) -> Option<String> {
        let cycles = self.cycles()?;
        (cycles < FEW_CYCLES).then(|| {
            format!(
                "the record shows {cycles:.1} cycles, too few to see what a simulator lacks; give a record of ten cycles or \
                 more"
            )
        })
    }
}
