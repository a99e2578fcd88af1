//! Direct light of a rectangle: one sample of next-event estimation.

use crate::{
    exercise::{Exercise, Function, Law, Mistake, Tolerance, texts},
    laws::{SAMPLES, mean},
    points::{Random, vector},
};
use std::f64::consts::{FRAC_1_PI, PI};
use steradian_math::DVec3;

/// The only function.
const F: &str = "direct";

pub(super) static EXERCISE: Exercise = Exercise {
    name: "next-event",
    chapter: 2,
    title: "Direct light of a rectangular lamp by one random point on it",
    functions: &[Function {
        name: F,
        inputs: &["albedo", "radiance", "corner[3]", "a[3]", "b[3]", "visible", "u[2]"],
        outputs: &["L"],
        reference: Some(|p| vec![Scene::of(p).light(&Form::RIGHT)]),
        points,
    }],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            F,
            "no-area",
            "The point was drawn with density 1/A per m²: the division by it, a factor of the lamp's area, is \
            missing.",
            |p| with(p, &Form { area: |_| 1.0, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "no-lamp-cosine",
            "The lamp's own cosine, which makes an area seen from the side count less, is missing.",
            |p| with(p, &Form { lamp: |c| if c > 0.0 { 1.0 } else { 0.0 }, ..Form::RIGHT }),
        ),
        Mistake::values(F, "no-surface-cosine", "The cosine at the lit surface is missing.", |p| {
            with(p, &Form { surface: |c| if c > 0.0 { 1.0 } else { 0.0 }, ..Form::RIGHT })
        }),
        Mistake::values(F, "distance-once", "Light falls with the square of the distance.", |p| {
            with(p, &Form { distance: |r| r, ..Form::RIGHT })
        }),
        Mistake::values(
            F,
            "four-pi",
            "4π r² belongs to a point light of a given flux; the area form has r² alone.",
            |p| with(p, &Form { distance: |r| 4.0 * PI * r * r, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "two-sided",
            "The lamp shines on the side of a × b only; behind it there is no light. Is its cosine clamped at 0?",
            |p| with(p, &Form { lamp: f64::abs, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "lit-from-behind",
            "A surface is lit from its own side only: the cosine at the surface must be clamped at 0.",
            |p| with(p, &Form { surface: f64::abs, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "other-side",
            "It shines on the wrong side: the lamp's normal is a × b, not b × a (or the direction at the lamp is \
            turned around).",
            |p| with(p, &Form { lamp: |c| (-c).max(0.0), ..Form::RIGHT }),
        ),
        Mistake::values(F, "no-pi", "The BRDF of a matt surface is albedo/π.", |p| {
            with(p, &Form { brdf: 1.0, ..Form::RIGHT })
        }),
        Mistake::values(F, "no-shadow", "Where `visible` is 0 something stands between, and no light arrives.", |p| {
            with(p, &Form { shadow: false, ..Form::RIGHT })
        }),
    ],
    laws: &[Law {
        name: "mean below the middle of a lamp",
        functions: &[F],
        questions: || {
            let mut random = Random::new(22);
            let scene = [1.0, 2.0, -1.0, -0.5, 1.0, 0.0, 1.0, 0.0, 2.0, 0.0, 0.0, 1.0];
            (0..SAMPLES).map(|_| (F, [&scene[..], &[random.unit(), random.unit()]].concat())).collect()
        },
        // Four quarters of 1 × ½ at height 1.
        judge: |exercise, answers| mean(exercise, F, 2.0 * 4.0 * quarter(1.0, 0.5), answers),
    }],
    texts: texts!("next-event"),
};

/// Form factor of a rectangle of sides `a`, `b` above a point below its corner, for height 1 (Howell, *Catalog of
/// Radiation Heat Transfer Configuration Factors*, B-3).
fn quarter(a: f64, b: f64) -> f64 {
    let (ra, rb) = (a.hypot(1.0), b.hypot(1.0));
    (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) * 0.5 * FRAC_1_PI
}

fn points() -> Vec<Vec<f64>> {
    let mut random = Random::new(21);
    let mut one = |i: usize| {
        let mut spread = |s: f64| [0; 3].map(|_| random.between(-s, s));
        let [x, y, z] = spread(1.0);
        // Some lamps reach below the surface.
        let corner = [x, y, if i.is_multiple_of(5) { z } else { z + 2.0 }];
        let (a, b) = (spread(1.5), spread(1.5));
        let head = [random.between(0.2, 1.0), random.between(0.5, 5.0)];
        let tail = [if i % 7 == 6 { 0.0 } else { 1.0 }, random.unit(), random.unit()];
        let mut p = [&head[..], &corner, &a, &b, &tail].concat();
        // Most lamps shine on the surface, so that wrong factors show.
        if !i.is_multiple_of(4) && Scene::of(&p).to_lamp() < 0.0 {
            (5..8).for_each(|k| p.swap(k, k + 3));
        }
        p
    };
    let simple = [0.5, 1.0, -1.0, -1.0, 2.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.25, 0.5];
    std::iter::once(simple.to_vec()).chain((0..80).map(&mut one)).collect()
}

/// A question by its parts.
struct Scene {
    albedo: f64,
    radiance: f64,
    /// The point on the lamp.
    y: DVec3,
    /// `a × b`.
    lamp: DVec3,
    visible: bool,
}

/// The factors of a variant.
struct Form {
    area: fn(f64) -> f64,
    lamp: fn(f64) -> f64,
    surface: fn(f64) -> f64,
    distance: fn(f64) -> f64,
    brdf: f64,
    shadow: bool,
}

impl Form {
    const RIGHT: Self = Self {
        area: |a| a,
        lamp: |c| c.max(0.0),
        surface: |c| c.max(0.0),
        distance: |r| r * r,
        brdf: FRAC_1_PI,
        shadow: true,
    };
}

fn with(p: &[f64], form: &Form) -> Vec<f64> {
    vec![Scene::of(p).light(form)]
}

impl Scene {
    fn of(p: &[f64]) -> Self {
        let at = |first| DVec3::from_array(vector(p, first));
        let (a, b) = (at(5), at(8));
        let y = at(2) + p[12] * a + p[13] * b;
        Self { albedo: p[0], radiance: p[1], y, lamp: a.cross(b), visible: p[11] != 0.0 }
    }

    fn to_lamp(&self) -> f64 {
        -self.lamp.normalize_or(DVec3::Z).dot(self.y.normalize_or(DVec3::Z))
    }

    fn light(&self, form: &Form) -> f64 {
        if form.shadow && !self.visible {
            return 0.0;
        }
        let cosines = (form.surface)(self.y.normalize_or(DVec3::Z).z) * (form.lamp)(self.to_lamp());
        let area = (form.area)(self.lamp.length());
        self.albedo * form.brdf * self.radiance * cosines * area / (form.distance)(self.y.length())
    }
}
