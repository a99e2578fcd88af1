//! `steradian bench`.

use crate::Place;

/// Two triangles that make a square in the plane z = 0, seen from (0, 0, 1).
const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 2\nproperty list uchar int vertex_indices\nend_header\n\
    -1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1 2\n3 0 2 3\n";

/// A file of rays.
fn rays(rays: &[[f32; 7]]) -> Vec<u8> {
    let numbers = rays.iter().flatten().flat_map(|x| x.to_le_bytes());
    (rays.len() as u64).to_le_bytes().into_iter().chain(numbers).collect()
}

#[test]
fn rays_of_a_file_are_traced_alike_in_every_mode() {
    let place = Place::new();
    place.file("square.ply", SQUARE);
    // Straight at it, past it, too short, and not a ray at all.
    let mut all: Vec<[f32; 7]> =
        (0..40).map(|i| [i as f32 / 50.0 - 0.4, 0.1, 2.0, 0.0, 0.0, -1.0, f32::INFINITY]).collect();
    all.push([5.0, 0.0, 2.0, 0.0, 0.0, -1.0, f32::INFINITY]);
    all.push([0.0, 0.0, 2.0, 0.0, 0.0, -1.0, 1.5]);
    all.push([f32::NAN; 7]);
    std::fs::write(place.path("rays.bin"), rays(&all)).unwrap();
    for mode in ["single", "packet", "stream"] {
        for query in ["closest", "occluded"] {
            let line = ["bench", "rays", "square.ply", "rays.bin", "--query", query, "--mode", mode, "--robust"];
            let more = ["--threads", "2", "--repeat", "1", "--json"];
            let json = place.succeed(&[&line[..], &more].concat()).json();
            assert_eq!((json["rays"].as_u64(), json["hits"].as_u64()), (Some(43), Some(40)), "{mode} {query}");
            let sum = if query == "closest" { 80.0 } else { 0.0 };
            assert_eq!(json["sum_t"].as_f64(), Some(sum));
            for positive in ["mrays_per_cpu_second", "mrays_per_second", "build_seconds", "bytes"] {
                assert!(json[positive].as_f64().is_some_and(|x| x > 0.0), "{positive}: {json}");
            }
        }
    }
    // One instance stands at the origin, turned: the square is seen by some ray or not, but always the same way.
    let line = ["bench", "rays", "square.ply", "rays.bin", "--instances", "1", "--repeat", "1", "--json"];
    let hits = |mode| place.succeed(&[&line[..], &["--mode", mode]].concat()).json()["hits"].as_u64();
    assert_eq!(hits("single"), hits("packet"));
    assert!(place.succeed(&line[..4]).stdout.contains("40 of 43 rays hit"));
}

#[test]
fn files_of_rays_that_are_not_sound_are_located() {
    let place = Place::new();
    place.file("square.ply", SQUARE);
    let whole = rays(&[[0.0; 7]; 3]);
    std::fs::write(place.path("short.bin"), &whole[..whole.len() - 1]).unwrap();
    std::fs::write(place.path("count.bin"), [&[255; 8], &whole[8..]].concat()).unwrap();
    place.refuse(2, &["bench", "rays", "square.ply", "short.bin"], &["short.bin", "byte 91", "2 rays and 27 of 28"]);
    place.refuse(2, &["bench", "rays", "square.ply", "count.bin"], &["count.bin", "byte 92", "18446744073709551615"]);
    place.refuse(2, &["bench", "rays", "square.ply", "none.bin"], &["none.bin"]);
    place.refuse(2, &["bench", "rays", "short.bin", "short.bin"], &["short.bin"]);
    place.refuse(2, &["bench", "rays", "square.ply", "short.bin", "--threads", "0"], &["--threads"]);
}

/// A scene by an integrator that is right and one that is not: snapshots at growing times, a table that has what the
/// JSON has, and a page.
#[test]
fn renders_are_measured_with_snapshots_table_and_page() {
    let place = Place::new();
    let line = ["bench", "render", "builtin:cornell-box", "--size", "16x16", "--time", "300ms", "--threads", "1"];
    let more = ["--integrators", "path,ao:distance=2", "--repeat", "2", "--reference-spp", "64", "--seed", "7"];
    let files = ["--html", "report.html", "--csv", "table.csv", "--json"];
    let run = place.succeed(&[&line[..], &more, &files].concat());
    let json = run.json();
    let scene = &json["scenes"][0];
    assert!(scene["reference"].as_str().unwrap().contains("64 spp, seed 1000010"), "{scene}");
    assert!(run.stderr.contains("seed 1000010"), "{}", run.stderr);
    let csv = std::fs::read_to_string(place.path("table.csv")).unwrap();
    let mut rows = csv.lines().skip(1);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    for (curve, name) in scene["integrators"].as_array().unwrap().iter().zip(["path", "ao:distance=2"]) {
        assert_eq!((curve["integrator"].as_str(), curve["runs"].as_array().unwrap().len()), (Some(name), 2));
        for (run, seed) in curve["runs"].as_array().unwrap().iter().zip([7, 8]) {
            assert_eq!(run["seed"], seed);
            let mut before = 0.0;
            assert!(!run["snapshots"].as_array().unwrap().is_empty());
            for snapshot in run["snapshots"].as_array().unwrap() {
                let cpu = number(&snapshot["cpu_seconds"]);
                assert!(cpu > before && number(&snapshot["spp"]) >= 1.0, "{snapshot}");
                before = cpu;
                for k in 0..4 {
                    let product = number(&snapshot["relmse"][k]) * cpu * number(&snapshot["efficiency"][k]);
                    assert!((product - 1.0).abs() < 1e-9, "{snapshot}");
                }
                let row: Vec<&str> = rows.next().unwrap().split(',').collect();
                assert_eq!((row.len(), row[0], row[1]), (15, "builtin:cornell-box", name));
                let written: f64 = row[7].parse().unwrap();
                assert!((written / number(&snapshot["relmse"][0]) - 1.0).abs() < 1e-12);
            }
        }
    }
    assert!(rows.next().is_none());
    let last = |k: usize| {
        let snapshots = scene["integrators"][k]["runs"][0]["snapshots"].as_array().unwrap();
        number(&snapshots.last().unwrap()["relmse"][3])
    };
    assert!(last(0) < 0.1 * last(1), "occlusion is no light: {} {}", last(0), last(1));
    let page = std::fs::read_to_string(place.path("report.html")).unwrap();
    assert!(!page.contains("http") && page.matches("data:image/svg+xml").count() == 2);
    assert_eq!(page.matches("<input type=\"range\"").count(), 2);
    for tag in ["section", "figure", "table", "tr", "td", "th", "div", "script", "p"] {
        let opened = page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
}

/// A reference from a file is compared with, and all that cannot be is refused before anything is rendered.
#[test]
fn references_of_bench_render_come_from_files() {
    let place = Place::new();
    let render = |size: &str, name: &str| {
        place.succeed(&["render", "builtin:cornell-box", "--size", size, "--spp", "4", "-q", "-o", name]);
    };
    render("16x16", "small.exr");
    render("24x16", "wide.exr");
    let line = ["bench", "render", "builtin:cornell-box", "--size", "8x8", "--time", "250ms"];
    let run = place.succeed(&[&line[..], &["--reference", "small.exr"]].concat());
    assert!(
        run.stderr.contains("16x16 pixels, resampled by area to 8x8") && run.stdout.contains("path"),
        "{}",
        run.stdout
    );
    let refuse = |more: &[&str], about: &[&str]| place.refuse(2, &[&line[..], more].concat(), about);
    refuse(&["--reference", "wide.exr"], &["24x16", "8x8", "wide.exr"]);
    refuse(&["--reference", "none.exr"], &["none.exr"]);
    refuse(&["builtin:caustic-glass", "--reference", "small.exr"], &["one scene", "2 are given"]);
    refuse(&["--reference", "small.exr", "--reference-spp", "4"], &["--reference-spp"]);
    refuse(&["--integrators", "path,pth"], &["pth"]);
    refuse(&["--integrators", "path,"], &["integrator"]);
    refuse(&["--time", "0s"], &["--time"]);
    refuse(&["--reference", "small.exr", "--csv", "small.exr"], &["overwritten"]);
    refuse(&["--html", "n", "--csv", "./n"], &["one file"]);
    assert!(!place.path("n").exists());
}
