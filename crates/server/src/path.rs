//! The path of one sample of a pixel, with its places in the picture.

use crate::{
    app::{App, Refused},
    viewer::Subject,
};
use axum::{
    extract::{Query, State},
    http::StatusCode,
    response::{IntoResponse, Json, Response},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use steradian::{
    SinglePath,
    integrators::traced::{End, Event, TracedPath, TracedVertex, VertexKind},
    math::{Vec2, Vec3},
    quality::MAX_SPP,
    trace_path,
};

/// A sample of a pixel.
#[derive(Clone, Copy, Deserialize)]
pub struct Asked {
    x: u32,
    y: u32,
    #[serde(default)]
    sample: u32,
}

/// Path as a page draws it.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[cfg_attr(test, ts(rename = "TracedPath"))]
pub struct Told {
    x: u32,
    y: u32,
    sample: u32,
    generation: u32,
    /// `path` or `volpath`, and whether the picture is made by it.
    tracer: &'static str,
    of_picture: bool,
    /// Contribution of the sample to the pixel.
    value: [f32; 3],
    end: EndTold,
    vertices: Vec<VertexTold>,
}

/// Reason for which a path ends.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[cfg_attr(test, ts(rename = "PathEnd"))]
#[serde(rename_all = "lowercase")]
pub enum EndTold {
    Escaped,
    Absorbed,
    Depth,
    Roulette,
    #[serde(rename = "not finite")]
    NotFinite,
    #[serde(rename = "too long")]
    TooLong,
}

/// Kind of a vertex.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[cfg_attr(test, ts(rename = "VertexKind"))]
#[serde(rename_all = "lowercase")]
pub enum KindTold {
    Camera,
    Surface,
    Medium,
    Escaped,
}

/// Vertex of a path as a page draws it.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[cfg_attr(test, ts(rename = "PathVertex"))]
pub struct VertexTold {
    kind: KindTold,
    position: [f32; 3],
    normal: Option<[f32; 3]>,
    object: Option<String>,
    material: Option<String>,
    /// In the picture, pixels from its left upper corner; `None` behind the camera.
    place: Option<[f32; 2]>,
    /// The unit direction in the picture in which the path goes on.
    onwards: Option<[f32; 2]>,
    weight: [f32; 3],
    emitted: [f32; 3],
    direct: Option<DirectTold>,
    event: Option<String>,
}

/// A light sample.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[cfg_attr(test, ts(rename = "LightSample"))]
pub struct DirectTold {
    /// The point on the light, of lights that are not infinite.
    position: Option<[f32; 3]>,
    place: Option<[f32; 2]>,
    /// The unit direction to it in the picture.
    onwards: Option<[f32; 2]>,
    light: [f32; 3],
}

/// The path of a sample of a pixel.
pub async fn path(State(app): State<App>, Query(asked): Query<Asked>) -> Result<Response, Refused> {
    let Asked { x, y, sample } = asked;
    if sample >= MAX_SPP {
        let why = format!("samples are whole numbers from 0 to {}, not {sample}", MAX_SPP - 1);
        return Err(Refused(StatusCode::BAD_REQUEST, why));
    }
    let subject = app.viewer.subject();
    let film = subject.scene.film();
    if x >= film.width || y >= film.height {
        return Err(Refused(StatusCode::NOT_FOUND, format!("there is no pixel {x}, {y} in the picture")));
    }
    let told = tokio::task::spawn_blocking(move || told(&subject, asked)).await;
    let told = told.map_err(|_| Refused(StatusCode::INTERNAL_SERVER_ERROR, "the path failed".into()))?;
    let told = told.map_err(|why| Refused(StatusCode::UNPROCESSABLE_ENTITY, why))?;
    Ok(Json(told).into_response())
}

fn told(subject: &Arc<Subject>, Asked { x, y, sample }: Asked) -> Result<Told, String> {
    let SinglePath { path, tracer, is_of_picture } =
        trace_path(&subject.scene, &subject.quality, [x, y], sample).map_err(|e| e.to_string())?;
    Ok(Told {
        x,
        y,
        sample,
        generation: subject.generation,
        tracer,
        of_picture: is_of_picture,
        value: path.value.to_array(),
        end: match path.end {
            End::Escaped => EndTold::Escaped,
            End::Absorbed => EndTold::Absorbed,
            End::Depth => EndTold::Depth,
            End::Roulette => EndTold::Roulette,
            End::NotFinite => EndTold::NotFinite,
            End::TooLong => EndTold::TooLong,
        },
        vertices: (0..path.vertices.len()).map(|k| vertex(subject, &path, k)).collect(),
    })
}

fn vertex(subject: &Subject, path: &TracedPath, k: usize) -> VertexTold {
    let (scene, v) = (&subject.scene, &path.vertices[k]);
    let place = |p: Vec3| scene.camera().project(scene.film(), p, path.time).filter(|at| at.is_finite());
    let here = (v.kind != VertexKind::Camera).then(|| place(v.position)).flatten();
    // By a small part of the way from the camera, which stays before it.
    let eye = path.vertices[0].position;
    let onwards = |towards: Vec3| {
        let there = place(v.position + towards * (0.01 * (v.position - eye).length()))?;
        (there - here?).try_normalize().map(|d| d.to_array())
    };
    let (object, material) = v.surface.map_or((None, None), |(object, material)| {
        let named = subject.names.of(object);
        let material = named.material.or_else(|| scene.material_names().get(material as usize).map(String::as_str));
        (named.object.map(String::from), material.map(String::from))
    });
    let direct = v.direct.map(|d| {
        let position = d.distance.is_finite().then(|| v.position + d.towards * d.distance);
        DirectTold {
            position: position.map(|p| scene.to_file(p).as_vec3().to_array()),
            place: position.and_then(place).map(|at| at.to_array()),
            onwards: onwards(d.towards),
            light: d.light.to_array(),
        }
    });
    VertexTold {
        kind: match v.kind {
            VertexKind::Camera => KindTold::Camera,
            VertexKind::Surface => KindTold::Surface,
            VertexKind::Medium => KindTold::Medium,
            VertexKind::Escaped => KindTold::Escaped,
        },
        position: scene.to_file(v.position).as_vec3().to_array(),
        normal: v.normal.map(|n| n.to_array()),
        object,
        material,
        place: here.filter(|_| v.kind != VertexKind::Escaped).map(|at: Vec2| at.to_array()),
        onwards: path.vertices.get(k + 1).and_then(|next: &TracedVertex| onwards(next.direction)),
        weight: v.throughput.to_array(),
        emitted: v.emitted.to_array(),
        direct,
        event: v.event.map(words),
    }
}

/// Continuation of a path, in words.
fn words(event: Event) -> String {
    let lobe = match event {
        Event::Phase => return "phase function".into(),
        Event::Straight => return "straight transmission".into(),
        Event::Passed => return "passed".into(),
        Event::Lobe(lobe) if lobe.is_subsurface() => return "below the surface".into(),
        Event::Lobe(lobe) => lobe,
    };
    let shape = if lobe.is_specular() {
        "specular"
    } else if lobe.is_diffuse() {
        "diffuse"
    } else if lobe.is_glossy() {
        "glossy"
    } else {
        "scattered"
    };
    format!("{shape} {}", if lobe.is_transmission() { "transmission" } else { "reflection" })
}
