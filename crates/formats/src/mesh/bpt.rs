//! Bézier patches in text, as the Utah teapot is handed down: their number, then for each its degrees (3 and 3) and
//! four rows of four points.

use super::{
    MeshError, MeshErrorKind as Kind,
    text::{double, integer, is_space, shown},
};
use steradian_math::{
    DVec3,
    geometry::bezier::{self, BezierPatch},
};
use steradian_scene::Mesh;

/// The patches as triangles, as fine as their curvature asks. By custom z is up in such files; here it is y.
///
/// # Errors
/// Where the text is not as said, and where there are too many patches.
pub fn read(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let mut at = 0;
    let count = whole(bytes, &mut at, "the number of patches")?;
    if count == 0 {
        return Err(MeshError::in_text(Kind::Missing, bytes, 0, "there are no patches"));
    }
    let mut patches = Vec::new();
    for patch in 1..=count {
        let start = at;
        let degrees = [(); 2].map(|()| whole(bytes, &mut at, "a degree"));
        let [u, v] = degrees;
        let (u, v) = (u?, v?);
        if (u, v) != (3, 3) {
            let message = format!("patch {patch} is of degrees {u} and {v}; only 3 and 3 are read");
            return Err(MeshError::in_text(Kind::Unsupported, bytes, after_spaces(bytes, start), message));
        }
        let mut points = [DVec3::ZERO; 16];
        for p in &mut points {
            *p = DVec3::new(number(bytes, &mut at)?, number(bytes, &mut at)?, number(bytes, &mut at)?);
            *p = DVec3::new(p.x, p.z, -p.y);
        }
        patches.push(BezierPatch { points });
    }
    if after_spaces(bytes, at) < bytes.len() {
        let (word, start) = next(bytes, &mut at);
        let message = format!("after {count} patches the end is expected, not '{}'", shown(word));
        return Err(MeshError::in_text(Kind::Syntax, bytes, start, message));
    }
    match bezier::tessellate(&patches, bezier::segments(&patches)) {
        Some(mesh) => Ok(mesh.into()),
        None => Err(MeshError::in_text(Kind::TooLarge, bytes, 0, format!("{count} patches are too many"))),
    }
}

fn after_spaces(bytes: &[u8], at: usize) -> usize {
    at + bytes[at..].iter().take_while(|b| is_space(**b) || **b == b',').count()
}

/// The next word and where it starts.
fn next<'a>(bytes: &'a [u8], at: &mut usize) -> (&'a [u8], usize) {
    let start = after_spaces(bytes, *at);
    let length = bytes[start..].iter().take_while(|b| !is_space(**b) && **b != b',').count();
    *at = start + length;
    (&bytes[start..*at], start)
}

fn whole(bytes: &[u8], at: &mut usize, what: &str) -> Result<i64, MeshError> {
    let (word, start) = next(bytes, at);
    match integer(word) {
        Some(n) if n >= 0 => Ok(n),
        _ => Err(wrong(bytes, word, start, what)),
    }
}

fn number(bytes: &[u8], at: &mut usize) -> Result<f64, MeshError> {
    let (word, start) = next(bytes, at);
    match double(word) {
        Some(v) if (v as f32).is_finite() => Ok(v),
        Some(_) => {
            let message = format!("the coordinate '{}' is not a finite number", shown(word));
            Err(MeshError::in_text(Kind::NotFinite, bytes, start, message))
        }
        None => Err(wrong(bytes, word, start, "a coordinate")),
    }
}

fn wrong(bytes: &[u8], word: &[u8], start: usize, what: &str) -> MeshError {
    let (kind, found) = match word {
        [] => (Kind::Truncated, "the end of the file".into()),
        word => (Kind::Syntax, format!("'{}'", shown(word))),
    };
    MeshError::in_text(kind, bytes, start, format!("expected {what}, found {found}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(degrees: &str) -> String {
        let points: String = (0..16).map(|k| format!("{} {},0.5\n", k % 4, k / 4)).collect();
        format!("{degrees}\n{points}")
    }

    #[test]
    fn patches_become_triangles() {
        let one = read(format!("1\n{}", flat("3 3")).as_bytes()).unwrap();
        assert_eq!((one.positions.len(), one.triangles.len()), (4, 2), "a flat patch needs no more");
        // z is up there, y here.
        assert_eq!(
            (one.positions[0], one.positions[3], one.normals[0]),
            ([0.0, 0.5, 0.0], [3.0, 0.5, -3.0], [0.0, 1.0, 0.0])
        );
        let two = read(format!("2\r\n{}{}", flat("3 3"), flat("3 3").replace("0.5", "2")).as_bytes()).unwrap();
        assert_eq!(two.triangles.len(), 4);
        two.validate().unwrap();
    }

    #[test]
    fn faults_have_their_place() {
        for (text, kind, said) in [
            (String::new(), Kind::Truncated, "the number of patches"),
            ("one".into(), Kind::Syntax, "found 'one'"),
            ("-1".into(), Kind::Syntax, "the number of patches"),
            (format!("1\n{}", flat("2 3")), Kind::Unsupported, "degrees 2 and 3"),
            (format!("2\n{}", flat("3 3")), Kind::Truncated, "a degree"),
            (format!("999999999999\n{}", flat("3 3")), Kind::Truncated, "a degree"),
            (format!("1\n{}", flat("3 3").replace("0.5", "1e99")), Kind::NotFinite, "'1e99'"),
            (format!("1\n{}", flat("3 3").replace("3 3,", "3 x,")), Kind::Syntax, "'x'"),
            (format!("1\n{} 7", flat("3 3")), Kind::Syntax, "the end is expected"),
            ("0".into(), Kind::Missing, "no patches"),
        ] {
            let e = read(text.as_bytes()).unwrap_err();
            assert!(e.kind == kind && e.message.contains(said), "{text}: {e:?}");
        }
    }
}
