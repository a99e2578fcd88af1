//! Small files that grow, floods of valid input, and requests beyond any machine.

use crate::{
    case::{Case, Expect, MITSUBA_SENSOR, MITSUBA_SKY, PBRT_HEAD, PBRT_SKY},
    images,
};
use Expect::{Either, Picture, Refused};
use std::io::Write;

fn pbrt_file(name: &str, text: impl Into<Vec<u8>>, expect: Expect) -> Case {
    Case::new(name, "s.pbrt", text, expect)
}

/// Zeros and spaces, packed a thousand to one.
fn gzip_bomb(count: usize) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let block = vec![b' '; 1 << 20];
    (0..count >> 20).for_each(|_| packer.write_all(&block).expect("memory can be written"));
    packer.finish().expect("memory can be written")
}

fn deep_materials(count: usize) -> String {
    let chain: String = (1..count)
        .map(|i| {
            format!(
                "MakeNamedMaterial \"m{i}\" \"string type\" \"mix\" \"string materials\" [\"m{}\" \"m{}\"]\n",
                i - 1,
                i - 1
            )
        })
        .collect();
    format!(
        "MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n{chain}NamedMaterial \"m{}\" Shape \"sphere\"",
        count - 1
    )
}

fn deep_textures(count: usize) -> String {
    let chain: String = (1..count)
        .map(|i| {
            format!(
                "Texture \"t{i}\" \"spectrum\" \"mix\" \"texture tex1\" \"t{}\" \"texture tex2\" \"t{}\"\n",
                i - 1,
                i - 1
            )
        })
        .collect();
    let last = count - 1;
    format!(
        "Texture \"t0\" \"spectrum\" \"constant\"\n{chain}Material \"diffuse\" \"texture reflectance\" \"t{last}\" Shape \"sphere\""
    )
}

fn p(name: &str, world: impl AsRef<str>, expect: Expect) -> Case {
    Case::pbrt(name, world, expect)
}

fn m(name: &str, body: impl AsRef<str>, expect: Expect) -> Case {
    Case::mitsuba(name, body, expect)
}

/// `what` for every number below `count`.
fn many(count: usize, what: impl Fn(usize) -> String) -> String {
    (0..count).map(what).collect()
}

/// Films and numbers of samples beyond any machine, and below any sense.
fn requests() -> Vec<Case> {
    let film = |size: &str| {
        let head = "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\"";
        format!(
            "{head} Film \"rgb\" \"integer xresolution\" {size} \"integer yresolution\" {size} WorldBegin {PBRT_SKY}"
        )
    };
    let mitsuba_film = |size: &str| {
        let size = format!("<integer name='width' value='{size}'/><integer name='height' value='{size}'/>");
        format!(
            "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'>{size}</film></sensor>{MITSUBA_SKY}</scene>"
        )
    };
    let spp = |n: &str| {
        format!(
            "{PBRT_HEAD}Sampler \"independent\" \"integer pixelsamples\" [{n}]\nWorldBegin {PBRT_SKY} Shape \"sphere\""
        )
    };
    vec![
        pbrt_file("film of 200000²", film("200000"), Refused("200000")),
        pbrt_file("film of 0²", film("0"), Refused("the film is empty")),
        pbrt_file("film of -5²", film("-5"), Refused("the film is empty")),
        pbrt_file("film of 2³¹", film("2147483647"), Refused("2147483647")),
        Case::new("Mitsuba film of 200000²", "s.xml", mitsuba_film("200000"), Refused("200000")),
        Case::new("Mitsuba film of 0²", "s.xml", mitsuba_film("0"), Refused("0")),
        Case::new("Mitsuba film of -5²", "s.xml", mitsuba_film("-5"), Refused("-5")),
        pbrt_file("10¹² samples", spp("1000000000000"), Either),
        pbrt_file("0 samples", spp("0"), Refused("must be above 0")),
    ]
}

/// Long and deep texts.
fn long_texts() -> Vec<Case> {
    vec![
        pbrt_file(
            "10⁶ blocks deep",
            format!("{PBRT_HEAD}WorldBegin\n{}", "AttributeBegin\n".repeat(1_000_000)),
            Refused("nested"),
        ),
        pbrt_file(
            "10⁶ objects deep",
            format!("{PBRT_HEAD}WorldBegin\n{}", "ObjectBegin \"o\"\n".repeat(1_000_000)),
            Refused(""),
        ),
        pbrt_file("10⁶ brackets", format!("{PBRT_HEAD}WorldBegin\n{}", "[".repeat(1_000_000)), Refused("")),
        pbrt_file(
            "10⁶ faults",
            format!("{PBRT_HEAD}WorldBegin\n{}", "Bogus \"x\"\n".repeat(1_000_000)),
            Refused("Bogus"),
        ),
        pbrt_file(
            "10⁵ warnings",
            format!("{PBRT_HEAD}WorldBegin\n{}", "Translate 9 0 0 Shape \"sphere\" \"float r\" 1\n".repeat(100_000)),
            Either,
        ),
        pbrt_file("10⁷ bytes in a line", [&b"WorldBegin "[..], &vec![b'1'; 10_000_000]].concat(), Refused("")),
        pbrt_file(
            "a string of 10⁷ bytes",
            [&b"WorldBegin Shape \""[..], &vec![b'a'; 10_000_000], b"\""].concat(),
            Refused(""),
        ),
        pbrt_file(
            "an unclosed string of 10⁷ bytes",
            [&b"WorldBegin Shape \""[..], &vec![b'\n'; 10_000_000]].concat(),
            Refused(""),
        ),
    ]
}

/// Files that unpack or include more than they seem to.
fn includes() -> Vec<Case> {
    let zip = gzip_bomb(64 << 20);
    vec![
        pbrt_file("a gzip bomb", zip.clone(), Refused("unpacks to more")),
        pbrt_file(
            "an included gzip bomb",
            format!("{PBRT_HEAD}WorldBegin {PBRT_SKY}{}", "Include \"bomb.gz\"\n".repeat(4)),
            Refused("unpacks to more"),
        )
        .with("bomb.gz", zip),
        pbrt_file(
            "10⁴ includes of 10⁷ bytes",
            format!("{PBRT_HEAD}WorldBegin {PBRT_SKY}{}", "Include \"spaces.pbrt\"\n".repeat(10_000)),
            Refused("included so often"),
        )
        .with("spaces.pbrt", vec![b' '; 10_000_000]),
        pbrt_file(
            "10⁵ transparent squares at one place",
            format!(
                "{PBRT_HEAD}WorldBegin {PBRT_SKY} Shape \"trianglemesh\" \"float alpha\" 0 \"point3 P\" [-9 -9 0 9 -9 0 9 9 0] \"integer indices\" [{}]",
                "0 1 2 ".repeat(100_000)
            ),
            Either,
        ),
        pbrt_file(
            "20000 includes",
            format!("{PBRT_HEAD}WorldBegin {}", "Include \"a.pbrt\"\n".repeat(20_000)),
            Refused(""),
        )
        .with("a.pbrt", "# a\n"),
        pbrt_file("includes that double", format!("{PBRT_HEAD}WorldBegin Include \"0.pbrt\"\n"), Refused(""))
            .with_doubling(40),
    ]
}

/// Shapes that are split without end.
fn fine_shapes() -> Vec<Case> {
    vec![
        p(
            "30 levels of subdivision",
            "Shape \"loopsubdiv\" \"integer levels\" 30 \"point3 P\" [-1 -1 0 1 -1 0 0 1 0 0 0 1] \"integer indices\" [0 1 2 0 1 3 1 2 3 2 0 3]",
            Either,
        ),
        p(
            "2³¹ levels of subdivision",
            "Shape \"loopsubdiv\" \"integer levels\" 2147483647 \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] \"integer indices\" [0 1 2]",
            Either,
        ),
        p(
            "a curve of 30000 points",
            format!(
                "Shape \"curve\" \"string basis\" \"bspline\" \"point3 P\" [{}] \"float width\" 0.01",
                many(30_000, |i| format!("{} {} 0 ", i % 7, i % 5))
            ),
            Picture,
        ),
        p(
            "a curve split 30 times",
            "Shape \"curve\" \"integer splitdepth\" 30 \"point3 P\" [-1 0 0 -0.5 1 0 0.5 1 0 1 0 0]",
            Either,
        ),
    ]
}

/// Many shapes, lights, materials and instances.
fn floods() -> Vec<Case> {
    vec![
        p("10⁵ spheres", many(100_000, |i| format!("Translate 0.{i} 0 0 Shape \"sphere\"\n")), Picture),
        p(
            "10⁵ lights",
            many(100_000, |i| format!("LightSource \"point\" \"point3 from\" [0 {i} -3]\n")) + "Shape \"sphere\"",
            Picture,
        ),
        p(
            "10⁵ lights at one point",
            "LightSource \"point\" \"point3 from\" [0 0 -3]\n".repeat(100_000) + "Shape \"sphere\"",
            Picture,
        ),
        p(
            "10⁴ emitting spheres at one point",
            "AreaLightSource \"diffuse\"\n".to_string() + &"Shape \"sphere\"\n".repeat(10_000),
            Picture,
        ),
        p(
            "10⁵ materials",
            many(100_000, |i| format!("Translate 0.{i} 0 0 Material \"diffuse\" Shape \"sphere\"\n")),
            Picture,
        ),
        p(
            "10⁴ coats",
            many(10_000, |i| format!("Material \"coateddiffuse\" \"float roughness\" 0.{i} Shape \"sphere\"\n")),
            Picture,
        ),
        p(
            "10⁵ instances",
            "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd\n".to_string()
                + &many(100_000, |i| format!("Translate 0 0 0.{i} ObjectInstance \"o\"\n")),
            Picture,
        ),
        p(
            "10⁵ instances of nothing",
            "ObjectBegin \"o\" ObjectEnd\n".to_string() + &"ObjectInstance \"o\"\n".repeat(100_000),
            Either,
        ),
    ]
}

/// Materials and textures that refer to others, and large ones that are not used.
fn chains() -> Vec<Case> {
    vec![
        p("mixtures of mixtures, 30 deep", deep_materials(30), Refused("more than 65536 textures")),
        p("mixtures of mixtures, 10⁴ deep", deep_materials(10_000), Refused("nested")),
        p("textures of textures, 30 deep", deep_textures(30), Refused("more than 65536 textures")),
        p("textures of textures, 10⁴ deep", deep_textures(10_000), Refused("more than 65536 textures")),
        p("10⁵ textures, none used", many(100_000, |i| format!("Texture \"t{i}\" \"float\" \"constant\"\n")), Either),
        p("a picture bomb of 30000²", "LightSource \"infinite\" \"string filename\" \"i.png\"", Refused("i.png"))
            .with("i.png", images::true_png(30_000)),
    ]
}

/// Deep and long documents of Mitsuba's.
fn mitsuba() -> Vec<Case> {
    let nested = |count: usize, open: &str, close: &str| {
        format!("<scene version='3.0.0'>{MITSUBA_SENSOR}{}{}</scene>", open.repeat(count), close.repeat(count))
    };
    vec![
        Case::new(
            "10⁶ elements deep",
            "s.xml",
            nested(1_000_000, "<shape type='shapegroup'>", "</shape>"),
            Refused("nest deeper"),
        ),
        Case::new("10⁶ elements deep, unclosed", "s.xml", nested(1_000_000, "<bsdf type='twosided'>", ""), Refused("")),
        Case::new("10⁶ tags that are none", "s.xml", nested(1_000_000, "<", ""), Refused("")),
        m(
            "blends of blends, 31 deep",
            "<shape type='sphere'>".to_string()
                + &"<bsdf type='twosided'>".repeat(31)
                + &"</bsdf>".repeat(31)
                + "</shape>",
            Either,
        ),
        m("10⁴ shapes at one point", "<shape type='sphere'/>".repeat(10_000), Picture),
        m("10⁵ rectangles", "<shape type='rectangle'/>".repeat(100_000), Picture),
        m(
            "10⁵ lights",
            "<emitter type='point'><point name='position' value='0 0 -3'/></emitter>".repeat(100_000),
            Picture,
        ),
        m("10⁵ faults", "<shape type='x'/>".repeat(100_000), Refused("'x'")),
        m(
            "10⁵ parameters",
            format!("<shape type='sphere'>{}</shape>", many(100_000, |i| format!("<float name='p{i}' value='1'/>"))),
            Either,
        ),
        m("10⁵ attributes", format!("<shape type='sphere' {}/>", many(100_000, |i| format!("a{i}='1' "))), Either),
        m("10⁵ defaults", many(100_000, |i| format!("<default name='p{i}' value='1'/>")), Either),
        m(
            "30000 instances",
            "<shape type='shapegroup' id='g'><shape type='sphere'/></shape>".to_string()
                + &many(30_000, |i| {
                    let place = format!("<transform name='to_world'><translate x='{i}'/></transform>");
                    format!("<shape type='instance'><ref id='g'/>{place}</shape>")
                }),
            Picture,
        ),
    ]
}

pub fn table() -> Vec<Case> {
    let parts = [requests(), long_texts(), includes(), fine_shapes(), floods(), chains(), mitsuba()];
    parts.into_iter().flatten().collect()
}

impl Case {
    /// Adds files `0.pbrt`, `1.pbrt`, … each of which includes the next one twice.
    fn with_doubling(mut self, count: usize) -> Self {
        for i in 0..count {
            let next = i + 1;
            self = self.with(&format!("{i}.pbrt"), format!("Include \"{next}.pbrt\"\nInclude \"{next}.pbrt\"\n"));
        }
        self.with(&format!("{count}.pbrt"), "# the end\n")
    }
}
