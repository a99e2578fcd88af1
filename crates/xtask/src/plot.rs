//! Plots as SVG.

use std::fmt::Write;

/// Points that belong together.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name of the points, for the legend.
    pub name: &'static str,
    /// x and y.
    pub points: Vec<[f64; 2]>,
}

/// A plot with a logarithmic x axis and a linear y axis from zero.
pub fn log_x(title: &str, x_label: &str, y_label: &str, series: &[Series]) -> String {
    let (width, height, left, top, right, bottom) = (720.0, 440.0, 70.0, 50.0, 20.0, 60.0);
    let points = || series.iter().flat_map(|s| &s.points).filter(|p| p[0] > 0.0 && p[1].is_finite());
    let decades = points().map(|p| p[0].log10());
    let low = decades.clone().fold(f64::INFINITY, f64::min).floor().min(1e9);
    let high = decades.fold(f64::NEG_INFINITY, f64::max).ceil().max(low + 1.0);
    let most = points().map(|p| p[1]).fold(0.0, f64::max).max(1e-300);
    // A round step that gives about five lines.
    let rough = most / 5.0;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough).unwrap_or(rough);
    let greatest = (most / step).ceil() * step;
    let x = |v: f64| left + (v.log10() - low) / (high - low) * (width - left - right);
    let y = |v: f64| height - bottom - v / greatest * (height - top - bottom);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"28\" font-size=\"16\">{title}</text>\n"
    );
    let mut line = |x0: f64, y0: f64, x1: f64, y1: f64| {
        let _ = writeln!(svg, "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"#ddd\"/>");
    };
    for decade in low as i32..=high as i32 {
        let at = x(10_f64.powi(decade));
        line(at, top, at, height - bottom);
    }
    let lines = (greatest / step).round() as usize;
    for i in 0..=lines {
        let at = y(step * i as f64);
        line(left, at, width - right, at);
    }
    for decade in low as i32..=high as i32 {
        let at = x(10_f64.powi(decade));
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">10<tspan dy=\"-5\" font-size=\"9\">{decade}</tspan></text>",
            height - bottom + 20.0
        );
    }
    for i in 0..=lines {
        let value = step * i as f64;
        let text = format!("{}", (value * 1e6).round() / 1e6);
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            left - 8.0,
            y(value) + 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_label}</text>",
        width / 2.0,
        height - 15.0
    );
    let _ = writeln!(svg, "<text x=\"10\" y=\"{:.1}\">{y_label}</text>", top - 6.0);
    for (i, (s, color)) in
        series.iter().zip(["#1f5fa8", "#c2501c", "#2c8a4b", "#7a4fa3"].into_iter().cycle()).enumerate()
    {
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{color}\">{}</text>",
            left + 12.0,
            top + 18.0 * (i + 1) as f64,
            s.name
        );
        let path: Vec<String> = s.points.iter().map(|p| format!("{:.1} {:.1}", x(p[0]), y(p[1]))).collect();
        let _ = writeln!(svg, "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>", path.join("L"));
        for p in &s.points {
            let _ = writeln!(svg, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3.5\" fill=\"{color}\"/>", x(p[0]), y(p[1]));
        }
    }
    svg + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_within_the_frame() {
        let svg = log_x("t", "x", "y", &[Series { name: "s", points: vec![[1e3, 0.5], [1e7, 4.2]] }]);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
        let circles: Vec<&str> = svg.lines().filter(|l| l.starts_with("<circle")).collect();
        assert_eq!(circles.len(), 2);
        assert!(circles[0].contains("cx=\"70.0\"") && circles[1].contains("cx=\"700.0\""), "{circles:?}");
    }
}
