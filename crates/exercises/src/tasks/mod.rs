//! The exercises, a file for each.

mod bvh_split;
mod closest_hit;
mod diffuse;
mod edge_function;
mod form_factor;
mod fresnel;
mod microfacet;
mod mip_level;
mod mis;
mod next_event;
mod path_tracer;
mod perspective_interpolation;
mod phong;
mod russian_roulette;
mod shadow_bias;
mod slab_test;
mod tone_curve;

use crate::{Exercise, Fault};
use steradian_schema::names;

/// All exercises in the order of the course.
pub static EXERCISES: &[&Exercise] = &[
    &next_event::EXERCISE,
    &path_tracer::EXERCISE,
    &russian_roulette::EXERCISE,
    &mis::EXERCISE,
    &fresnel::EXERCISE,
    &microfacet::EXERCISE,
    &tone_curve::EXERCISE,
    &diffuse::EXERCISE,
    &phong::EXERCISE,
    &form_factor::EXERCISE,
    &edge_function::EXERCISE,
    &perspective_interpolation::EXERCISE,
    &mip_level::EXERCISE,
    &shadow_bias::EXERCISE,
    &slab_test::EXERCISE,
    &bvh_split::EXERCISE,
    &closest_hit::EXERCISE,
];

/// The exercise of this name.
///
/// # Errors
/// [`Fault::Unknown`] with the nearest name.
pub fn find(name: &str) -> Result<&'static Exercise, Fault> {
    EXERCISES.iter().copied().find(|e| e.name == name).ok_or_else(|| {
        let hint = names::did_you_mean(name, EXERCISES.iter().map(|e| e.name));
        Fault::Unknown { name: name.to_owned(), hint: hint.map_or_else(String::new, |h| format!("; {h}")) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exercise::{Mistake, Values, Wrong};
    use std::collections::HashSet;

    /// Part of the points at which two wrong functions must differ to be told apart.
    const TOLD: f64 = 0.04;

    fn values(mistake: &Mistake) -> Option<Values> {
        if let Wrong::Values(values) = mistake.wrong { Some(values) } else { None }
    }

    #[test]
    fn names_are_found_or_the_nearest_is_told() {
        assert_eq!(find("fresnel").unwrap().name, "fresnel");
        let message = find("fresnl").unwrap_err().to_string();
        assert!(message.contains("did you mean 'fresnel'?"), "{message}");
    }

    #[test]
    fn exercises_are_whole() {
        let names: HashSet<&str> = EXERCISES.iter().map(|e| e.name).collect();
        assert_eq!(names.len(), EXERCISES.len());
        for e in EXERCISES {
            assert!((1..=15).contains(&e.chapter) && e.mistakes.len() >= 4, "{}", e.name);
            let keys: HashSet<&str> = e.mistakes.iter().map(|m| m.key).collect();
            assert_eq!(keys.len(), e.mistakes.len(), "{}", e.name);
            for m in e.mistakes {
                assert!(e.function(m.function).is_some() && m.hint.len() > 20, "{} {}", e.name, m.key);
            }
            for law in e.laws {
                assert!(law.functions.iter().all(|f| e.function(f).is_some()), "{} {}", e.name, law.name);
            }
        }
    }

    #[test]
    fn points_have_as_many_numbers_as_inputs_and_references_as_outputs() {
        for e in EXERCISES {
            for f in e.functions {
                let count: usize = f.inputs.iter().map(|i| crate::exercise::shape(i).1).sum();
                let points = (f.points)();
                assert!(points.len() >= 10, "{} {}", e.name, f.name);
                for p in &points {
                    assert_eq!(p.len(), count, "{} {}", e.name, f.name);
                    let right = f.reference.map(|reference| reference(p));
                    let is_sound = right.is_none_or(|r| r.len() == f.outputs.len() && r.iter().all(|x| x.is_finite()));
                    assert!(is_sound, "{} {} {p:?}", e.name, f.name);
                }
            }
        }
    }

    /// Every mistake differs from the reference and from every other one at more points than a diagnosis may miss.
    #[test]
    fn mistakes_are_told_apart() {
        let mut alike = Vec::new();
        for e in EXERCISES {
            for f in e.functions {
                let Some(reference) = f.reference else { continue };
                let wrong: Vec<(&str, Values)> = (e.mistakes.iter().filter(|m| m.function == f.name))
                    .filter_map(|m| Some((m.key, values(m)?)))
                    .chain([("the reference", reference)])
                    .collect();
                let points = (f.points)();
                for (i, (a, of_a)) in wrong.iter().enumerate() {
                    for (b, of_b) in &wrong[..i] {
                        let differ = points.iter().filter(|p| !e.tolerance.all_hold(&of_a(p), &of_b(p))).count();
                        let part = differ as f64 / points.len() as f64;
                        if part < TOLD {
                            alike.push(format!("{} {}: '{a}' and '{b}' differ at {differ} points", e.name, f.name));
                        }
                    }
                }
            }
        }
        assert!(alike.is_empty(), "{}", alike.join("\n"));
    }
}
