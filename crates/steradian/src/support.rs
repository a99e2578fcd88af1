//! The answers of all methods to all features, for people who choose one.

use crate::{Error, cornell, methods};
use std::fmt::Write;
use steradian_compile::{Options, compile};
use steradian_engine::{Asked, Feature, Support};
use steradian_request::{MethodRequest, Request};

/// Answer of a method to a feature.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// The feature.
    pub feature: Feature,
    /// Name of the method.
    pub method: &'static str,
    /// Its answer, with default options.
    pub support: Support,
}

/// The answers of all methods with their default options, feature by feature.
///
/// # Errors
/// [`Error`] of a method that refuses the scene of the trial, which none does.
pub fn answers() -> Result<Vec<Answer>, Error> {
    // Methods are made for a scene; answers do not depend on it.
    let compiled = compile(&cornell::luminous_ceiling(), &Options::default());
    let scene = compiled.scene.ok_or(Error::Scene(compiled.diagnostics))?;
    let mut made = Vec::new();
    for kind in methods() {
        let (request, options) = (Request::default(), MethodRequest::named(kind.name)?);
        made.push((kind.name, (kind.new)(&Asked { request: &request, options: &options, scene: &scene })?));
    }
    let of =
        |feature: Feature| made.iter().map(move |(method, m)| Answer { feature, method, support: m.supports(feature) });
    Ok(Feature::ALL.into_iter().flat_map(of).collect())
}

/// The answers as a page: a row for each feature that not every method renders.
///
/// # Errors
/// Errors of [`answers`].
pub fn page() -> Result<String, Error> {
    let answers = answers()?;
    let mut page = String::from(
        "# Limits of integrators\n\n\
         Written by `steradian list limits --markdown`. Integrators with their default options; those that a row does not \
         name render the feature as it is. A render tells what it leaves out, and refuses what it cannot do.\n\n\
         | feature | approximated by | left out by | refused by |\n|---|---|---|---|\n",
    );
    for feature in Feature::ALL {
        let named = |is: &dyn Fn(Support) -> bool| {
            let names = answers.iter().filter(|a| a.feature == feature && is(a.support));
            names.map(|a| format!("`{}`", a.method)).collect::<Vec<_>>().join(" ")
        };
        let columns = [
            named(&|s| matches!(s, Support::Approximates(_))),
            named(&|s| matches!(s, Support::LeavesOut(_))),
            named(&|s| matches!(s, Support::Refuses(_))),
        ];
        if columns.iter().any(|c| !c.is_empty()) {
            let _ = writeln!(page, "| {} | {} |", feature.name(), columns.join(" | "));
        }
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every integrator of the schema has a method, and the reverse.
    #[test]
    fn methods_are_those_of_the_schema() {
        let mut of_schema: Vec<_> = steradian_scene::Family::Integrator.kinds().collect();
        let mut made: Vec<_> = methods().map(|kind| kind.name).collect();
        of_schema.sort_unstable();
        made.sort_unstable();
        assert_eq!(made, of_schema);
    }
}
