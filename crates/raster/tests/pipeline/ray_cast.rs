//! Rasterisation against ray casting: for each pixel the closest triangle, its depth and its attributes (M36, M38,
//! M46).

use crate::stage::{Random, framebuffer, perspective};
use steradian_raster::{
    Draw, Fragment, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::{DVec3, Vec2, Vec3, Vec4},
    state::DepthState,
    varyings,
};

varyings! {
    struct Seen {
        uv: Vec2,
        screen: Vec2 => linear,
    }
}

/// A bumpy torus and a hundred loose triangles before it.
fn mesh(random: &mut Random) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (rings, sides) = (48, 24);
    let mut points = Vec::new();
    for ring in 0..rings {
        for side in 0..sides {
            let (a, b) = (
                ring as f32 / rings as f32 * std::f32::consts::TAU,
                side as f32 / sides as f32 * std::f32::consts::TAU,
            );
            let r = 0.5 + 0.05 * random.unit();
            let flat = Vec3::new((1.2 + r * b.cos()) * a.cos(), (1.2 + r * b.cos()) * a.sin(), r * b.sin());
            // Turned, so that nothing is aligned with the picture.
            points.push(Vec3::new(flat.x, 0.8 * flat.y - 0.6 * flat.z, 0.6 * flat.y + 0.8 * flat.z - 2.7));
        }
    }
    let at = |ring: usize, side: usize| (ring % rings * sides + side % sides) as u32;
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for side in 0..sides {
            let [a, b, c, d] = [at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), at(ring, side + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    for _ in 0..100 {
        let start = points.len() as u32;
        let middle = Vec3::new(random.between(-1.5, 1.5), random.between(-1.5, 1.5), random.between(-4.0, -1.0));
        for _ in 0..3 {
            let by = Vec3::new(random.between(-0.4, 0.4), random.between(-0.4, 0.4), random.between(-0.6, 0.6));
            points.push(middle + by);
        }
        triangles.push([start, start + 1, start + 2]);
    }
    (points, triangles)
}

/// Distance along the ray and weights of the second and third corner.
fn intersect(direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, f64, f64)> {
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(e2);
    let det = e1.dot(p);
    let u = (-a).dot(p) / det;
    let q = (-a).cross(e1);
    let v = direction.dot(q) / det;
    let t = e2.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, u, v))
}

#[test]
fn a_mesh_equals_its_ray_cast() {
    let mut random = Random(46);
    let (points, triangles) = mesh(&mut random);
    let (near, far) = (0.1, 10.0);
    let size = 128u32;
    let mut target = framebuffer(size, 1);
    let vertex = |input: VertexInput| {
        let corner = input.vertex as usize;
        let position = points[triangles[corner / 3][corner % 3] as usize];
        let uv = [Vec2::ZERO, Vec2::X, Vec2::Y][corner % 3];
        let clip = perspective(position, near, far);
        Vertex::new(clip, Seen { uv, screen: Vec2::new(clip.x, clip.y) / clip.w })
    };
    let shader = fragment(|f: &Fragment<Seen>| {
        let v = f.varyings();
        // The pixel's place is interpolated linearly.
        let pixel = (v.screen * Vec2::new(1.0, -1.0) + 1.0) * size as f32 / 2.0;
        assert!((pixel.x - f.position().x).abs() < 0.01 || f.is_helper());
        Vec4::new((f.primitive_id() + 1) as f32, v.uv.x, v.uv.y, f.position().w)
    });
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, target.layout()).unwrap();
    let counters = pipeline.draw(&mut target, &Draw::vertices(0..3 * triangles.len() as u32)).unwrap();
    assert_eq!(counters.primitives, triangles.len() as u64);

    let corners: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|i| points[i as usize].as_dvec3())).collect();
    let (mut covered, mut other) = (0, 0);
    for y in 0..size {
        for x in 0..size {
            let to_view = |v: u32| (f64::from(v) + 0.5) / f64::from(size) * 2.0 - 1.0;
            let direction = DVec3::new(to_view(x), -to_view(y), -1.0);
            let hits = corners.iter().enumerate().filter_map(|(i, t)| intersect(direction, *t).map(|hit| (i, hit)));
            let hits: Vec<_> = hits.filter(|(_, hit)| hit.0 > f64::from(near) && hit.0 < f64::from(far)).collect();
            let closest = hits.iter().min_by(|a, b| a.1.0.total_cmp(&b.1.0));
            let pixel = target.color(0).pixel(x, y).unwrap();
            let id = pixel.x as usize;
            match closest {
                Some(&(i, (t, u, v))) if i + 1 == id => {
                    covered += 1;
                    // Positions are rounded to 1/256 pixel, which moves attributes by that much of their change from
                    // pixel to pixel; a triangle of height h pixels changes by 1/h.
                    let [a, b, c] = corners[i].map(|p| DVec3::new(p.x / -p.z, p.y / -p.z, 0.0) * 64.0);
                    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
                    let height = (b - a).cross(c - a).length() / longest;
                    let spread = corners[i].map(|p| -p.z);
                    let stretch =
                        spread.iter().fold(0.0f64, |m, z| m.max(*z)) / spread.iter().fold(9e9f64, |m, z| m.min(*z));
                    let allowed = 3.0 * stretch * stretch / 256.0 / height + 1e-5;
                    assert!((f64::from(pixel.y) - u).abs() < allowed, "{x} {y}: u {} {u} {allowed}", pixel.y);
                    assert!((f64::from(pixel.z) - v).abs() < allowed, "{x} {y}: v {} {v} {allowed}", pixel.z);
                    let slope = spread.iter().fold(0.0f64, |m, z| m.max((z - t).abs())) / height / 256.0;
                    assert!((f64::from(pixel.w) - 1.0 / t).abs() < 3.0 * stretch * slope / t + 1e-5);
                }
                None if id == 0 => {}
                _ => {
                    // Only where an edge runs within the rounding of positions by the pixel's centre, or two surfaces
                    // are as close as that moves their depths.
                    other += 1;
                    let near_edge = |i: usize| {
                        let p = corners[i].map(|p| [64.0 + 64.0 * p.x / -p.z, 64.0 - 64.0 * p.y / -p.z]);
                        let q = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                        (0..3).any(|e| {
                            let (a, b) = (p[e], p[(e + 1) % 3]);
                            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
                            let off = ((b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0])).abs() / length;
                            off < 1.0 / 128.0
                        })
                    };
                    let by_edge = closest.is_some_and(|c| near_edge(c.0)) || (id > 0 && near_edge(id - 1));
                    let depths: Vec<f64> = hits.iter().filter(|h| h.0 + 1 == id).map(|h| h.1.0).collect();
                    let by_depth = closest.is_some_and(|c| depths.iter().any(|d| (d - c.1.0).abs() < 0.01));
                    assert!(by_edge || by_depth, "pixel {x} {y}: {id} against {closest:?}");
                }
            }
        }
    }
    // Of 16384 pixels, those whose centre has an edge within 1/128 pixel.
    assert!(covered > 5000 && other < 40, "{covered} {other}");
}
