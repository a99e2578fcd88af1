//! The report of `steradian verify --html`: one page with the table, the pictures, and maps of where they differ.

use super::{COLUMNS, Row};
use crate::{
    args::VerifyArgs,
    brightness,
    html::{self, FULL, Scale, command_line, escaped},
};
use std::io::{self, Write};
use steradian::{
    Film, Scene,
    image::{Image, WriteOptions},
    verify::{Difference, Outcome, Report},
};

/// Writes the page. Pictures are encoded one after the other: beside the films there is one of them at a time.
///
/// # Errors
/// Errors of `out`, and a picture that cannot be encoded.
pub fn write(
    out: &mut dyn Write,
    args: &VerifyArgs,
    scene: &Scene,
    report: &Report,
    rows: &[Row<'_>],
) -> io::Result<()> {
    let name = args.scene.file_name().map_or(args.scene.to_string_lossy(), |name| name.to_string_lossy());
    let (name, reference) = (escaped(&name), escaped(&report.reference));
    // One exposure for all, so that they can be compared.
    let reference_picture = steradian::develop(scene, &report.film, &[]);
    let stops = brightness::needed(&reference_picture).map_or(0.0, |(_, stops)| stops);
    let mut options = WriteOptions::default();
    options.tone = options.tone.with_exposure(stops).map_err(io::Error::other)?;
    out.write_all(html::head(&format!("Agreement of integrators on {name}"), "").as_bytes())?;
    writeln!(out, "<p>{}</p>", summary(report, rows))?;
    write!(
        out,
        "<dl>\n<dt>Command</dt><dd><code>{}</code></dd>\n<dt>Version</dt><dd>Steradian {}</dd>\n\
         <dt>Reference</dt><dd>{reference}</dd>\n\
         <dt>Samples per pixel</dt><dd>{} a round; spp in the table are all</dd>\n\
         <dt>Seed</dt><dd>{}</dd>\n<dt>Picture</dt><dd>{} × {} pixels, exposure {stops:+} stops, \
         lights in view black</dd>\n</dl>\n",
        escaped(&command_line()),
        env!("CARGO_PKG_VERSION"),
        args.spp,
        args.seed,
        report.film.crop.width(),
        report.film.crop.height(),
    )?;
    table(out, &reference, rows)?;
    legend(out)?;
    write!(out, "<h2>Pictures</h2>\n<div class=\"all\">\n<section class=\"one\">\n<h3>{reference} (reference)</h3>\n")?;
    figure(out, &reference_picture, &options, &format!("Picture by {reference}"), "picture")?;
    out.write_all(b"</section>\n")?;
    for (verified, row) in report.verified.iter().zip(rows) {
        let Outcome::Compared(c) = &verified.outcome else { continue };
        let (name, (class, answer)) = (escaped(row.integrator), answer(row));
        let z = &c.difference;
        let note = format!("z-map, largest z {:.2}, allowed {:.2}", z.largest, z.allowed);
        write!(
            out,
            "<section class=\"two\">\n<h3>{name}: <span class=\"{class}\">{answer}</span></h3>\n<div class=\"row\">\n"
        )?;
        let picture = steradian::develop(scene, &c.film, &[]);
        figure(out, &picture, &options, &format!("Picture by {name}"), "picture")?;
        let alt = format!("Map of where {name} is brighter or darker than {reference}: {note}");
        figure(out, &map(&c.film, z)?, &WriteOptions::default(), &alt, &note)?;
        out.write_all(b"</div>\n</section>\n")?;
    }
    write!(out, "</div>\n{}", html::END)
}

/// Numbers of integrators by verdict, or why nothing is decided.
fn summary(report: &Report, rows: &[Row<'_>]) -> String {
    if let Some(what) = &report.incomplete {
        return format!("Nothing is decided: no method with a known error finds {}.", escaped(what));
    }
    let counts = [
        ("agree", Some("agrees")),
        ("agree in the limit", Some("converges")),
        ("not decided", Some("undecided")),
        ("differ", Some("differs")),
        ("cannot render the scene", None),
    ];
    let count = |(words, verdict)| format!("{words}: {}", rows.iter().filter(|row| row.verdict == verdict).count());
    counts.map(count).join("; ")
}

/// The class of an answer, and the answer.
fn answer(row: &Row<'_>) -> (&'static str, &'static str) {
    let class = match row.verdict {
        Some("agrees") => "yes",
        Some("converges") => "limit",
        Some("undecided") => "unsure",
        _ => "no",
    };
    (class, row.answer())
}

fn table(out: &mut dyn Write, reference: &str, rows: &[Row<'_>]) -> io::Result<()> {
    out.write_all(b"<h2>Tests</h2>\n<div class=\"scroll\" role=\"region\" aria-label=\"Tests\" tabindex=\"0\">\n")?;
    out.write_all(b"<table>\n<thead><tr><th scope=\"col\">integrator</th>")?;
    write!(out, "<th scope=\"col\">agrees with {reference}</th>")?;
    for (column, _) in COLUMNS {
        write!(out, "<th scope=\"col\">{column}</th>")?;
    }
    out.write_all(b"</tr></thead>\n<tbody>\n")?;
    for row in rows {
        write!(out, "<tr><th scope=\"row\">{}</th>", escaped(row.integrator))?;
        if let Some(what) = row.cannot {
            write!(out, "<td colspan=\"{}\">cannot do {}</td>", 1 + COLUMNS.len(), escaped(what))?;
        } else {
            let (class, answer) = answer(row);
            write!(out, "<td class=\"{class}\">{answer}</td>")?;
            for cell in row.cells() {
                write!(out, "<td>{cell}</td>")?;
            }
        }
        out.write_all(b"</tr>\n")?;
    }
    writeln!(
        out,
        "</tbody>\n</table>\n</div>\n<p>The mean is over that of the reference; “detects” is its smallest difference \
         from 1 that noise does not hide. “Difference” is the root mean square over blocks of pixels, “noise” what \
         errors alone would make of it, and “change” what half the radius or half the patches changed.</p>"
    )
}

/// Explains the colours of the maps.
fn legend(out: &mut dyn Write) -> io::Result<()> {
    let ends = [format!("−{FULL}: darker"), "0".into(), format!("+{FULL}: brighter")];
    writeln!(
        out,
        "<h2>Colours of the z-maps</h2>\n{}<p>Difference of each block of pixels from the \
         reference, in standard errors; of red, green and blue the one that differs most. Grey blocks \
         have errors that are not known, and are not tested.</p>",
        Scale::Signed.legend(ends.each_ref().map(String::as_str))
    )
}

/// Writes a picture into the page.
fn figure(out: &mut dyn Write, picture: &Image, options: &WriteOptions, alt: &str, caption: &str) -> io::Result<()> {
    let img = html::img(picture, options, alt).map_err(io::Error::other)?;
    writeln!(out, "<figure>{img}<figcaption>{caption}</figcaption></figure>")
}

/// The map of a picture's blocks, pixel by pixel.
fn map(film: &Film, difference: &Difference) -> io::Result<Image> {
    let (width, height, edge) = (film.crop.width() as usize, film.crop.height() as usize, difference.edge);
    let columns = width.div_ceil(edge);
    let colours: Vec<[f32; 3]> = difference.z.chunks_exact(3).map(colour).collect();
    let pixel = |k: usize| colours[k / width / edge * columns + k % width / edge];
    let pixels: Vec<[f32; 3]> = (0..width * height).map(pixel).collect();
    Image::from_rgb(width, height, &pixels).map_err(io::Error::other)
}

/// Linear colour of a block, by the channel that differs most.
fn colour(z: &[Option<f64>]) -> [f32; 3] {
    html::signed(z.iter().flatten().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())))
}
