//! Expressions in a few variables, such as x, y and z, compiled to programs for a stack.

mod number;
#[cfg(test)]
mod tests;

pub use number::{Dual, Interval, Number};

use std::fmt;

/// Longest expression, bytes.
const MOST_LETTERS: usize = 4096;
/// Deepest nesting.
const MOST_NESTED: u32 = 64;
/// Most operations.
const MOST_OPERATIONS: usize = 1024;
/// Deepest stack that nesting allows: three operands wait at each level.
const MOST_WAITING: usize = 4 * MOST_NESTED as usize;
/// A stack that most programs are content with.
const FEW_WAITING: usize = 12;
/// Largest whole exponent that is done by multiplying.
const MOST_POWER: f64 = 1024.0;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Op {
    Constant(f64),
    Variable(usize),
    Add,
    Sub,
    Mul,
    Div,
    Negate,
    /// A whole exponent.
    Power(i32),
    /// `exp(b log a)`.
    RealPower,
    Function(Function),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Function {
    Min,
    Max,
    Abs,
    Sqrt,
    Sin,
    Cos,
    Exp,
    Log,
    Floor,
}

const FUNCTIONS: [(&str, Function, u32); 9] = [
    ("min", Function::Min, 2),
    ("max", Function::Max, 2),
    ("abs", Function::Abs, 1),
    ("sqrt", Function::Sqrt, 1),
    ("sin", Function::Sin, 1),
    ("cos", Function::Cos, 1),
    ("exp", Function::Exp, 1),
    ("log", Function::Log, 1),
    ("floor", Function::Floor, 1),
];

/// Fault of an expression's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Column of the fault, in letters from one; `None` if it is of the whole.
    pub column: Option<usize>,
    /// The fault in words.
    pub what: String,
    /// A name that is not known, where that is the fault.
    pub name: Option<String>,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.column {
            Some(column) => write!(f, "column {column}: {}", self.what),
            None => f.write_str(&self.what),
        }
    }
}

impl std::error::Error for Fault {}

/// A function of `N` variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression<const N: usize> {
    ops: Vec<Op>,
    /// Most operands that wait at once.
    waiting: usize,
}

impl<const N: usize> Expression<N> {
    /// From its text: numbers, the variables, `pi`, `+ - * / ^`, parentheses, and the functions `min`, `max` (of two or
    /// more), `abs`, `sqrt`, `sin`, `cos`, `exp`, `log`, `floor`. `^` binds to the right and before a sign: `-x^2` is
    /// `-(x^2)`.
    ///
    /// # Errors
    /// [`Fault`] with what was expected, and in which column.
    pub fn new(text: &str, variables: &[&str; N]) -> Result<Self, Fault> {
        let of_all = |what| Fault { column: None, what, name: None };
        if text.len() > MOST_LETTERS {
            return Err(of_all(format!("an expression has {MOST_LETTERS} letters at most, this one {}", text.len())));
        }
        let mut parser = Parser { text, variables, at: 0, nested: 0, ops: Vec::new(), depth: 0, most: 0 };
        parser.sum()?;
        match parser.peek() {
            None if parser.most <= MOST_WAITING => Ok(Self { ops: parser.ops, waiting: parser.most }),
            None => Err(of_all(format!("expressions nest {MOST_NESTED} deep at most"))),
            Some(_) => Err(parser.expected("an operator or the end")),
        }
    }

    /// All names that an expression may have.
    pub fn names<'a>(variables: &[&'a str; N]) -> impl Iterator<Item = &'a str> {
        variables.iter().copied().chain(["pi"]).chain(FUNCTIONS.iter().map(|f| f.0))
    }

    /// The value at a point, in any arithmetic.
    pub fn value<T: Number>(&self, p: [T; N]) -> T {
        if self.waiting <= FEW_WAITING { self.run::<T, FEW_WAITING>(p) } else { self.run::<T, MOST_WAITING>(p) }
    }

    fn run<T: Number, const DEPTH: usize>(&self, p: [T; N]) -> T {
        let mut stack = [T::constant(0.0); DEPTH];
        let mut n = 0;
        for op in &self.ops {
            let takes = match op {
                Op::Constant(_) | Op::Variable(_) => 0,
                Op::Negate | Op::Power(_) => 1,
                Op::Function(f) if !matches!(f, Function::Min | Function::Max) => 1,
                _ => 2,
            };
            n -= takes;
            let (a, b) = (stack[n], stack[(n + 1).min(DEPTH - 1)]);
            stack[n] = match *op {
                Op::Constant(v) => T::constant(v),
                Op::Variable(k) => p[k],
                Op::Add => a.add(b),
                Op::Sub => a.sub(b),
                Op::Mul => a.mul(b),
                Op::Div => a.div(b),
                Op::Negate => T::constant(0.0).sub(a),
                Op::Power(2) => a.square(),
                Op::Power(4) => a.square().square(),
                Op::Power(k) if k < 0 => T::constant(1.0).div(a.power(k.unsigned_abs())),
                Op::Power(k) => a.power(k.unsigned_abs()),
                Op::RealPower => b.mul(a.log()).exp(),
                Op::Function(Function::Min) => a.min(b),
                Op::Function(Function::Max) => a.max(b),
                Op::Function(Function::Abs) => a.abs(),
                Op::Function(Function::Sqrt) => a.sqrt(),
                Op::Function(Function::Sin) => a.sin(),
                Op::Function(Function::Cos) => a.cos(),
                Op::Function(Function::Exp) => a.exp(),
                Op::Function(Function::Log) => a.log(),
                Op::Function(Function::Floor) => a.floor(),
            };
            n += 1;
        }
        stack[0]
    }

    /// Value and gradient at a point, by derivatives carried along.
    pub fn sample(&self, p: [f64; N]) -> (f64, [f64; N]) {
        let along = |axis| self.value(std::array::from_fn(|k| Dual::new(p[k], if k == axis { 1.0 } else { 0.0 })));
        let all: [Dual<f64>; N] = std::array::from_fn(along);
        (all.first().map_or_else(|| self.value(p), |dual| dual.value), all.map(|dual| dual.slope))
    }

    /// True if the value can depend on a variable.
    pub fn uses(&self, variable: usize) -> bool {
        self.ops.contains(&Op::Variable(variable))
    }

    /// Number of operations.
    pub fn operations(&self) -> usize {
        self.ops.len()
    }

    /// Bytes held beyond its own.
    pub fn bytes(&self) -> usize {
        self.ops.capacity() * size_of::<Op>()
    }
}

struct Parser<'a> {
    text: &'a str,
    variables: &'a [&'a str],
    at: usize,
    nested: u32,
    ops: Vec<Op>,
    depth: usize,
    most: usize,
}

impl<'a> Parser<'a> {
    fn peek(&mut self) -> Option<u8> {
        let rest = &self.text.as_bytes()[self.at..];
        self.at += rest.iter().take_while(|c| c.is_ascii_whitespace()).count();
        self.text.as_bytes().get(self.at).copied()
    }

    fn takes(&mut self, c: u8) -> bool {
        let is = self.peek() == Some(c);
        self.at += usize::from(is);
        is
    }

    fn column(&self, at: usize) -> usize {
        self.text.get(..at).map_or(at, |t| t.chars().count()) + 1
    }

    fn fault(&self, at: usize, what: String) -> Fault {
        Fault { column: Some(self.column(at)), what, name: None }
    }

    fn expected(&mut self, what: &str) -> Fault {
        let found = match self.peek() {
            None => "the end".into(),
            Some(_) => {
                self.text.get(self.at..).and_then(|t| t.chars().next()).map_or(String::new(), |c| format!("'{c}'"))
            }
        };
        self.fault(self.at, format!("expected {what}, found {found}"))
    }

    fn push(&mut self, op: Op, takes: usize) -> Result<(), Fault> {
        if self.ops.len() == MOST_OPERATIONS {
            let what = format!("an expression has {MOST_OPERATIONS} operations at most");
            return Err(self.fault(self.at, what));
        }
        self.ops.push(op);
        self.depth = self.depth + 1 - takes;
        self.most = self.most.max(self.depth);
        Ok(())
    }

    fn sum(&mut self) -> Result<(), Fault> {
        self.product()?;
        loop {
            let op = match self.peek() {
                Some(b'+') => Op::Add,
                Some(b'-') => Op::Sub,
                _ => return Ok(()),
            };
            self.at += 1;
            self.product()?;
            self.push(op, 2)?;
        }
    }

    fn product(&mut self) -> Result<(), Fault> {
        self.signed()?;
        loop {
            let op = match self.peek() {
                Some(b'*') => Op::Mul,
                Some(b'/') => Op::Div,
                _ => return Ok(()),
            };
            self.at += 1;
            self.signed()?;
            self.push(op, 2)?;
        }
    }

    /// Parses an operand with its signs and its power. All nesting goes through here.
    fn signed(&mut self) -> Result<(), Fault> {
        self.nested += 1;
        if self.nested > MOST_NESTED {
            return Err(self.fault(self.at, format!("expressions nest {MOST_NESTED} deep at most")));
        }
        if self.takes(b'-') {
            self.signed()?;
            match self.ops.last_mut() {
                Some(Op::Constant(v)) => *v = -*v,
                _ => self.push(Op::Negate, 1)?,
            }
        } else if self.takes(b'+') {
            self.signed()?;
        } else {
            self.atom()?;
            if self.takes(b'^') {
                let first = self.ops.len();
                self.signed()?;
                match self.ops[first..] {
                    [Op::Constant(v)] if v.fract() == 0.0 && v.abs() <= MOST_POWER => {
                        self.ops.pop();
                        self.depth -= 1;
                        self.push(Op::Power(v as i32), 1)?;
                    }
                    _ => self.push(Op::RealPower, 2)?,
                }
            }
        }
        self.nested -= 1;
        Ok(())
    }

    fn atom(&mut self) -> Result<(), Fault> {
        match self.peek() {
            Some(b'(') => {
                self.at += 1;
                self.sum()?;
                if self.takes(b')') { Ok(()) } else { Err(self.expected("an operator or ')'")) }
            }
            Some(c) if c.is_ascii_digit() || c == b'.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() => self.name(),
            _ => {
                let variables = self.variables.join(", ");
                Err(self.expected(&format!("a number, {variables}, pi, a function or '('")))
            }
        }
    }

    fn number(&mut self) -> Result<(), Fault> {
        let rest = &self.text.as_bytes()[self.at..];
        let digits = |from: usize| rest[from.min(rest.len())..].iter().take_while(|c| c.is_ascii_digit()).count();
        let mut n = digits(0);
        if rest.get(n) == Some(&b'.') {
            n += 1 + digits(n + 1);
        }
        if matches!(rest.get(n), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.get(n + 1), Some(b'+' | b'-')));
            let power = digits(n + 1 + sign);
            n += if power > 0 { 1 + sign + power } else { 0 };
        }
        let value = self.text[self.at..self.at + n].parse::<f64>().ok().filter(|v| v.is_finite());
        let Some(value) = value else { return Err(self.expected("a number")) };
        self.at += n;
        self.push(Op::Constant(value), 0)
    }

    fn name(&mut self) -> Result<(), Fault> {
        let rest: &'a str = &self.text[self.at..];
        let name = &rest[..rest.bytes().take_while(|c| c.is_ascii_alphanumeric() || *c == b'_').count()];
        let start = self.at;
        self.at += name.len();
        if let Some(variable) = self.variables.iter().position(|known| *known == name) {
            return self.push(Op::Variable(variable), 0);
        }
        if name == "pi" {
            return self.push(Op::Constant(std::f64::consts::PI), 0);
        }
        let Some((_, function, count)) = FUNCTIONS.iter().find(|f| f.0 == name) else {
            let functions = FUNCTIONS.map(|f| f.0).join(", ");
            let variables = self.variables.join(", ");
            let what = format!("expected {variables}, pi or a function ({functions}), found '{name}'");
            return Err(Fault { name: Some(name.to_owned()), ..self.fault(start, what) });
        };
        if !self.takes(b'(') {
            return Err(self.expected(&format!("'(' after {name}")));
        }
        self.sum()?;
        if *count == 1 {
            self.push(Op::Function(*function), 1)?;
        } else if self.peek() != Some(b',') {
            return Err(self.expected(&format!("',' and what else {name} is of")));
        }
        while *count == 2 && self.takes(b',') {
            self.sum()?;
            self.push(Op::Function(*function), 2)?;
        }
        if self.takes(b')') { Ok(()) } else { Err(self.expected("an operator or ')'")) }
    }
}
