//! The layer of halves of samples: what they are, and that they err independently.

use std::sync::Arc;
use steradian::{
    CompileOptions, Control, Layer, Quality, Render, Scene, compile,
    denoise::{self, GUIDES},
    develop,
    film::Film,
    image::{Image, Value},
    integrators::Plan,
    load, render,
};

const SIZE: u32 = 20;

fn cornell_box() -> Arc<Scene> {
    let loaded = load("builtin:cornell-box", &Default::default());
    let options = CompileOptions { size: Some((SIZE, SIZE)), ..CompileOptions::default() };
    Arc::new(compile(&loaded.desc, &options).scene.expect("a sound scene"))
}

fn halved(integrator: &str, spp: u32) -> Quality {
    Quality { layers: vec![Layer::HALVES], seed: Some(1), ..Quality::of(integrator) }.spp(spp)
}

/// The film, taken in two steps, of which the second goes on from what the first saved, with another number of threads.
fn resumed(scene: &Arc<Scene>, render: Render, first: u32) -> Film {
    let with = |threads| Render { plan: Plan { threads, ..render.plan }, ..render.clone() }.session(scene).unwrap();
    let (mut before, mut after, mut state) = (with(1), with(3), Vec::new());
    before.step(first, &Control::default());
    before.save(&mut state).unwrap();
    after.restore(&mut state.as_slice()).unwrap();
    after.step(u32::MAX, &Control::default());
    after.film()
}

/// Both halves make up the picture, of methods by paths of one pixel, of several, in rounds, and by passes, with an odd
/// number of samples too; and come to the same bits with any number of threads and after a stop.
#[test]
fn halves_make_up_the_picture() {
    let scene = cornell_box();
    let adaptive = Quality { adaptive: true, ..halved("path", 64) };
    let cases = [halved("path", 5), halved("path:reuse=16", 6), adaptive, halved("bdpt", 3), halved("direct", 2)];
    for quality in cases {
        let render = quality.render(&scene).unwrap();
        let mut session = render.session(&scene).unwrap();
        session.step(u32::MAX, &Control::default());
        let film = session.film();
        let of_bits = |film: &Film| -> Vec<[u64; 4]> {
            film.halves.iter().map(|h| [h.part[0], h.part[1], h.part[2], h.weight].map(f64::to_bits)).collect()
        };
        let spp = render.plan.sampler.spp;
        assert_eq!(of_bits(&film), of_bits(&resumed(&scene, render, spp / 2)), "{quality:?}");
        let picture = develop(&scene, &film, &quality.layers);
        let plane = |name: &str| picture.channel(name).unwrap_or_else(|| panic!("{name}: {quality:?}"));
        for c in ["R", "G", "B"] {
            let (whole, a, b) = (plane(c), plane(&format!("half_a.{c}")), plane(&format!("half_b.{c}")));
            assert!(a != b, "{quality:?}");
            for (at, half) in film.halves.iter().enumerate() {
                let even = spp.div_ceil(2) as f32 / spp as f32;
                assert!((half.weight as f32 - even).abs() < 1e-6, "{} {quality:?}", half.weight);
                let sum = a[at] * even + b[at] * (1.0 - even);
                assert!((sum - whole[at]).abs() <= 1e-5 * (whole[at].abs() + 1e-3), "{sum} {} {quality:?}", whole[at]);
            }
        }
    }
}

/// A render that stops after its first sample has no second half: the layer is absent.
#[test]
fn one_sample_has_no_halves() {
    let scene = cornell_box();
    let quality = halved("path", 4);
    let mut session = quality.render(&scene).unwrap().session(&scene).unwrap();
    session.step(1, &Control::default());
    assert!(develop(&scene, &session.film(), &quality.layers).channel("half_a.R").is_none());
    session.step(1, &Control::default());
    assert!(develop(&scene, &session.film(), &quality.layers).channel("half_b.B").is_some());
    let refusal = |quality: Quality| quality.render(&scene).unwrap_err().to_string();
    assert!(refusal(halved("path", 1)).contains("two or more"));
    for method in ["light", "sppm", "vcm", "raster", "stokes", "radiosity"] {
        let said = refusal(halved(method, 4));
        assert!(said.contains("'halves'") && said.contains(method), "{said}");
    }
}

/// Over many seeds the errors of both halves have the same variance, and no correlation: of methods by tiles and by
/// passes, by the default sampler, and by one whose points of a pixel fill each other's gaps.
#[test]
fn halves_err_independently() {
    const SEEDS: u64 = 96;
    let scene = cornell_box();
    for (integrator, sampler) in [("path:reuse=1", "zsobol"), ("path:reuse=16", "zsobol"), ("bdpt", "pmj02")] {
        let pictures: Vec<Image> = (0..SEEDS)
            .map(|seed| {
                let quality = Quality { sampler: Some(sampler.into()), seed: Some(seed), ..halved(integrator, 8) };
                render(&scene, &quality).unwrap()
            })
            .collect();
        let of = |name: &str| -> Vec<&[f32]> { pictures.iter().map(|p| p.channel(name).unwrap()).collect() };
        let (a, b) = (of("half_a.G"), of("half_b.G"));
        // By seeds, since pixels of one seed may err alike: products of the errors of both halves, and their squares.
        let (mut products, mut squares, mut count) = (vec![0.0; SEEDS as usize], [0.0; 2], 0.0);
        for at in 0..(SIZE * SIZE) as usize {
            let means = [&a, &b].map(|half| half.iter().map(|p| f64::from(p[at])).sum::<f64>() / SEEDS as f64);
            let errors = |k: usize| [f64::from(a[k][at]) - means[0], f64::from(b[k][at]) - means[1]];
            let variance = (0..products.len()).map(errors).map(|e| e[0] * e[0] + e[1] * e[1]).sum::<f64>() * 0.5;
            if variance <= 1e-12 {
                continue;
            }
            count += 1.0;
            for (k, product) in products.iter_mut().enumerate() {
                let [x, y] = errors(k);
                *product += x * y / variance * SEEDS as f64;
                squares = [squares[0] + x * x / variance, squares[1] + y * y / variance];
            }
        }
        let correlation = products.iter().sum::<f64>() / SEEDS as f64 / count;
        let spread = products.iter().map(|p| (p / count - correlation).powi(2)).sum::<f64>();
        let deviation = (spread / (SEEDS * (SEEDS - 1)) as f64).sqrt();
        let ratio = squares[0] / squares[1];
        assert!(
            deviation < 0.02 && correlation.abs() < 4.0 * deviation,
            "{integrator}, {sampler}: {correlation} ± {deviation}"
        );
        assert!((ratio - 1.0).abs() < 0.1, "{integrator} {sampler}: {squares:?}");
    }
}

/// A picture with halves is denoised as two pictures that guide each other.
#[test]
fn halves_guide_each_other() {
    let scene = cornell_box();
    let layers = [&GUIDES[..], &[Layer::HALVES]].concat();
    let whole = render(&scene, &Quality { layers, independent: true, ..halved("path", 8) }).unwrap();
    let [a, b] = ["half_a", "half_b"].map(|half| {
        let mut picture = Image::new(whole.width(), whole.height());
        for channel in whole.channels().iter().filter(|c| !c.name.starts_with("half_")) {
            let data = match channel.name.as_str() {
                "R" | "G" | "B" => whole.channel(&format!("{half}.{}", channel.name)).unwrap().to_vec(),
                name if name.starts_with("variance") => channel.data.iter().map(|v| 2.0 * v).collect(),
                _ => channel.data.clone(),
            };
            picture.push(channel.name.clone(), data).unwrap();
        }
        picture
    });
    let (one, two) = (denoise::picture(&whole, None, 1.0).unwrap(), denoise::picture(&a, Some(&b), 1.0).unwrap());
    assert!(one.error.is_some_and(|e| e > 0.0) && one.error == two.error);
    for c in ["R", "G", "B"] {
        assert_eq!(one.picture.channel(c), two.picture.channel(c));
        assert_eq!(one.picture.channel(&format!("raw.{c}")), whole.channel(c));
    }
    let told = one.picture.metadata.get("steradian:denoised_relative_error");
    assert!(matches!(told, Some(Value::Float(e)) if Some(f64::from(*e)) == one.error.map(|e| f64::from(e as f32))));
    // Again from what was noisy, and by a filter that tells no error.
    assert_eq!(denoise::picture(&one.picture, None, 1.0).unwrap().picture.channels(), one.picture.channels());
    let quick = denoise::quick(&one.picture).unwrap();
    assert!(quick.error.is_none() && quick.picture.metadata.get("steradian:denoised_relative_error").is_none());
}

/// Pixels of which the picture is not known are not known of its halves either, and are told; a picture without a
/// single known pixel is refused by all filters, with the channels that are known nowhere.
#[test]
fn halves_do_not_hide_what_is_unknown() {
    let scene = cornell_box();
    let layers = [&GUIDES[..], &[Layer::HALVES]].concat();
    let whole = render(&scene, &Quality { layers, independent: true, ..halved("path", 8) }).unwrap();
    let without = |is_unknown: &dyn Fn(usize, &str) -> bool| {
        let mut picture = Image::new(whole.width(), whole.height());
        for channel in whole.channels() {
            let value = |(k, v): (usize, &f32)| if is_unknown(k, &channel.name) { f32::NAN } else { *v };
            picture.push(channel.name.clone(), channel.data.iter().enumerate().map(value).collect::<Vec<_>>()).unwrap();
        }
        picture
    };
    let some = denoise::picture(&without(&|k, name| name == "B" && k % 7 == 0), None, 1.0).unwrap();
    assert_eq!(some.not_finite, (SIZE * SIZE).div_ceil(7) as usize);
    assert!(["R", "G", "B"].iter().all(|c| some.picture.channel(c).unwrap().iter().all(|v| v.is_finite())));
    let refused = |picture: &Image| {
        let by_nlm = denoise::picture(picture, None, 1.0).unwrap_err().to_string();
        assert_eq!(by_nlm, denoise::quick(picture).unwrap_err().to_string());
        assert_eq!(by_nlm, denoise::Sequence::default().picture(picture).unwrap_err().to_string());
        by_nlm
    };
    assert!(refused(&without(&|_, name| name == "B")).starts_with("no value of the channel 'B' is finite"));
    assert!(refused(&without(&|_, name| "RG".contains(name))).contains("channels 'R', 'G'"));
    let none = refused(&without(&|k, name| if k % 2 == 0 { name == "R" } else { name == "G" }));
    assert!(none.contains("'R', 'G' and 'B' at once"), "{none}");
}
