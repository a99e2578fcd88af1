//! Tests of the viewer's tasks, step by step, without the thread.

use super::{opening::open, *};
use crate::{
    document::Source,
    protocol::{Denoiser, Request, SettingsChange, told},
};
use steradian::Quality;

const BOX: &str = "builtin:cornell-box";

/// A viewer of small pictures that nobody runs.
fn viewer() -> (Viewer, Handle) {
    let settings = SettingsChange {
        spp: Some(Some(2)),
        width: Some(16),
        height: Some(12),
        denoise: Some(None),
        ..SettingsChange::default()
    };
    let source = Source { name: BOX.into(), ..Source::default() };
    open(source, Look { settings, ..Look::default() }, Err("none".into())).unwrap_or_else(|d| panic!("{}", told(&d)))
}

/// Goes on as the thread does without tasks, until the picture is done.
fn finish(viewer: &mut Viewer) {
    viewer.tell_state(Invalidates::Scene);
    viewer.show_change(Invalidates::Scene);
    while !viewer.job.as_ref().unwrap().is_done() {
        viewer.advance();
    }
}

/// Invalidates of a request.
fn ask(viewer: &mut Viewer, request: Request) -> Invalidates {
    let (reply, _) = oneshot::channel();
    let reach = viewer.take(Task::Page(request, reply));
    viewer.tell_state(reach);
    viewer.show_change(reach);
    reach
}

#[test]
fn a_finished_picture_is_sent_once() {
    let (mut viewer, mut handle) = viewer();
    finish(&mut viewer);
    assert!(handle.shown().is_some_and(|shown| shown.is_done && shown.samples == 2.0));
    handle.frames.mark_unchanged();
    for _ in 0..10 {
        viewer.advance();
    }
    assert!(!handle.frames.has_changed().unwrap());
    // A pause changes nothing of it, other layers do.
    for on in [true, false] {
        assert_eq!(ask(&mut viewer, Request::Pause { on }), Invalidates::State);
        viewer.advance();
        assert!(!handle.frames.has_changed().unwrap());
    }
    ask(&mut viewer, Request::Layers { names: vec!["depth".into()] });
    assert!(handle.frames.has_changed().unwrap());
    handle.frames.mark_unchanged();
    viewer.advance();
    assert!(!handle.frames.has_changed().unwrap());
    // Another picture is sent.
    ask(&mut viewer, Request::Settings(SettingsChange { seed: Some(Some(7)), ..SettingsChange::default() }));
    viewer.advance();
    assert!(handle.frames.has_changed().unwrap());
}

/// A run that would take days ends at once where a task waits.
#[test]
fn previews_are_broken_off_for_tasks() {
    let (mut viewer, handle) = viewer();
    let endless = Quality::of("path:reuse=1,effort=even,caustics=false").spp(1 << 24);
    let mut job = Job::new(&viewer.scene, &endless).unwrap();
    let (reply, _) = oneshot::channel();
    handle.send(Task::Page(Request::Undo, reply));
    assert!(!job.run(Duration::ZERO, &viewer.waiting));
    // The task is answered, and the picture that is owed begins.
    viewer.owed = true;
    let task = viewer.tasks.try_recv().unwrap();
    viewer.waiting.remove();
    assert_eq!(viewer.take(task), Invalidates::Nothing);
    assert!(!viewer.waiting.is_any());
    viewer.show_picture();
    assert!(!viewer.owed && viewer.job.is_some());
}

/// Pictures for which there is no memory are refused before they are begun, and the picture stays; its own memory
/// counts as there.
#[test]
fn pictures_without_memory_are_refused() {
    let (mut viewer, _handle) = viewer();
    viewer.document.source.memory = Some(|| Some(1 << 20));
    let size = |side| SettingsChange { width: Some(side), height: Some(side), ..SettingsChange::default() };
    let refused = |viewer: &mut Viewer, change| {
        let before = (viewer.held, viewer.scene.film().width);
        let why = viewer.request(Request::Settings(change)).unwrap_err();
        assert!(why.contains("memory"), "{why}");
        assert_eq!(before, (viewer.held, viewer.scene.film().width));
    };
    refused(&mut viewer, size(64));
    viewer.request(Request::Settings(size(20))).unwrap();
    let transient = SettingsChange { integrator: Some("transient".into()), ..SettingsChange::default() };
    refused(&mut viewer, transient.clone());
    viewer.held += 1 << 32;
    viewer.request(Request::Settings(transient)).unwrap();
}

/// The scene that an edit is checked with is the one that is shown; a render's preview is a new view of
/// what was compiled.
#[test]
fn an_edit_compiles_the_scene_once() {
    let (mut viewer, _handle) = viewer();
    finish(&mut viewer);
    let edit = |value: &str, moving| {
        let (node, parameter, value) = ("white".into(), "reflectance".into(), Some(value.to_owned()));
        Request::Edit { node, parameter, value, moving }
    };
    // Compilations for the change, and for its pictures.
    let mut compiled = |request| {
        let before = viewer.document.compiled;
        let invalid = viewer.request(request).unwrap();
        let changed = viewer.document.compiled;
        viewer.tell_state(invalid);
        viewer.show_change(invalid);
        [changed - before, viewer.document.compiled - changed]
    };
    assert_eq!(compiled(edit("0.3", false)), [1, 1]);
    assert_eq!(compiled(edit("0.4", true)), [1, 0]);
    assert_eq!(compiled(edit("0.5", true)), [1, 0]);
    assert_eq!(compiled(edit("0.5", false)), [1, 1]);
    assert_eq!(compiled(Request::Undo), [1, 1]);
    // What is refused leaves all as it is.
    let edits = viewer.document.edits();
    viewer.document.source.memory = Some(|| Some(1 << 10));
    for moving in [true, false] {
        let why = viewer.request(edit("0.7", moving)).unwrap_err();
        assert!(why.contains("memory"), "{why}");
        assert_eq!(viewer.document.edits(), edits);
    }
}

/// Pictures of a scene in the order in which they are shown, by samples that double, are each as near to the reference
/// as the one before, and at last much nearer.
#[test]
fn the_picture_never_gets_worse() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("gem.obj");
    std::fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n").unwrap();
    let showcase = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/showcase.xml");
    for name in [BOX, showcase, &*model.to_string_lossy()] {
        let settings = SettingsChange {
            spp: Some(Some(64)),
            width: Some(64),
            height: Some(48),
            denoise: Some(Some(Denoiser::Atrous)),
            integrator: Some("path".into()),
            ..SettingsChange::default()
        };
        let source = Source { name: name.into(), ..Source::default() };
        let look = Look { settings, ..Look::default() };
        let (mut viewer, handle) = open(source, look, Err("none".into())).unwrap_or_else(|d| panic!("{}", told(&d)));
        let reference = steradian::render(&viewer.scene, &Quality::of("path").spp(256)).unwrap();
        let error = || {
            let shown = steradian::image::metrics::resampled(&handle.shown().unwrap().picture(&[]), 64, 48).unwrap();
            steradian::image::metrics::flip(&shown, &reference, 67.0).unwrap()
        };
        viewer.tell_state(Invalidates::Scene);
        viewer.show_change(Invalidates::Scene);
        let mut errors = vec![error()];
        while viewer.refine() {}
        errors.push(error());
        let first = errors[1];
        for samples in [1, 1, 2, 4, 8, 16, 32] {
            let control = steradian::Control::default();
            viewer.job.as_mut().unwrap().take(samples, &control);
            viewer.publish();
            errors.push(error());
        }
        let worst = errors.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::NEG_INFINITY, f64::max);
        assert!(worst < 1e-3, "{name}: {errors:?}");
        assert!(errors[errors.len() - 1] < 0.7 * first, "{name}: {errors:?}");
    }
}
