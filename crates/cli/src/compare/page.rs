//! The report of `steradian compare --html`: one page with all metrics, and for each pair its pictures under a slider
//! and maps of where they differ.

use super::{
    maps,
    pair::{self, Pair},
};
use crate::html::{self, FULL, Scale, command_line, escaped, slider};
use steradian::{
    compare::Noise,
    image::{self, Image, WriteOptions, metrics},
};

/// The whole page, with the sections of its pairs.
pub fn page(pairs: &[Pair], sections: &[String]) -> String {
    format!(
        "{}<dl>\n<dt>Command</dt><dd><code>{}</code></dd>\n<dt>Version</dt><dd>Steradian {}</dd>\n</dl>\n{}{}\
         <script>\n{}</script>\n{}",
        html::head("Comparison of pictures", slider::STYLE),
        escaped(&command_line()),
        env!("CARGO_PKG_VERSION"),
        table(pairs),
        sections.concat(),
        slider::SCRIPT,
        html::END
    )
}

/// Metrics, a row for each pair.
fn table(pairs: &[Pair]) -> String {
    let heads: String = pair::columns().map(|name| format!("<th scope=\"col\">{name}</th>")).collect();
    let row = |pair: &Pair| -> String {
        let cells = pair.cells(html::number);
        let cell = |(k, cell): (usize, &String)| match k {
            0 => format!("<th scope=\"row\">{}</th>", escaped(cell)),
            _ => format!("<td>{}</td>", escaped(cell)),
        };
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
    };
    format!(
        "<h2>Metrics</h2>\n<div class=\"scroll\" role=\"region\" aria-label=\"Metrics\" tabindex=\"0\">\n<table>\n\
         <thead><tr>{heads}</tr></thead>\n<tbody>\n{}</tbody>\n</table>\n</div>\n",
        pairs.iter().map(row).collect::<String>()
    )
}

/// The section of a pair, whose reference has its picture's size.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn section(pair: &Pair, picture: &Image, reference: &Image, noise: Option<&Noise<'_>>) -> image::Result<String> {
    let [name, other] = [&pair.picture, &pair.reference].map(|path| escaped(&path.display().to_string()));
    let resampled = pair.resampled_from.map(|[w, h]| {
        let (width, height) = (pair.width, pair.height);
        format!("<p>The reference has {w} × {h} pixels and is resampled by area to {width} × {height}.</p>\n")
    });
    let plain = WriteOptions::default();
    let flip = html::img(
        &metrics::flip_picture(picture, reference)?,
        &plain,
        &format!("FLIP errors of {name} against {other}, {:.4} on average", pair.flip),
    )?;
    let (relative, full) = maps::relative(picture, reference)?;
    let relative = html::img(&relative, &plain, &format!("Relative errors of {name} against {other}"))?;
    let percent = |part: f64| format!("{} %", (part * 1e6).round() / 1e4);
    let z_map = match (noise, &pair.no_z_test) {
        (Some(noise), _) => {
            let alt = format!("Map of where {name} is brighter or darker than {other}, in standard errors");
            let img = html::img(&maps::signed(picture, reference, noise)?, &plain, &alt)?;
            let ends = [format!("−{FULL}: darker"), "0".into(), format!("+{FULL}: brighter")];
            let legend = Scale::Signed.legend(ends.each_ref().map(String::as_str));
            let about = "differences in standard errors, of red, green and blue the one that differs most";
            format!("<figure>{img}{legend}<figcaption><b>z</b>: {about}</figcaption></figure>\n")
        }
        (None, Some(why)) => format!("<p>No map of standard errors: {}.</p>\n", escaped(why)),
        (None, None) => String::new(),
    };
    Ok(format!(
        "<section class=\"pair\">\n<h2>{name} against {other}</h2>\n{}<div class=\"maps\">\n{}\
         <figure>{flip}{}<figcaption><b>FLIP</b>: perceived difference, mean {:.4}</figcaption></figure>\n\
         <figure>{relative}{}<figcaption><b>Relative error</b>: |x − ref| / (|ref| + 0.01), \
         mean {}</figcaption></figure>\n\
         {z_map}</div>\n</section>\n",
        resampled.unwrap_or_default(),
        slider::slider([&name, &other], [picture, reference])?,
        Scale::Magma.legend(["0", "0.5", "1"]),
        pair.flip,
        Scale::Magma.legend(["0", &percent(0.5 * full), &format!("{} and above", percent(full))]),
        percent(pair.mape),
    ))
}
