//! Linear maps: shears, mirrors and scalings, on a cube, a point and a normal.
//!
//! A shear slides the cards of a deck, `x' = x + a y + b z`, `y' = y + c z`: its determinant is one. A mirror has −1
//! and turns round the winding of triangles. Normals follow the inverse transpose. A scale of zero flattens space and
//! has no inverse.

use super::{RANGE, drawing, tell_matrix, tell3, vector3};
use crate::laboratory::{Error, Experiment, Parameter, Report, Run, Values};
use glam::DMat3;
use steradian_math::transform::Transform;

pub const EXPERIMENT: Experiment = Experiment {
    name: "map",
    doc: "a shear, a mirror or a scaling: matrix, determinant, handedness, images of a point and of a normal",
    source: "Strang, Introduction to Linear Algebra, §8; Householder 1958",
    parameters: &[
        Parameter::choice("kind", &["shear", "mirror", "scale"], "which map"),
        Parameter::number("a", 0.5, (-1e3, 1e3), "", "of x by y; x of the mirror's normal; scale along x"),
        Parameter::number("b", 0.25, (-1e3, 1e3), "", "of x by z; y of the mirror's normal; scale along y"),
        Parameter::number("c", 0.4, (-1e3, 1e3), "", "of y by z; z of the mirror's normal; scale along z"),
        Parameter::number("x", 1.0, RANGE, "", "the point, and the normal"),
        Parameter::number("y", 1.0, RANGE, "", "the point, and the normal"),
        Parameter::number("z", 1.0, RANGE, "", "the point, and the normal"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let numbers = vector3(values, ["a", "b", "c"]);
    let map = match values.choice("kind") {
        "mirror" => Transform::mirror(numbers)
            .ok_or_else(|| Error::Impossible("the normal of the mirror ('a', 'b', 'c') is zero".into()))?,
        "scale" => Transform::scale(numbers),
        _ => Transform::shear(numbers.x, numbers.y, numbers.z),
    };
    let p = vector3(values, ["x", "y", "z"]);
    let m = DMat3::from_mat4(map.matrix);
    let mut report = Report::default();
    tell_matrix(&mut report, m);
    let determinant = m.determinant();
    report.quantity("determinant, the volume of the unit cube's image", determinant + 0.0, "");
    report.fact(
        "handedness",
        match determinant {
            0.0 => "none: space is flattened",
            _ if map.swaps_handedness() => "swapped, and the winding of triangles with it",
            _ => "kept",
        },
    );
    tell3(&mut report, "image of the point", map.point(p));
    match map.inverse() {
        Some(inverse) => {
            tell3(&mut report, "point that is mapped there", inverse.point(p));
            let normal = DMat3::from_mat4(inverse.matrix).transpose() * p;
            tell3(&mut report, "image as a normal", normal.normalize_or_zero());
        }
        None => report.fact("inverse", "none: the map is singular"),
    }
    report.chart = Some(drawing::cube_and_image(|p| map.point(p)));
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M19, M20: by hand: the shear takes (1, 1, 1) to (1.75, 1.4, 1) and keeps volume; the mirror in x = y swaps x and
    /// y and the handedness; a scale of zero has no inverse; under a stretch of 2 along z the normal (0, 1, 1) tilts to
    /// (0, 2, 1)/√5.
    #[test]
    fn maps_by_hand() {
        let shear = run_with(&EXPERIMENT, &[]).unwrap();
        let image = |r: &Report| ["x", "y", "z"].map(|a| r.value(&format!("image of the point, {a}")));
        assert_eq!(image(&shear), [1.75, 1.4, 1.0]);
        assert_eq!(
            (shear.value("determinant, the volume of the unit cube's image"), shear.facts[0].text.as_str()),
            (1.0, "kept")
        );
        let mirror =
            run_with(&EXPERIMENT, &[("kind", "mirror"), ("a", "1"), ("b", "-1"), ("c", "0"), ("x", "3")]).unwrap();
        assert!(image(&mirror).iter().zip([1.0, 3.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(mirror.facts[0].text.contains("swapped"));
        let flat = run_with(&EXPERIMENT, &[("kind", "scale"), ("a", "0")]).unwrap();
        assert!(flat.facts.iter().any(|f| f.text.contains("singular")) && flat.facts[0].text.contains("flattened"));
        let given = [("kind", "scale"), ("a", "1"), ("b", "1"), ("c", "2"), ("x", "0")];
        let stretch = run_with(&EXPERIMENT, &given).unwrap();
        assert!((stretch.value("image as a normal, y") - 2.0 / 5f64.sqrt()).abs() < 1e-12);
        assert!(run_with(&EXPERIMENT, &[("kind", "mirror"), ("a", "0"), ("b", "0"), ("c", "0")]).is_err());
    }
}
