//! Parts of renders, computed apart, saved, left, gone on with, and joined: the bits of one run.

use super::*;
use crate::{Control, Layer, Quality, compile, cornell};
use std::{path::PathBuf, sync::Arc};
use steradian_engine::Indivisible;

type Print = [u8; blake3::OUT_LEN];

/// The scene, on a film of a kind.
fn scene(size: u32, film: &str) -> (Arc<Scene>, Print) {
    let mut desc = cornell::luminous_ceiling();
    desc.node_mut(desc.film.unwrap()).kind = film.into();
    let options = CompileOptions { size: Some((size, size)), ..CompileOptions::default() };
    (Arc::new(compile(&desc, &options).scene.unwrap()), fingerprint(&desc).unwrap())
}

fn quality(integrator: &str, spp: u32, layers: &[&str]) -> Quality {
    let layers = layers.iter().map(|name| Layer::named(name).unwrap()).collect();
    Quality { layers, threads: 1, ..Quality::of(integrator).spp(spp) }
}

/// A render whose parts lie in a folder.
struct Parts {
    scene: Arc<Scene>,
    render: Render,
    recipe: Recipe,
    folder: tempfile::TempDir,
}

impl Parts {
    fn new(size: u32, quality: &Quality) -> Self {
        Self::on("rgb", size, quality)
    }

    fn on(film: &str, size: u32, quality: &Quality) -> Self {
        let (scene, print) = scene(size, film);
        let render = quality.render(&scene).unwrap();
        let recipe = Recipe::new(&scene, print, &CompileOptions::default(), &render);
        Self { scene, render, recipe, folder: tempfile::tempdir().unwrap() }
    }

    fn session(&self) -> Box<dyn Session> {
        self.render.session(&self.scene).unwrap()
    }

    fn run(&self) -> Box<dyn Session> {
        let mut session = self.session();
        finish(&mut *session);
        session
    }

    fn path(&self, pieces: &Range<u32>) -> PathBuf {
        self.folder.path().join(format!("{}-{}", pieces.start, pieces.end))
    }

    /// Computes pieces and saves them; left after so many samples, if so, and gone on with.
    fn compute(&self, pieces: &Range<u32>, left_at: Option<u32>) -> PathBuf {
        let path = self.path(pieces);
        let of = self.session().pieces().unwrap();
        let recipe = self.recipe.clone().of_pieces(pieces, of);
        let restricted = || {
            let mut session = self.session();
            session.restrict(pieces.clone()).unwrap();
            session
        };
        let mut session = restricted();
        if let Some(samples) = left_at {
            session.step(samples, &Control::default());
            recipe.save(&mut *session, &path).unwrap();
            assert!(session.is_done() || !state_file(&path).unwrap().is_finished);
            session = restricted();
            recipe.restore(&mut *session, &path).unwrap();
        }
        finish(&mut *session);
        recipe.save(&mut *session, &path).unwrap();
        path
    }
}

fn finish(session: &mut dyn Session) {
    for _ in 0..1000 {
        if session.is_done() {
            return;
        }
        session.step(7, &Control::default());
    }
    panic!("no end");
}

/// So many parts of unequal size.
fn cut(pieces: u32, parts: u32) -> Vec<Range<u32>> {
    let at = |i: u32| if i == parts { pieces } else { i.max(pieces * i * i / (parts * parts)) };
    (0..parts).map(|i| at(i)..at(i + 1)).collect()
}

fn bits(session: &dyn Session) -> String {
    format!("{:?}", session.film())
}

#[test]
fn joined_parts_have_the_bits_of_one_run() {
    let layers = ["albedo", "cryptomatte", "halves"];
    for (size, spp, integrator, layers) in [
        (40, 3, "path", &layers[..]),
        (40, 3, "path:guiding=false", &["light_groups"]),
        (40, 2, "direct", &["bands"]),
        (40, 2, "volpath", &["bounces"]),
        (20, 66, "light", &layers[..2]),
        (20, 67, "bdpt", &layers),
        (20, 7, "vcm", &["albedo"]),
        (20, 8, "sppm", &["albedo"]),
        (20, 7, "photon", &[]),
        (20, 67, "structure", &layers[..2]),
    ] {
        // Bands are of the film.
        let has_bands = layers == ["bands"];
        let (film, layers) = if has_bands { ("spectral", &[][..]) } else { ("rgb", layers) };
        let all = Parts::on(film, size, &quality(integrator, spp, layers));
        let whole = all.run();
        assert_eq!(!whole.film().layers.by_band.is_empty(), has_bands);
        let pieces = whole.pieces().unwrap();
        assert_eq!(pieces, if size == 40 { 9 } else { spp.div_ceil(spp.div_ceil(64)) }, "{integrator}");
        for parts in [1, 3, 7] {
            let ranges = cut(pieces, parts);
            let paths: Vec<_> =
                ranges.iter().enumerate().map(|(i, range)| all.compute(range, (i % 2 == 1).then_some(1))).collect();
            let mut joined = all.session();
            for (range, path) in ranges.iter().zip(&paths).rev() {
                assert!(!joined.is_done());
                assert_eq!(all.recipe.join(&mut *joined, path).unwrap(), *range, "{integrator}");
            }
            assert!(joined.is_done() && joined.samples() == whole.samples(), "{integrator}");
            assert_eq!(joined.counters(), whole.counters(), "{integrator}");
            assert!(bits(&*joined) == bits(&*whole), "{integrator} in {parts} parts");
            // It is a render like any other: saved, gone on with, extended.
            let path = all.path(&(0..pieces));
            all.recipe.save(&mut *joined, &path).unwrap();
            let mut again = all.session();
            all.recipe.restore(&mut *again, &path).unwrap();
            assert!(again.is_done() && bits(&*again) == bits(&*whole), "{integrator}");
            if parts == 3 && integrator != "sppm" {
                let mut longer = all.session();
                finish(&mut *longer);
                for session in [&mut longer, &mut joined] {
                    assert!(session.extend(spp + 3));
                    finish(&mut **session);
                }
                assert!(bits(&*joined) == bits(&*longer), "{integrator}: not gone on with as one run is");
            }
        }
    }
}

/// A state of a part has its pieces alone, whatever the order of the parts, and what is there is in the film.
#[test]
fn a_part_holds_its_pieces_alone() {
    let all = Parts::new(40, &quality("path", 2, &["albedo"]));
    let size = |pieces: Range<u32>| std::fs::metadata(all.compute(&pieces, None)).unwrap().len();
    let (one, four, nine) = (size(4..5), size(0..4), size(0..9));
    // Tiles within are 16 × 16, those at the ends 16 × 8 and 8 × 8; settings take some kilobytes.
    assert!(one < nine / 4 && four < 3 * nine / 4, "{one} {four} {nine}");
    let mut session = all.session();
    session.restrict(4..5).unwrap();
    finish(&mut *session);
    let film = session.film();
    let taken = film.pixels.iter().filter(|p| p.samples == 2).count();
    assert_eq!((taken, session.counters().samples), (256, 512));
    assert!(!session.extend(8));
    assert!(session.error().is_some_and(f64::is_finite));
}

/// Parts that never were in a file are those of files.
#[test]
fn parts_in_memory_are_those_of_files() {
    let all = Parts::new(40, &quality("path", 2, &["albedo"]));
    let of = all.session().pieces().unwrap();
    let mut joined = all.session();
    for pieces in [0..4, 4..of] {
        let path = all.compute(&pieces, None);
        let mut session = all.session();
        session.restrict(pieces.clone()).unwrap();
        finish(&mut *session);
        let mut part = Vec::new();
        all.recipe.clone().of_pieces(&pieces, of).write(&mut *session, &mut part).unwrap();
        assert_eq!(part.len() as u64, std::fs::metadata(path).unwrap().len());
        let last = part.len() - 1;
        assert!(matches!(all.recipe.join_bytes(&mut *joined, &part[..last]), Err(StateError::Damaged)));
        assert!(matches!(all.recipe.join_bytes(&mut *joined, &part[..20]), Err(StateError::NotAState)));
        assert_eq!(all.recipe.join_bytes(&mut *joined, &part).unwrap(), pieces);
    }
    assert!(joined.is_done() && bits(&*joined) == bits(&*all.run()));
}

/// A session that computed some pieces computes others as a new one does, trials aside, which it keeps.
#[test]
fn one_session_computes_pieces_after_others() {
    for (integrator, size, layers) in [("path", 40, &["halves", "albedo"][..]), ("bdpt", 20, &["halves"])] {
        let all = Parts::new(size, &quality(integrator, 6, layers));
        let pieces = all.session().pieces().unwrap();
        let mut session = all.session();
        for range in [2..3, 0..2, 0..pieces, 3..pieces] {
            session.restrict(range.clone()).unwrap();
            assert_eq!((session.samples(), session.counters().samples), (0, 0));
            // One that was left on the way is no worse.
            session.step(1, &Control::default());
            session.restrict(range.clone()).unwrap();
            finish(&mut *session);
            let mut alone = all.session();
            alone.restrict(range).unwrap();
            finish(&mut *alone);
            assert!(bits(&*session) == bits(&*alone) && session.counters() == alone.counters(), "{integrator}");
        }
    }
}

#[test]
fn work_that_is_one_is_refused_by_name() {
    let (scene, _) = scene(20, "rgb");
    let why = |quality: &Quality| quality.render(&scene).unwrap().session(&scene).unwrap().pieces().unwrap_err();
    let of = |integrator| quality(integrator, 16, &[]);
    assert_eq!(why(&Quality { adaptive: true, ..of("path") }), Indivisible::Adaptive);
    assert_eq!(why(&Quality { error: Some(0.1), ..of("path") }), Indivisible::Error);
    assert_eq!(why(&Quality { error: Some(0.1), ..of("light") }), Indivisible::Error);
    assert_eq!(why(&of("path:reuse=4")), Indivisible::Sharing);
    assert_eq!(why(&of("path:reuse=auto")), Indivisible::Sharing);
    assert_eq!(why(&of("raster:frame=hybrid")), Indivisible::Follows);
    let mut session = of("path:reuse=4").render(&scene).unwrap().session(&scene).unwrap();
    assert_eq!(session.restrict(0..1), Err(Indivisible::Sharing));
    let mut session = of("path").render(&scene).unwrap().session(&scene).unwrap();
    for range in [0..5, 3..3, 7..9, Range { start: 3, end: 1 }] {
        assert_eq!(session.restrict(range), Err(Indivisible::NoSuchPieces));
    }
}

/// Parts of other renders, unfinished ones, those that are there already, and files that lie are refused.
#[test]
fn only_parts_of_the_render_are_joined() {
    for (integrator, size) in [("path", 40), ("light", 20)] {
        let all = Parts::new(size, &quality(integrator, 6, &[]));
        let of = all.session().pieces().unwrap();
        let path = all.compute(&(1..3), None);
        let what = state_file(&path).unwrap();
        assert!(what.is_finished && what.pieces == Some((1..3, of)) && what.scene == all.recipe.scene());
        // A part is no whole, and no other part.
        let restore = |recipe: &Recipe| recipe.restore(&mut *all.session(), &path).unwrap_err().to_string();
        let other = |range: &str| format!("was saved with other settings: pieces 1..3 of {of}, not {range}");
        assert_eq!(restore(&all.recipe), other("all"));
        assert_eq!(restore(&all.recipe.clone().of_pieces(&(0..2), of)), other(&format!("0..2 of {of}")));
        let join = |session: &mut dyn Session, path: &Path| all.recipe.join(session, path);
        let mut joined = all.session();
        join(&mut *joined, &path).unwrap();
        assert!(!joined.is_done() && joined.save(&mut Vec::new()).is_err(), "pieces are missing");
        let before = bits(&*joined);
        joined.step(6, &Control::default());
        assert!(bits(&*joined) == before, "samples were taken");
        let again = join(&mut *joined, &all.compute(&(2..4), None)).unwrap_err();
        assert_eq!(again.to_string(), "has pieces that were joined already: 2 to 3");
        let mut begun = all.session();
        begun.step(1, &Control::default());
        assert!(matches!(join(&mut *begun, &path), Err(StateError::Damaged)));
        let more = Parts::new(size, &quality(integrator, 7, &[]));
        let refused = more.recipe.join(&mut *more.session(), &path).unwrap_err();
        assert!(refused.to_string().contains("samples per pixel 6, not 7"), "{refused}");
        // Left in the middle.
        let mut part = all.session();
        part.restrict(1..3).unwrap();
        part.step(1, &Control::default());
        let unfinished = all.path(&(0..0));
        all.recipe.clone().of_pieces(&(1..3), of).save(&mut *part, &unfinished).unwrap();
        assert!(matches!(join(&mut *all.session(), &unfinished), Err(StateError::Unfinished)));
        let mut state = Vec::new();
        part.save(&mut state).unwrap();
        assert!(all.session().join(&mut &state[..], 1..3).is_err());
        // Cut anywhere, or with one number changed.
        finish(&mut *part);
        state.clear();
        part.save(&mut state).unwrap();
        all.session().join(&mut &state[..], 1..3).unwrap();
        for wrong in [0..2, 1..4, 2..3, 1..of + 1, Range { start: 3, end: 1 }] {
            assert!(all.session().join(&mut &state[..], wrong).is_err());
        }
        for end in (0..state.len()).step_by(state.len() / 40) {
            assert!(all.session().join(&mut &state[..end], 1..3).is_err(), "cut at {end}");
        }
        let mut refused = 0;
        for at in (0..state.len()).step_by(4).filter(|at| *at < 200 || at / 4 % 211 == 0) {
            for value in [[0xff; 4], [0, 0, 0xc0, 0x7f], [9, 0, 0, 0]] {
                let mut forged = state.clone();
                forged[at..at + 4].copy_from_slice(&value);
                let mut session = all.session();
                if session.join(&mut &forged[..], 1..3).is_err() {
                    refused += 1;
                    continue;
                }
                let film = session.film();
                assert!(film.pixels.iter().flat_map(|p| p.mean()).all(f64::is_finite), "{value:?} at {at}");
            }
        }
        assert!(refused > 20, "{refused}");
    }
}
