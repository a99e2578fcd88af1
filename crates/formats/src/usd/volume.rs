//! Volumes: UsdVolVolume with a density of OpenVDB.

use super::{
    Loss, Reader,
    nodes::{Drawn, Form, Inherited},
    stage::Prim,
};
use std::sync::Arc;
use steradian_math::DMat4;
use steradian_scene::{Family, Mesh, Node};

/// A box with a medium in it.
#[derive(Clone, Debug)]
pub(super) struct Filled {
    /// The mesh of the box.
    pub mesh: usize,
    /// The medium, in the space of its file.
    pub medium: Node,
    /// Places the file in the volume.
    pub place: DMat4,
}

/// A box with normals outwards.
fn block(low: [f32; 3], high: [f32; 3]) -> Mesh {
    let corner = |k: usize| std::array::from_fn(|i| if k >> i & 1 == 0 { low[i] } else { high[i] });
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh { positions: (0..8).map(corner).collect(), triangles: triangles.into(), ..Mesh::default() }
}

impl Reader<'_> {
    /// Draws a volume: its density in the box of its extent.
    pub(super) fn volume(&mut self, prim: &Prim, state: &Inherited) {
        let names = self.stage.properties(prim);
        let fields: Vec<&str> = names.iter().map(String::as_str).filter(|name| name.starts_with("field:")).collect();
        let Some(name) = fields.iter().find(|n| **n == "field:density").or(fields.first()) else {
            return self.count(Loss::Dropped("volumes without a field are left out".into()), prim, None);
        };
        if fields.len() > 1 {
            let what = format!("fields of volumes but '{name}' are left out");
            self.count(Loss::Dropped(what), prim, None);
        }
        let target = self.stage.targets(prim, name, "targets").into_iter().next();
        let Some(field) = target.and_then(|path| self.stage.prim(&path)) else {
            return self.fault(prim, name, "the path of a field is expected".into());
        };
        let kind = self.stage.type_name(&field);
        if kind != "OpenVDBAsset" {
            let what = format!("volumes with a field of type '{kind}' are left out");
            return self.count(Loss::Dropped(what), prim, None);
        }
        let file = match self.stage.asset(&field, "filePath") {
            Some(Ok(file)) => file,
            found => {
                let why = found.and_then(Result::err).unwrap_or_else(|| "it names no file".into());
                let span = self.stage.span(&field, Some("filePath"));
                return self.stage.dropped(span, format!("{}: {why}: the volume is left out", field.path));
            }
        };
        if self.stage.value(prim, "extent").is_none() {
            return self.count(Loss::Dropped("volumes without an extent are left out".into()), prim, None);
        }
        let extent = self.tuple(prim, "extent", [0.0; 6]).map(|v| v as f32);
        let [x0, y0, z0, x1, y1, z1] = extent;
        if !extent.iter().all(|v| v.is_finite()) || x0 >= x1 || y0 >= y1 || z0 >= z1 {
            return self.fault(prim, "extent", "the corners of a box are expected".into());
        }
        let place = self.local(&field).0;
        if !place.as_mat4().is_finite() || place.determinant() == 0.0 {
            return self.count(Loss::Dropped("fields without a size are left out".into()), prim, None);
        }
        let grid = self.word(&field, "fieldName").unwrap_or_else(|| "density".into());
        let what = "volumes have no material: their density is that of extinction, and half of it scatters";
        self.count(Loss::Approximated(what.into()), prim, None);
        let medium = Node::new(Family::Medium, "vdb", self.stage.span(prim, None))
            .with("file", file)
            .with("grid", grid)
            .with("sigma_s", 0.5)
            .with("sigma_a", 0.5);
        let mesh = self.stage.import.desc.add_mesh(Arc::new(block([x0, y0, z0], [x1, y1, z1])));
        let filled = Filled { mesh, medium, place };
        let node = Node::new(Family::Material, "interface", None);
        let material = Some(self.stage.import.desc.add(node));
        let (name, place) = (prim.name().to_owned(), state.place);
        self.draw(Drawn { name, form: Form::Volume(Box::new(filled)), place, material, emission: None });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::DVec3;

    #[test]
    fn blocks_have_normals_outwards() {
        let mesh = block([1.0, 2.0, 3.0], [2.0, 4.0, 7.0]);
        let at = |k: u32| DVec3::from(mesh.positions[k as usize].map(f64::from));
        let middle = DVec3::new(1.5, 3.0, 5.0);
        let parts = mesh.triangles.iter().map(|t| {
            let [a, b, c] = t.map(at);
            (b - a).cross(c - a).dot(a - middle) / 6.0
        });
        let parts: Vec<f64> = parts.collect();
        assert!(parts.iter().all(|v| *v > 0.0) && (parts.iter().sum::<f64>() - 8.0).abs() < 1e-9, "{parts:?}");
    }
}
