//! The smallest box of a chart.

use steradian_math::DVec2;

/// Convex hull of points, counter-clockwise (Andrew's monotone chain).
fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp_dot(p - a) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut sorted.iter().copied());
    lower.extend(half(&mut sorted.iter().rev().copied()));
    lower
}

/// Axis of the box with the least area around points: it has a side along one of the hull's (Freeman and Shapira, 1975).
/// The box lies along it.
pub fn axis(points: &[DVec2]) -> DVec2 {
    let hull = hull(points);
    let count = hull.len();
    if count < 3 {
        return DVec2::X;
    }
    let turned = |axis: DVec2, p: DVec2| DVec2::new(axis.dot(p), axis.perp_dot(p));
    // The farthest points along an axis and across it wander around the hull as the axis turns.
    let mut farthest = [0; 3];
    let mut best = (f64::INFINITY, DVec2::X);
    for i in 0..count {
        let side = hull[(i + 1) % count] - hull[i];
        let axis = side.normalize_or(DVec2::X);
        for (k, direction) in [axis, axis.perp(), -axis].into_iter().enumerate() {
            farthest[k] = farthest[k].max(if k > 0 { farthest[k - 1] } else { i });
            let along = |j: usize| direction.dot(hull[j % count]);
            while along(farthest[k] + 1) > along(farthest[k]) && farthest[k] < i + 2 * count {
                farthest[k] += 1;
            }
        }
        let [right, top, left] = farthest.map(|j| turned(axis, hull[j % count]));
        let (width, height) = (right.x - left.x, top.y - turned(axis, hull[i]).y);
        if width * height < best.0 {
            best = (width * height, if width >= height { axis } else { axis.perp() });
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_rectangle_gets_its_own_axis() {
        let along = DVec2::new(0.8, 0.6);
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [1.0, 0.5]];
        let points = points.map(|[x, y]| along * x + along.perp() * y);
        assert!(axis(&points).dot(along).abs() > 1.0 - 1e-12);
    }
}
