//! Splits of an envelope's peaks into fitted and held-out peaks.

use crate::error::StudyError;
use experiment::PredictionSettings;
use results::SplitKind;

/// Split of the peaks into fitted and held-out ones. The first peak is always fitted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Split {
    /// Purpose of the split: interpolation or extrapolation.
    pub kind: SplitKind,
    /// For each peak, in order, the number of the block with which it is held out; `None` if it is fitted.
    pub held_out: Vec<Option<usize>>,
}

/// Minimum number of peaks in a fit.
const FEWEST_SEEN: usize = 6;

/// Returns all splits of a problem's peaks: the folds of interpolation first, extrapolation last.
///
/// Interpolation divides the peaks into blocks of `block_peaks`. Each fold holds out one of `every`
/// successive blocks, never the first and never the last block, so that held-out peaks lie between fitted
/// ones. Extrapolation holds out the last `last_share` of the peaks as one block.
///
/// # Errors
/// [`StudyError::Split`] if a fit would have fewer than six peaks, or if there are fewer than three blocks.
pub(crate) fn splits(
    problem: &str,
    peaks: usize,
    settings: &PredictionSettings,
) -> Result<Vec<Split>, StudyError> {
    let refuse = |missing| StudyError::Split { problem: problem.to_owned(), peaks, missing };
    let blocks = peaks.div_ceil(settings.block_peaks);
    let inner = blocks.saturating_sub(2);
    if inner == 0 {
        return Err(refuse("interpolation needs three blocks"));
    }
    let fold = |fold: usize| Split {
        kind: SplitKind::Interpolation,
        held_out: (0..peaks)
            .map(|peak| peak / settings.block_peaks)
            .map(|block| {
                let is_held = block > 0 && block <= inner && (block - 1) % settings.every == fold;
                is_held.then_some(block)
            })
            .collect(),
    };
    let mut splits: Vec<Split> = (0..settings.every.min(inner)).map(fold).collect();
    let last = ((peaks as f64 * settings.last_share).round() as usize).max(1);
    let seen = peaks.saturating_sub(last);
    splits.push(Split {
        kind: SplitKind::Extrapolation,
        held_out: (0..peaks).map(|peak| (peak >= seen).then_some(0)).collect(),
    });
    let too_few = splits.iter().any(|split| split.seen().count() < FEWEST_SEEN);
    if too_few { Err(refuse("a fit needs six peaks")) } else { Ok(splits) }
}

impl Split {
    /// Returns the indices of the fitted peaks.
    pub fn seen(&self) -> impl Iterator<Item = usize> + '_ {
        self.held_out.iter().enumerate().filter(|(_, block)| block.is_none()).map(|(peak, _)| peak)
    }

    /// Selects the fitted peaks' entries from a list with one entry per peak.
    #[must_use]
    pub fn seen_of(&self, values: &[f64]) -> Vec<f64> {
        self.seen().filter_map(|peak| values.get(peak).copied()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Split, splits};
    use experiment::{PredictionSettings, resolve_prediction};
    use results::SplitKind;
    use settings::Document;

    fn settings(overrides: &str) -> PredictionSettings {
        let text = format!(
            "task = \"predict\"\n[predict]\n{overrides}\n[problem.a]\nkind = \"exponential\"\ndecay_rate = 1\n\
             scatter_size = 0\n"
        );
        resolve_prediction(&Document::parse("a.toml", &text).unwrap(), &[], &[]).unwrap().settings
    }

    #[test]
    fn every_inner_peak_is_held_out_once_and_the_ends_never() {
        let all = splits("a", 70, &settings("")).unwrap();
        let (folds, end): (Vec<&Split>, Vec<&Split>) =
            all.iter().partition(|split| split.kind == SplitKind::Interpolation);
        assert_eq!((folds.len(), end.len()), (4, 1));
        for peak in 0..70 {
            let times = folds.iter().filter(|fold| fold.held_out[peak].is_some()).count();
            // There are 24 blocks of three peaks, the last with one peak.
            assert_eq!(times, usize::from((3..69).contains(&peak)), "{peak}");
        }
        for fold in folds {
            for (peak, block) in fold.held_out.iter().enumerate() {
                assert!(block.is_none_or(|block| block == peak / 3));
            }
        }
        assert_eq!(end[0].held_out.iter().flatten().count(), 23);
        assert!(end[0].held_out[46].is_none() && end[0].held_out[47].is_some());
    }

    #[test]
    fn too_few_peaks_are_refused_with_numbers() {
        let message =
            |peaks, settings: &PredictionSettings| splits("a", peaks, settings).unwrap_err().to_string();
        assert!(
            message(6, &settings("")).starts_with("problem.a: 6 peaks cannot be split: interpolation needs")
        );
        assert!(message(20, &settings("last_share = 0.8")).contains("a fit needs six peaks"));
    }
}
