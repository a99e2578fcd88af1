//! Interpreter of the GLSL that tone curves are written in: functions of floats, vectors and matrices, without loops.

use std::{collections::HashMap, iter};

/// Value of an expression; what is true is 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f32),
    /// A vector; of `vec2` the last component is 0.
    Vector([f32; 3]),
    /// A matrix, column by column.
    Matrix([[f32; 3]; 3]),
}

use Value::{Matrix, Number, Vector};

#[derive(Clone, Debug)]
enum Expression {
    Literal(f32),
    Name(String),
    Component(Box<Self>, usize),
    Call(String, Vec<Self>),
    Negative(Box<Self>),
    Choice(Box<[Self; 3]>),
}

#[derive(Clone, Debug)]
enum Statement {
    Set(String, Expression),
    Return(Expression),
    If(Expression, Box<Self>, Option<Box<Self>>),
    Block(Vec<Self>),
}

#[derive(Debug)]
struct Function {
    name: String,
    /// Types and names.
    parameters: Vec<(String, String)>,
    body: Statement,
}

/// Functions of a shader.
#[derive(Debug)]
pub struct Shader(Vec<Function>);

/// Names and their values.
pub type Scope = HashMap<String, Value>;

impl Shader {
    /// Reads a shader's text.
    pub fn parse(text: &str) -> Self {
        let mut parser = Parser { words: words(text), at: 0 };
        let mut functions = Vec::new();
        while parser.at < parser.words.len() {
            let (kind, name) = (parser.next(), parser.next());
            if kind == "uniform" {
                (parser.next(), parser.expect(";")).1
            } else {
                functions.push(parser.function(name));
            }
        }
        Self(functions)
    }

    /// Result of a function, given the uniform values.
    pub fn call(&self, name: &str, arguments: &[Value], uniforms: &Scope) -> Value {
        let fits = |kind: &str, value: &Value| match value {
            Number(_) => matches!(kind, "float" | "int" | "bool"),
            Vector(_) => kind.starts_with("vec"),
            Matrix(_) => kind == "mat3",
        };
        let is_meant = |f: &&Function| {
            f.name == name
                && f.parameters.len() == arguments.len()
                && iter::zip(&f.parameters, arguments).all(|(p, a)| fits(&p.0, a))
        };
        let Some(function) = self.0.iter().find(is_meant) else { return built_in(name, arguments) };
        let mut scope = uniforms.clone();
        scope.extend(iter::zip(&function.parameters, arguments).map(|(p, a)| (p.1.clone(), a.clone())));
        self.run(&function.body, &mut scope, uniforms).unwrap_or_else(|| panic!("{name} returns nothing"))
    }

    /// Runs a statement; what it returns, if it does.
    fn run(&self, statement: &Statement, scope: &mut Scope, uniforms: &Scope) -> Option<Value> {
        match statement {
            Statement::Set(name, value) => {
                let value = self.value(value, scope, uniforms);
                scope.insert(name.clone(), value);
                None
            }
            Statement::Return(value) => Some(self.value(value, scope, uniforms)),
            Statement::If(condition, then, otherwise) => {
                let is_true = self.value(condition, scope, uniforms) == Number(1.0);
                let chosen = if is_true { Some(then) } else { otherwise.as_ref() };
                chosen.and_then(|chosen| self.run(chosen, scope, uniforms))
            }
            Statement::Block(all) => all.iter().find_map(|one| self.run(one, scope, uniforms)),
        }
    }

    fn value(&self, expression: &Expression, scope: &Scope, uniforms: &Scope) -> Value {
        let value = |e: &Expression| self.value(e, scope, uniforms);
        match expression {
            Expression::Literal(number) => Number(*number),
            Expression::Name(name) => scope.get(name).unwrap_or_else(|| panic!("{name} is not known")).clone(),
            Expression::Component(of, at) => match value(of) {
                Vector(v) => Number(v[*at]),
                other => panic!("{other:?} has no components"),
            },
            Expression::Call(name, arguments) => {
                self.call(name, &arguments.iter().map(value).collect::<Vec<_>>(), uniforms)
            }
            Expression::Negative(of) => componentwise(&value(of), &Number(0.0), |v, _| -v),
            Expression::Choice(all) => value(&all[if value(&all[0]) == Number(1.0) { 1 } else { 2 }]),
        }
    }
}

/// Operators and functions of the language.
fn built_in(name: &str, arguments: &[Value]) -> Value {
    let both = |f: fn(f32, f32) -> f32| componentwise(&arguments[0], &arguments[1], f);
    let truth = |is: bool| f32::from(u8::from(is));
    match (name, arguments) {
        ("+", _) => both(|a, b| a + b),
        ("-", _) => both(|a, b| a - b),
        ("*", [Matrix(columns), Vector(v)]) => {
            Vector([0, 1, 2].map(|row| (0..3).map(|k| columns[k][row] * v[k]).sum()))
        }
        ("*", _) => both(|a, b| a * b),
        ("/", _) => both(|a, b| a / b),
        ("min", _) => both(f32::min),
        ("max", _) => both(f32::max),
        ("pow", _) => both(f32::powf),
        ("<", [Number(a), Number(b)]) => Number(truth(a < b)),
        ("<=", [Number(a), Number(b)]) => Number(truth(a <= b)),
        ("==", [Number(a), Number(b)]) => Number(truth(a == b)),
        ("equal", [Vector(a), Vector(b)]) => Vector([0, 1, 2].map(|k| truth(a[k] == b[k]))),
        ("log2", [v]) => componentwise(v, v, |v, _| v.log2()),
        ("clamp", [v, low, high]) => componentwise(&componentwise(v, low, f32::max), high, f32::min),
        ("mix", [Vector(a), Vector(b), Vector(part)]) => {
            Vector([0, 1, 2].map(|k| a[k] * (1.0 - part[k]) + b[k] * part[k]))
        }
        ("vec3", [Number(v)]) => Vector([*v; 3]),
        ("vec3", [Number(x), Number(y), Number(z)]) => Vector([*x, *y, *z]),
        ("mat3", all) if all.len() == 9 => {
            let number = |k: usize| if let Number(v) = all[k] { v } else { panic!("{:?} is no number", all[k]) };
            Matrix([0, 1, 2].map(|column| [0, 1, 2].map(|row| number(3 * column + row))))
        }
        _ => panic!("{name} is not known of {arguments:?}"),
    }
}

/// Applies a function to numbers and components of vectors; a number counts as a vector of equal components.
fn componentwise(a: &Value, b: &Value, f: impl Fn(f32, f32) -> f32) -> Value {
    match (a, b) {
        (Number(a), Number(b)) => Number(f(*a, *b)),
        (Vector(a), Number(b)) => Vector(a.map(|a| f(a, *b))),
        (Number(a), Vector(b)) => Vector(b.map(|b| f(*a, b))),
        (Vector(a), Vector(b)) => Vector([0, 1, 2].map(|k| f(a[k], b[k]))),
        _ => panic!("{a:?} and {b:?} have no components"),
    }
}

/// Words of a text: names, numbers, and signs.
fn words(text: &str) -> Vec<String> {
    let text: String = text.lines().flat_map(|line| [line.split("//").next().unwrap_or_default(), "\n"]).collect();
    let mut rest = text.trim_start();
    let mut words = Vec::new();
    while let Some(first) = rest.chars().next() {
        let is_part = |k: usize, c: char| {
            let is_exponent = matches!(c, '-' | '+') && rest[..k].ends_with('e');
            c.is_ascii_alphanumeric() || c == '_' || (first.is_ascii_digit() && (c == '.' || is_exponent))
        };
        let end = match first.is_ascii_alphanumeric() {
            true => rest.char_indices().find(|(k, c)| !is_part(*k, *c)).map_or(rest.len(), |(k, _)| k),
            false if ["<=", "=="].iter().any(|sign| rest.starts_with(sign)) => 2,
            false => first.len_utf8(),
        };
        words.push(rest[..end].to_owned());
        rest = rest[end..].trim_start();
    }
    words
}

struct Parser {
    words: Vec<String>,
    at: usize,
}

impl Parser {
    fn peek(&self) -> &str {
        self.words.get(self.at).map_or("", String::as_str)
    }

    fn next(&mut self) -> String {
        self.at += 1;
        self.words[self.at - 1].clone()
    }

    fn takes(&mut self, word: &str) -> bool {
        let is_there = self.peek() == word;
        self.at += usize::from(is_there);
        is_there
    }

    fn expect(&mut self, word: &str) {
        assert!(self.takes(word), "'{word}' is expected, not '{}'", self.peek());
    }

    fn function(&mut self, name: String) -> Function {
        let mut parameters = Vec::new();
        self.expect("(");
        while !self.takes(")") {
            parameters.push((self.next(), self.next()));
            self.takes(",");
        }
        Function { name, parameters, body: self.statement() }
    }

    fn statement(&mut self) -> Statement {
        if self.takes("{") {
            let all = iter::from_fn(|| (!self.takes("}")).then(|| self.statement()));
            return Statement::Block(all.collect());
        }
        if self.takes("if") {
            self.expect("(");
            let condition = self.expression();
            self.expect(")");
            let then = Box::new(self.statement());
            let otherwise = self.takes("else").then(|| Box::new(self.statement()));
            return Statement::If(condition, then, otherwise);
        }
        if self.takes("return") {
            let value = self.expression();
            self.expect(";");
            return Statement::Return(value);
        }
        self.takes("const");
        if matches!(self.peek(), "float" | "vec3" | "mat3") {
            self.next();
        }
        let mut all = Vec::new();
        loop {
            let name = self.next();
            if self.takes("=") {
                all.push(Statement::Set(name, self.expression()));
            }
            if self.takes(";") {
                return Statement::Block(all);
            }
            self.expect(",");
        }
    }

    fn expression(&mut self) -> Expression {
        let condition = self.binary(0);
        if !self.takes("?") {
            return condition;
        }
        let then = self.expression();
        self.expect(":");
        Expression::Choice(Box::new([condition, then, self.expression()]))
    }

    /// Operators of a rank and of those above it.
    fn binary(&mut self, rank: usize) -> Expression {
        const RANKS: [&[&str]; 3] = [&["<", "<=", "=="], &["+", "-"], &["*", "/"]];
        let Some(operators) = RANKS.get(rank) else { return self.unary() };
        let mut left = self.binary(rank + 1);
        while operators.contains(&self.peek()) {
            let operator = self.next();
            left = Expression::Call(operator, vec![left, self.binary(rank + 1)]);
        }
        left
    }

    fn unary(&mut self) -> Expression {
        if self.takes("-") {
            return Expression::Negative(Box::new(self.unary()));
        }
        let word = self.next();
        let mut value = if word == "(" {
            let inner = self.expression();
            self.expect(")");
            inner
        } else if let Ok(number) = word.parse() {
            Expression::Literal(number)
        } else if self.takes("(") {
            let mut arguments = Vec::new();
            while !self.takes(")") {
                arguments.push(self.expression());
                self.takes(",");
            }
            Expression::Call(word, arguments)
        } else {
            Expression::Name(word)
        };
        while self.takes(".") {
            let name = self.next();
            let at = ["xyz", "rgb"].iter().find_map(|names| names.find(&name));
            value = Expression::Component(Box::new(value), at.unwrap_or_else(|| panic!("no component '{name}'")));
        }
        value
    }
}
