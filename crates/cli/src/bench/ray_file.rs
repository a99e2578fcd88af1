//! Files of rays: a little-endian `u64` count, then for each ray seven `f32`: origin, direction, and where its interval
//! ends.

use steradian::math::{Ray, Vec3};

/// Bytes before the rays.
const HEADER: usize = 8;
/// Bytes of a ray.
const RAY: usize = 28;

/// Reads rays. Their numbers may be anything, NaN included.
///
/// # Errors
/// What is wrong, and at which byte, when the file is not as long as its count says.
pub fn read(bytes: &[u8]) -> Result<Vec<Ray>, String> {
    let Some((count, rays)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(format!(
            "byte {}: the file ends within the count of rays, which takes {HEADER} bytes",
            bytes.len()
        ));
    };
    let count = u64::from_le_bytes(*count);
    let held = (rays.len() / RAY) as u64;
    if count > held {
        let place = match rays.len() % RAY {
            0 => String::new(),
            part => format!(" and {part} of {RAY} bytes of another"),
        };
        return Err(format!("byte {}: the file ends after {held} rays{place}, but its count is {count}", bytes.len()));
    }
    let end = count as usize * RAY;
    if rays.len() > end {
        let more = rays.len() - end;
        return Err(format!("byte {}: {more} bytes follow the {count} rays that the count tells of", HEADER + end));
    }
    let ray = |ray: &[u8]| {
        let number = |i: usize| f32::from_le_bytes([ray[4 * i], ray[4 * i + 1], ray[4 * i + 2], ray[4 * i + 3]]);
        let vector = |i: usize| Vec3::new(number(i), number(i + 1), number(i + 2));
        Ray { t_max: number(6), ..Ray::new(vector(0), vector(3)) }
    };
    Ok(rays.chunks_exact(RAY).map(ray).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with a count and some numbers.
    fn file(count: u64, numbers: &[f32]) -> Vec<u8> {
        count.to_le_bytes().into_iter().chain(numbers.iter().flat_map(|x| x.to_le_bytes())).collect()
    }

    #[test]
    fn rays_are_read_in_order() {
        let mut numbers: Vec<f32> = (0..14).map(|i| i as f32).collect();
        numbers[9] = f32::NAN;
        let rays = read(&file(2, &numbers)).expect("a sound file");
        assert_eq!(rays.len(), 2);
        assert_eq!((rays[0].origin, rays[0].direction), (Vec3::new(0.0, 1.0, 2.0), Vec3::new(3.0, 4.0, 5.0)));
        assert_eq!((rays[0].t_max, rays[1].t_max), (6.0, 13.0));
        assert!(rays[1].origin.z.is_nan());
        assert!(read(&file(0, &[])).is_ok_and(|rays| rays.is_empty()));
    }

    #[test]
    fn lengths_that_do_not_fit_are_located() {
        let message = |bytes: &[u8]| read(bytes).expect_err("not a sound file");
        assert!(message(&[1, 0, 0]).starts_with("byte 3: "));
        assert!(message(&[]).starts_with("byte 0: "));
        let two = file(2, &[0.0; 14]);
        assert!(message(&two[..two.len() - 5]).starts_with("byte 59: the file ends after 1 rays and 23 of 28"));
        assert!(message(&file(3, &[0.0; 14])).starts_with("byte 64: the file ends after 2 rays, but"));
        assert!(message(&file(u64::MAX, &[0.0; 14])).contains(&u64::MAX.to_string()));
        assert!(message(&file(1, &[0.0; 14])).starts_with("byte 36: 28 bytes follow"));
    }
}
