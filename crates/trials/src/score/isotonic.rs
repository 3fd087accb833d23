//! Monotonic map from stated to observed probabilities.

use results::ProbabilityMap;

/// Smallest number of cases that a map is fitted to: the mean of a block with fewer than six cases scatters
/// by 0.2, and there is more than one block.
const FEWEST: usize = 20;

/// Block of cases at the same level: sums of stated probabilities and of outcomes, and their count.
#[derive(Debug, Clone, Copy)]
struct Block {
    stated: f64,
    found: f64,
    count: f64,
}

impl Block {
    fn level(&self) -> f64 {
        self.found / self.count
    }
}

/// Fits a nondecreasing map by least squares, pooling adjacent violators. Each knot lies at the mean of a
/// block's stated probabilities. With too few cases, the map has no knots and changes nothing.
///
/// # Reference
/// M. Ayer, H. D. Brunk, G. M. Ewing, W. T. Reid, E. Silverman, Ann. Math. Statist. 26 (1955) 641–647.
pub(crate) fn fit(statements: &[(f64, bool)]) -> ProbabilityMap {
    let method = "isotonic, pooling adjacent violators, on every second case of the own banks".to_owned();
    let fitted_to = statements.len() as u64;
    if statements.len() < FEWEST {
        return ProbabilityMap { method, knots: Vec::new(), fitted_to };
    }
    let mut sorted = statements.to_vec();
    sorted.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut blocks: Vec<Block> = Vec::new();
    for (stated, so) in sorted {
        let mut block = Block { stated, found: f64::from(u8::from(so)), count: 1.0 };
        // Equal statements belong to one block whatever their outcomes.
        while let Some(last) = blocks.last().copied() {
            let same = last.stated / last.count == block.stated / block.count;
            if !same && last.level() < block.level() {
                break;
            }
            blocks.pop();
            block = Block {
                stated: last.stated + block.stated,
                found: last.found + block.found,
                count: last.count + block.count,
            };
        }
        blocks.push(block);
    }
    let knots = blocks.iter().map(|block| [block.stated / block.count, block.level()]).collect();
    ProbabilityMap { method, knots, fitted_to }
}

/// Applies a map to a probability: linear between knots, constant beyond them, unchanged without knots.
pub(crate) fn at(map: &ProbabilityMap, stated: f64) -> f64 {
    let (Some([first, low]), Some([last, high])) = (map.knots.first(), map.knots.last()) else {
        return stated;
    };
    if stated <= *first {
        return *low;
    }
    if stated >= *last {
        return *high;
    }
    let pairs = map.knots.iter().zip(map.knots.iter().skip(1));
    let inside = pairs.filter(|(_, [to, _])| stated <= *to).map(|([from, a], [to, b])| {
        let share = if to > from { (stated - from) / (to - from) } else { 1.0 };
        a + share * (b - a)
    });
    inside.take(1).last().unwrap_or(*high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn violators_are_pooled() {
        // Outcomes 0 1 0 1 1 are pooled to 0, ½, 1 (the textbook's example), five times over.
        let cases: Vec<(f64, bool)> = [(0.1, false), (0.2, true), (0.3, false), (0.4, true), (0.5, true)]
            .into_iter()
            .flat_map(|case| [case; 5])
            .collect();
        let map = fit(&cases);
        let levels: Vec<f64> = map.knots.iter().map(|knot| knot[1]).collect();
        assert_eq!(levels.first(), Some(&0.0));
        assert!(levels.contains(&0.5) && levels.last() == Some(&1.0), "{levels:?}");
        assert!((at(&map, 0.25) - 0.5).abs() < 1e-12);
        assert_eq!((at(&map, 0.0), at(&map, 1.0)), (0.0, 1.0));
        let mut last = 0.0;
        for step in 0..=100 {
            let value = at(&map, f64::from(step) / 100.0);
            assert!(value >= last);
            last = value;
        }
    }

    #[test]
    fn too_few_cases_change_nothing() {
        let map = fit(&[(0.3, true); 19]);
        assert!(map.knots.is_empty());
        assert_eq!(at(&map, 0.3), 0.3);
    }
}
