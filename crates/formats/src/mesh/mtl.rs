//! MTL material libraries of OBJ files (Alias|Wavefront, "Material Library File"), with the common extension for
//! physically based parameters (`Pr Pm Ps Pc Pcr Ke aniso anisor` and their maps).

use super::{
    obj::Lines,
    text::{float, is_blank, shown, trim},
};
use steradian_scene::{FileId, Span};

/// An image given for a quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// The file name, as written.
    pub file: String,
    /// `-s`: scale of the texture coordinates; 1 by default.
    pub scale: [f32; 3],
    /// `-o`: offset of the texture coordinates; 0 by default.
    pub offset: [f32; 3],
    /// `-mm`: the value is `base + gain × texel`; 0 and 1 by default.
    pub base_gain: [f32; 2],
    /// `-bm`: strength of a bump map; 1 by default.
    pub bump: f32,
    /// `-clamp on`: no repetition.
    pub clamp: bool,
    /// `-imfchan`: the channel used for a number (`r g b m l z`).
    pub channel: Option<char>,
    /// Offset of the statement in the library.
    pub position: usize,
    /// Source span of the statement, once the library is one of the sources of a scene.
    pub span: Option<Span>,
}

/// A material as the library gives it. What is `None` is not set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Material {
    /// After `newmtl`.
    pub name: String,
    /// Offset of the `newmtl` in the library.
    pub position: usize,
    /// Source span of the `newmtl`, once the library is one of the sources of a scene.
    pub span: Option<Span>,
    /// `Ka`: ambient reflectance.
    pub ambient: Option<[f32; 3]>,
    /// `Kd`: diffuse reflectance.
    pub diffuse: Option<[f32; 3]>,
    /// `Ks`: specular reflectance.
    pub specular: Option<[f32; 3]>,
    /// `Ke`: emitted radiance.
    pub emission: Option<[f32; 3]>,
    /// `Tf`: transmission filter, a factor per channel.
    pub transmission: Option<[f32; 3]>,
    /// `Ns`: exponent of the Phong lobe, from 0 up.
    pub shininess: Option<f32>,
    /// `Ni`: index of refraction.
    pub ior: Option<f32>,
    /// `d` (or 1 − `Tr`): opacity from 0 to 1.
    pub opacity: Option<f32>,
    /// `illum`: the illumination model, 0 to 10.
    pub illum: Option<i64>,
    /// `Pr`: roughness from 0 to 1.
    pub roughness: Option<f32>,
    /// `Pm`: metalness from 0 to 1.
    pub metallic: Option<f32>,
    /// `Ps`: sheen.
    pub sheen: Option<f32>,
    /// `Pc`: thickness of a clear coat.
    pub clearcoat: Option<f32>,
    /// `Pcr`: roughness of the clear coat.
    pub clearcoat_roughness: Option<f32>,
    /// `aniso`: anisotropy.
    pub anisotropy: Option<f32>,
    /// `map_Kd`
    pub diffuse_map: Option<Map>,
    /// `map_Ks`
    pub specular_map: Option<Map>,
    /// `map_Ke`
    pub emission_map: Option<Map>,
    /// `map_d`
    pub opacity_map: Option<Map>,
    /// `map_Ns`
    pub shininess_map: Option<Map>,
    /// `map_Bump`, `bump`
    pub bump_map: Option<Map>,
    /// `norm`
    pub normal_map: Option<Map>,
    /// `disp`
    pub displacement_map: Option<Map>,
    /// `map_Pr`
    pub roughness_map: Option<Map>,
    /// `map_Pm`
    pub metallic_map: Option<Map>,
}

impl Material {
    /// All its images.
    fn maps_mut(&mut self) -> impl Iterator<Item = &mut Map> {
        [
            &mut self.diffuse_map,
            &mut self.specular_map,
            &mut self.emission_map,
            &mut self.opacity_map,
            &mut self.shininess_map,
            &mut self.bump_map,
            &mut self.normal_map,
            &mut self.displacement_map,
            &mut self.roughness_map,
            &mut self.metallic_map,
        ]
        .into_iter()
        .flatten()
    }

    /// Fills in the spans, for messages about the material.
    pub(crate) fn locate(&mut self, source: FileId) {
        self.span = Some(Span::new(source, self.position, self.position + "newmtl ".len() + self.name.len()));
        for map in self.maps_mut() {
            map.span = Some(Span::new(source, map.position, map.position + 1));
        }
    }
}

/// Something in a library that was not understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Offset of the statement in the library.
    pub position: usize,
    /// Description of the fault.
    pub message: String,
}

/// The contents of a library. Nothing in it is fatal: what cannot be read is left out and remarked upon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlFile {
    /// In order. Of several with one name the first counts.
    pub materials: Vec<Material>,
    /// Remarks on statements that were not understood, at most a hundred.
    pub remarks: Vec<Remark>,
}

/// Reads a library.
pub fn read(bytes: &[u8]) -> MtlFile {
    let mut out = MtlFile::default();
    for (position, line) in Lines::new(bytes) {
        let end = line.iter().position(|&b| is_blank(b)).unwrap_or(line.len());
        let (word, rest) = (String::from_utf8_lossy(&line[..end]).to_ascii_lowercase(), trim(&line[end..]));
        let result = if word == "newmtl" {
            let name = super::obj::name(rest);
            out.materials.push(Material { name, position, ..Material::default() });
            Ok(())
        } else {
            match out.materials.last_mut() {
                Some(m) => statement(m, &word, rest, position),
                None => Err(format!("'{word}' stands before any 'newmtl'")),
            }
        };
        if let Err(message) = result
            && out.remarks.len() < 100
        {
            out.remarks.push(Remark { position, message });
        }
    }
    out
}

fn statement(m: &mut Material, word: &str, rest: &[u8], position: usize) -> Result<(), String> {
    let number = || number(word, rest).map(Some);
    let color = || color(word, rest).map(Some);
    let map = || map(word, rest, position).map(Some);
    match word {
        "ka" => m.ambient = color()?,
        "kd" => m.diffuse = color()?,
        "ks" => m.specular = color()?,
        "ke" => m.emission = color()?,
        "tf" => m.transmission = color()?,
        "ns" => m.shininess = number()?,
        "ni" => m.ior = number()?,
        "d" => {
            // `d -halo 0.5` fades with the angle; the number is its opacity.
            let value = rest.strip_prefix(b"-halo").unwrap_or(rest);
            m.opacity = Some(self::number(word, value)?);
        }
        "tr" => m.opacity = m.opacity.or(Some(1.0 - self::number(word, rest)?)),
        "illum" => m.illum = number()?.map(|v| v as i64),
        "pr" => m.roughness = number()?,
        "pm" => m.metallic = number()?,
        "ps" => m.sheen = number()?,
        "pc" => m.clearcoat = number()?,
        "pcr" => m.clearcoat_roughness = number()?,
        "aniso" => m.anisotropy = number()?,
        "anisor" | "sharpness" | "map_aat" => {}
        "map_kd" => m.diffuse_map = map()?,
        "map_ks" => m.specular_map = map()?,
        "map_ke" => m.emission_map = map()?,
        "map_d" | "map_opacity" => m.opacity_map = map()?,
        "map_ns" => m.shininess_map = map()?,
        "map_bump" | "bump" => m.bump_map = map()?,
        "norm" | "map_kn" | "map_norm" => m.normal_map = map()?,
        "disp" | "map_disp" => m.displacement_map = map()?,
        "map_pr" => m.roughness_map = map()?,
        "map_pm" => m.metallic_map = map()?,
        "map_ka" => {}
        "map_ps" | "map_tr" | "refl" | "decal" | "map_refl" | "map_rma" | "map_orm" => {
            return Err(format!("'{word}' has no counterpart and is left out"));
        }
        _ => return Err(format!("unknown statement '{}'", shown(word.as_bytes()))),
    }
    Ok(())
}

fn finite(word: &[u8]) -> Option<f32> {
    float(word).filter(|v| v.is_finite())
}

fn blank_words(s: &[u8]) -> impl Iterator<Item = &[u8]> {
    s.split(|&b| is_blank(b)).filter(|w| !w.is_empty())
}

fn number(word: &str, rest: &[u8]) -> Result<f32, String> {
    let text = blank_words(rest).next().unwrap_or_default();
    finite(text).ok_or_else(|| format!("'{word}': '{}' is not a finite number", shown(text)))
}

/// `r g b`, `r` for grey, or `xyz x y z`.
fn color(word: &str, rest: &[u8]) -> Result<[f32; 3], String> {
    let mut words = blank_words(rest).peekable();
    let xyz = words.next_if(|w| w.eq_ignore_ascii_case(b"xyz")).is_some();
    if words.peek().is_some_and(|w| w.eq_ignore_ascii_case(b"spectral")) {
        return Err(format!("'{word}': spectral files (.rfl) are not read"));
    }
    let mut values = [0.0; 3];
    let mut found = 0;
    for (v, w) in values.iter_mut().zip(words.take_while(|w| !w.starts_with(b"#"))) {
        *v = finite(w).ok_or_else(|| format!("'{word}': '{}' is not a finite number", shown(w)))?;
        found += 1;
    }
    match found {
        1 => Ok([values[0]; 3]),
        3 if xyz => Ok(rgb_from_xyz(values)),
        3 => Ok(values),
        _ => Err(format!("'{word}': {found} numbers where 3 are needed")),
    }
}

/// To linear Rec.709 (IEC 61966-2-1).
fn rgb_from_xyz([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        3.240_454 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
}

/// Options, then the file name, which may have blanks in it.
fn map(word: &str, rest: &[u8], position: usize) -> Result<Map, String> {
    let mut map = Map { scale: [1.0; 3], base_gain: [0.0, 1.0], bump: 1.0, position, ..Map::default() };
    let mut left = rest;
    let next = |left: &mut &[u8]| {
        let text = trim(left);
        let end = text.iter().position(|&b| is_blank(b)).unwrap_or(text.len());
        *left = &text[end..];
        text[..end].to_vec()
    };
    loop {
        let before = left;
        let option = next(&mut left);
        // `-o 1` takes one to three numbers: as many as follow.
        let numbers = |left: &mut &[u8], into: &mut [f32]| {
            let mut found = 0;
            for v in into {
                let mut ahead = *left;
                let Some(number) = finite(&next(&mut ahead)) else { break };
                // A file may be called `1`: the last word is never a number of an option.
                if trim(ahead).is_empty() {
                    break;
                }
                *v = number;
                *left = ahead;
                found += 1;
            }
            found
        };
        match option.to_ascii_lowercase().as_slice() {
            b"-s" => {
                numbers(&mut left, &mut map.scale);
            }
            b"-o" => {
                numbers(&mut left, &mut map.offset);
            }
            b"-t" => {
                numbers(&mut left, &mut [0.0; 3]);
            }
            b"-mm" => {
                numbers(&mut left, &mut map.base_gain);
            }
            b"-bm" => {
                numbers(&mut left, std::slice::from_mut(&mut map.bump));
            }
            b"-boost" | b"-texres" => {
                numbers(&mut left, &mut [0.0]);
            }
            b"-clamp" => map.clamp = next(&mut left).eq_ignore_ascii_case(b"on"),
            b"-imfchan" => map.channel = next(&mut left).first().map(|&b| char::from(b)),
            b"-blendu" | b"-blendv" | b"-cc" | b"-type" => {
                next(&mut left);
            }
            _ => {
                map.file = String::from_utf8_lossy(trim(before)).trim_matches('"').to_owned();
                break;
            }
        }
    }
    if map.file.is_empty() { Err(format!("'{word}' names no file")) } else { Ok(map) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_files::{assets, mutants};

    #[test]
    fn all_statements_are_understood() {
        let text = b"# a library\nKd 1 1 1\nnewmtl  Red Shiny  \nKa 0.1 0.1 0.1\nKd 0.8 0 0\nKs 0.5\nKe 0 0 2\nTf 1 1 1\nNs 200\nNi 1.5\n\
            Tr 0.25\nillum 4\nPr 0.3\nPm 1\nPs 0\nPc 0.1\nmap_Kd -s 2 3 -o 0.5 -clamp on my wood.png\nmap_bump -bm 0.2 b.png\n\
            norm n.png\nbogus 1\nKd x 0 0\nmap_d\nnewmtl b\nd 0.5\nTr 0.9\nmap_Ke -mm 0 2 -imfchan r -s 1 7\n";
        let file = read(text);
        let (a, b) = (&file.materials[0], &file.materials[1]);
        assert_eq!((a.name.as_str(), a.diffuse, a.specular), ("Red Shiny", Some([0.8, 0., 0.]), Some([0.5; 3])));
        assert_eq!((a.opacity, a.illum, a.ior, a.shininess), (Some(0.75), Some(4), Some(1.5), Some(200.)));
        let wood = a.diffuse_map.as_ref().unwrap();
        assert_eq!(
            (wood.file.as_str(), wood.scale, wood.offset, wood.clamp),
            ("my wood.png", [2., 3., 1.], [0.5, 0., 0.], true)
        );
        assert_eq!((a.bump_map.as_ref().unwrap().bump, a.normal_map.as_ref().unwrap().file.as_str()), (0.2, "n.png"));
        assert_eq!(b.opacity, Some(0.5));
        let glow = b.emission_map.as_ref().unwrap();
        assert_eq!((glow.file.as_str(), glow.base_gain, glow.channel, glow.scale), ("7", [0., 2.], Some('r'), [1.; 3]));
        let remarks: Vec<_> = file.remarks.iter().map(|r| r.message.as_str()).collect();
        let expected = [
            "'kd' stands before any 'newmtl'",
            "unknown statement 'bogus'",
            "'kd': 'x' is not a finite number",
            "'map_d' names no file",
        ];
        assert_eq!(remarks, expected);
    }

    #[test]
    fn real_libraries_read_without_remarks() {
        let Some(root) = assets() else { return };
        for (name, count) in [
            ("box_spaces.mtl", 12),
            ("concave_polygon.mtl", 1),
            ("cube_usemtl.mtl", 2),
            ("space_in_material_name.mtl", 1),
        ] {
            let file = read(&std::fs::read(root.join("obj/assimp").join(name)).unwrap());
            assert_eq!((file.materials.len(), file.remarks.len()), (count, 0), "{name}: {:?}", file.remarks);
        }
    }

    #[test]
    fn mutants_do_not_panic() {
        mutants(b"newmtl a b\nKd 1 0.5 .2\nmap_Kd -s 1 2 3 -clamp on \"a b.png\"\nd -halo 0.5\nKe xyz 1 1 1\nillum 2\\\n7\n", 5_000, |b| {
            assert!(read(b).remarks.len() <= 100);
        });
    }
}
