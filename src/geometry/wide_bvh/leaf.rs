//! Several pairs of a ray and a triangle at once: the test of [`crate::geometry::triangle`], lane by
//! lane and to the bit.

use crate::geometry::lanes::{DoubleLanes, Lanes};
use crate::geometry::wide_bvh::stream::Take;

/// A corner relative to the ray's origin, sheared so that the direction is along z.
#[inline(always)]
pub(super) fn sheared<F: Lanes>(relative: [F; 3], shear: [F; 2]) -> [F; 3] {
    let [x, y, z] = relative;
    [x.sub(shear[0].mul(z)), y.sub(shear[1].mul(z)), z]
}

/// Where rays meet triangles: the lanes that do at a parameter above 0 and at most `limit`, and the
/// parameters. `corners` are sheared, `speed` is the direction's largest component and `pace` 1 over
/// it. Where any hit will do, its parameter may be that of a corner.
#[inline(always)]
pub(super) fn hits<F: Lanes, T: Take>(
    corners: [[F; 3]; 3],
    speed: F,
    pace: F,
    limit: F,
) -> Option<(u32, F)> {
    let [a, b, c] = corners;
    let zero = F::splat(0.0);
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    // The signs are right where they are not 0.
    let is_outside = u.min(v).min(w).lt(zero) & zero.lt(u.max(v).max(w));
    let mut mask = F::ALL & !is_outside;
    if mask == 0 {
        return None;
    }
    // The parameter lies between those of the corners, give or take the rounding.
    let (t_a, t_b, t_c) = (a[2].mul(pace), b[2].mul(pace), c[2].mul(pace));
    let (least, greatest) = (t_a.min(t_b).min(t_c), t_a.max(t_b).max(t_c));
    let slack = F::splat(1.0 - 1e-6).mul(least);
    mask &= least.min(slack).le(limit) & zero.le(limit) & zero.lt(greatest);
    if mask == 0 {
        return None;
    }
    if !T::SORTED {
        // All signs are certain, and the whole triangle is between the ends.
        let is_inside =
            (zero.lt(u) & zero.lt(v) & zero.lt(w)) | (u.lt(zero) & v.lt(zero) & w.lt(zero));
        let is_between = zero.lt(least) & F::splat(1.0 + 1e-6).mul(greatest).lt(limit);
        if mask & !(is_inside & is_between) == 0 {
            return Some((mask, greatest));
        }
    }
    let (is_hit, t) = exact(corners, speed);
    mask &= is_hit & t.le(limit) & zero.lt(t);
    if mask == 0 { None } else { Some((mask, t)) }
}

/// Twice the area between the rays and the edges.
#[inline(always)]
fn edge<F: Lanes>(p: [F; 3], q: [F; 3]) -> F {
    p[0].mul(q[1]).sub(p[1].mul(q[0]))
}

/// What decides: [`crate::geometry::triangle::exact`].
#[inline(always)]
fn exact<F: Lanes>(corners: [[F; 3]; 3], speed: F) -> (u32, F) {
    let [a, b, c] = corners;
    let (a, b, c) = (widened(a), widened(b), widened(c));
    let (u, v, w) = (exact_edge(c, b), exact_edge(a, c), exact_edge(b, a));
    let det = u.add(v).add(w);
    let ((u_below, u_above), (v_below, v_above)) = (u.signs(), v.signs());
    let ((w_below, w_above), (det_below, det_above)) = (w.signs(), det.signs());
    let is_outside = (u_below | v_below | w_below) & (u_above | v_above | w_above);
    let sum = u.mul(a[2]).add(v.mul(b[2])).add(w.mul(c[2]));
    let t = sum.div(det.mul(speed.widened())).narrowed();
    (!is_outside & (det_below | det_above), t)
}

#[inline(always)]
fn widened<F: Lanes>(p: [F; 3]) -> [F::Double; 3] {
    [p[0].widened(), p[1].widened(), p[2].widened()]
}

#[inline(always)]
fn exact_edge<D: DoubleLanes>(p: [D; 3], q: [D; 3]) -> D {
    p[0].mul(q[1]).sub(p[1].mul(q[0]))
}
