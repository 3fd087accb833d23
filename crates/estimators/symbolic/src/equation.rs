//! Expressions as equations in the time t, simplified for reading.

use crate::data::Data;
use crate::expression::{Expression, Node};
use crate::operators::{Binary, Unary};
use std::fmt;

/// Highest power of t to which products of sums are multiplied out; beyond, digits would cancel.
const HIGHEST_POWER: u32 = 4;

/// Sum of terms and a constant: the normal form, in which equal terms are merged.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Equation {
    offset: f64,
    /// Factors, with the terms that they multiply; no two terms are equal.
    terms: Vec<(f64, Core)>,
}

/// Term without its factor.
#[derive(Debug, Clone, PartialEq)]
enum Core {
    /// Power of t, from 1 on.
    Power(u32),
    Call(Unary, Box<Equation>),
    Product(Box<Equation>, Box<Equation>),
    Quotient(Box<Equation>, Box<Equation>),
}

impl Equation {
    /// Converts an expression in scaled units to ln A as a function of the time in seconds after the first
    /// peak.
    pub(crate) fn new(expression: &Expression, data: &Data) -> Self {
        let mut stack: Vec<Self> = Vec::new();
        for node in expression.nodes() {
            let mut pop = || stack.pop().unwrap_or(Self::constant(f64::NAN));
            let equation = match node {
                Node::Constant(value) => Self::constant(*value),
                Node::Time => {
                    Self { offset: 0.0, terms: vec![(1.0 / data.scaling.duration(), Core::Power(1))] }
                }
                Node::Unary(operator) => pop().called(*operator),
                Node::Binary(operator) => {
                    let right = pop();
                    let left = pop();
                    match operator {
                        Binary::Add => left.plus(right),
                        Binary::Subtract => left.plus(right.times_factor(-1.0)),
                        Binary::Multiply => left.times(right),
                        Binary::Divide => left.over(right),
                    }
                }
            };
            stack.push(equation);
        }
        let scaled = stack.pop().unwrap_or(Self::constant(f64::NAN));
        scaled.times_factor(data.scaling.spread()).plus(Self::constant(data.scaling.mean()))
    }

    fn constant(offset: f64) -> Self {
        Self { offset, terms: Vec::new() }
    }

    fn of(core: Core) -> Self {
        Self { offset: 0.0, terms: vec![(1.0, core)] }
    }

    /// Returns the value if the equation is a constant.
    fn as_constant(&self) -> Option<f64> {
        self.terms.is_empty().then_some(self.offset)
    }

    /// Returns the only term if there is just one, so that its factor can be moved out.
    fn as_single(&self) -> Option<&(f64, Core)> {
        match self.terms.as_slice() {
            [term] if self.offset == 0.0 => Some(term),
            _ => None,
        }
    }

    /// Returns factor and degree of a single power of t.
    fn as_power(&self) -> Option<(f64, u32)> {
        match self.as_single()? {
            (factor, Core::Power(power)) => Some((*factor, *power)),
            _ => None,
        }
    }

    /// Returns the degree if the equation is a polynomial in t.
    fn degree(&self) -> Option<u32> {
        self.terms.iter().try_fold(0, |degree, (_, core)| match core {
            Core::Power(power) => Some(degree.max(*power)),
            _ => None,
        })
    }

    fn plus(mut self, other: Self) -> Self {
        self.offset += other.offset;
        for (factor, core) in other.terms {
            match self.terms.iter_mut().find(|(_, known)| *known == core) {
                Some((known, _)) => *known += factor,
                None => self.terms.push((factor, core)),
            }
        }
        self.terms.retain(|(factor, _)| *factor != 0.0);
        self
    }

    fn times_factor(mut self, factor: f64) -> Self {
        self.offset *= factor;
        self.terms.iter_mut().for_each(|(own, _)| *own *= factor);
        self.terms.retain(|(factor, _)| *factor != 0.0);
        self
    }

    fn times(self, other: Self) -> Self {
        if let Some(factor) = other.as_constant() {
            return self.times_factor(factor);
        }
        if let Some(factor) = self.as_constant() {
            return other.times_factor(factor);
        }
        let degree = self.degree().zip(other.degree()).map(|(one, other)| one + other);
        if degree.is_some_and(|degree| degree <= HIGHEST_POWER) {
            return self.multiplied_out(&other);
        }
        if self.as_power().is_some() {
            return other.distributed(&self);
        }
        if other.as_power().is_some() {
            return self.distributed(&other);
        }
        let (one, left) = self.normalized();
        let (two, right) = other.normalized();
        Self::of(Core::Product(Box::new(left), Box::new(right))).times_factor(one * two)
    }

    /// Returns the product with a single power of t, term by term.
    fn distributed(&self, power: &Self) -> Self {
        let Some((factor, degree)) = power.as_power() else { return self.clone() };
        let constant = power.clone().times_factor(self.offset);
        let terms = self.terms.iter().map(|(own, core)| {
            let raised = match core {
                Core::Power(own) => Core::Power(own + degree),
                Core::Quotient(above, below) => {
                    let power = Self::of(Core::Power(degree));
                    Core::Quotient(Box::new(above.as_ref().clone().times(power)), below.clone())
                }
                _ => Core::Product(Box::new(Self::of(Core::Power(degree))), Box::new(Self::of(core.clone()))),
            };
            Self::of(raised).times_factor(own * factor)
        });
        terms.fold(constant, Self::plus)
    }

    /// Returns the product of two polynomials.
    fn multiplied_out(&self, other: &Self) -> Self {
        let monomials = |equation: &Self| -> Vec<(f64, u32)> {
            let powers = equation.terms.iter().filter_map(|(factor, core)| match core {
                Core::Power(power) => Some((*factor, *power)),
                _ => None,
            });
            std::iter::once((equation.offset, 0)).chain(powers).collect()
        };
        let mut product = Self::constant(0.0);
        for (one, low) in monomials(self) {
            for (two, high) in monomials(other) {
                product = product.plus(match low + high {
                    0 => Self::constant(one * two),
                    power => Self::of(Core::Power(power)).times_factor(one * two),
                });
            }
        }
        product
    }

    fn over(self, other: Self) -> Self {
        if let Some(divisor) = other.as_constant() {
            let mut quotient = self;
            quotient.offset /= divisor;
            quotient.terms.iter_mut().for_each(|(factor, _)| *factor /= divisor);
            return quotient;
        }
        if self == other {
            return Self::constant(1.0);
        }
        let (one, above) = match self.as_constant() {
            Some(value) => (value, Self::constant(1.0)),
            None => self.normalized(),
        };
        let (two, below) = other.normalized();
        Self::of(Core::Quotient(Box::new(above), Box::new(below))).times_factor(one / two)
    }

    fn called(self, operator: Unary) -> Self {
        if let Some(value) = self.as_constant() {
            return Self::constant(operator.value(value));
        }
        match operator {
            Unary::Square if self.degree().is_some_and(|degree| 2 * degree <= HIGHEST_POWER) => {
                self.multiplied_out(&self)
            }
            Unary::Square => {
                if let Some((factor, power)) = self.as_power() {
                    return Self::of(Core::Power(2 * power)).times_factor(factor * factor);
                }
                if let Some((factor, Core::Call(Unary::Exp, of))) = self.as_single() {
                    let double = Box::new(of.as_ref().clone().times_factor(2.0));
                    return Self::of(Core::Call(Unary::Exp, double)).times_factor(factor * factor);
                }
                let (factor, core) = self.normalized();
                Self::of(Core::Call(operator, Box::new(core))).times_factor(factor * factor)
            }
            // exp(a + u) = exp(a)·exp(u), unless exp(a) leaves the range of doubles.
            Unary::Exp if self.offset.exp().is_normal() => {
                let factor = self.offset.exp();
                let rest = Self { offset: 0.0, ..self };
                Self::of(Core::Call(operator, Box::new(rest))).times_factor(factor)
            }
            _ => Self::of(Core::Call(operator, Box::new(self))),
        }
    }

    /// Returns the factor of a single term, and the equation without it.
    fn normalized(self) -> (f64, Self) {
        match self.as_single() {
            Some((factor, core)) => (*factor, Self::of(core.clone())),
            None => (1.0, self),
        }
    }

    /// Returns the number of terms, including the constant.
    fn size(&self) -> usize {
        self.terms.len() + usize::from(self.offset != 0.0 || self.terms.is_empty())
    }

    /// Writes the equation for use within a product: in brackets if it is a sum or a negative number.
    fn bracketed(&self) -> String {
        if self.size() > 1 || self.terms.iter().any(|(factor, _)| *factor < 0.0) || self.offset < 0.0 {
            format!("({self})")
        } else {
            self.to_string()
        }
    }

    #[cfg(test)]
    fn value(&self, t: f64) -> f64 {
        let core = |core: &Core| match core {
            Core::Power(power) => t.powi(*power as i32),
            Core::Call(operator, of) => operator.value(of.value(t)),
            Core::Product(one, other) => one.value(t) * other.value(t),
            Core::Quotient(one, other) => one.value(t) / other.value(t),
        };
        self.offset + self.terms.iter().map(|(factor, of)| factor * core(of)).sum::<f64>()
    }
}

impl fmt::Display for Core {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Power(1) => write!(f, "t"),
            Self::Power(power) => write!(f, "t^{power}"),
            Self::Call(Unary::Square, of) => write!(f, "({of})^2"),
            Self::Call(operator, of) => write!(f, "{}({of})", operator.name()),
            Self::Product(one, other) => write!(f, "{}*{}", one.bracketed(), other.bracketed()),
            Self::Quotient(one, other) => write!(f, "{}/({other})", one.bracketed()),
        }
    }
}

impl fmt::Display for Equation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut powers: Vec<&(f64, Core)> = self.terms.iter().collect();
        // Powers of t first, from the lowest; then the other terms in the order of the expression.
        powers.sort_by_key(|(_, core)| match core {
            Core::Power(power) => *power,
            _ => u32::MAX,
        });
        let mut first = true;
        if self.offset != 0.0 || powers.is_empty() {
            write!(f, "{}", number(self.offset))?;
            first = false;
        }
        for (factor, core) in powers {
            let sign = match (first, *factor < 0.0) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            first = false;
            let size = number(factor.abs());
            if let Core::Quotient(above, below) = core
                && above.as_constant() == Some(1.0)
            {
                write!(f, "{sign}{size}/({below})")?;
                continue;
            }
            if size == "1" { write!(f, "{sign}{core}")? } else { write!(f, "{sign}{size}*{core}")? }
        }
        Ok(())
    }
}

/// Formats a number with eight digits, without trailing zeros.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let rounded: f64 = format!("{value:.7e}").parse().unwrap_or(value);
    if (1e-4..1e7).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::Workspace;
    use crate::variation::Grammar;
    use envelope::Envelope;
    use seed::Seed;

    fn data() -> Data {
        Data::new(&Envelope::new(vec![0.0, 1.0, 2.5, 4.0], vec![0.1, -1.0, -1.8, -3.0], 6.0).unwrap())
            .unwrap()
    }

    #[test]
    fn an_equation_has_the_values_of_its_expression() {
        let (data, grammar) = (data(), Grammar { depth: 5, sine: true });
        let mut generator = Seed::new(1).generator();
        let mut compared = 0;
        for index in 0..3000 {
            let expression = grammar.ramped(index, &mut generator);
            let equation = Equation::new(&expression, &data);
            for x in [0.2, 0.7] {
                let direct = data.scaling.log_amplitude(Workspace::default().values(&expression, &[x])[0]);
                let found = equation.value(x * data.scaling.duration());
                if direct.is_finite() && direct.abs() < 1e6 && found.is_finite() {
                    assert!(
                        (found - direct).abs() < 1e-6 * (1.0 + direct.abs()),
                        "{expression:?} {equation}"
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 3000, "{compared}");
    }

    #[test]
    fn a_line_reads_as_a_line_however_it_was_built() {
        let data = data();
        let [constant, time] = [Expression::constant(-2.0), Expression::time()];
        // The expression is (x − 2)·(−2) + (x·x − x·x) + x/x.
        let shifted = Expression::binary(Binary::Add, time.clone(), &constant);
        let scaled = Expression::binary(Binary::Multiply, shifted, &constant);
        let square = Expression::unary(Unary::Square, time.clone());
        let nothing = Expression::binary(Binary::Subtract, square.clone(), &square);
        let one = Expression::binary(Binary::Divide, time.clone(), &time);
        let sum = Expression::binary(Binary::Add, Expression::binary(Binary::Add, scaled, &nothing), &one);
        let (offset, slope) =
            (data.scaling.mean() + 5.0 * data.scaling.spread(), 2.0 * data.scaling.spread() / 4.0);
        let text = Equation::new(&sum, &data).to_string();
        assert_eq!(text, format!("{} - {}*t", number(offset), number(slope)));
    }

    #[test]
    fn numbers_are_short() {
        let written = [0.1 + 0.2, -1e-9, 1e12, 12345.678912, 0.0, 1.0].map(number);
        assert_eq!(written, ["0.3", "-1e-9", "1e12", "12345.679", "0", "1"]);
    }
}
