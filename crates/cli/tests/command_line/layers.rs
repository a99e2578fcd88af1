//! Layers of pictures: `--aov`, `--transparent`, `convert --layer`, `compare -o`.

use crate::Place;

/// A grey card of reflectance one half that fills the right half of the picture, one unit before the camera, under a
/// coloured sky.
const CARD: &str = "LookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\" \"float fov\" 90\n\
    Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\nWorldBegin\n\
    LightSource \"infinite\" \"rgb L\" [ .5 .6 .9 ]\n\
    Material \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\n\
    Shape \"bilinearmesh\" \"point3 P\" [ 0 -2 1  4 -2 1  0 2 1  4 2 1 ]\n";

/// Every layer of a grey card is what denoisers and compositors expect, with either colour arithmetic.
#[test]
fn a_grey_card_has_the_layers_that_it_should() {
    let place = Place::new();
    place.file("card.pbrt", CARD);
    for color in ["rgb", "spectral"] {
        let command = ["render", "card.pbrt", "--spp", "16", "--aov", "all", "--color", color, "-q", "-o", "card.exr"];
        place.succeed(&command);
        let picture = place.picture("card.exr");
        let at = |channel: &str, x: usize, y: usize| picture.channel(channel).unwrap()[y * 16 + x];
        for (x, y) in [(9, 2), (12, 8), (15, 15)] {
            let close = |channel: &str, value: f32, within: f32| {
                let found = at(channel, x, y);
                assert!((found - value).abs() <= within, "{color}: {channel} at {x}, {y} is {found}, not {value}");
            };
            let [px, py] = [(x as f32 + 0.5) / 8.0 - 1.0, 1.0 - (y as f32 + 0.5) / 8.0];
            // The plane at distance one; the picture is two units wide there.
            for (channel, value, within) in [
                ("albedo.R", 0.5, 2e-4),
                ("albedo.G", 0.5, 2e-4),
                ("albedo.B", 0.5, 2e-4),
                ("N.X", 0.0, 1e-6),
                ("N.Y", 0.0, 1e-6),
                ("N.Z", -1.0, 1e-6),
                ("Ng.X", 0.0, 1e-6),
                ("Ng.Y", 0.0, 1e-6),
                ("Ng.Z", -1.0, 1e-6),
                ("P.X", px, 0.07),
                ("P.Y", py, 0.07),
                ("P.Z", 1.0, 1e-5),
                ("Z", 1.0, 1e-5),
                ("A", 1.0, 0.0),
                ("samples.Y", 16.0, 0.0),
            ] {
                close(channel, value, within);
            }
            close("depth.Z", (1.0 + px * px + py * py).sqrt(), 0.07);
            close("uv.U", at("P.X", x, y) / 4.0, 1e-4);
            assert!(at("object_id.Y", x, y) > 0.0 && at("material_id.Y", x, y) > 0.0);
            assert!(at("variance.R", x, y) >= 0.0);
        }
        for channel in ["albedo.R", "N.Z", "Ng.Z", "P.Z", "uv.U", "object_id.Y", "material_id.Y", "A"] {
            assert_eq!(at(channel, 3, 8), 0.0, "{color}: {channel}");
        }
        assert_eq!((at("Z", 3, 8), at("depth.Z", 3, 8)), (f32::INFINITY, f32::INFINITY));
        assert!(at("R", 3, 8) > 0.4, "the sky is in the picture");
    }
}

/// The background is left out, premultiplied in .exr and straight in .png.
#[test]
fn transparent_pictures_have_no_background() {
    let place = Place::new();
    // The card's edge runs through the middle of a column.
    place.file("card.pbrt", &CARD.replace(" 0 -2 1 ", " .0625 -2 1 ").replace(" 0 2 1 ", " .0625 2 1 "));
    let common = ["render", "card.pbrt", "--spp", "256", "--color", "rgb", "-q", "-o", "card.exr"];
    place.succeed(&[&common[..], &["-o", "card.png", "--transparent"]].concat());
    let (exr, png) = (place.picture("card.exr"), place.picture("card.png"));
    let at = |picture: &steradian::image::Image, channel: &str, x: usize| picture.channel(channel).unwrap()[8 * 16 + x];
    assert_eq!((at(&exr, "A", 3), at(&exr, "R", 3), at(&png, "A", 3)), (0.0, 0.0, 0.0));
    let (a, full) = (at(&exr, "A", 8), at(&exr, "B", 12));
    assert!((a - 0.5).abs() < 0.1 && at(&exr, "A", 12) == 1.0, "{a}");
    assert!((at(&exr, "B", 8) / (a * full) - 1.0).abs() < 0.1, "premultiplied");
    assert!((at(&png, "B", 8) / at(&png, "B", 12) - 1.0).abs() < 0.1, "straight");
    place.refuse(2, &["render", "card.pbrt", "--transparent", "--integrator", "bdpt"], &["transparent"]);
    place.succeed(&["render", "card.pbrt", "--transparent", "--integrator", "raster", "-q", "-o", "drawn.exr"]);
    let drawn = place.picture("drawn.exr");
    assert_eq!((at(&drawn, "A", 3), at(&drawn, "B", 3), at(&drawn, "A", 12)), (0.0, 0.0, 1.0));
    assert!((at(&drawn, "B", 12) / full - 1.0).abs() < 0.1, "premultiplied");
}

/// The ground that models get is left out with the background, unless it is asked for.
#[test]
fn transparent_pictures_of_models_have_no_ground() {
    let place = Place::new();
    place.file("m.obj", "v 0 0 0\nv 1 2 0\nv -1 2 0\nf 1 2 3\n");
    let common = ["render", "m.obj", "--size", "32x24", "--spp", "16", "-q", "--transparent"];
    let bottom = |more: &[&str]| {
        place.succeed(&[&common[..], more, &["-D", "material=gold", "-o", "m.exr"]].concat());
        place.picture("m.exr").channel("A").unwrap()[23 * 32 + 2]
    };
    assert_eq!((bottom(&[]), bottom(&["-D", "ground=true"])), (0.0, 1.0));
    let shadow = bottom(&["-D", "ground=shadow"]);
    assert!((0.0..0.5).contains(&shadow), "{shadow}");
    let by_photons = ["render", "m.obj", "-D", "ground=shadow", "--integrator", "sppm", "--size", "8x6", "-o", "m.exr"];
    let said = place.succeed(&by_photons).stderr;
    assert!(said.contains("shadow catchers: they are shown as surfaces"), "{said}");
    place.refuse(2, &["render", "m.obj", "-D", "material=godl", "-o", "m.exr"], &["'material'", "gold"]);
}

#[test]
fn layers_and_differences_become_pictures() {
    let place = Place::new();
    place.file("card.pbrt", CARD);
    for (seed, name) in [("1", "a.exr"), ("2", "b.exr")] {
        place.succeed(&[
            "render",
            "card.pbrt",
            "--spp",
            "4",
            "--aov",
            "normal,depth",
            "--seed",
            seed,
            "-q",
            "-o",
            name,
        ]);
    }
    for (layer, output) in [("normal", "n.pfm"), ("N", "n.exr"), ("Z", "z.pfm"), ("depth", "depth.png")] {
        place.succeed(&["convert", "a.exr", output, "--layer", layer]);
    }
    assert_eq!(place.picture("n.pfm").rgb().unwrap().at(8 * 16 + 12), [0.0, 0.0, -1.0]);
    assert_eq!(place.picture("n.exr").channel_names(), "B, G, R");
    place.refuse(2, &["convert", "a.exr", "x.exr", "--layer", "nromal"], &["no layer 'nromal'", "N.X"]);
    for output in ["difference.png", "difference.exr"] {
        place.succeed(&["compare", "a.exr", "b.exr", "-o", output]);
        let picture = place.picture(output);
        assert!(picture.rgb().unwrap().r.iter().all(|v| v.is_finite()) && picture.width() == 16, "{output}");
    }
    place.refuse(2, &["compare", "a.exr", "b.exr", "-o", "a.exr"], &["would be overwritten"]);
    place.refuse(2, &["compare", "a.exr", "-r", "a.exr", "-r", "b.exr", "-o", "d.png"], &["one pair"]);
}

/// Cryptomattes name what covers each pixel, as the specification has it.
#[test]
fn cryptomattes_name_what_covers_pixels() {
    let place = Place::new();
    let shape = "<shape type='rectangle' id='Wall'><ref id='Paint'/></shape>\
        <shape type='rectangle'><transform name='to_world'><scale value='.5'/><translate x='1' z='.5'/></transform>\
        <bsdf type='diffuse'/></shape>";
    place.file(
        "mattes.xml",
        &format!(
            "<scene version='3.0.0'><integrator type='path'/><sensor type='orthographic'><transform name='to_world'>\
             <scale value='2'/><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'>\
             <integer name='width' value='15'/><integer name='height' value='15'/><rfilter type='box'/></film></sensor>\
             <emitter type='constant'/><bsdf type='diffuse' id='Paint'/>{shape}</scene>"
        ),
    );
    let command = ["render", "mattes.xml", "--spp", "64", "--aov", "cryptomatte", "--exr", "half", "-q"];
    place.succeed(&[&command[..], &["-o", "mattes.exr", "-o", "mattes.png"]].concat());
    let picture = place.picture("mattes.exr");
    let at = |channel: &str, x: usize, y: usize| picture.channel(channel).unwrap()[y * 15 + x];
    for layer in ["crypto_object", "crypto_material"] {
        let keys: Vec<&str> = picture
            .metadata
            .entries
            .iter()
            .filter(|(_, v)| *v == steradian::image::Value::Text(layer.into()))
            .filter_map(|(n, _)| n.strip_suffix("/name"))
            .collect();
        assert_eq!(keys.len(), 1, "one key names {layer}");
        let text = |what: &str| match picture.metadata.get(&format!("{}/{what}", keys[0])) {
            Some(steradian::image::Value::Text(text)) => text.clone(),
            other => panic!("{what}: {other:?}"),
        };
        assert_eq!((text("hash"), text("conversion")), ("MurmurHash3_32".into(), "uint32_to_float32".into()));
        let manifest: serde_json::Value = serde_json::from_str(&text("manifest")).unwrap();
        let id = |name: &str| f32::from_bits(u32::from_str_radix(manifest[name].as_str().unwrap(), 16).unwrap());
        let wall = if layer == "crypto_object" { "Wall" } else { "Paint" };
        let first = |x, y| [at(&format!("{layer}00.r"), x, y), at(&format!("{layer}00.g"), x, y)];
        let second = |x, y| [at(&format!("{layer}00.b"), x, y), at(&format!("{layer}00.a"), x, y)];
        // The wall spans the middle half of the picture, 3.75 pixels from its edges.
        assert_eq!(first(7, 7), [id(wall), 1.0], "{layer}");
        assert_eq!((first(0, 0), second(7, 7)), ([0.0; 2], [0.0; 2]), "{layer}");
        let [edge, part] = first(7, 3);
        assert!(edge == id(wall) && (0.1..0.45).contains(&part), "{layer}: {part} of the pixel is covered");
        // The smaller one hides it, and has a name of its own in the manifest.
        let other = (0..15).map(|x| first(x, 7)).find(|r| r[1] == 1.0 && r[0] != id(wall)).expect("another thing");
        assert!(manifest.as_object().unwrap().keys().any(|name| id(name) == other[0]), "{layer}");
        // Between them both share a pixel, the one that covers more before the other.
        let shared = (0..15).map(|x| (first(x, 7), second(x, 7))).find(|(a, b)| a[1] > 0.0 && b[1] > 0.0);
        let ([_, more], [_, less]) = shared.expect("an edge of the smaller one over the larger");
        assert!(more >= less && more + less == 1.0, "{layer}: {more} and {less}");
    }
    // A .png has no layers, and so nothing that tells of them.
    let flat = place.picture("mattes.png");
    assert!(flat.metadata.entries.iter().all(|(name, _)| !name.starts_with("cryptomatte/")));
}

/// A room corner with a lamp of each sort: a named panel, a point, and a sky, seen past a sheet of glass.
fn lamps(chosen: &[&str]) -> String {
    let all = [
        (
            "Panel",
            "AttributeBegin\n AreaLightSource \"diffuse\" \"rgb L\" [ 9 6 3 ]\n Shape \"bilinearmesh\" \
            \"point3 P\" [ -1 3 6  1 3 6  -1 3 4  1 3 4 ] \nAttributeEnd\n",
        ),
        ("point", "LightSource \"point\" \"rgb I\" [ 2 4 6 ] \"point3 from\" [ 1 2 2 ]\n"),
        ("environment", "LightSource \"infinite\" \"rgb L\" [ .1 .2 .1 ]\n"),
    ];
    let lights: String = all.iter().filter(|(name, _)| chosen.contains(name)).map(|(_, text)| *text).collect();
    format!(
        "LookAt 0 1 -2  0 1 4  0 1 0\nCamera \"perspective\" \"float fov\" 70\nFilm \"rgb\" \"integer xresolution\" 16 \
         \"integer yresolution\" 16 \"float maxcomponentvalue\" 2\nWorldBegin\n{lights}\
         Material \"diffuse\" \"rgb reflectance\" [ .6 .6 .5 ]\n\
         Shape \"bilinearmesh\" \"point3 P\" [ -9 0 -9  9 0 -9  -9 0 9  9 0 9 ]\n\
         Material \"dielectric\"\nShape \"sphere\" \"float radius\" .5\n\
         Material \"conductor\"\nAttributeBegin\nTranslate -1 .6 3\nShape \"sphere\" \"float radius\" .6\nAttributeEnd\n"
    )
}

/// The light of groups adds up to the picture, and that of one group is the picture of a scene with that light alone.
#[test]
fn the_light_of_groups_adds_up_to_the_picture() {
    let place = Place::new();
    let every = ["Panel", "point", "environment"];
    place.file("lamps.pbrt", &lamps(&every));
    for light in every {
        place.file(&format!("{light}.pbrt"), &lamps(&[light]));
    }
    for color in ["rgb", "spectral"] {
        let render = |scene: &str, layers: &[&str]| {
            let command = ["render", scene, "--spp", "256", "--color", color, "-q", "-o", "out.exr"];
            place.succeed(&[&command[..], layers].concat());
            place.picture("out.exr")
        };
        let picture = render("lamps.pbrt", &["--aov", "light_groups"]);
        let groups: Vec<String> = picture
            .channels()
            .iter()
            .filter_map(|c| c.name.strip_suffix(".R").filter(|name| name.starts_with("RGBA_")))
            .map(String::from)
            .collect();
        assert_eq!(groups.len(), 3, "{groups:?}");
        for channel in ["R", "G", "B"] {
            let whole = picture.channel(channel).unwrap();
            for (at, &value) in whole.iter().enumerate() {
                let sum: f32 = groups.iter().map(|g| picture.channel(&format!("{g}.{channel}")).unwrap()[at]).sum();
                assert!((sum - value).abs() <= 1e-5 * value.max(1.0), "{color}: {channel} of {at}: {sum} and {value}");
            }
        }
        // The clamp at two scales all light of a sample alike, so lights alone are compared where nothing reaches it:
        // on the floor.
        let mean = |image: &steradian::image::Image, name: &str| {
            let plane = image.channel(name).unwrap();
            (192..256).map(|at| f64::from(plane[at])).sum::<f64>() / 64.0
        };
        for light in every {
            let kind = if light == "Panel" { "area" } else { light };
            let group = groups.iter().find(|g| g.starts_with(&format!("RGBA_{kind}"))).expect(light);
            let alone = render(&format!("{light}.pbrt"), &[]);
            for channel in ["R", "G", "B"] {
                let (a, b) = (mean(&picture, &format!("{group}.{channel}")), mean(&alone, channel));
                assert!(b > 0.0 && (a / b - 1.0).abs() < 0.03, "{color}: {light} {channel} is {a}, alone {b}");
            }
        }
    }
    place.refuse(2, &["render", "lamps.pbrt", "--integrator", "bdpt", "--aov", "light_groups"], &["'bdpt'", "groups"]);
    place.refuse(2, &["render", "lamps.pbrt", "--adaptive", "--aov", "light_groups"], &["--adaptive"]);
}

/// In a closed sphere that shines by 1 and reflects a half, light of n scattering events is 2⁻ⁿ. The picture is the sum
/// of the layers to the bit, in fog, too, and the last layer has the rest.
#[test]
fn bounces_are_terms_of_a_series() {
    let place = Place::new();
    let furnace = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nCamera \"perspective\"\nWorldBegin\n\
                   Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\nReverseOrientation\n\
                   AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\nShape \"sphere\"";
    place.file("furnace.pbrt", furnace);
    let fog = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 1 1] \"rgb sigma_a\" [1 1 1] \
               \"rgb Le\" [1 1 1]\nMediumInterface \"\" \"fog\"\nCamera";
    place.file(
        "fog.pbrt",
        &furnace
            .replace("L\" [1 1 1]", "L\" [.5 .5 .5]")
            .replace("Camera", fog)
            .replace("ReverseOrientation", "MediumInterface \"fog\" \"\"\nReverseOrientation"),
    );
    for (scene, integrator, color, layers) in [
        ("furnace", "path:max_depth=-1", "rgb", 16),
        ("furnace", "path:max_depth=3", "spectral", 4),
        ("furnace", "direct", "rgb", 2),
        ("fog", "volpath:max_depth=5", "rgb", 6),
        ("fog", "volpath:max_depth=-1", "spectral", 16),
    ] {
        let scene_file = format!("{scene}.pbrt");
        let command = ["render", &scene_file, "--spp", "64", "--color", color, "--integrator", integrator];
        place.succeed(&[&command[..], &["--aov", "bounces", "-q", "-o", "out.exr"]].concat());
        let picture = place.picture("out.exr");
        let name = |n: usize| if n == 15 { "bounce.rest".into() } else { format!("bounce.{n:02}") };
        let count = picture.channels().iter().filter(|c| c.name.starts_with("bounce.")).count();
        assert_eq!(count, 3 * layers, "{integrator}");
        let plane = |n: usize, c: &str| picture.channel(&format!("{}.{c}", name(n))).unwrap();
        for c in ["R", "G", "B"] {
            for (at, value) in picture.channel(c).unwrap().iter().enumerate() {
                let sum = (0..layers).fold(0.0, |sum, n| sum + plane(n, c)[at]);
                assert!(sum == *value, "{integrator}: {c} of {at}: {sum} and {value}");
            }
        }
        if scene == "furnace" {
            for n in 0..layers.min(5) {
                let mean = plane(n, "G").iter().sum::<f32>() / 64.0;
                assert!((mean * 2_f32.powi(n as i32) - 1.0).abs() < 0.02, "{integrator}: {n} is {mean}");
            }
        } else {
            // Walls and fog of one temperature: all light together is 1 wherever one looks.
            let mean = |n: usize| plane(n, "G").iter().sum::<f32>() / 64.0;
            assert!((1..5).all(|n| mean(n) < 0.8 * mean(n - 1) && mean(n) > 0.2 * mean(n - 1)));
            let sum: f32 = (0..layers).map(mean).sum();
            assert!(layers < 16 || (sum - 1.0).abs() < 0.01, "{sum}");
        }
    }
    let refused = |options: &[&str], words: &[&str]| {
        place.refuse(2, &[&["render", "furnace.pbrt", "--aov"], options].concat(), words);
    };
    refused(&["bounces", "--integrator", "bdpt"], &["'bdpt'", "bounces"]);
    refused(&["bounces", "--adaptive"], &["bounces", "--adaptive"]);
    refused(&["bounces,light_groups"], &["bounces", "groups"]);
}

/// Layers change no bit of the picture, also where paths share: these are the guides that denoisers ask for at few
/// samples.
#[test]
fn layers_change_no_bit_of_the_picture() {
    let place = Place::new();
    let command = ["render", "--size", "256x256", "--spp", "4", "--integrator", "path:reuse=4", "-q"];
    place.succeed(&[&command[..], &["-o", "plain.exr"]].concat());
    place.succeed(&[&command[..], &["--aov", "albedo,normal,cryptomatte", "-o", "layers.exr"]].concat());
    let (plain, layers) = (place.picture("plain.exr"), place.picture("layers.exr"));
    for channel in ["R", "G", "B"] {
        assert!(plain.channel(channel) == layers.channel(channel), "{channel} differs");
    }
    let sharing = layers.metadata.get("steradian:sharing");
    assert!(matches!(sharing, Some(steradian::image::Value::Int(2..))), "{sharing:?}");
}

/// A camera that looks along z into a mirror at 45°, or through glass, at a wall of albedo (0.8, 0.4, 0.2).
#[test]
fn mirrors_and_glass_show_what_is_behind() {
    let scene = |surface: &str, wall: &str| {
        let quad = |p: &str| format!("Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [{p}]\n");
        format!(
            "LookAt 0 0 0 0 0 1 0 1 0\nCamera \"perspective\" \"float fov\" 10\nWorldBegin\n\
             LightSource \"point\" \"point3 from\" [0 5 1]\n{surface}\n\
             Material \"diffuse\" \"rgb reflectance\" [0.8 0.4 0.2]\n{}",
            if wall.is_empty() { String::new() } else { quad(wall) }
        )
        .replace("AT_45", &quad("-2 -2 4 2 -2 0 2 2 0 -2 2 4"))
        .replace("AHEAD", &quad("-2 -2 2 2 -2 2 2 2 2 -2 2 2"))
    };
    let mirror = "Material \"conductor\" \"rgb reflectance\" [0.5 0.6 0.7] \"float roughness\" 0\nAT_45";
    let rough = "Material \"conductor\" \"rgb reflectance\" [0.5 0.6 0.7] \"float roughness\" 0.3\nAT_45";
    let glass = "Material \"dielectric\" \"float eta\" 1.5\nAHEAD";
    let (left, behind) = ("-3 -9 -9 -3 -9 9 -3 9 9 -3 9 -9", "-9 -9 5 9 -9 5 9 9 5 -9 9 5");
    let wall = [0.8, 0.4, 0.2];
    // What the albedo is a multiple of, the normal up to its sign, and the depth.
    let cases = [
        (mirror, left, wall, [1.0, 0.0, 0.0]),
        (mirror, "", [1.0; 3], [0.5f32.sqrt(), 0.0, 0.5f32.sqrt()]),
        (rough, left, [1.0; 3], [0.5f32.sqrt(), 0.0, 0.5f32.sqrt()]),
        (glass, behind, wall, [0.0, 0.0, 1.0]),
    ];
    for (surface, seen, factor, normal) in cases {
        let place = Place::new();
        place.file("scene.pbrt", &scene(surface, seen));
        let line = ["render", "scene.pbrt", "--size", "9x7", "--spp", "2", "--color", "rgb", "-q", "--aov"];
        place.succeed(&[&line[..], &["albedo,normal,depth", "-o", "first.exr"]].concat());
        let all = "albedo,normal,depth,denoise_albedo,denoise_normal";
        place.succeed(&[&line[..], &[all, "-o", "seen.exr"]].concat());
        let (first, picture) = (place.picture("first.exr"), place.picture("seen.exr"));
        for channel in first.channels() {
            assert_eq!(picture.channel(&channel.name), Some(&channel.data[..]), "{}", channel.name);
        }
        for (c, axis) in ["X", "Y", "Z"].iter().enumerate() {
            let rgb = ["R", "G", "B"][c];
            let own = first.channel(&format!("albedo.{rgb}")).unwrap();
            let found = picture.channel(&format!("denoise_albedo.{rgb}")).unwrap();
            let pairs = own.iter().zip(found);
            assert!(pairs.clone().all(|(a, b)| (a * factor[c] - b).abs() < 1e-5), "{surface}{seen}: {pairs:?}");
            let found = picture.channel(&format!("denoise_normal.{axis}")).unwrap();
            assert!(found.iter().all(|n| (n.abs() - normal[c]).abs() < 1e-5), "{surface}{seen}: {found:?}");
        }
    }
}
