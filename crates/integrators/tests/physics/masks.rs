//! Surfaces that are there in part only.

use crate::{
    shot::{Shot, is_exactly, mean, same_bits},
    stage::{Stage, diffuse, material, plane, rectangle, shape, sphere, white},
};
use std::f64::consts::PI;
use steradian_scene::{Family, Node};

/// A mask of some opacity on a disk before a wall of radiance one; the disk reflects nothing.
fn masked_disk(opacity: f64, by_alpha: bool) -> Stage {
    let mut stage = Stage::new();
    let inner = stage.add(diffuse(0.0));
    let disk = shape("disk").with("radius", 2.0);
    if by_alpha {
        stage.place(disk.with("alpha", opacity)).material = Some(inner);
    } else {
        let mask = stage.add(material("mask").with("opacity", opacity).with("material", inner));
        stage.place(disk).material = Some(mask);
    }
    stage.lamp(plane([0.0, 0.0, -1.0], -3.0), 1.0);
    stage.film(16, 16).look([0.0, 0.0, -4.0], [0.0; 3], 30.0);
    stage
}

/// A mask lets through what its opacity leaves, in the mean over rays, 4σ; all or nothing is exact. A mask on the
/// material and an alpha on the shape are one: the same bits.
#[test]
fn masks_let_a_part_through() {
    for opacity in [0.0, 0.25, 0.5, 0.9, 1.0] {
        let scenes = [false, true].map(|by_alpha| masked_disk(opacity, by_alpha).scene());
        for integrator in ["path", "volpath", "whitted"] {
            let film = Shot::of(integrator, 200).take(&scenes[0]);
            if opacity == 0.0 || opacity == 1.0 {
                is_exactly(&film, integrator, [1.0 - opacity; 3]);
            } else {
                mean(&film).is_near_grey(&format!("{integrator}, opacity {opacity}"), 1.0 - opacity, 0.03);
            }
            same_bits(&film, &Shot::of(integrator, 200).take(&scenes[1]), "mask and alpha");
        }
    }
}

/// A mask and an alpha together let through what both do.
#[test]
fn masks_multiply() {
    let mut stage = Stage::new();
    let inner = stage.add(diffuse(0.0));
    let mut outer = inner;
    for opacity in [0.6, 0.5] {
        outer = stage.add(material("mask").with("opacity", opacity).with("material", outer));
    }
    stage.place(shape("disk").with("radius", 2.0)).material = Some(outer);
    stage.lamp(plane([0.0, 0.0, -1.0], -3.0), 1.0);
    stage.film(16, 16).look([0.0, 0.0, -4.0], [0.0; 3], 30.0);
    mean(&Shot::of("path", 200).take(&stage.scene())).is_near_grey("0.6 of 0.5", 0.7, 0.02);
}

/// Shadow rays see the same mask: light of a point and of a lamp that passes a half-opaque sheet, and a sphere (two
/// sheets), is halved and quartered. 4σ.
#[test]
fn shadows_of_masks_are_partial() {
    for mesh in [false, true] {
        let mut stage = Stage::new();
        stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
        stage.light(crate::stage::light("point").with("position", [0.0, 0.0, 4.0]).with("intensity", white(16.0)));
        let black = stage.add(diffuse(0.0));
        if mesh {
            stage.place_mesh(rectangle([-1.0, -1.0, 2.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0])).material = Some(black);
            let id = stage.desc.shapes.last().expect("the sheet").node;
            stage.desc.node_mut(id).set("alpha", 0.5, None);
        } else {
            stage.place(sphere([0.0, 0.0, 2.0], 0.5).with("alpha", 0.5)).material = Some(black);
        }
        // A window wide enough that rays differ: the hash of a ray decides.
        stage.film(64, 64).look([0.4, 0.3, 1.0], [0.0; 3], 2.0);
        let expected = if mesh { 0.5 } else { 0.25 } / PI;
        let film = Shot::of("direct", 8).take(&stage.scene());
        // The floor within this view is lit by cos³ ≈ 1.
        mean(&film).is_near_grey(&format!("sheet: {mesh}"), expected, 0.03);
    }
}

/// A checkerboard of opacity lets half through, and the two kinds of cells each wholly, but for their edges, where the
/// mean opacity of the footprint decides by chance.
#[test]
fn textured_masks() {
    let mut stage = Stage::new();
    let inner = stage.add(diffuse(0.0));
    let checks = Node::new(Family::Texture, "checkerboard", None).with("a", 1.0).with("b", 0.0);
    let checks = stage.add(checks.with("scale_u", 8.0).with("scale_v", 8.0));
    let mask = stage.add(material("mask").with("opacity", checks).with("material", inner));
    let mut sheet = rectangle([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]);
    sheet.uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    stage.place_mesh(sheet).material = Some(mask);
    stage.lamp(plane([0.0, 0.0, -1.0], -3.0), 1.0);
    // The frame is the sheet.
    let camera = Node::new(Family::Camera, "orthographic", None).with("screen_window", vec![-2.0, 2.0, -2.0, 2.0]);
    stage.film(32, 32).camera(camera.with("to_world", crate::stage::look_at([0.0, 0.0, -4.0], [0.0; 3])));
    let film = Shot::of("path", 4).take(&stage.scene());
    mean(&film).is_near_grey("half", 0.5, 0.01);
    // Cells are four pixels wide, footprints less than one.
    let is_inner = |at: &usize| [at % 32, at / 32].iter().all(|x| [1, 2].contains(&(x % 4)));
    let inner: Vec<_> = (0..32 * 32).filter(is_inner).map(|at| film.pixels[at].mean()).collect();
    let [lit, dark] = [1.0, 0.0].map(|level| inner.iter().filter(|mean| **mean == [level; 3]).count());
    assert_eq!((lit, dark), (128, 128));
}
