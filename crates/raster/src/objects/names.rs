//! Names of objects (OpenGL 4.6 core, sections 2.5.1 and 5.1).
//!
//! A name is reserved when it is generated; its object comes into being when the name is bound for the first time, or
//! is there at once if the name was created. Objects are counted references: the table of names holds one, each binding
//! and each attachment another. Deletion takes the reference of the table, so that the name is free at once, while the
//! object lives on for as long as something still refers to it. This is all there is to orphaning.

use std::{
    cell::{RefCell, RefMut},
    collections::BTreeMap,
    rc::Rc,
};

use super::error::{invalid_operation, invalid_value};
use crate::error::Result;

/// A reference to an object.
pub(super) type Object<T> = Rc<RefCell<T>>;

/// The most names of one call and one kind.
const MAX_NAMES: usize = 1 << 20;

/// Names of one kind of object.
#[derive(Debug)]
pub(super) struct Names<T> {
    /// The kind, for messages.
    kind: &'static str,
    /// Objects by name; `None` for a name that is only reserved.
    objects: BTreeMap<u32, Option<Object<T>>>,
}

impl<T> Names<T> {
    pub fn new(kind: &'static str) -> Self {
        Self { kind, objects: BTreeMap::new() }
    }

    /// Puts `count` entries under the smallest names that are unused.
    fn add(&mut self, count: usize, call: &'static str, entry: impl Fn() -> Option<T>) -> Result<Vec<u32>> {
        if count > MAX_NAMES {
            return invalid_value(call, format_args!("{count} names; at most {MAX_NAMES}"));
        }
        let names: Vec<u32> = (1..=u32::MAX).filter(|name| !self.objects.contains_key(name)).take(count).collect();
        self.objects.extend(names.iter().map(|name| (*name, entry().map(|object| Rc::new(RefCell::new(object))))));
        Ok(names)
    }

    /// Reserves names without objects.
    pub fn generate(&mut self, count: usize, call: &'static str) -> Result<Vec<u32>> {
        self.add(count, call, || None)
    }

    /// Reserves names and makes their objects.
    pub fn create(&mut self, count: usize, call: &'static str, new: impl Fn() -> T) -> Result<Vec<u32>> {
        self.add(count, call, || Some(new()))
    }

    /// The object of a name, made now if the name is only reserved.
    pub fn first_use(&mut self, name: u32, call: &'static str, new: impl FnOnce() -> T) -> Result<Object<T>> {
        let Some(entry) = self.objects.get_mut(&name) else {
            return invalid_operation(call, format_args!("{name} is not a generated name of a {}", self.kind));
        };
        Ok(Rc::clone(entry.get_or_insert_with(|| Rc::new(RefCell::new(new())))))
    }

    /// The object of a name.
    pub fn object(&self, name: u32, call: &'static str) -> Result<Object<T>> {
        match self.objects.get(&name) {
            Some(Some(object)) => Ok(Rc::clone(object)),
            Some(None) => {
                invalid_operation(call, format_args!("{} {name} is a reserved name without an object", self.kind))
            }
            None => invalid_operation(call, format_args!("{name} is not a name of a {}", self.kind)),
        }
    }

    /// True if the name has an object.
    pub fn has_object(&self, name: u32) -> bool {
        matches!(self.objects.get(&name), Some(Some(_)))
    }

    /// Frees a name. Its object, if there is one, is the caller's to unbind.
    pub fn delete(&mut self, name: u32) -> Option<Object<T>> {
        self.objects.remove(&name).flatten()
    }

    /// The name of an object; 0 if it is deleted.
    pub fn name_of(&self, object: &Object<T>) -> u32 {
        let is_it = |entry: &Option<Object<T>>| entry.as_ref().is_some_and(|other| Rc::ptr_eq(other, object));
        self.objects.iter().find(|(_, entry)| is_it(entry)).map_or(0, |(name, _)| *name)
    }
}

/// An object to be written. A draw reads what is bound until its closure returns; what the closure does to these
/// objects by a mapping or by another context of the group is refused.
pub(super) fn written<'a, T>(object: &'a Object<T>, call: &'static str) -> Result<RefMut<'a, T>> {
    match object.try_borrow_mut() {
        Ok(object) => Ok(object),
        Err(_) => invalid_operation(call, "a draw that has not ended reads the object"),
    }
}

/// True if a reference is to this object.
pub(super) fn refers_to<T>(reference: &Option<Object<T>>, object: &Object<T>) -> bool {
    reference.as_ref().is_some_and(|other| Rc::ptr_eq(other, object))
}
