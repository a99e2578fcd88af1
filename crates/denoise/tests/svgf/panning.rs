//! A still scene before a camera that moves.

use steradian_denoise::Image;
use steradian_math::{Vec2, Vec3};

use crate::scene::{blind, frame, largest, noise, wall};

/// The bits of the picture are those of a camera that stands still, where it was seen all the time.
#[test]
fn a_pan_by_whole_pixels_has_the_history_of_no_pan() {
    const FRAMES: u32 = 9;
    let (width, height, [dx, dy]) = (40, 30, [3, 2]);
    let world = [width + dx * FRAMES, height + dy * FRAMES];
    let (mut still, mut panning) = (blind(0), blind(0));
    let mut gbuffer = wall(width, height);
    gbuffer.motion = Image::filled(width, height, Vec2::new(dx as f32, dy as f32));
    for n in 0..FRAMES {
        let all = noise(world[0], world[1], u64::from(n));
        let place = |x, y| (x + dx * n, y + dy * n);
        let seen = |x, y| {
            let (x, y) = place(x, y);
            *all.get(x, y).unwrap()
        };
        let expected = frame(&mut still, &all, &wall(world[0], world[1]));
        let found = frame(&mut panning, &Image::from_fn(width, height, seen), &gbuffer);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            // For so many frames before this one the place was in the picture.
            let before = ((width - 1 - x) / dx).min((height - 1 - y) / dy).min(n);
            assert_eq!(found.history.get(x, y), Some(&(before + 1)), "{x}, {y} in frame {n}");
            let (i, j) = place(x, y);
            if before == n {
                assert_eq!(found.radiance.get(x, y), expected.radiance.get(i, j));
            }
        }
    }
}

/// Bilinear taps are exact for what is linear.
#[test]
fn a_pan_by_fractions_keeps_what_is_linear() {
    let (width, height, pan) = (50, 40, Vec2::new(0.3, -1.7));
    let mut gbuffer = wall(width, height);
    gbuffer.motion = Image::filled(width, height, pan);
    let mut denoiser = blind(0);
    for n in 0..20 {
        let offset = pan * n as f32;
        let seen =
            |x: u32, y: u32| Vec3::new(1.0, 0.5, -0.2) * (0.1 * (x as f32 + offset.x) - 0.07 * (y as f32 + offset.y));
        let radiance = Image::from_fn(width, height, seen);
        let found = frame(&mut denoiser, &radiance, &gbuffer);
        let pairs = found.radiance.values().iter().zip(radiance.values()).zip(found.history.values());
        // At the border only some of the taps are inside; further in all are, and histories long.
        let inside = pairs.enumerate().filter(|(i, _)| {
            let (x, y) = (*i as u32 % width, *i as u32 / width);
            x < width - 1 - n.min(10) && y > 2 * n
        });
        let mut compared = 0;
        let error = largest(inside.map(|(_, ((a, b), &history))| {
            assert_eq!(history, n + 1);
            compared += 1;
            (a - b).abs().max_element()
        }));
        assert!(error < 1e-4 && (n > 15 || compared > 100), "{error} in frame {n}");
    }
}

/// The camera comes nearer by a tenth in each frame: depths change, histories stay.
#[test]
fn depths_are_compared_as_they_were() {
    let (width, height) = (20, 20);
    let mut gbuffer = wall(width, height);
    let mut denoiser = blind(0);
    for n in 0..5 {
        let depth = 10.0 * 0.9f32.powi(n);
        gbuffer.previous_depth = Image::filled(width, height, depth / 0.9);
        gbuffer.depth = Image::filled(width, height, depth);
        let found = frame(&mut denoiser, &noise(width, height, n as u64), &gbuffer);
        assert!(found.history.values().iter().all(|&history| history == n as u32 + 1));
    }
    // The wall is gone, and another behind it is seen: as deep as it was, but not there before.
    gbuffer.depth = Image::filled(width, height, 20.0);
    gbuffer.previous_depth = gbuffer.depth.clone();
    let found = frame(&mut denoiser, &noise(width, height, 9), &gbuffer);
    assert!(found.history.values().iter().all(|&history| history == 1));
    gbuffer.normal = Image::filled(width, height, Vec3::X);
    let found = frame(&mut denoiser, &noise(width, height, 9), &gbuffer);
    assert!(found.history.values().iter().all(|&history| history == 1));
}
