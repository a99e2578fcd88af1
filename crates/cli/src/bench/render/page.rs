//! The report of `steradian bench render --html`: curves, tables, and pictures with maps of their errors.

use super::{Curve, Measured, RenderBenchArgs, measure::Snapshot, table};
use crate::html::{self, Scale, command_line, escaped, slider};
use base64::{display::Base64Display, prelude::BASE64_STANDARD};
use steradian::{
    image::{self, Image, WriteOptions, metrics},
    instruments::experiment::{Axis, Chart, Series},
};

/// The whole page.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn page(args: &RenderBenchArgs, scenes: &[Measured]) -> image::Result<String> {
    let sections: Vec<String> = scenes.iter().map(section).collect::<Result<_, _>>()?;
    Ok(format!(
        "{}<dl>\n<dt>Command</dt><dd><code>{}</code></dd>\n<dt>Version</dt><dd>Steradian {}</dd>\n\
         <dt>Time of a render</dt><dd>{:?}; {} render(s) by each integrator, seeds from {}</dd>\n</dl>\n\
         <p>Efficiency (eff) is 1 / (relMSE · CPU s), of single pixels and of means over squares of pixels. Noise of \
         the reference counts as error.</p>\n{}<script>\n{}</script>\n{}",
        html::head("Error against time", slider::STYLE),
        escaped(&command_line()),
        env!("CARGO_PKG_VERSION"),
        args.time,
        args.repeat,
        args.seed,
        sections.concat(),
        slider::SCRIPT,
        html::END
    ))
}

fn section(scene: &Measured) -> image::Result<String> {
    let name = escaped(&scene.scene);
    let figures: Vec<String> = scene
        .integrators
        .iter()
        .filter_map(|curve| Some(figures(curve, curve.picture.as_ref()?, &scene.truth)))
        .collect::<Result<_, _>>()?;
    Ok(format!(
        "<section class=\"pair\">\n<h2>{name}</h2>\n<p>{} × {} pixels; reference: {}</p>\n{}\
         <div class=\"maps\">\n{}{}</div>\n{}</section>\n",
        scene.width,
        scene.height,
        escaped(&scene.reference),
        rows(scene),
        chart(scene, "relMSE", |s| s.relmse[0]),
        chart(scene, "FLIP", |s| s.flip),
        figures.concat(),
    ))
}

/// The last picture of an integrator beside the reference, and its FLIP errors.
fn figures(curve: &Curve, picture: &Image, reference: &Image) -> image::Result<String> {
    let name = escaped(&curve.integrator);
    let alt = format!("FLIP errors of {name}");
    let flip = html::img(&metrics::flip_picture(picture, reference)?, &WriteOptions::default(), &alt)?;
    Ok(format!(
        "<h3>{name}</h3>\n<div class=\"maps\">\n{}<figure>{flip}{}<figcaption><b>FLIP</b>: perceived difference\
         </figcaption></figure>\n</div>\n",
        slider::slider([&name, "reference"], [picture, reference])?,
        Scale::Magma.legend(["0", "0.5", "1"]),
    ))
}

/// A metric against CPU time, both logarithmic; means over renders.
fn chart(scene: &Measured, metric: &str, of: impl Fn(&Snapshot) -> f64) -> String {
    let title = format!("{metric} against CPU time");
    let mut chart = Chart::new(&title, Axis::log("CPU time of rendering, s"), Axis::log(metric));
    for curve in &scene.integrators {
        let most = curve.runs.iter().map(|run| run.snapshots.len()).max().unwrap_or(0);
        let point = |k: usize| {
            let there: Vec<&Snapshot> = curve.runs.iter().filter_map(|run| run.snapshots.get(k)).collect();
            let mean = |of: &dyn Fn(&Snapshot) -> f64| there.iter().map(|s| of(s)).sum::<f64>() / there.len() as f64;
            (mean(&|s| s.cpu_seconds), mean(&of))
        };
        chart = chart.with(Series::line(&curve.integrator, (0..most).map(point).collect()));
    }
    let svg = chart.svg();
    format!(
        "<figure><img class=\"chart\" alt=\"{title} on {}; the table has the last values\" \
         src=\"data:image/svg+xml;base64,{}\"></figure>\n",
        escaped(&scene.scene),
        Base64Display::new(svg.as_bytes(), &BASE64_STANDARD)
    )
}

fn rows(scene: &Measured) -> String {
    let heads: String = table::heads().iter().map(|head| format!("<th scope=\"col\">{head}</th>")).collect();
    let row = |curve: &Curve| {
        let cells: String = match (table::cells(curve), &curve.cannot) {
            (Some(cells), _) => cells.iter().map(|cell| format!("<td>{cell}</td>")).collect(),
            (None, why) => {
                let why = why.as_deref().unwrap_or("no snapshot");
                format!("<td colspan=\"{}\">{}</td>", table::heads().len(), escaped(why))
            }
        };
        format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", escaped(&curve.integrator))
    };
    format!(
        "<div class=\"scroll\" role=\"region\" aria-label=\"Efficiencies on {}\" tabindex=\"0\">\n<table>\n\
         <thead><tr><th scope=\"col\">integrator</th>{heads}</tr></thead>\n<tbody>\n{}</tbody>\n</table>\n</div>\n",
        escaped(&scene.scene),
        scene.integrators.iter().map(row).collect::<String>()
    )
}
