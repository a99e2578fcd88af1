//! The terms in which the schema is written.

/// Type required of a JSON value.
#[derive(Debug)]
pub(super) enum Kind {
    Bool,
    Text,
    /// Two numbers with a point between.
    Version,
    Uri,
    /// One of some texts.
    Word(&'static [&'static str]),
    /// One of some numbers.
    Code(&'static [u64]),
    Integer {
        least: u64,
        most: u64,
        multiple: u64,
    },
    /// An index into an array of the document; into one nearby if it is called "".
    Index(&'static str),
    /// Both bounds included.
    Number {
        least: f64,
        most: f64,
    },
    /// A number that exceeds this one.
    Above(f64),
    /// An array with one of some lengths; of any but none if there are none.
    List(&'static Kind, &'static [usize]),
    /// A list without repetitions, and not empty.
    Set(&'static Kind),
    Object(&'static Object),
    /// An object with any names, and not empty.
    Map(&'static Kind),
}

/// A kind of object.
#[derive(Debug)]
pub(super) struct Object {
    pub name: &'static str,
    pub members: &'static [Member],
    /// Exactly one of these is there.
    pub one_of: &'static [&'static str],
}

/// A member of an object.
#[derive(Debug)]
pub(super) struct Member {
    pub name: &'static str,
    pub kind: Kind,
    pub is_required: bool,
    /// A member that must be there if this one is.
    pub needs: Option<&'static str>,
}

/// An extension, the objects that it extends, and what it adds to each.
#[derive(Debug)]
pub(super) struct Extension {
    pub name: &'static str,
    pub places: &'static [(&'static str, &'static Object)],
}

pub(super) const fn object(name: &'static str, members: &'static [Member]) -> Object {
    Object { name, members, one_of: &[] }
}

/// A member that may be missing.
pub(super) const fn may(name: &'static str, kind: Kind) -> Member {
    Member { name, kind, is_required: false, needs: None }
}

/// A member that may be missing, but needs another one.
pub(super) const fn may_with(name: &'static str, kind: Kind, needs: &'static str) -> Member {
    Member { name, kind, is_required: false, needs: Some(needs) }
}

/// A member that must be there.
pub(super) const fn must(name: &'static str, kind: Kind) -> Member {
    Member { name, kind, is_required: true, needs: None }
}

/// Any number.
pub(super) const NUMBER: Kind = Kind::Number { least: f64::NEG_INFINITY, most: f64::INFINITY };
/// From 0 to 1.
pub(super) const FACTOR: Kind = Kind::Number { least: 0.0, most: 1.0 };
/// Zero or more.
pub(super) const NOT_NEGATIVE: Kind = Kind::Number { least: 0.0, most: f64::INFINITY };

/// Whole numbers from `least` on.
pub(super) const fn from(least: u64) -> Kind {
    Kind::Integer { least, most: u64::MAX, multiple: 1 }
}
