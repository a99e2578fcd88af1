//! Mirages: rays in air whose index changes with height.
//!
//! The ray equation `d/ds (n dr/ds) = ∇n` (Born, Wolf, *Principles of Optics*, eq. 3.2.2), by the classical Runge–Kutta
//! method. Where the index depends on the height alone, `n cos α` (α the angle above the horizontal) is kept; in a
//! linear gradient level rays are arcs of the radius `n/|∇n|`.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use glam::DVec2;

pub const EXPERIMENT: Experiment = Experiment {
    name: "mirage",
    doc: "rays through air over a hot road, an inversion, or a linear gradient of the index",
    source: "Born, Wolf, Principles of Optics, eq. 3.2.2",
    parameters: &[
        Parameter::choice(
            "profile",
            &["road", "inversion", "linear"],
            "hot ground, a warm layer above, or a constant gradient",
        ),
        Parameter::number(
            "strength",
            5e-5,
            (-0.01, 0.01),
            "",
            "change of the index: of the layer, or for each metre of a linear gradient",
        ),
        Parameter::number("scale", 0.3, (1e-3, 1e4), "m", "thickness of the layer"),
        Parameter::number("height", 1.6, (0.0, 1e4), "m", "of the eye"),
        Parameter::number("length", 800.0, (1.0, 1e6), "m", "of the way"),
        Parameter::number("spread", 0.4, (0.0, 30.0), "°", "rays go from this below to this above the horizontal"),
        Parameter::count("rays", 17, (1, 201), "number of rays"),
    ],
    run: Run::Alone(run),
};

/// Index of air of 15 °C for visible light.
const AIR: f64 = 1.000_277;

/// An index by height, and its derivative.
#[derive(Clone, Copy, Debug)]
enum Profile {
    /// `n − a e^(−y/h)`: thin, hot air on the ground.
    Road { strength: f64, scale: f64 },
    /// `n − a / (1 + e^((h₀ − y)/h))`: warm air above the height of 10 layers' thickness.
    Inversion { strength: f64, scale: f64 },
    /// `n + a y`.
    Linear { strength: f64 },
}

impl Profile {
    fn at(self, y: f64) -> (f64, f64) {
        match self {
            Self::Road { strength, scale } => {
                let e = strength * (-y.max(0.0) / scale).exp();
                (AIR - e, e / scale)
            }
            Self::Inversion { strength, scale } => {
                let s = 1.0 / (1.0 + ((10.0 * scale - y) / scale).exp());
                (AIR - strength * s, -strength * s * (1.0 - s) / scale)
            }
            Self::Linear { strength } => (AIR + strength * y, strength),
        }
    }
}

/// A ray: place and `n` times its direction, by arc length over the index, in which the equation is `r'' = n ∇n`.
fn step(profile: Profile, (p, v): (DVec2, DVec2), h: f64) -> (DVec2, DVec2) {
    let force = |p: DVec2| {
        let (n, slope) = profile.at(p.y);
        DVec2::new(0.0, n * slope)
    };
    let (k1, l1) = (v, force(p));
    let (k2, l2) = (v + l1 * (h / 2.0), force(p + k1 * (h / 2.0)));
    let (k3, l3) = (v + l2 * (h / 2.0), force(p + k2 * (h / 2.0)));
    let (k4, l4) = (v + l3 * h, force(p + k3 * h));
    (p + (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0), v + (l1 + l2 * 2.0 + l3 * 2.0 + l4) * (h / 6.0))
}

/// A ray's places from a height at an angle above the horizontal, to a length or the ground, and the largest change of
/// `n cos α`.
fn trace(profile: Profile, height: f64, angle: f64, length: f64, steps: usize) -> (Vec<(f64, f64)>, f64) {
    let n = profile.at(height).0;
    let mut state = (DVec2::new(0.0, height), DVec2::new(angle.cos(), angle.sin()) * n);
    let kept = state.1.x;
    let (mut places, mut drift) = (vec![(0.0, height)], 0.0_f64);
    for _ in 0..2 * steps {
        state = step(profile, state, length / steps as f64 / n);
        let speed = state.1.length();
        drift = drift.max((profile.at(state.0.y).0 * state.1.x / speed / kept - 1.0).abs());
        places.push((state.0.x, state.0.y));
        if state.0.x >= length || state.0.y < 0.0 {
            break;
        }
    }
    (places, drift)
}

fn run(values: &Values) -> Result<Report, Error> {
    let (strength, scale) = (values.number("strength"), values.number("scale"));
    let profile = match values.choice("profile") {
        "road" => Profile::Road { strength, scale },
        "inversion" => Profile::Inversion { strength, scale },
        _ => Profile::Linear { strength },
    };
    let (height, length) = (values.number("height"), values.number("length"));
    if matches!(profile, Profile::Linear { .. }) && (strength * length).abs() > 0.5 {
        return Err(Error::Impossible(
            "the index changes by more than 0.5 over the way: make 'strength' or 'length' smaller".into(),
        ));
    }
    let spread = values.number("spread").to_radians();
    let rays = values.count("rays");
    // Several steps for each thickness of the layer that a ray may cross.
    let steps = ((length * spread.sin().max(0.01) / scale * 50.0) as usize).clamp(2000, 200_000);
    let mut report = Report::default();
    let (mut drift, mut turned) = (0.0_f64, 0);
    let mut chart = Chart::new(
        format!("rays through air, {}", values.choice("profile")),
        Axis::linear("distance (m)").over(0.0, length),
        Axis::linear("height (m)"),
    );
    for k in 0..rays {
        let angle = if rays > 1 { spread * (2.0 * k as f64 / (rays - 1) as f64 - 1.0) } else { -spread };
        let (places, change) = trace(profile, height, angle, length, steps);
        drift = drift.max(change);
        let (start, end) = (places[1].1 - places[0].1, places[places.len() - 1].1 - places[places.len() - 2].1);
        turned += usize::from(start * end < 0.0);
        let every = (places.len() / 400).max(1);
        chart = chart.with(Series::line("", places.into_iter().step_by(every).collect()).colored([0x1f, 0x5f, 0xa8]));
    }
    let (n, slope) = profile.at(height);
    report.quantity("index at the eye", n, "");
    report.quantity("radius of a level ray at the eye", n / slope.abs(), "m");
    report.quantity("rays that turn up or down", turned as f64, "");
    report.quantity("greatest relative change of n cos α", drift, "");
    if let Profile::Road { strength, .. } = profile {
        // n cos α is kept, so a ray turns above the ground where n(0) > n(eye) cos α.
        let ratio = (AIR - strength) / n;
        if (0.0..1.0).contains(&ratio) {
            report.quantity("steepest ray that does not meet the ground", ratio.acos().to_degrees(), "°");
        }
    }
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M141: in a linear gradient a level ray is an arc of the radius n/|∇n| (a catenary of which the arc is the
    /// beginning).
    #[test]
    fn level_rays_are_arcs_in_a_linear_gradient() {
        let profile = Profile::Linear { strength: -1e-4 };
        let (places, drift) = trace(profile, 10.0, 0.0, 200.0, 2000);
        let n = profile.at(10.0).0;
        let radius = n / 1e-4;
        for (x, y) in places {
            // The ray is y = −(n/a) (cosh-like); its fourth-order term is below 1e-6 m here.
            let arc = 10.0 - (radius - (radius * radius - x * x).sqrt());
            assert!((y - arc).abs() < 2e-6 * (1.0 + x), "{x}: {y} {arc}");
        }
        assert!(drift < 1e-12, "{drift}");
    }

    /// n cos α is kept over a hot road, and rays flatter than the limit turn before the ground.
    #[test]
    fn rays_over_a_road_turn_where_they_must() {
        let given = [("rays".to_owned(), "41".to_owned())];
        let r = EXPERIMENT.run(&given, None).unwrap();
        assert!(r.value("greatest relative change of n cos α") < 1e-9);
        let limit = r.value("steepest ray that does not meet the ground").to_radians();
        let profile = Profile::Road { strength: 5e-5, scale: 0.3 };
        let least = |angle: f64| {
            trace(profile, 1.6, angle, 1500.0, 100_000).0.iter().map(|p| p.1).fold(f64::INFINITY, f64::min)
        };
        assert!(least(-0.99 * limit) > 0.0 && least(-1.01 * limit) < 0.0);
    }
}
