//! Sound inputs: scenes of the project, and small files that are made here.

use std::{fs, path::PathBuf};
use steradian::image::{self, Compression, FileKind, Image, WriteOptions};

/// Longest scene that is a seed, bytes.
const LONGEST: u64 = 10_000;

/// The folder of the project's scenes.
pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes"))
}

/// Scenes of the project in a format.
pub fn scenes(extension: &str) -> Vec<Vec<u8>> {
    let mut files: Vec<PathBuf> = [folder(), folder().join("verify")]
        .iter()
        .flat_map(|folder| fs::read_dir(folder).into_iter().flatten().flatten())
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .filter(|path| path.metadata().is_ok_and(|m| m.len() <= LONGEST))
        .collect();
    files.sort();
    files.iter().filter_map(|path| fs::read(path).ok()).collect()
}

/// The scenes in glTF's text as binary files.
pub fn glb() -> Vec<Vec<u8>> {
    let pack = |mut json: Vec<u8>| {
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((20 + json.len() as u32).to_le_bytes());
        file.extend((json.len() as u32).to_le_bytes());
        file.extend(b"JSON");
        file.extend(json);
        file
    };
    scenes("gltf").into_iter().map(pack).collect()
}

pub fn ply() -> Vec<Vec<u8>> {
    let mut all = scenes("ply");
    let mut binary = b"ply\nformat binary_little_endian 1.0\n\
        element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for number in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        binary.extend(number.to_le_bytes());
    }
    binary.push(3);
    [0i32, 1, 2].iter().for_each(|index| binary.extend(index.to_le_bytes()));
    all.push(binary);
    all
}

pub fn obj() -> Vec<Vec<u8>> {
    let texts = [
        "# a square\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n\
         usemtl a\nf 1/1/1 2/2/1 3/2/1 4/1/1\n",
        "v -1 -1 0 1 0 0\nv 1 -1 0 0 1 0\nv 0 1 .5 0 0 1\ng one two\ns 1\nf -3 -2 -1\nf 1 \\\n2 3\nl 1 2 3\np 1\n",
    ];
    texts.map(|text| text.as_bytes().to_vec()).into()
}

/// Values in the scene language.
pub fn values() -> Vec<Vec<u8>> {
    let texts = [
        "0.5",
        "[0.1, 0.2, 0.3]",
        "{spectrum: metal-Au-eta}",
        "{spectrum: 0.5}",
        "{rgb: [0.2, 0.5, 0.9], space: rec2020}",
        "{wavelengths: [400, 500, 700], values: [0, 0.5, 1]}",
        "{blackbody: 6500}",
        "{texture: checkerboard, a: 0.6, b: 0.15, scale_u: 10, scale_v: 10}",
        "{texture: scale, value: {texture: fbm, frequency: 3, octaves: 4}, scale: 0.5} // remark",
    ];
    texts.map(|text| text.as_bytes().to_vec()).into()
}

pub fn spectra() -> Vec<Vec<u8>> {
    ["# nm value\n400 0.1\n500 0.2\n700 0.9\n", "400,1e-3\n401.5,2\n800,3\n"]
        .map(|text| text.as_bytes().to_vec())
        .into()
}

/// A picture with colours and numbers beyond those of a display.
fn picture() -> Image {
    let pixels: Vec<[f32; 3]> =
        (0..72).map(|i| [i as f32 / 72.0, (i % 9) as f32 / 9.0, (i * i) as f32 / 500.0]).collect();
    let mut image = Image::from_rgb(9, 8, &pixels).unwrap_or_else(|e| unreachable!("{e}"));
    image.metadata.set_text("Software", "seed");
    image
}

/// The picture in a file of a kind.
pub fn pictures(kind: FileKind) -> Vec<Vec<u8>> {
    vec![encode(kind, &WriteOptions::default())]
}

fn encode(kind: FileKind, options: &WriteOptions) -> Vec<u8> {
    image::encode(kind, &picture(), options).unwrap_or_else(|e| unreachable!("{e}"))
}

pub fn exr() -> Vec<Vec<u8>> {
    let of = |exr_compression| encode(FileKind::Exr, &WriteOptions { exr_compression, ..WriteOptions::default() });
    [Compression::None, Compression::Zip, Compression::Piz].map(of).into()
}

/// Pictures as they are written, and one of each colour type and of interlaced rows with stored data.
pub fn png() -> Vec<Vec<u8>> {
    let mut all = pictures(FileKind::Png);
    for (colour, depth, row) in [(0u8, 1u8, 1usize), (0, 16, 4), (2, 8, 6), (4, 8, 4), (6, 16, 16), (3, 2, 1)] {
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        chunk(&mut file, b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 2, depth, colour, 0, 0, 0]);
        if colour == 3 {
            chunk(&mut file, b"PLTE", &[255, 0, 0, 0, 255, 0, 0, 0, 255, 9, 9, 9]);
            chunk(&mut file, b"tRNS", &[255, 128]);
        }
        let rows = [vec![0; row + 1], vec![1; row + 1]].concat();
        chunk(&mut file, b"IDAT", &stored(&rows));
        chunk(&mut file, b"IEND", &[]);
        all.push(file);
    }
    all
}

fn chunk(file: &mut Vec<u8>, name: &[u8; 4], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let from = file.len();
    file.extend(name);
    file.extend(data);
    let sum = super::targets::crc32(&file[from..]);
    file.extend(sum.to_be_bytes());
}

/// A zlib stream of one stored block (RFC 1950, RFC 1951).
fn stored(data: &[u8]) -> Vec<u8> {
    let length = data.len() as u16;
    let (mut a, mut b) = (1u32, 0u32);
    for byte in data {
        a = (a + u32::from(*byte)) % 65521;
        b = (b + a) % 65521;
    }
    let mut stream = vec![0x78, 1, 1];
    stream.extend(length.to_le_bytes());
    stream.extend((!length).to_le_bytes());
    stream.extend(data);
    stream.extend((b << 16 | a).to_be_bytes());
    stream
}

/// Uncompressed colours, and runs of grey.
pub fn tga() -> Vec<Vec<u8>> {
    let header = |kind: u8, bits: u8| vec![0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 2, 0, bits, 0];
    let plain = [header(2, 24), (0..24).collect()].concat();
    let runs = [header(11, 8), vec![0x83, 7, 0x03, 1, 2, 3, 4]].concat();
    vec![plain, runs]
}

pub fn bmp() -> Vec<Vec<u8>> {
    let mut file = b"BM".to_vec();
    for number in [70u32, 0, 54, 40, 2, 2, 1 | 24 << 16, 0, 16, 2835, 2835, 0, 0] {
        file.extend(number.to_le_bytes());
    }
    file.extend(0..16u8);
    vec![file]
}

/// Archives of a scene alone, and of one with a mesh.
pub fn archive() -> Vec<Vec<u8>> {
    let folder = image::TemporaryFolder::new("steradian-fuzz-").unwrap_or_else(|e| panic!("no temporary folder: {e}"));
    let (scene, mesh, zip) = (folder.path().join("a.pbrt"), folder.path().join("b.ply"), folder.path().join("a.zip"));
    let write = |path, text: &str| fs::write(path, text).unwrap_or_else(|e| panic!("{e}"));
    write(&scene, "WorldBegin\nShape \"plymesh\" \"string filename\" \"b.ply\"\n");
    write(&mesh, "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n");
    let pack = |files: &[&std::path::Path]| {
        steradian::archive::pack(&scene, files.iter().copied(), &zip).unwrap_or_else(|e| panic!("{e}"));
        fs::read(&zip).unwrap_or_default()
    };
    vec![pack(&[]), pack(&[&mesh])]
}
