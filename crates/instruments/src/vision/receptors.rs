//! Density of rods and cones over the retina (Curcio et al. 1990, data of figures 6 and 9: means of eight eyes), and
//! their number: densities integrated over a sphere as large as the eye, as far as they were measured.
//!
//! Cones crowd in the fovea, which has no rods; rods are densest at the distance of the blind spot, where neither is.

use super::blind_spot;
use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use std::f64::consts::TAU;

pub const EXPERIMENT: Experiment = Experiment {
    name: "receptors",
    doc: "density of the rods and cones of the retina by distance from the fovea, and their number",
    source: "Curcio, Sloan, Kalina, Hendrickson 1990 (figures 6 and 9)",
    parameters: &[
        Parameter::choice("meridian", &["temporal", "nasal", "superior", "inferior"], "direction on the retina"),
        Parameter::number("eccentricity", 10.0, (0.0, 90.0), "°", "distance from the fovea that is described"),
    ],
    run: Run::Alone(run),
};

/// Meridians in the order of the table.
const MERIDIANS: [&str; 4] = ["temporal", "nasal", "superior", "inferior"];

/// Radius of the sphere whose area is that of the retina, mm.
const RADIUS: f64 = 11.06;

/// Mark of a density that was not measured.
const NONE: f64 = f64::NAN;

/// Distance from the fovea on the retina (mm) and in the field of view (°), cones and rods for each mm² on the four
/// meridians.
const TABLE: [(f64, f64, [f64; 4], [f64; 4]); 34] = [
    (0.0, 0.0, [196_890.0, 196_890.0, 196_890.0, 196_890.0], [0.0, 0.0, 0.0, 0.0]),
    (0.05, 0.18, [162_414.0, 154_441.0, 140_595.0, 145_724.0], [13.0, 0.0, 66.0, 0.0]),
    (0.1, 0.36, [121_619.0, 115_399.0, 105_146.0, 107_325.0], [74.0, 24.0, 446.0, 158.0]),
    (0.15, 0.54, [98_424.0, 92_992.0, 83_182.0, 85_645.0], [1_022.0, 204.0, 1_864.0, 966.0]),
    (0.2, 0.71, [80_004.0, 74_233.0, 65_106.0, 68_785.0], [3_864.0, 969.0, 6_304.0, 4_321.0]),
    (0.3, 1.07, [57_712.0, 53_432.0, 46_900.0, 50_905.0], [13_439.0, 11_023.0, 23_430.0, 18_492.0]),
    (0.4, 1.43, [45_420.0, 42_975.0, 35_696.0, 39_422.0], [26_877.0, 22_395.0, 41_122.0, 33_777.0]),
    (0.5, 1.79, [38_380.0, 36_493.0, 28_034.0, 32_397.0], [36_675.0, 33_699.0, 52_027.0, 43_321.0]),
    (0.6, 2.14, [34_223.0, 31_530.0, 24_346.0, 28_194.0], [45_316.0, 43_492.0, 59_992.0, 49_407.0]),
    (0.7, 2.5, [29_027.0, 26_109.0, 21_232.0, 24_597.0], [53_390.0, 50_971.0, 67_695.0, 55_307.0]),
    (0.8, 2.86, [24_144.0, 23_872.0, 19_249.0, 21_911.0], [60_097.0, 57_762.0, 73_859.0, 61_376.0]),
    (0.9, 3.21, [21_165.0, 22_339.0, 17_453.0, 19_205.0], [64_875.0, 62_923.0, 80_122.0, 67_223.0]),
    (0.99, 3.57, [19_699.0, 20_962.0, 15_863.0, 16_993.0], [68_997.0, 66_977.0, 86_245.0, 73_251.0]),
    (1.99, 7.14, [11_703.0, 12_522.0, 10_102.0, 10_430.0], [109_264.0, 111_888.0, 134_337.0, 129_249.0]),
    (2.98, 10.71, [9_118.0, 8_849.0, 7_581.0, 7_650.0], [132_354.0, 130_967.0, 155_973.0, 143_386.0]),
    (3.98, 14.29, [7_030.0, NONE, 5_911.0, 6_224.0], [138_390.0, NONE, 156_649.0, 144_656.0]),
    (4.97, 17.86, [5_786.0, 7_179.0, 5_294.0, 5_545.0], [137_095.0, 126_595.0, 142_759.0, 139_942.0]),
    (5.97, 21.43, [5_103.0, 6_651.0, 4_868.0, 4_991.0], [134_004.0, 145_158.0, 135_312.0, 131_565.0]),
    (6.96, 25.0, [4_780.0, 6_409.0, 4_575.0, 4_700.0], [126_964.0, 144_241.0, 133_088.0, 128_547.0]),
    (7.96, 28.57, [4_477.0, 6_232.0, 4_367.0, 4_426.0], [120_700.0, 137_114.0, 131_176.0, 123_142.0]),
    (8.96, 32.14, [4_208.0, 5_959.0, 4_232.0, 4_196.0], [112_405.0, 130_478.0, 128_416.0, 118_435.0]),
    (9.95, 35.71, [3_888.0, 5_609.0, 4_229.0, 4_029.0], [105_756.0, 123_706.0, 123_943.0, 111_402.0]),
    (10.95, 39.28, [3_763.0, 5_348.0, 4_069.0, 3_861.0], [98_807.0, 116_888.0, 117_004.0, 102_911.0]),
    (11.94, 42.85, [3_539.0, 5_139.0, 3_917.0, 3_722.0], [90_966.0, 109_731.0, 108_768.0, 95_125.0]),
    (12.94, 46.64, [3_436.0, 4_989.0, 3_871.0, 3_673.0], [83_973.0, 102_422.0, 100_184.0, 88_418.0]),
    (13.93, 50.79, [3_368.0, 4_886.0, 3_847.0, 3_714.0], [76_106.0, 93_008.0, 92_596.0, 82_560.0]),
    (14.93, 54.9, [3_336.0, 4_807.0, 3_778.0, 3_701.0], [69_000.0, 83_995.0, 85_948.0, 77_234.0]),
    (15.92, 58.77, [3_176.0, 4_726.0, 3_728.0, 3_676.0], [60_889.0, 78_266.0, 77_926.0, 71_021.0]),
    (16.91, 62.91, [3_070.0, 4_721.0, 3_767.0, 3_673.0], [NONE, 71_644.0, 68_103.0, 56_209.0]),
    (17.91, 67.67, [3_359.0, 4_717.0, 3_723.0, 3_736.0], [NONE, 59_557.0, 46_486.0, NONE]),
    (18.91, 72.69, [NONE, 4_846.0, 3_983.0, 4_539.0], [NONE, 56_824.0, NONE, NONE]),
    (19.9, 77.97, [NONE, 5_234.0, 3_227.0, NONE], [NONE, 48_666.0, NONE, NONE]),
    (20.89, 84.38, [NONE, 4_906.0, NONE, NONE], [NONE, NONE, NONE, NONE]),
    (21.89, 91.35, [NONE, 5_191.0, NONE, NONE], [NONE, NONE, NONE, NONE]),
];

/// Densities of a meridian by degrees, where they were measured.
fn measured(meridian: usize, rods: bool) -> impl Iterator<Item = (f64, f64)> {
    let row = move |&(_, degrees, cones, all): &(f64, f64, [f64; 4], [f64; 4])| {
        (degrees, if rods { all[meridian] } else { cones[meridian] })
    };
    TABLE.iter().map(row).filter(|p| !p.1.is_nan())
}

/// Density between the measured places; none beyond them and in the blind spot.
fn density(meridian: usize, rods: bool, degrees: f64) -> Option<f64> {
    // The nasal retina sees what lies to the temple; the meridian passes 1.5° beside the middle of the spot.
    if MERIDIANS[meridian] == "nasal" && blind_spot::contains(degrees, 0.0, 0.0) {
        return None;
    }
    let points: Vec<_> = measured(meridian, rods).collect();
    let pair = points.windows(2).find(|w| (w[0].0..=w[1].0).contains(&degrees))?;
    let (a, b) = (pair[0], pair[1]);
    Some(a.1 + (b.1 - a.1) * (degrees - a.0) / (b.0 - a.0))
}

/// Receptors of the quarter of the retina around each meridian, and together.
fn number(rods: bool) -> f64 {
    let quarter = |meridian: usize| -> f64 {
        let all = TABLE.iter().map(|row| (row.0, if rods { row.3[meridian] } else { row.2[meridian] }));
        let points: Vec<_> = all.filter(|p| !p.1.is_nan()).collect();
        // Over each ring the density is linear in the distance; the circumference is that of a circle on the sphere.
        let ring = |w: &[(f64, f64)]| {
            let (a, b) = (w[0], w[1]);
            let term = |t: f64| (a.1 + (b.1 - a.1) * t) * RADIUS * ((a.0 + (b.0 - a.0) * t) / RADIUS).sin();
            TAU / 4.0 * (b.0 - a.0) / 6.0 * (term(0.0) + 4.0 * term(0.5) + term(1.0))
        };
        points.windows(2).map(ring).sum()
    };
    (0..4).map(quarter).sum()
}

fn run(values: &Values) -> Result<Report, Error> {
    let name = values.choice("meridian");
    let meridian = MERIDIANS.iter().position(|m| *m == name).unwrap_or(0);
    let at = values.number("eccentricity");
    let mut report = Report::default();
    let found = [false, true].map(|rods| density(meridian, rods, at));
    for (kind, found) in ["cones", "rods"].into_iter().zip(found) {
        match found {
            Some(found) => report.quantity(format!("density of {kind}"), found, "1/mm²"),
            None => report.fact(
                if kind == "rods" { "rods" } else { "cones" },
                if name == "nasal" && blind_spot::contains(at, 0.0, 0.0) {
                    "none: the optic nerve leaves the eye here"
                } else {
                    "not measured so far out"
                },
            ),
        }
    }
    if let [Some(cones), Some(rods)] = found
        && cones > 0.0
    {
        report.quantity("rods for each cone", rods / cones, "");
    }
    report.quantity("cones of the retina, as far as measured", number(false), "");
    report.quantity("rods of the retina, as far as measured", number(true), "");
    let mut chart = Chart::new(
        "receptors on the horizontal meridian",
        Axis::linear("degrees from the fovea; nasal retina below zero"),
        Axis::linear("1000 for each mm²"),
    );
    for (rods, kind) in [(false, "cones"), (true, "rods")] {
        let side = |m: usize, sign: f64| measured(m, rods).map(move |p| (sign * p.0, 1e-3 * p.1));
        // The line is broken at the blind spot.
        let mut nasal: Vec<_> = side(1, -1.0).collect();
        nasal.reverse();
        let (outer, inner): (Vec<_>, Vec<_>) = nasal.into_iter().partition(|p| p.0 < -blind_spot::MIDDLE[0]);
        let color = if rods { [0x1f, 0x5f, 0xa8] } else { [0xd0, 0x5a, 0x1e] };
        chart = chart.with(Series::line("", outer).colored(color));
        chart = chart.with(Series::line(kind, inner.into_iter().chain(side(0, 1.0).skip(1)).collect()).colored(color));
    }
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(meridian: &str, degrees: &str) -> Report {
        let given = [("meridian", meridian), ("eccentricity", degrees)];
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// Curcio et al.: 199 000 cones/mm² at most in the mean, a tenth of it 1 mm away, no rods in the middle 1.25°, most
    /// of them at the distance of the blind spot; cones are 40 to 45 % denser on the nasal side of the periphery than
    /// on the temporal; 4.6 million cones and 92 million rods, of which the outermost were not measured here.
    #[test]
    fn the_retina_is_as_the_paper_tells() {
        let fovea = with("temporal", "0");
        let peak = fovea.value("density of cones");
        assert!((peak / 199_000.0 - 1.0).abs() < 0.02 && fovea.value("density of rods") == 0.0);
        // 1 mm is 3.57°.
        let tenth = MERIDIANS.iter().map(|m| with(m, "3.57").value("density of cones")).sum::<f64>() / 4.0 / peak;
        assert!((0.08..0.11).contains(&tenth), "{tenth}");
        for meridian in MERIDIANS {
            assert!(with(meridian, "0.36").value("density of rods") < 500.0);
        }
        let ratio = [25.0, 35.71, 46.64].map(|d| density(1, false, d).unwrap() / density(0, false, d).unwrap());
        assert!(ratio.iter().all(|r| (1.3..1.5).contains(r)), "{ratio:?}");
        let most = (0..4).map(|m| measured(m, true).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0);
        assert!(most.clone().all(|d| (10.0..22.0).contains(&d)), "{:?}", most.collect::<Vec<_>>());
        let cones = fovea.value("cones of the retina, as far as measured");
        let rods = fovea.value("rods of the retina, as far as measured");
        assert!((4.08e6..5.29e6).contains(&cones) && (77.9e6..107.3e6).contains(&rods), "{cones} {rods}");
    }

    /// Neither kind is told in the blind spot, which the authors left out, nor beyond the last place.
    #[test]
    fn there_are_no_receptors_in_the_blind_spot() {
        let spot = with("nasal", "15.5");
        assert!(spot.value("density of rods").is_nan() && spot.facts.iter().all(|f| f.text.contains("optic nerve")));
        assert!(with("temporal", "15.5").value("density of rods") > 1e5);
        assert!(with("temporal", "90").facts.iter().all(|f| f.text.contains("not measured")));
        assert!(TABLE.iter().filter(|row| row.2[1].is_nan()).all(|row| blind_spot::contains(row.1, 0.0, 0.0)));
    }
}
