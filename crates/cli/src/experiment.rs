//! `steradian optics`, `vision`, `estimate` and `geometry`: experiments that end in numbers, a chart and a picture.

use crate::{
    args::FileOptions,
    failure::{self, Failure, Outcome},
    output,
    terminal::{self, Terminal},
    values::{self, known_name},
};
use clap::Args;
use serde::Serialize;
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};
use steradian::{
    Inputs,
    image::{self, Limits, write_whole},
    instruments::experiment::{Chart, Error, Experiment, FAMILIES, Fact, Picture, Quantity, Report, find},
};

/// Options of all four commands.
#[derive(Args, Debug)]
pub struct ExperimentArgs {
    /// Name of the experiment; without it, list all
    pub name: Option<String>,
    /// Picture to work on, for experiments that need one
    pub picture: Option<PathBuf>,
    /// Set a parameter; may be repeated
    #[arg(short, long, value_name = "NAME=VALUE", num_args = 1.., value_parser = values::definition)]
    pub params: Vec<(String, String)>,
    /// Output file: the chart for .svg, else the picture; may be repeated
    #[arg(short, long = "output", value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// Write the points of the chart as a table, separated by tabs
    #[arg(long, value_name = "OUT.txt")]
    pub table: Option<PathBuf>,
    /// List the parameters of the experiment instead of running it
    #[arg(long)]
    pub explain: bool,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Answer<'a> {
    experiment: &'static str,
    #[serde(skip_serializing_if = "<[Fact]>::is_empty")]
    facts: &'a [Fact],
    quantities: &'a [Quantity],
    #[serde(skip_serializing_if = "Option::is_none")]
    chart: Option<&'a Chart>,
}

/// Lists, explains, or runs and writes.
pub fn run(family: &'static str, args: &ExperimentArgs, terminal: Terminal) -> Outcome {
    let experiments = || FAMILIES.iter().filter(|f| f.0 == family).flat_map(|f| f.2);
    let first = experiments().next().map_or("NAME", |e| e.name);
    let Some(name) = &args.name else {
        if args.explain || !args.params.is_empty() || !args.output.is_empty() || args.table.is_some() {
            let what = format!(
                "of which experiment? Name it first, as in steradian {family} {first}; `steradian {family}` lists all"
            );
            return Err(Failure::bad_input(what));
        }
        terminal::data(list(family).as_bytes())?;
        return Ok(failure::DONE);
    };
    let names = experiments().map(|e| e.name);
    if Path::new(name).is_file() {
        let on_picture = experiments().find(|e| e.needs_picture()).map(|e| format!("{} {name}", e.name));
        let example = on_picture.unwrap_or_else(|| first.into());
        let what = format!("'{name}' is a file; name an experiment first, as in steradian {family} {example}");
        return Err(Failure::bad_input(what));
    }
    let name = known_name(name, "experiment", names).map_err(Failure::bad_input)?;
    let experiment =
        find(family, name).ok_or_else(|| Failure::bad_input(format!("there is no experiment '{name}'")))?;
    if args.explain {
        terminal::data(explain(experiment).as_bytes())?;
        return Ok(failure::DONE);
    }
    let options = args.files.write_options().map_err(Failure::bad_input)?;
    args.output.iter().filter(|path| !is_svg(path)).try_for_each(|path| output::kind(path).map(drop))?;
    let outputs = args.output.iter().chain(&args.table).map(PathBuf::as_path);
    output::claim(outputs, &Inputs::of(args.picture.as_deref()))?;
    let picture = args.picture.as_deref().map(read).transpose()?;
    let report = experiment.run(&args.params, picture.as_ref()).map_err(|e| match e {
        Error::UnknownParameter { .. } | Error::BadValue { .. } => {
            Failure::bad_input(format!("{e}\n`steradian {family} {name} --explain` lists the parameters"))
        }
        other if experiment.needs_picture() && picture.is_none() => {
            Failure::bad_input(format!("{other}, as in steradian {family} {name} PICTURE.png -o {name}.png"))
        }
        other => Failure::bad_input(other.to_string()),
    })?;
    for path in &args.output {
        let missing = |what: &str, other: &str| {
            Failure::bad_input(format!("'{name}' has no {what}: cannot write '{}'; {other}", path.display()))
        };
        let written = if is_svg(path) {
            let chart = report.chart.as_ref().ok_or_else(|| missing("chart", "write its picture, as .png or .exr"))?;
            write_whole(path, chart.svg().as_bytes())
        } else {
            let drawn = report.picture.as_ref().ok_or_else(|| missing("picture", "write its chart, as .svg"))?;
            image::write(path, drawn, &options)
        };
        written.map_err(|e| Failure::failed(e.to_string()))?;
    }
    if let Some(path) = &args.table {
        let chart = report.chart.as_ref().ok_or_else(|| Failure::bad_input(format!("'{name}' has no chart")))?;
        write_whole(path, chart.table().as_bytes()).map_err(|e| Failure::failed(e.to_string()))?;
    }
    if args.json {
        let Report { facts, quantities, chart, .. } = &report;
        terminal::json(&Answer { experiment: name, facts, quantities, chart: chart.as_ref() })?;
    } else {
        terminal::data(numbers(&report).as_bytes())?;
    }
    if args.output.is_empty() && args.table.is_none() && !args.json {
        let kinds = match (&report.chart, &report.picture) {
            (Some(_), Some(_)) => "its chart (-o OUT.svg) and its picture (-o OUT.png)",
            (Some(_), None) => "its chart (-o OUT.svg)",
            _ => "its picture (-o OUT.png)",
        };
        terminal.say(&format!("write {kinds} with -o"));
    }
    Ok(failure::DONE)
}

fn is_svg(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"))
}

fn read(path: &Path) -> Result<Picture, Failure> {
    let image = image::read(path, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()))?;
    let rgb = image.to_rgb().map_err(|e| Failure::bad_input(e.to_string()))?;
    Ok(Picture { width: image.width(), height: image.height(), rgb })
}

fn list(family: &str) -> String {
    let mut text = String::new();
    for experiment in FAMILIES.iter().filter(|f| f.0 == family).flat_map(|f| f.2) {
        let _ = writeln!(text, "{:22} {}", experiment.name, experiment.doc);
    }
    let first = FAMILIES.iter().find(|f| f.0 == family).and_then(|f| f.2.first()).map_or("NAME", |e| e.name);
    let _ = writeln!(
        text,
        "\n`steradian {family} NAME --explain` lists the parameters of one. \
         To run one: steradian {family} {first} -o {first}.svg"
    );
    text
}

fn explain(experiment: &Experiment) -> String {
    let mut text = format!("{}: {}\nsource: {}\n", experiment.name, experiment.doc, experiment.source);
    if experiment.needs_picture() {
        text.push_str("works on a picture\n");
    }
    for p in experiment.parameters {
        let unit = if p.unit.is_empty() { String::new() } else { format!(" {}", p.unit) };
        let _ = writeln!(text, "  {:14} {} ({}{unit}; default {})", p.name, p.doc, p.range_text(), p.default_text());
    }
    text
}

fn numbers(report: &Report) -> String {
    let names = report.quantities.iter().map(|q| q.name.as_str()).chain(report.facts.iter().map(|f| f.name));
    let width = names.map(|name| name.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for f in &report.facts {
        let pad = width - f.name.chars().count();
        let _ = writeln!(text, "{}{:pad$}  {}", f.name, "", f.text);
    }
    for q in &report.quantities {
        let value = if q.value != 0.0 && !(1e-4..1e7).contains(&q.value.abs()) && q.value.is_finite() {
            format!("{:.6e}", q.value)
        } else if q.value.is_infinite() {
            format!("{}infinity", if q.value < 0.0 { "-" } else { "" })
        } else {
            let rounded = format!("{:.6}", q.value);
            rounded.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        let pad = width - q.name.chars().count();
        let _ = writeln!(text, "{}{:pad$}  {value} {}", q.name, "", q.unit);
    }
    text
}
