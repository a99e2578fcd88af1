//! Open Image Denoise, where `STERADIAN_OIDN` names its library; without, what is no such library is refused.

// Tests say on stdout what they skip.
#![expect(clippy::print_stdout, reason = "output of the program or test")]

use std::{env, fs, path::Path};
use steradian_denoise::{
    Image,
    oidn::{Error, Oidn},
};
use steradian_math::Vec3;

fn library(threads: usize) -> Option<Oidn> {
    let Some(path) = env::var_os("STERADIAN_OIDN") else {
        println!("SKIPPED: STERADIAN_OIDN does not name the library of Open Image Denoise");
        return None;
    };
    Some(Oidn::load(Path::new(&path), threads).unwrap())
}

/// From 0 to 1, equally distributed.
fn random(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / u32::MAX as f32
}

const SIZE: [u32; 2] = [72, 50];

/// Two halves of albedo 0.2 and 0.8 under light of 2, exactly and with noise of an exponential distribution.
fn scene() -> [Image<Vec3>; 3] {
    let (mut state, [width, height]) = (1, SIZE);
    let albedo = Image::from_fn(width, height, |x, _| Vec3::splat(if x < width / 2 { 0.2 } else { 0.8 }));
    let exact = Image::from_fn(width, height, |x, y| *albedo.get(x, y).unwrap() * 2.0);
    let noisy = Image::from_fn(width, height, |x, y| {
        *exact.get(x, y).unwrap() * Vec3::from_array([(); 3].map(|()| -f32::ln(1.0 - 0.999_999 * random(&mut state))))
    });
    [albedo, exact, noisy]
}

fn error(a: &Image<Vec3>, b: &Image<Vec3>) -> f32 {
    let squares: f32 = a.values().iter().zip(b.values()).map(|(a, b)| (*a - *b).length_squared()).sum();
    squares / (3 * a.values().len()) as f32
}

#[test]
fn noise_falls_and_edges_stay() {
    let Some(oidn) = library(2) else { return };
    assert_eq!(oidn.version()[0], 2);
    let [albedo, exact, noisy] = scene();
    let normal = Image::filled(SIZE[0], SIZE[1], Vec3::Z);
    let alone = oidn.denoise(&noisy, None, None).unwrap();
    let guided = oidn.denoise(&noisy, Some(&albedo), Some(&normal)).unwrap();
    let [before, alone, guided] = [&noisy, &alone, &guided].map(|image| error(image, &exact));
    assert!(alone < before / 30.0 && guided < before / 100.0, "{before} to {alone} and {guided}");
}

/// Also that guides of noise, normals without albedo, and what is not finite do no harm.
#[test]
fn hostile_pictures_are_filtered() {
    let Some(oidn) = library(1) else { return };
    let [albedo, _, noisy] = scene();
    assert_eq!(oidn.denoise(&noisy, None, Some(&albedo)).unwrap(), oidn.denoise(&noisy, None, None).unwrap());
    let mut broken = noisy;
    for (place, bad) in [(7, f32::NAN), (900, f32::INFINITY), (1700, f32::NEG_INFINITY), (3000, -1e30), (3100, 1e38)] {
        broken.values_mut()[place] = Vec3::new(bad, 1.0, bad);
    }
    let found = oidn.denoise(&broken, Some(&broken), Some(&broken)).unwrap();
    assert!(found.values().iter().all(|v| v.is_finite() && v.min_element() >= 0.0));
    for size in [[1, 1], [1, 40], [40, 1]] {
        let image = Image::filled(size[0], size[1], Vec3::ONE);
        assert_eq!(oidn.denoise(&image, Some(&image), Some(&image)).unwrap().size(), size);
    }
    let other = Image::filled(3, 3, Vec3::ONE);
    assert!(matches!(oidn.denoise(&broken, Some(&other), None), Err(Error::Image(_))));
    assert!(matches!(oidn.denoise(&Image::filled(0, 3, Vec3::ONE), None, None), Err(Error::Image(_))));
}

#[test]
fn threads_do_not_change_the_picture() {
    let [albedo, _, noisy] = scene();
    let [Some(one), Some(two)] = [1, 2].map(library) else { return };
    let [one, two] = [one, two].map(|oidn| oidn.denoise(&noisy, Some(&albedo), None).unwrap());
    assert_eq!(one, two);
}

/// A path that is relative, a file that is not there, a text, a folder, a pipe, a device, and a library of something
/// else.
#[test]
fn what_is_no_such_library_is_refused() {
    let folder = fs::canonicalize(env::temp_dir()).unwrap();
    let text = folder.join(format!("steradian-oidn-{}.so", std::process::id()));
    fs::write(&text, "no library").unwrap();
    for path in [&text, &folder, &folder.join("none.so")] {
        let refusal = Oidn::load(path, 1).unwrap_err();
        assert!(matches!(refusal, Error::Load(_)), "{}: {refusal}", path.display());
    }
    fs::remove_file(&text).unwrap();
    assert!(matches!(Oidn::load(Path::new("libm.so.6"), 1), Err(Error::Relative)));
    #[cfg(unix)]
    {
        // Nobody ever writes into this pipe.
        assert!(std::process::Command::new("mkfifo").arg(&text).status().unwrap().success());
        let refusal = Oidn::load(&text, 1).unwrap_err();
        fs::remove_file(&text).unwrap();
        assert!(matches!(refusal, Error::Irregular), "{refusal}");
        assert!(matches!(Oidn::load(Path::new("/dev/zero"), 1), Err(Error::Irregular)));
    }
    let places = ["/lib/x86_64-linux-gnu", "/lib/aarch64-linux-gnu", "/lib64", "/usr/lib"];
    let Some(other) = places.map(|place| Path::new(place).join("libm.so.6")).into_iter().find(|p| p.is_file()) else {
        println!("SKIPPED: no libm.so.6 is where systems have it");
        return;
    };
    let refusal = Oidn::load(&other, 1).unwrap_err();
    assert!(matches!(refusal, Error::Lacks("oidnNewDevice")), "{refusal}");
}
