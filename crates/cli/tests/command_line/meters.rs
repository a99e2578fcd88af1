//! Meters of light at points of scenes.

use super::*;

/// A meter looks from its own place: the scene needs no camera, and one that is named must be there.
#[test]
fn a_meter_needs_no_camera() {
    let place = Place::new();
    let lamp = "<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"0\" z=\"2\"/>\
                <rgb name=\"intensity\" value=\"4 8 12\"/></emitter><shape type=\"sphere\">\
                <transform name=\"to_world\"><translate x=\"0\" y=\"0\" z=\"-9\"/></transform></shape>";
    let sensor = "<sensor type=\"perspective\"/>";
    place.file("lamp.xml", &format!("<scene version=\"3.0.0\">{lamp}</scene>"));
    place.file("seen.xml", &format!("<scene version=\"3.0.0\">{lamp}{sensor}</scene>"));
    let metered = |scene: &str| {
        let at = ["meter", scene, "--at", "0,0,0", "--normal", "0,0,1", "--spp", "64", "--color", "rgb", "--json"];
        place.succeed(&at).json()["rgb"].clone()
    };
    let read = metered("lamp.xml");
    assert!((read[1]["value"].as_f64().unwrap() - 2.0).abs() < 0.1, "{read}");
    assert_eq!(read, metered("seen.xml"));
    place.refuse(2, &["meter", "lamp.xml", "--at", "0,0,0", "--camera", "front"], &["no camera 'front'"]);
}

/// Many points are read at once, each as it would be alone.
#[test]
fn many_points_are_rows_of_a_table() {
    let place = Place::new();
    place.file("points.csv", "x,y,z,nx,ny,nz\n0,-0.5,0,0,1,0\n0.3,0,0.2,0,0,1\n");
    let common = ["meter", "builtin:cornell-box", "--spp", "256"];
    let alone = |at: &str, normal: &str| {
        place.succeed(&[&common[..], &["--at", at, "--normal", normal, "--json"]].concat()).json()
    };
    let table = place.succeed(&[&common[..], &["--points", "points.csv"]].concat()).stdout;
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines[0], "x,y,z,red,green,blue,luminous,luminous_error");
    let told = place.succeed(&[&common[..], &["--points", "points.csv", "--json"]].concat()).stdout;
    for (k, (at, normal)) in [("0,-0.5,0", "0,1,0"), ("0.3,0,0.2", "0,0,1")].into_iter().enumerate() {
        let alone = alone(at, normal);
        let json: serde_json::Value = serde_json::from_str(told.lines().nth(k).unwrap()).unwrap();
        assert_eq!(json, alone);
        let row: Vec<f64> = lines[k + 1].split(',').map(|field| field.parse().unwrap()).collect();
        assert_eq!(
            (row[3], row[6]),
            (alone["rgb"][0]["value"].as_f64().unwrap(), alone["luminous"]["value"].as_f64().unwrap())
        );
    }
    place.refuse(2, &["meter", "builtin:cornell-box"], &["--at"]);
    place.refuse(2, &[&common[..], &["--points", "none.csv"]].concat(), &["none.csv"]);
    place.file("bad.csv", "1,2\n").refuse(2, &[&common[..], &["--points", "bad.csv"]].concat(), &["bad.csv", "line 1"]);
}
