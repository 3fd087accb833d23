//! Parser for expressions, by recursive descent.

use super::{Expression, Function, Operator, Variable};
use std::str::FromStr;
use thiserror::Error;

/// Reason why a text is not an expression.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{text}` cannot be read at character {at}: {problem}")]
pub struct Unreadable {
    /// The text.
    pub text: String,
    /// Position of the fault, counted in characters from 1.
    pub at: usize,
    /// The fault, and what was expected.
    pub problem: String,
}

/// Deepest nesting allowed.
const DEEPEST: usize = 64;

/// Largest exponent allowed.
const LARGEST: i32 = 20;

struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl FromStr for Expression {
    type Err = Unreadable;

    fn from_str(text: &str) -> Result<Self, Unreadable> {
        let mut reader = Reader { text, at: 0, depth: 0 };
        let found = reader.sum()?;
        match reader.peek() {
            None => Ok(found),
            Some(other) => {
                Err(reader.wrong(format!("`{other}` follows a whole expression; expected an operator")))
            }
        }
    }
}

impl TryFrom<String> for Expression {
    type Error = Unreadable;

    fn try_from(text: String) -> Result<Self, Unreadable> {
        text.parse()
    }
}

impl Reader<'_> {
    fn wrong(&self, problem: impl Into<String>) -> Unreadable {
        let at = self.text[..self.at].chars().count() + 1;
        Unreadable { text: self.text.to_owned(), at, problem: problem.into() }
    }

    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    /// Skips spaces and returns the next character.
    fn peek(&mut self) -> Option<char> {
        self.at += self.rest().len() - self.rest().trim_start().len();
        self.rest().chars().next()
    }

    fn takes(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    fn closed_by(&mut self, mark: char) -> Result<(), Unreadable> {
        if self.takes(mark) { Ok(()) } else { Err(self.wrong(format!("expected `{mark}`"))) }
    }

    fn sum(&mut self) -> Result<Expression, Unreadable> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.wrong(format!("nested deeper than {DEEPEST}")));
        }
        let mut left = self.product()?;
        loop {
            let operator = match self.peek() {
                Some('+') => Operator::Add,
                Some('-') => Operator::Subtract,
                _ => break,
            };
            self.at += 1;
            left = Expression::Join(operator, Box::new(left), Box::new(self.product()?));
        }
        self.depth -= 1;
        Ok(left)
    }

    fn product(&mut self) -> Result<Expression, Unreadable> {
        let mut left = self.signed()?;
        loop {
            let operator = match self.peek() {
                Some('*') => Operator::Multiply,
                Some('/') => Operator::Divide,
                _ => return Ok(left),
            };
            self.at += 1;
            left = Expression::Join(operator, Box::new(left), Box::new(self.signed()?));
        }
    }

    fn signed(&mut self) -> Result<Expression, Unreadable> {
        if !self.takes('-') {
            return self.power();
        }
        Ok(match self.power()? {
            Expression::Number(value) => Expression::Number(-value),
            other => {
                Expression::Join(Operator::Multiply, Box::new(Expression::Number(-1.0)), Box::new(other))
            }
        })
    }

    fn power(&mut self) -> Result<Expression, Unreadable> {
        let base = self.atom()?;
        if !self.takes('^') {
            return Ok(base);
        }
        self.peek();
        let length = self.rest().find(|c: char| !c.is_ascii_digit()).unwrap_or(self.rest().len());
        let exponent = self.rest().get(..length).and_then(|digits| digits.parse::<i32>().ok());
        match exponent.filter(|exponent| (1..=LARGEST).contains(exponent)) {
            Some(exponent) => {
                self.at += length;
                Ok(Expression::Power(Box::new(base), exponent))
            }
            None => Err(self.wrong(format!("expected a whole exponent from 1 to {LARGEST}"))),
        }
    }

    fn atom(&mut self) -> Result<Expression, Unreadable> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                let inner = self.sum()?;
                self.closed_by(')')?;
                Ok(inner)
            }
            Some('|') => {
                self.at += 1;
                let inner = self.sum()?;
                self.closed_by('|')?;
                Ok(Expression::Call(Function::Abs, Box::new(inner)))
            }
            Some(digit) if digit.is_ascii_digit() || digit == '.' => self.number(),
            Some(letter) if letter.is_alphabetic() => self.word(),
            _ => Err(self.wrong("expected a number, a variable, a function or a parenthesis")),
        }
    }

    fn number(&mut self) -> Result<Expression, Unreadable> {
        let rest = self.rest();
        let mut length = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        // An exponent, with an optional sign.
        if let Some(after) = rest.get(length..).and_then(|after| after.strip_prefix(['e', 'E'])) {
            let digits = after.strip_prefix(['+', '-']).unwrap_or(after);
            let count = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
            if count > 0 {
                length += 1 + (after.len() - digits.len()) + count;
            }
        }
        match rest
            .get(..length)
            .and_then(|number| number.parse::<f64>().ok())
            .filter(|value| value.is_finite())
        {
            Some(value) => {
                self.at += length;
                Ok(Expression::Number(value))
            }
            None => Err(self.wrong("this is no number")),
        }
    }

    fn word(&mut self) -> Result<Expression, Unreadable> {
        let rest = self.rest();
        let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let word = rest[..length].to_owned();
        if let Some(variable) = Variable::ALL.into_iter().find(|variable| variable.name() == word) {
            self.at += length;
            return Ok(Expression::Variable(variable));
        }
        if word == "pi" {
            self.at += length;
            return Ok(Expression::Number(std::f64::consts::PI));
        }
        let Some(function) = Function::ALL.into_iter().find(|function| function.name() == word) else {
            let known =
                Variable::ALL.map(Variable::name).into_iter().chain(Function::ALL.map(Function::name));
            let known = known.collect::<Vec<_>>().join(", ");
            return Err(self.wrong(format!("`{word}` is not known; there are {known}, pi")));
        };
        self.at += length;
        self.closed_by('(')?;
        let inner = self.sum()?;
        self.closed_by(')')?;
        Ok(Expression::Call(function, Box::new(inner)))
    }
}
