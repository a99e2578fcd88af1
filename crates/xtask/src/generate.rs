//! Meshes and scenes to measure with. Only `+ − × ÷ √` and `sin` of small arguments decide them.

use std::{
    error::Error,
    f64::consts::{PI, TAU},
    fmt::Write as _,
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};
use steradian_math::{DVec3, Vec3};

/// Arguments of `generate`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// File to write: .ply for a mesh, .pbrt for a text scene with long lists, .xml for a scene with a mesh beside it
    out: PathBuf,
    /// Triangles
    #[arg(long, default_value_t = 1_000_000)]
    triangles: usize,
}

/// Writes what the extension says.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let out = &arguments.out;
    match out.extension().and_then(|e| e.to_str()) {
        Some("ply") => ply(out, &bumpy_sphere(arguments.triangles))?,
        Some("pbrt") => pbrt(out, &bumpy_sphere(arguments.triangles))?,
        Some("xml") => scene(out, &bumpy_sphere(arguments.triangles), 256)?,
        _ => return Err("the file must end in .ply, .pbrt or .xml".into()),
    }
    Ok(())
}

/// Vertices and triangles.
pub type Mesh = (Vec<Vec3>, Vec<[u32; 3]>);

/// A sphere with bumps of many sizes, of about so many triangles: rows and columns of squares that are cut in two.
pub fn bumpy_sphere(triangles: usize) -> Mesh {
    let rows = ((triangles as f64 / 4.0).sqrt().round() as u32).max(3);
    let columns = 2 * rows;
    let bump = |p: DVec3| {
        let wave =
            |(amplitude, f): (f64, f64)| amplitude * (f * p.x).sin() * (f * p.y + 1.0).sin() * (f * p.z + 2.0).sin();
        [(0.2, 3.0), (0.08, 11.0), (0.03, 29.0), (0.01, 83.0)].into_iter().map(wave).sum::<f64>()
    };
    let at = |row: u32, column: u32| {
        let (theta, phi) =
            (PI * f64::from(row) / f64::from(rows), TAU * f64::from(column % columns) / f64::from(columns));
        let p = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
        (p * (1.0 + bump(p))).as_vec3()
    };
    let positions = (0..=rows).flat_map(|row| (0..columns).map(move |column| at(row, column))).collect();
    let squares = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let indices = squares.flat_map(|(row, column)| {
        let next = (column + 1) % columns;
        let [a, b, c, d] =
            [(row, column), (row, next), (row + 1, column), (row + 1, next)].map(|(r, c)| r * columns + c);
        [[a, b, c], [b, d, c]]
    });
    (positions, indices.collect())
}

/// Writes a binary PLY file.
pub fn ply(path: &Path, (positions, indices): &Mesh) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        positions.len(),
        indices.len()
    )?;
    for p in positions {
        for x in p.to_array() {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    for triangle in indices {
        out.write_all(&[3])?;
        for i in triangle {
            out.write_all(&i.to_le_bytes())?;
        }
    }
    out.flush()
}

/// Writes a pbrt scene whose mesh is in the text.
pub fn pbrt(path: &Path, (positions, indices): &Mesh) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    write!(
        out,
        "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\nWorldBegin\nLightSource \"infinite\"\n\
         Shape \"trianglemesh\"\n  \"point3 P\" ["
    )?;
    let mut line = String::new();
    for p in positions {
        line.clear();
        let _ = write!(line, "\n{} {} {}", p.x, p.y, p.z);
        out.write_all(line.as_bytes())?;
    }
    write!(out, "]\n  \"integer indices\" [")?;
    for [a, b, c] in indices {
        line.clear();
        let _ = write!(line, "\n{a} {b} {c}");
        out.write_all(line.as_bytes())?;
    }
    writeln!(out, "]")?;
    out.flush()
}

/// Writes a Mitsuba scene of a mesh on a floor under a lamp and a sky, with its PLY file beside it.
pub fn scene(path: &Path, mesh: &Mesh, size: u32) -> std::io::Result<()> {
    let model = path.with_extension("ply");
    ply(&model, mesh)?;
    let name = model.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let text = format!(
        r#"<scene version="3.0.0">
  <default name="spp" value="16"/>
  <integrator type="path"><integer name="max_depth" value="8"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="1.5, 1.5, 3.5" target="0, -0.1, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{size}"/><integer name="height" value="{size}"/><rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
  </sensor>
  <emitter type="constant"><rgb name="radiance" value="0.3, 0.3, 0.3"/></emitter>
  <shape type="ply"><string name="filename" value="{name}"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
  <shape type="rectangle">
    <transform name="to_world"><scale value="8"/><rotate x="1" angle="-90"/><translate y="-1.3"/></transform>
    <bsdf type="diffuse"/>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="90"/><translate y="3.5"/></transform>
    <emitter type="area"><rgb name="radiance" value="10, 10, 10"/></emitter>
  </shape>
</scene>
"#
    );
    std::fs::write(path, text)
}
