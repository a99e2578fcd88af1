//! Reading what follows a directive.

use super::{
    dict::Dict,
    lexer::{Fault, Kind, Lexer, Token},
    param,
    reader::{Given, Reader},
    state::{NameRef, Target},
};
use steradian_scene::{Span, Transform};

impl Reader<'_> {
    /// The file being read. There is always one while a directive is carried out.
    pub(super) fn lexer(&mut self) -> &mut Lexer {
        let last = self.frames.len() - 1;
        &mut self.frames[last].lexer
    }

    pub(super) fn fault(&mut self, fault: Fault) {
        let span = self.lexer().span(fault.range);
        self.scene.report.error(span, fault.message);
    }

    pub(super) fn refuse<T>(&mut self, span: Span, message: impl Into<String>) -> Result<T, Given> {
        self.scene.report.error(span, message);
        Err(Given)
    }

    /// Reports a fault of the lexer.
    pub(super) fn or_fault<T>(&mut self, result: Result<T, Fault>) -> Result<T, Given> {
        result.map_err(|fault| {
            self.fault(fault);
            Given
        })
    }

    pub(super) fn token(&mut self) -> Result<Token, Given> {
        let token = self.lexer().next();
        self.or_fault(token)
    }

    pub(super) fn peek(&mut self) -> Result<Token, Given> {
        let token = self.lexer().peek();
        self.or_fault(token)
    }

    /// A quoted string.
    pub(super) fn quoted(&mut self) -> Result<(String, Span), Given> {
        let token = self.token()?;
        let lexer = self.lexer();
        let span = lexer.token_span(token);
        match token.kind {
            Kind::Quoted => {
                let text = lexer.unquote(token).map(std::borrow::Cow::into_owned);
                Ok((self.or_fault(text)?, span))
            }
            Kind::End => self.refuse(span, "the file ends where a quoted string is expected"),
            _ => {
                let found = lexer.excerpt(token);
                if lexer.starts_statement(token) {
                    lexer.back(token);
                }
                self.refuse(span, format!("expected a quoted string, found '{found}'"))
            }
        }
    }

    pub(super) fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Given> {
        let mut values = [0.0; N];
        for v in &mut values {
            let number = self.lexer().next_number();
            *v = self.or_fault(number)?;
        }
        Ok(values)
    }

    /// Sixteen numbers in brackets.
    pub(super) fn matrix(&mut self, directive: Span) -> Result<Transform, Given> {
        let open = self.peek()?;
        if open.kind != Kind::Open {
            return self.refuse(directive, "expected sixteen numbers in brackets");
        }
        let list = self.lexer().numbers();
        let list = self.or_fault(list)?;
        match <[f64; 16]>::try_from(list) {
            Ok(m) => Ok(Transform::from_columns(m)),
            Err(list) => self.refuse(directive, format!("expected sixteen numbers, found {}", list.len())),
        }
    }

    /// The name of a model and parameters.
    pub(super) fn dict(&mut self, target: Option<Target>) -> Result<Dict, Given> {
        let (kind, span) = self.quoted()?;
        let inherited = target.map(|t| self.state.inherited(t)).unwrap_or_default();
        let space = self.state.space;
        let last = self.frames.len() - 1;
        let params = param::read(&mut self.frames[last].lexer, space, &mut self.scene.report);
        Ok(Dict::new(kind, span, params, inherited, space))
    }

    pub(super) fn name_ref(&mut self) -> Result<NameRef, Given> {
        let (name, span) = self.quoted()?;
        Ok(NameRef { name: name.into(), span })
    }

    /// Moves to the next directive after a fault.
    pub(super) fn resynchronise(&mut self) {
        while let Some(frame) = self.frames.last_mut() {
            match frame.lexer.next() {
                Ok(t) if t.kind == Kind::End || frame.lexer.starts_statement(t) => return frame.lexer.back(t),
                _ => {}
            }
        }
    }
}
