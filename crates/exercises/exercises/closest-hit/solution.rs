//! A closest-hit shader; the task is in README.md.
#![allow(dead_code, unused_variables)]

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The columns of the inverse: cross products of rows over the determinant.
fn columns_of_inverse(m: [f64; 9]) -> [[f64; 3]; 3] {
    let [r0, r1, r2] = [0, 3, 6].map(|i| [m[i], m[i + 1], m[i + 2]]);
    let determinant = dot(r0, cross(r1, r2));
    [cross(r1, r2), cross(r2, r0), cross(r0, r1)].map(|c| c.map(|x| x / determinant))
}

/// The attribute at the hit.
pub fn attribute(beta: f64, gamma: f64, a: [f64; 3]) -> f64 {
    // gap
    (1.0 - beta - gamma) * a[0] + beta * a[1] + gamma * a[2]
    // end
}

/// Origin and direction of the ray in the object.
pub fn to_object(m: [f64; 9], b: [f64; 3], o: [f64; 3], d: [f64; 3]) -> [f64; 6] {
    // gap
    let c = columns_of_inverse(m);
    let times = |v: [f64; 3]| [0, 1, 2].map(|i| c[0][i] * v[0] + c[1][i] * v[1] + c[2][i] * v[2]);
    let o = times([0, 1, 2].map(|i| o[i] - b[i]));
    let d = times(d);
    [o[0], o[1], o[2], d[0], d[1], d[2]]
    // end
}

/// The normal in the world.
pub fn normal(m: [f64; 9], n: [f64; 3]) -> [f64; 3] {
    // gap
    // The rows of the inverse transpose are the columns of the inverse.
    let turned = columns_of_inverse(m).map(|c| dot(c, n));
    let length = dot(turned, turned).sqrt();
    turned.map(|x| x / length)
    // end
}
