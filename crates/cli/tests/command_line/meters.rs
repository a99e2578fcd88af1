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
