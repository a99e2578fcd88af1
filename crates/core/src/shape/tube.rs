//! Curves as meshes, of which points can be drawn: tubes, and strips for ribbons.

use super::curve::{CurveKind, CurveParams, Twist, evaluate};
use std::f32::consts::{PI, TAU};
use steradian_math::{Frame, Vec3};
use steradian_scene::Mesh;

/// Sides of a tube. Where they are odd the width that is seen hardly depends on the direction: by 0.8 % to each side.
const SIDES: u32 = 9;
/// Largest deviation of a step from the curve, in widths.
const TOLERANCE: f32 = 0.02;
/// Most steps of a segment.
const MOST_STEPS: f32 = 64.0;
/// Most triangles.
const MOST_TRIANGLES: usize = 1 << 20;

impl CurveParams {
    /// The surface of the curve in object space: of ribbons a strip, of others a tube of nine sides whose mean width
    /// over directions is that of the curve (Cauchy: the perimeter over π).
    ///
    /// # Errors
    /// A message, where the curve is not valid ([`CurveParams::segments`]), has no width, or is too long.
    pub fn surface(&self) -> Result<Mesh, String> {
        let count = self.segments()?;
        let widest = self.width[0].max(self.width[1]);
        if widest <= 0.0 {
            return Err("the curve has no width".into());
        }
        let is_ribbon = self.kind == CurveKind::Ribbon;
        let sides = if is_ribbon { 1 } else { SIDES };
        let mut mesh = Mesh::default();
        let mut aside: Option<Vec3> = None;
        for segment in 0..count {
            let points = self.bezier(segment);
            let bend = [0, 1].map(|k| (points[k] - points[k + 1] * 2.0 + points[k + 2]).length());
            let steps =
                (0.75 * bend[0].max(bend[1]) / (TOLERANCE * widest)).sqrt().ceil().clamp(1.0, MOST_STEPS) as u32;
            if mesh.triangles.len() + (2 * steps * sides) as usize > MOST_TRIANGLES {
                return Err(format!("the curve takes more than {MOST_TRIANGLES} triangles"));
            }
            let twist = is_ribbon.then(|| Twist::new(self.normals[segment], self.normals[segment + 1]));
            let first = mesh.positions.len() as u32;
            for step in 0..=steps {
                let u = step as f32 / steps as f32;
                let (p, tangent) = evaluate(&points, u);
                let Some(along) = tangent.try_normalize().or_else(|| (points[3] - points[0]).try_normalize()) else {
                    return Err("a segment of the curve is a point".into());
                };
                let at = (segment as f32 + u) / count as f32;
                let width = self.width[0] * (1.0 - at) + self.width[1] * at;
                let mut push = |q: Vec3, n: Vec3, v: f32| {
                    mesh.positions.push(q.to_array());
                    mesh.normals.push(n.to_array());
                    mesh.uvs.push([u, v]);
                };
                if let Some(twist) = &twist {
                    let facing = twist.at(u);
                    let across = facing.cross(along).try_normalize().unwrap_or_else(|| Frame::from_z(facing).x);
                    let n = along.cross(across);
                    push(p + across * (0.5 * width), n, 0.0);
                    push(p - across * (0.5 * width), n, 1.0);
                    continue;
                }
                // The frame turns as little as it can.
                let x = aside.and_then(|x| (x - along * x.dot(along)).try_normalize());
                let x = x.unwrap_or_else(|| Frame::from_z(along).x);
                aside = Some(x);
                let y = along.cross(x);
                let half = PI / SIDES as f32;
                let radius = 0.5 * width * half / half.sin();
                for side in 0..=SIDES {
                    let v = side as f32 / SIDES as f32;
                    let (sin, cos) = (TAU * v).sin_cos();
                    let n = x * cos + y * sin;
                    push(p + n * radius, n, v);
                }
            }
            for step in 0..steps {
                for side in 0..sides {
                    let a = first + step * (sides + 1) + side;
                    let (b, c) = (a + 1, a + sides + 1);
                    mesh.triangles.extend([[a, b, c + 1], [a, c + 1, c]]);
                }
            }
        }
        Ok(mesh)
    }
}
