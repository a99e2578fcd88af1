//! The whole way of an input: load, compile, render, develop.

use crate::case::{Case, Expect};
use std::{io, path::Path, sync::Arc};
use steradian::{
    CompileOptions, Control, Layer, Quality, compile, develop, formats, load,
    scene::{Diagnostic, Diagnostics, SceneDesc, Severity, Value},
};

/// End of a case.
pub enum Outcome {
    /// With errors among the messages.
    Refused(Vec<Diagnostic>),
    /// With a finite picture, the messages, and how many samples were not finite.
    Picture(Vec<Diagnostic>, u64),
}

/// Writes the files of a case to a folder and takes the scene all the way.
pub fn run(case: &Case, folder: &Path) -> Result<Outcome, String> {
    let write = || -> io::Result<()> {
        for (name, bytes) in &case.files {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap_or(folder))?;
            std::fs::write(path, bytes)?;
        }
        Ok(())
    };
    write().map_err(|e| format!("cannot write the files: {e}"))?;
    let compile_options = CompileOptions { size: case.small.then_some((16, 16)), ..CompileOptions::default() };
    if let Some(description) = &case.description {
        let mut description = description.clone();
        for value in description.nodes.iter_mut().flat_map(|n| &mut n.params).map(|p| &mut p.value) {
            if let Value::Path(path) = value {
                *path = folder.join(&*path);
            }
        }
        return render(&description, &compile_options, &Diagnostics::default());
    }
    let scene = folder.join(&case.files[0].0);
    let options = formats::Options { search: case.search.iter().cloned().collect(), ..formats::Options::default() };
    let loaded = load(scene, &options);
    if loaded.diagnostics.has_errors() {
        return refused(&loaded.diagnostics);
    }
    render(&loaded.desc, &compile_options, &loaded.diagnostics)
}

/// Compiles a description and renders it with two samples per pixel, so that there is a variance.
pub fn render(desc: &SceneDesc, options: &CompileOptions, earlier: &Diagnostics) -> Result<Outcome, String> {
    let compiled = compile(desc, options);
    let Some(scene) = compiled.scene.map(Arc::new) else { return refused(&compiled.diagnostics) };
    if compiled.diagnostics.has_errors() {
        return Err("there is a scene in spite of errors".into());
    }
    let messages = earlier.iter().chain(compiled.diagnostics.iter()).cloned().collect();
    let mut quality = Quality { spp: Some(2), threads: 1, layers: Layer::ALL.to_vec(), ..Quality::default() };
    // Not all integrators have these layers, nor are there any of too many lights; light is parted in one way at a
    // time.
    for layer in [Layer::BOUNCES, Layer::LIGHT_GROUPS, Layer::HALVES] {
        if quality.render(&scene).is_err() {
            quality.layers.retain(|kept| *kept != layer);
        }
    }
    let layers = quality.layers.clone();
    // Integrators of other names are refused before the render.
    let render = match quality.render(&scene) {
        Ok(render) => render,
        Err(e) => {
            return if e.to_string().is_empty() {
                Err("an empty error".into())
            } else {
                Ok(Outcome::Refused(Vec::new()))
            };
        }
    };
    let mut session = render.session(&scene).expect("a session");
    session.step(2, &Control::default());
    let picture = develop(&scene, &session.film(), &layers);
    for channel in picture.channels() {
        // Where nothing is hit, distances are infinite.
        let is_distance = matches!(channel.name.as_str(), "Z" | "depth.Z");
        let is_sound = |v: &f32| v.is_finite() || is_distance && *v == f32::INFINITY;
        if let Some(i) = channel.data.iter().position(|v| !is_sound(v)) {
            return Err(format!("pixel {i} of {} is {}", channel.name, channel.data[i]));
        }
    }
    Ok(Outcome::Picture(messages, session.counters().nonfinite))
}

fn refused(diagnostics: &Diagnostics) -> Result<Outcome, String> {
    if !diagnostics.has_errors() {
        return Err("refused without an error".into());
    }
    if diagnostics.iter().count() > Diagnostics::MAX_ERRORS + Diagnostics::MAX_OTHERS {
        return Err(format!("{} messages", diagnostics.iter().count()));
    }
    Ok(Outcome::Refused(diagnostics.iter().cloned().collect()))
}

/// Compares an outcome with the expectation; an error says what speaks against it.
pub fn judge(outcome: &Outcome, expect: Expect) -> Result<(), String> {
    let said = |messages: &[Diagnostic]| messages.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    match (outcome, expect) {
        (Outcome::Refused(m), Expect::Refused(what)) if said(m).contains(what) => Ok(()),
        (Outcome::Refused(m), Expect::Refused(what)) => Err(format!("the errors do not say '{what}':\n{}", said(m))),
        (Outcome::Picture(m, _), Expect::Warned(what)) if said(m).contains(what) => Ok(()),
        (Outcome::Picture(m, _), Expect::Warned(what)) => Err(format!("no message says '{what}':\n{}", said(m))),
        (Outcome::Refused(m), Expect::Warned(_) | Expect::Picture) => Err(format!("refused:\n{}", said(m))),
        (Outcome::Picture(m, _), Expect::Refused(what)) => {
            Err(format!("rendered without the error '{what}':\n{}", said(m)))
        }
        (Outcome::Picture(m, _), Expect::Told) if m.iter().all(|d| d.severity == Severity::Note) => {
            Err("rendered without a word".into())
        }
        (Outcome::Picture(..), Expect::Picture) | (_, Expect::Either | Expect::Told) => Ok(()),
    }
}
