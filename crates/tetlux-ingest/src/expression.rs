//! Formulas in x, y and z.

use glam::DVec3;

/// Deepest nesting of brackets, powers and signs: bounds the parser's recursion.
const DEEPEST: usize = 64;

/// A formula in the coordinates x, y and z, as `exp(-(x^2 + y^2)) * sin(2*pi*z)`.
///
/// Numbers, `pi`, `x`, `y`, `z`, brackets, `+ - * /`, `^` (binds to the right, and before a sign: `-x^2` is
/// `-(x^2)`), `sin cos tan exp log sqrt abs` of one value, `min max pow` of two. `log` is the natural logarithm.
/// Where a value does not exist, as `log(-1)`, it is NaN.
///
/// ```
/// use tetlux_ingest::Expression;
///
/// let formula = Expression::parse("max(x, 2*y) - z^2")?;
/// assert_eq!(formula.value([1.0, 3.0, 2.0].into()), 2.0);
/// assert_eq!(Expression::parse("x + (y").unwrap_err().column, 7);
/// # Ok::<(), tetlux_ingest::ExpressionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Expression {
    /// As it was given.
    text: String,
    /// Steps in postfix order.
    steps: Vec<Step>,
}

/// What is wrong with a formula, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{text}\", column {column}: found {found}, but {expected}")]
pub struct ExpressionError {
    /// The formula.
    pub text: String,
    /// The place in it, in characters from 1.
    pub column: usize,
    /// What is there.
    pub found: String,
    /// What should be.
    pub expected: String,
}

#[derive(Debug, Clone, Copy)]
enum Step {
    Number(f64),
    Coordinate(usize),
    One(One),
    Two(Two),
}

type One = fn(f64) -> f64;
type Two = fn(f64, f64) -> f64;

/// The functions of one value.
const ONE: [(&str, One); 7] = [
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("exp", f64::exp),
    ("log", f64::ln),
    ("sqrt", f64::sqrt),
    ("abs", f64::abs),
];
/// The functions of two values.
const TWO: [(&str, Two); 3] = [("min", f64::min), ("max", f64::max), ("pow", f64::powf)];
const NAMES: &str = "a number, x, y, z, pi, a bracket or one of sin cos tan exp log sqrt abs min max pow must be here";

impl Expression {
    /// Reads a formula.
    pub fn parse(text: &str) -> Result<Expression, ExpressionError> {
        let mut parser = Parser { text, at: 0, steps: Vec::new(), depth: 0 };
        parser.sum()?;
        if parser.peek().is_some() {
            return Err(parser.error("an operator or the end must be here"));
        }
        Ok(Expression { text: text.into(), steps: parser.steps })
    }

    /// The formula as it was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The value at a point.
    pub fn value(&self, at: DVec3) -> f64 {
        self.evaluate(at, &mut Vec::new())
    }

    /// The values at points.
    pub fn values(&self, points: &[DVec3]) -> Vec<f64> {
        let mut stack = Vec::new();
        points.iter().map(|&p| self.evaluate(p, &mut stack)).collect()
    }

    fn evaluate(&self, at: DVec3, stack: &mut Vec<f64>) -> f64 {
        stack.clear();
        // The parser gives each step its operands: none is ever missing.
        let pop = |stack: &mut Vec<f64>| stack.pop().unwrap_or(f64::NAN);
        for step in &self.steps {
            let value = match *step {
                Step::Number(value) => value,
                Step::Coordinate(axis) => at[axis],
                Step::One(f) => f(pop(stack)),
                Step::Two(f) => {
                    let b = pop(stack);
                    f(pop(stack), b)
                }
            };
            stack.push(value);
        }
        pop(stack)
    }
}

struct Parser<'a> {
    text: &'a str,
    /// Bytes read.
    at: usize,
    steps: Vec<Step>,
    depth: usize,
}

impl<'a> Parser<'a> {
    /// The next character that is no blank.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Moves past one of these characters if it is next.
    fn take(&mut self, any: &[char]) -> Option<char> {
        let next = self.peek().filter(|c| any.contains(c))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn need(&mut self, c: char) -> Result<(), ExpressionError> {
        self.take(&[c]).map(drop).ok_or_else(|| self.error(format!("\"{c}\" must be here")))
    }

    /// Terms with + and - between them.
    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.product()?;
        while let Some(sign) = self.take(&['+', '-']) {
            self.product()?;
            self.steps.push(Step::Two(if sign == '+' { |a, b| a + b } else { |a, b| a - b }));
        }
        Ok(())
    }

    /// Factors with * and / between them.
    fn product(&mut self) -> Result<(), ExpressionError> {
        self.signed()?;
        while let Some(sign) = self.take(&['*', '/']) {
            self.signed()?;
            self.steps.push(Step::Two(if sign == '*' { |a, b| a * b } else { |a, b| a / b }));
        }
        Ok(())
    }

    /// A power with or without a sign. Every nesting passes through here.
    fn signed(&mut self) -> Result<(), ExpressionError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("no more than {DEEPEST} brackets, powers and signs may nest")));
        }
        match self.take(&['-', '+']) {
            Some(sign) => {
                self.signed()?;
                if sign == '-' {
                    self.steps.push(Step::One(|a| -a));
                }
            }
            None => {
                self.operand()?;
                if self.take(&['^']).is_some() {
                    self.signed()?;
                    self.steps.push(Step::Two(f64::powf));
                }
            }
        }
        self.depth -= 1;
        Ok(())
    }

    /// A number, a name, a call, or a sum in brackets.
    fn operand(&mut self) -> Result<(), ExpressionError> {
        match self.peek() {
            Some('(') => {
                self.need('(')?;
                self.sum()?;
                self.need(')')
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() => self.name(),
            _ => Err(self.error(NAMES)),
        }
    }

    fn number(&mut self) -> Result<(), ExpressionError> {
        let rest = &self.text.as_bytes()[self.at..];
        let digits = |from: usize| rest[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut length = digits(0);
        if rest.get(length) == Some(&b'.') {
            length += 1 + digits(length + 1);
        }
        if matches!(rest.get(length), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.get(length + 1), Some(b'+' | b'-')));
            let exponent = digits((length + 1 + sign).min(rest.len()));
            length += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        let value = self.text[self.at..self.at + length].parse().map_err(|_| self.error("a number must be here"))?;
        self.steps.push(Step::Number(value));
        self.at += length;
        Ok(())
    }

    fn name(&mut self) -> Result<(), ExpressionError> {
        let rest = &self.text[self.at..];
        let name = &rest[..rest.bytes().take_while(u8::is_ascii_alphanumeric).count()];
        let (one, two) = (ONE.iter().find(|f| f.0 == name), TWO.iter().find(|f| f.0 == name));
        let value = match name {
            "x" => Some(Step::Coordinate(0)),
            "y" => Some(Step::Coordinate(1)),
            "z" => Some(Step::Coordinate(2)),
            "pi" => Some(Step::Number(std::f64::consts::PI)),
            _ if one.is_none() && two.is_none() => return Err(self.error(NAMES)),
            _ => None,
        };
        self.at += name.len();
        if let Some(value) = value {
            self.steps.push(value);
            return Ok(());
        }
        self.need('(')?;
        self.sum()?;
        if let Some(&(_, f)) = two {
            self.need(',')?;
            self.sum()?;
            self.steps.push(Step::Two(f));
        }
        self.steps.extend(one.map(|&(_, f)| Step::One(f)));
        self.need(')')
    }

    /// That what is next is not as expected.
    fn error(&mut self, expected: impl Into<String>) -> ExpressionError {
        let found = match self.peek() {
            None => "the end".to_string(),
            Some(c) if c.is_ascii_alphanumeric() => {
                let rest = &self.text[self.at..];
                let length = rest.bytes().take_while(u8::is_ascii_alphanumeric).count();
                format!("\"{}\"", crate::source::excerpt(&rest[..length]))
            }
            Some(c) => format!("\"{c}\""),
        };
        let column = self.text[..self.at].chars().count() + 1;
        ExpressionError { text: crate::source::excerpt(self.text), column, found, expected: expected.into() }
    }
}

#[cfg(test)]
mod tests;
