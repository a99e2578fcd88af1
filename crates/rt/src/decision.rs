//! Decisions of any-hit and intersection shaders.

/// Decision of an any-hit shader. Its context makes them, so no other stage can.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Decision(pub(crate) Verdict);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Accept,
    Ignore,
    AcceptAndEndSearch,
}

impl Verdict {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accept => "accept",
            Self::Ignore => "ignore",
            Self::AcceptAndEndSearch => "accept and end search",
        }
    }
}

/// The search is over: an intersection shader ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndSearch(pub(crate) ());
