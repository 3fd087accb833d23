//! A torque without a name in the place of effects that can sit where they like.
//!
//! What no law of the vocabulary explains is soaked up by several flexible effects at once, and each of these then seems to be
//! needed. A law that is none of them but explains the same in one piece shows that they are not. The torque along the position
//! is such a law: it is fitted beside the best sets of plain laws wherever the best set of all has a flexible member.

use crate::data::segments::Data;
use crate::evidence::weights::{EVEN, Weighing};
use crate::explain::position_torque::beside;
use crate::fit::levenberg_marquardt::Fit;
use crate::search::archive::Archive;
use rayon::prelude::*;

/// Sets of plain laws that it is fitted beside.
const SETS: usize = 2;

/// Takes the best sets of plain laws with a torque without a name into an archive.
pub(crate) fn nameless(data: &Data, calibrated: &Fit, archive: &mut Archive, vocabulary: usize) {
    let weighing = Weighing::of(data, calibrated, archive, vocabulary);
    let weighed = weighing.weigh(archive);
    if weighed.first().is_none_or(|best| best.fit.hypothesis.flexible() == 0) {
        return;
    }
    let plain = weighed.iter().map(|own| own.fit).filter(|fit| fit.hypothesis.is_plain());
    let plain: Vec<&Fit> = plain.take(SETS).collect();
    let fitted: Vec<Option<Fit>> = plain
        .par_iter()
        .map(|set| beside(data, set, set.autocorrelation_time(), EVEN).ok().flatten())
        .collect();
    for fit in fitted.into_iter().flatten() {
        archive.admit(data, fit);
    }
}
