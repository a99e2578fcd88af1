//! Meshes, textures and rows of the benchmark, for both renderers.

use std::{error::Error, io::Read};
use steradian_raster::{
    Format, Result as RasterResult,
    glam::{
        Mat4, Vec3, Vec4,
        camera::rh::{proj::directx::perspective, view::look_at_mat4},
    },
    texture::Texture,
};

/// Columns of the pictures.
pub const WIDTH: u32 = 1920;
/// Rows of the pictures.
pub const HEIGHT: u32 = 1080;

/// Triangles that share vertices.
pub struct Mesh {
    pub points: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub indices: Vec<u32>,
    /// To clip space.
    pub matrix: Mat4,
}

impl Mesh {
    /// A grid over the picture, with hills as depth.
    pub fn grid(columns: u32, rows: u32) -> Self {
        let corners = (0..=rows).flat_map(|y| (0..=columns).map(move |x| (x, y)));
        let point = |(x, y): (u32, u32)| {
            let [x, y] = [x as f32 / columns as f32, y as f32 / rows as f32].map(|s| 2.0 * s - 1.0);
            Vec3::new(x, y, 0.5 + 0.2 * (7.0 * x).sin() * (5.0 * y).cos())
        };
        let points: Vec<Vec3> = corners.map(point).collect();
        let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| y * (columns + 1) + x));
        let triangles = |a: u32| {
            let c = a + columns + 1;
            [a, a + 1, c + 1, a, c + 1, c]
        };
        let normals = points.iter().map(|p| Vec3::new(p.x, p.y, 1.0)).collect();
        Self { normals, indices: cells.flat_map(triangles).collect(), points, matrix: Mat4::IDENTITY }
    }

    /// Little-endian: the number of vertices and of triangles (u32), points (three f32 each), indices (three u32 each).
    /// Seen whole, from the front and above.
    pub fn read(mut bytes: impl Read) -> Result<Self, Box<dyn Error>> {
        let mut all = Vec::new();
        bytes.read_to_end(&mut all)?;
        let words: Vec<u32> = all.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let [vertices, triangles, data @ ..] = &words[..] else { return Err("no mesh on the standard input".into()) };
        let (vertices, triangles) = (*vertices as usize, *triangles as usize);
        if data.len() != 3 * (vertices + triangles) || data[3 * vertices..].iter().any(|&i| i as usize >= vertices) {
            return Err("the mesh on the standard input is not as long as it says, or its indices are too large".into());
        }
        let (points, indices) = data.split_at(3 * vertices);
        let points = points.chunks_exact(3).map(|p| Vec3::from_array([p[0], p[1], p[2]].map(f32::from_bits))).collect();
        Ok(Self::seen_whole(points, indices.to_vec()))
    }

    /// With normals that are means over the triangles around a vertex, weighted by area.
    fn seen_whole(points: Vec<Vec3>, indices: Vec<u32>) -> Self {
        let mut normals = vec![Vec3::ZERO; points.len()];
        for t in indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| points[i as usize]);
            t.iter().for_each(|&i| normals[i as usize] += (b - a).cross(c - a));
        }
        let normals = normals.into_iter().map(|n| n.try_normalize().unwrap_or(Vec3::Z)).collect();
        let least = points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let greatest = points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let (center, radius) = (0.5 * (least + greatest), 0.5 * (greatest - least).length());
        let (angle, near) = (0.8f32, 0.5 * radius);
        let distance = radius / (0.5 * angle).sin();
        let eye = center + distance * Vec3::new(0.36, 0.48, 0.8);
        let view = look_at_mat4(eye, center, Vec3::Y);
        // Y up, depths from 0 to 1.
        let projection = perspective(angle, WIDTH as f32 / HEIGHT as f32, near, distance + radius);
        Self { points, normals, indices, matrix: projection * view }
    }
}

/// Work of the fragment shader.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Shading {
    /// The cosine to a light.
    Lit,
    /// A chequered board with all levels, blended between levels.
    Textured,
    /// Phong's model, to the 32nd power.
    Phong,
    /// Nothing: depths alone.
    Depth,
}

/// A row of the table.
pub struct Row<'a> {
    pub name: &'static str,
    pub mesh: &'a Mesh,
    /// Number of copies of the mesh, drawn back to front.
    pub layers: u32,
    pub samples: u32,
    pub shading: Shading,
}

/// The texture of [`Shading::Textured`], 512².
pub fn board() -> RasterResult<Texture> {
    let field = |i: u32| Vec4::splat(((i % 512 / 32 + i / 512 / 32) % 2) as f32);
    let colors: Vec<Vec4> = (0..512 * 512).map(field).collect();
    Texture::from_colors(Format::Rgba8Unorm, 512, 512, &colors, true)
}
