//! A method of rendering: ambient occlusion, the share of directions in which nothing is near.

use std::sync::Arc;
use steradian::engine::{
    Asked, Feature, Integrator, Method, MethodKind, PathContext, PerPixel, Plan, Refusal, Session, Support, dimension,
};
use steradian::math::{Ray, Spectrum, warp::cosine_hemisphere};
use steradian::schema::{Model, Parameter, Type};
use steradian::{Scene, math::Frame};

pub(crate) static MODEL: Model = Model {
    kind: "my_openness",
    doc: "the share of directions in which nothing is near",
    parameters: &[Parameter::new(Type::Number, "near", (0.0, 1e9), "1", "length of rays")],
    groups: &[],
    source: "",
};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Openness(f32);

/// Constructor from the options of a request.
pub(crate) const KIND: MethodKind = MethodKind::new(MODEL.kind, make);

fn make(asked: &Asked<'_>) -> Result<Arc<dyn Method>, Refusal> {
    Ok(Arc::new(Openness(asked.options.number("near").unwrap_or(1.0) as f32)))
}

impl Method for Openness {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::Media => Support::Refuses("they hide nothing here"),
            _ => Support::Exact,
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(PerPixel::per_pixel(scene, *self, plan)))
    }
}

impl Integrator for Openness {
    type Prepared = ();
    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let PathContext { scene, sampler, counters, .. } = context;
        counters.rays += 2;
        let Some(hit) = scene.intersect(&ray) else { return Spectrum::ZERO };
        let i = scene.interaction(&ray, &hit);
        let n = i.surface.n * -i.surface.n.dot(ray.direction).signum();
        let w = cosine_hemisphere(sampler.get_2d(dimension::at(0, dimension::DIRECTION)));
        let near = Ray { t_max: self.0, ..i.spawn(Frame::from_z(n).to_world(w)) };
        if scene.intersect(&near).is_some() { Spectrum::ZERO } else { Spectrum::ONE }
    }
}
