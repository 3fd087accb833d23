//! Pareto front of error against complexity, and the choice from it.

use crate::constants::{FULL, HeldOut, fit_constants, held_out};
use crate::data::Data;
use crate::expression::{Expression, Workspace};

/// Expression of the front.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Member {
    pub(crate) expression: Expression,
    /// Mean square error on the peaks it was fitted to, in scaled units.
    pub(crate) loss: f64,
    pub(crate) held_out: HeldOut,
}

/// Smallest relative decrease of the loss by which a more complex expression stays on the front.
const LEAST_GAIN: f64 = 1e-6;

/// Expressions for which none has been found that is both simpler and better: from each to the next the
/// complexity rises and the loss falls.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Front {
    members: Vec<Member>,
}

impl Front {
    pub(crate) fn members(&self) -> &[Member] {
        &self.members
    }

    /// Offers an expression with its loss.
    pub(crate) fn offer(
        &mut self,
        expression: &Expression,
        loss: f64,
        data: &Data,
        workspace: &mut Workspace,
    ) {
        let complexity = expression.complexity();
        let rounding = data.rounding();
        let beaten = self.members.iter().any(|member| {
            let simpler = member.expression.complexity() <= complexity;
            simpler && member.loss <= (loss * (1.0 + LEAST_GAIN)).max(rounding)
        });
        if !loss.is_finite() || beaten || !expression.is_sound() {
            return;
        }
        self.members.retain(|member| {
            member.expression.complexity() < complexity
                || member.loss < loss * (1.0 - LEAST_GAIN) && loss > rounding
        });
        let held_out = held_out(expression, data, workspace);
        let place = self.members.partition_point(|member| member.expression.complexity() < complexity);
        self.members.insert(place, Member { expression: expression.clone(), loss, held_out });
    }

    /// Returns the front with the constants of every expression fitted to these data as far as rounding
    /// allows. Expressions without best constants are left out.
    pub(crate) fn polished(&self, data: &Data, workspace: &mut Workspace) -> Self {
        let mut front = Self::default();
        for member in &self.members {
            let mut expression = member.expression.clone();
            let fitted = fit_constants(&mut expression, data, FULL, workspace);
            if fitted.settled {
                front.offer(&expression, fitted.loss, data, workspace);
            }
        }
        front
    }

    /// Returns the least held-out error on the front.
    pub(crate) fn least_held_out(&self) -> Option<HeldOut> {
        let errors = self.members.iter().map(|member| member.held_out);
        errors.min_by(|one, other| one.mean.total_cmp(&other.mean))
    }

    /// Returns the largest held-out error that counts as adequate: one standard error above the least. Errors
    /// that are due to rounding alone count as zero.
    ///
    /// Reference: Breiman, Friedman, Olshen, Stone, Classification and Regression Trees (1984), section 3.4.3.
    fn bound(&self, data: &Data) -> f64 {
        let least = self.least_held_out().map_or(f64::INFINITY, |least| least.mean + least.std_error);
        least.max(data.rounding())
    }

    /// Returns the simplest adequate expression: the one with the fewest nodes among those whose held-out
    /// error is within one standard error of the least.
    pub(crate) fn simplest_adequate(&self, data: &Data) -> Option<&Member> {
        self.by_preference(data).next()
    }

    /// Returns the adequate expressions, the simplest first, then the others, the best first.
    pub(crate) fn by_preference(&self, data: &Data) -> impl Iterator<Item = &Member> {
        // If no expression has a degree of freedom, the bound is infinite, and the simplest comes first.
        let bound = self.bound(data);
        let adequate = self.members.iter().filter(move |member| member.held_out.mean <= bound);
        let others = self.members.iter().rev().filter(move |member| member.held_out.mean > bound);
        adequate.chain(others)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use envelope::Envelope;

    fn member(complexity: usize, loss: f64, mean: f64) -> Member {
        let mut expression = Expression::time();
        for _ in 1..complexity {
            expression = Expression::unary(crate::operators::Unary::Exp, expression);
        }
        Member { expression, loss, held_out: HeldOut { mean, std_error: 0.3 * mean } }
    }

    fn data() -> Data {
        Data::new(&Envelope::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.0, -1.0, -1.8, -3.0], 6.0).unwrap())
            .unwrap()
    }

    #[test]
    fn the_choice_is_within_one_standard_error_of_the_best() {
        let members =
            vec![member(1, 1.0, 1.1), member(3, 0.12, 0.15), member(5, 0.1, 0.12), member(9, 0.01, 0.2)];
        let front = Front { members };
        assert_eq!(front.simplest_adequate(&data()).unwrap().expression.complexity(), 3);
        let strict = Front { members: vec![member(3, 0.12, 0.16), member(5, 0.1, 0.12)] };
        assert_eq!(strict.simplest_adequate(&data()).unwrap().expression.complexity(), 5);
        assert!(Front::default().simplest_adequate(&data()).is_none());
    }

    #[test]
    fn the_front_falls_as_it_grows() {
        let (data, mut workspace, mut front) = (data(), Workspace::default(), Front::default());
        let bent = |complexity| member(complexity, 0.0, 0.0).expression;
        for (complexity, loss) in
            [(3, 0.5), (1, 1.0), (2, 1.0), (4, 0.5), (3, 0.4), (2, 0.45), (2, f64::INFINITY)]
        {
            front.offer(&bent(complexity), loss, &data, &mut workspace);
        }
        let found: Vec<_> =
            front.members().iter().map(|member| (member.expression.complexity(), member.loss)).collect();
        assert_eq!(found, [(1, 1.0), (2, 0.45), (3, 0.4)]);
        // A perfect fit leaves no room for a more complex expression.
        front.offer(&bent(2), 0.0, &data, &mut workspace);
        assert_eq!(front.members().len(), 2);
    }
}
