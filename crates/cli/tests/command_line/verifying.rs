//! `steradian verify --html`.

use super::Place;
use base64::{Engine, prelude::BASE64_STANDARD};

/// A name that is a tag unless it is escaped.
const NAME: &str = "<b>.pbrt";
const SCENE: &str = r#"Film "rgb" "integer xresolution" [10] "integer yresolution" [6]
Camera "perspective" "float fov" [15] WorldBegin LightSource "infinite" "rgb L" [2 2 2]
Material "conductor" Translate 0 0 3 Shape "sphere""#;
const VERIFY: &[&str] = &["verify", NAME, "--spp", "64", "-i", "path", "-i", "ao", "-i", "light"];

/// The page has every integrator with its answer, as the text has it, and maps that show that `path` agrees, and that
/// `ao`, which knows no light of 2, is darker.
#[test]
fn a_report_is_one_page_with_table_pictures_and_maps() {
    let place = Place::new();
    place.file(NAME, SCENE);
    let run = place.run(&[VERIFY, &["--html", "report.html"]].concat());
    assert_eq!(run.code, 4, "{}", run.stderr);
    let page = std::fs::read_to_string(place.path("report.html")).unwrap();
    let rows: Vec<_> = page.split("<tr>").skip(2).collect();
    assert_eq!(rows.len(), 3);
    let answers = [("path", "yes</td>"), ("ao", "NO</td>"), ("light", "cannot do ")];
    for ((row, (name, answer)), line) in rows.iter().zip(answers).zip(run.stdout.lines().skip(1)) {
        assert!(row.starts_with(&format!("<th scope=\"row\">{name}</th>")) && row.contains(answer), "{row}");
        assert!(line.starts_with(name) && line.contains(answer.trim_end_matches("</td>")), "{line}");
    }
    assert!(!page.contains("<b>") && page.contains("<h1>Agreement of integrators on &lt;b&gt;.pbrt</h1>"));
    assert!(page.contains("<code>steradian verify '&lt;b&gt;.pbrt' --spp 64 -i path"));
    // Nothing is fetched.
    assert!(
        !page.contains("http") && page.matches("src=").count() == page.matches("src=\"data:image/png;base64,").count()
    );
    let pictures: Vec<_> = page.split("<img ").skip(1).collect();
    for (k, picture) in pictures.iter().enumerate() {
        let data = picture.split("base64,").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
        std::fs::write(place.path(&format!("{k}.png")), BASE64_STANDARD.decode(data).unwrap()).unwrap();
        assert!(picture.starts_with("width=\"10\" height=\"6\" alt=\""), "{picture}");
    }
    assert_eq!(pictures.len(), 5, "the reference, and a picture and a map of each that can");
    // White is no difference, blue four standard errors.
    let middle = |map: &str, channel| place.picture(map).channel(channel).unwrap()[3 * 10 + 5];
    assert!(middle("2.png", "G") > 0.3 && middle("2.png", "R") > 0.2, "agrees");
    assert!(middle("4.png", "R") < 0.02 && middle("4.png", "B") > 0.4, "darker");
}

#[test]
fn a_report_that_cannot_be_written_is_refused_before_rendering() {
    let place = Place::new();
    place.file(NAME, SCENE);
    let run = place.run(&[VERIFY, &["--html", "none/report.html"]].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("none/report.html") && !run.stderr.contains("rendering"), "{}", run.stderr);
    place.refuse(2, &[VERIFY, &["--html", NAME]].concat(), &["is a file that is read here"]);
}
