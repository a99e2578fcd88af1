//! Mitsuba scenes: faults of the text, and numbers that no scene should hold.

use crate::case::{Case, Expect, MITSUBA_SENSOR, MITSUBA_SKY, POISON};
use Expect::{Either, Picture, Refused, Warned};

const SPHERE: &str = "<shape type='sphere'/>";

/// Faults of syntax and structure.
pub fn syntax() -> Vec<Case> {
    let c = Case::mitsuba;
    let raw = |name: &str, text: &[u8], expect| Case::new(name, "s.xml", text, expect);
    vec![
        c("sound", SPHERE, Picture),
        c("unknown shape", "<shape type='spere'/>", Refused("did you mean 'sphere'")),
        c("place of the fault", "\n  <shape type='spere'/>", Refused("s.xml:6:")),
        c("unknown bsdf", "<shape type='sphere'><bsdf type='difuse'/></shape>", Refused("did you mean 'diffuse'")),
        c("unknown emitter", "<emitter type='constnt'/>", Refused("did you mean 'constant'")),
        c("unknown texture", "<shape type='sphere'><bsdf type='diffuse'><texture type='bitmp' name='reflectance'/></bsdf></shape>", Refused("did you mean 'bitmap'")),
        c("unknown element", "<shap type='sphere'/>", Refused("did you mean 'shape'")),
        c("unknown parameter", "<shape type='sphere'><float name='radus' value='1'/></shape>", Warned("did you mean 'radius'")),
        c("unknown reference", "<shape type='sphere'><ref id='a'/></shape>", Refused("'a'")),
        c("unknown alias", "<alias id='a' as='b'/>", Refused("'a'")),
        c("unknown parameter of the scene", "<shape type='sphere'><float name='radius' value='$r'/></shape>", Refused("r")),
        c("parameter of itself", "<default name='r' value='$r'/><shape type='sphere'><float name='radius' value='$r'/></shape>", Either),
        c("same id twice", "<bsdf type='diffuse' id='a'/><bsdf type='diffuse' id='a'/>", Refused("'a'")),
        c("reference to itself", "<bsdf type='twosided' id='a'><ref id='a'/></bsdf><shape type='sphere'><ref id='a'/></shape>", Refused("'a'")),
        c("alias cycle", "<alias id='a' as='b'/><alias id='b' as='a'/><shape type='sphere'><ref id='a'/></shape>", Refused("")),
        c("number that is none", "<shape type='sphere'><float name='radius' value='one'/></shape>", Refused("one")),
        c("value missing", "<shape type='sphere'><float name='radius'/></shape>", Refused("value")),
        c("string for a number", "<shape type='sphere'><string name='radius' value='1'/></shape>", Either),
        c("missing include", "<include filename='no.xml'/>", Refused("no.xml' (searched '")),
        c("missing mesh", "<shape type='ply'><string name='filename' value='no.ply'/></shape>", Refused("no.ply' (searched '")),
        c("missing image", "<emitter type='envmap'><string name='filename' value='no.exr'/></emitter>", Refused("no.exr' (searched '")),
        c("missing file name", "<shape type='ply'/>", Refused("filename")),
        c("include of itself", "<include filename='s.xml'/>", Refused("include")),
        c("include cycle", "<include filename='a.xml'/>", Refused("include"))
            .with("a.xml", "<scene version='3.0.0'><include filename='b.xml'/></scene>")
            .with("b.xml", "<scene version='3.0.0'><include filename='a.xml'/></scene>"),
        c("group in itself", "<shape type='shapegroup' id='g'><shape type='instance'><ref id='g'/></shape></shape><shape type='instance'><ref id='g'/></shape>", Refused("")),
        c("empty group", "<shape type='shapegroup' id='g'/><shape type='instance'><ref id='g'/></shape>", Either),
        c("instance of nothing", "<shape type='instance'/>", Refused("instance")),
        c("instance of a sphere", "<shape type='sphere' id='g'/><shape type='instance'><ref id='g'/></shape>", Refused("")),
        c("errors come together", "<shape type='a1'/>\n<emitter type='b2'/>\n<bsdf type='c3'/>", Refused("a1")),
        c("errors come together, last", "<shape type='a1'/>\n<emitter type='b2'/>\n<bsdf type='c3'/>", Refused("c3")),
        c("unclosed element", "<shape type='sphere'>", Refused("s.xml:")),
        c("wrong end", "<shape type='sphere'></bsdf>", Refused("s.xml:")),
        c("bare ampersand", "<shape type='sphere & co'/>", Refused("s.xml:")),
        c("billion laughs", "<shape type='&lol;'/>", Refused("s.xml:")),
        raw(
            "entities",
            b"<?xml version='1.0'?><!DOCTYPE s [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;'><!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;'><!ENTITY d '&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;'><!ENTITY e '&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;'><!ENTITY f '&e;&e;&e;&e;&e;&e;&e;&e;&e;&e;'><!ENTITY g '&f;&f;&f;&f;&f;&f;&f;&f;&f;&f;'><!ENTITY h '&g;&g;&g;&g;&g;&g;&g;&g;&g;&g;'>]><scene version='3.0.0'><string name='x' value='&h;'/></scene>",
            Refused(""),
        ),
        raw("external entity", b"<!DOCTYPE s [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><scene version='3.0.0'><string name='x' value='&x;'/></scene>", Refused("")),
        raw("empty file", b"", Refused("")),
        raw("zeros", &[0; 4096], Refused("")),
        raw("not utf-8", b"<scene version='3.0.0'><shape type='\xff\xfe'/></scene>", Refused("")),
        raw("utf-16", &"<scene version='3.0.0'/>".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>(), Refused("")),
        raw("other root", b"<shape type='sphere'/>", Refused("")),
        raw("no version", format!("<scene>{MITSUBA_SENSOR}{MITSUBA_SKY}</scene>").as_bytes(), Either),
        raw("version of the future", format!("<scene version='99.0.0'>{MITSUBA_SENSOR}{MITSUBA_SKY}</scene>").as_bytes(), Either),
        raw("version that is none", format!("<scene version='-1.x'>{MITSUBA_SENSOR}{MITSUBA_SKY}</scene>").as_bytes(), Refused("version")),
        raw("no sensor", b"<scene version='3.0.0'><shape type='sphere'/><emitter type='constant'/></scene>", Either),
        raw("empty scene", b"<scene version='3.0.0'/>", Either),
        c("sensor of a kind we lack", "<sensor type='radiancemeter'/>", Either),
        c("spectrum backwards", "<emitter type='point'><spectrum name='intensity' value='700:1, 400:1'/></emitter>", Refused("")),
        c("light that is black", "<emitter type='constant'><rgb name='radiance' value='0'/></emitter>", Either),
    ]
}

/// Elements whose numbers (`@`) are poisoned one after the other.
const BODIES: [&str; 46] = [
    "<shape type='sphere'><float name='radius' value='@'/></shape>",
    "<shape type='sphere'><point name='center' x='@' y='0' z='0'/></shape>",
    "<shape type='sphere'><transform name='to_world'><scale value='@'/></transform></shape>",
    "<shape type='sphere'><transform name='to_world'><scale x='@'/></transform></shape>",
    "<shape type='sphere'><transform name='to_world'><translate x='@'/></transform></shape>",
    "<shape type='sphere'><transform name='to_world'><rotate x='@' angle='30'/></transform></shape>",
    "<shape type='sphere'><transform name='to_world'><rotate y='1' angle='@'/></transform></shape>",
    "<shape type='sphere'><transform name='to_world'><lookat origin='@,0,0' target='0,0,0' up='0,1,0'/></transform></shape>",
    "<shape type='sphere'><transform name='to_world'><matrix value='1 0 0 @ 0 1 0 0 0 0 1 0 0 0 0 1'/></transform></shape>",
    "<shape type='sphere'><transform name='to_world'><matrix value='1 0 0 0 0 1 0 0 0 0 1 0 @ 0 0 1'/></transform></shape>",
    "<shape type='rectangle'><transform name='to_world'><scale x='@' y='0.5'/></transform></shape>",
    "<shape type='disk'><transform name='to_world'><scale x='@' y='0.5'/></transform></shape>",
    "<shape type='cube'><transform name='to_world'><scale x='@' y='0.5'/></transform></shape>",
    "<shape type='cylinder'><float name='radius' value='@'/></shape>",
    "<shape type='cylinder'><point name='p0' value='@, 0, 0'/></shape>",
    "<shape type='cylinder'><point name='p0' value='@, 0, 0'/><point name='p1' value='@, 0, 0'/></shape>",
    "<shape type='sphere'><float name='radius' value='@'/><emitter type='area'/></shape>",
    "<shape type='rectangle'><transform name='to_world'><scale x='@'/></transform><emitter type='area'/></shape>",
    "<shape type='sphere'><transform name='to_world'><scale x='@' y='2'/></transform><emitter type='area'/></shape>",
    "<shape type='rectangle'><emitter type='area'><rgb name='radiance' value='@,1,1'/></emitter></shape>",
    "<shape type='rectangle'><emitter type='area'><spectrum name='radiance' value='400:1, 500:@, 600:1'/></emitter></shape>",
    "<shape type='rectangle'><emitter type='directionalarea'><rgb name='radiance' value='@,1,1'/></emitter></shape>",
    "<emitter type='point'><point name='position' value='@ 0 0'/></emitter><shape type='sphere'/>",
    "<emitter type='point'><rgb name='intensity' value='@'/></emitter><shape type='sphere'/>",
    "<emitter type='spot'><float name='cutoff_angle' value='@'/></emitter><shape type='rectangle'/>",
    "<emitter type='spot'><float name='beam_width' value='@'/></emitter><shape type='rectangle'/>",
    "<emitter type='directional'><vector name='direction' value='@ 0 0'/></emitter><shape type='sphere'/>",
    "<emitter type='directional'><spectrum name='irradiance' value='@'/></emitter><shape type='sphere'/>",
    "<emitter type='constant'><rgb name='radiance' value='@ 1 1'/></emitter><shape type='sphere'/>",
    "<emitter type='projector'><float name='fov' value='@'/></emitter><shape type='sphere'/>",
    "<emitter type='projector'><rgb name='irradiance' value='@'/><float name='scale' value='@'/></emitter><shape type='sphere'/>",
    "<shape type='shapegroup' id='g'><shape type='sphere'/></shape><shape type='instance'><ref id='g'/><transform name='to_world'><scale value='@'/></transform></shape>",
    "<shape type='shapegroup' id='g'><shape type='sphere'/></shape><shape type='instance'><ref id='g'/><transform name='to_world'><translate x='@'/></transform></shape>",
    "<shape type='sphere'><bsdf type='null'/><medium name='interior' type='homogeneous'><rgb name='sigma_t' value='@ 1 1'/></medium></shape>",
    "<shape type='sphere'><bsdf type='null'/><medium name='interior' type='homogeneous'><float name='scale' value='@'/></medium></shape>",
    "<shape type='sphere'><bsdf type='null'/><medium name='interior' type='homogeneous'><rgb name='albedo' value='@'/></medium></shape>",
    "<shape type='sphere'><bsdf type='null'/><medium name='interior' type='homogeneous'><phase type='hg'><float name='g' value='@'/></phase></medium></shape>",
    "<integrator type='path'><integer name='max_depth' value='@'/></integrator><shape type='sphere'/>",
    "<integrator type='path'><integer name='rr_depth' value='@'/></integrator><shape type='sphere'/>",
    "<shape type='rectangle'><bsdf type='diffuse'><texture name='reflectance' type='checkerboard'><transform name='to_uv'><scale x='@'/></transform></texture></bsdf></shape>",
    "<shape type='linearcurve'><string name='filename' value='s.xml'/><float name='radius' value='@'/></shape>",
    "<emitter type='sunsky'><float name='turbidity' value='@'/></emitter><shape type='sphere'/>",
    "<shape type='sphere'><boolean name='flip_normals' value='@'/></shape>",
    "<shape type='sphere'><integer name='id' value='@'/></shape>",
    "<default name='r' value='@'/><shape type='sphere'><float name='radius' value='$r'/></shape>",
    "<emitter type='constant'><spectrum name='radiance' value='@:1, 700:1'/></emitter><shape type='sphere'/>",
];

/// Sensors whose numbers are poisoned; the sphere is before them.
const SENSORS: [&str; 22] = [
    "<sensor type='perspective'><float name='fov' value='@'/>#</sensor>",
    "<sensor type='perspective'><string name='focal_length' value='@mm'/>#</sensor>",
    "<sensor type='perspective'><float name='near_clip' value='@'/>#</sensor>",
    "<sensor type='perspective'><float name='far_clip' value='@'/>#</sensor>",
    "<sensor type='perspective'><float name='principal_point_offset_x' value='@'/>#</sensor>",
    "<sensor type='perspective'><transform name='to_world'><lookat origin='0,0,@' target='0,0,0' up='0,1,0'/></transform>#</sensor>",
    "<sensor type='perspective'><transform name='to_world'><lookat origin='0,0,-5' target='0,0,0' up='0,0,@'/></transform>#</sensor>",
    "<sensor type='thinlens'><float name='aperture_radius' value='@'/><float name='focus_distance' value='5'/>#</sensor>",
    "<sensor type='thinlens'><float name='aperture_radius' value='0.1'/><float name='focus_distance' value='@'/>#</sensor>",
    "<sensor type='orthographic'><transform name='to_world'><scale value='@'/></transform>#</sensor>",
    "<sensor type='orthographic'><float name='near_clip' value='@'/>#</sensor>",
    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='@'/><integer name='height' value='4'/></film></sensor>",
    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><integer name='crop_width' value='@'/><integer name='crop_height' value='4'/></film></sensor>",
    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><integer name='crop_offset_x' value='@'/></film></sensor>",
    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><rfilter type='gaussian'><float name='stddev' value='@'/></rfilter></film></sensor>",
    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><rfilter type='mitchell'><float name='B' value='@'/></rfilter></film></sensor>",
    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><rfilter type='lanczos'><integer name='lobes' value='@'/></rfilter></film></sensor>",
    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><rfilter type='tent'><float name='radius' value='@'/></rfilter></film></sensor>",
    "<sensor type='perspective'>#<sampler type='independent'><integer name='sample_count' value='@'/></sampler></sensor>",
    "<sensor type='perspective'>#<sampler type='stratified'><integer name='seed' value='@'/></sampler></sensor>",
    "<sensor type='perspective'>#<float name='shutter_open' value='@'/></sensor>",
    "<sensor type='perspective'>#<string name='fov_axis' value='@'/></sensor>",
];

const FILM: &str = "<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/></film>";

/// Poisoned numbers: errors, or a finite picture.
pub fn numbers() -> Vec<Case> {
    let bodies = BODIES.iter().flat_map(|t| POISON.iter().map(move |p| (t.replace('@', p), Expect::of_number(p))));
    let bodies = bodies.map(|(text, expect)| Case::mitsuba(text.clone(), text, expect));
    let fill = |t: &str, p: &str| (t.replace('@', p).replace('#', FILM), Expect::of_number(p));
    let sensors = SENSORS.iter().flat_map(|t| POISON.iter().map(move |p| fill(t, p)));
    let sensors = sensors.map(|(sensor, expect)| {
        let text = format!("<scene version='3.0.0'>{MITSUBA_SKY}{SPHERE}{sensor}</scene>");
        Case::new(sensor, "s.xml", text, expect)
    });
    bodies.chain(sensors).collect()
}
