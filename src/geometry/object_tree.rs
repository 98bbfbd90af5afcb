//! A tree over the objects of a scene, for whole batches of rays and for single ones.

use std::sync::atomic::AtomicBool;

use glam::Vec3;

use crate::geometry::Stopped;
use crate::geometry::binned::Range;
use crate::geometry::kd_tree::{Item, Walk};
use crate::math::{Aabb, Ray, RayBatch};

/// Members of a branch at most; so few objects have no branches.
const MOST_MEMBERS: usize = 16;

/// Objects and further branches, each in its box.
#[derive(Debug)]
pub(super) struct Branch {
    members: Vec<Member>,
    /// Of branches, this one included.
    n_levels: usize,
}

/// What a branch leads to.
#[derive(Debug)]
pub(super) struct Member {
    /// Around everything that a ray may be found to meet of it.
    pub(super) bounds: Aabb,
    pub(super) what: What,
}

/// An object, by its number in the scene, or a branch.
#[derive(Debug)]
pub(super) enum What {
    Object(u32),
    Branch(Branch),
}

impl Branch {
    /// The tree over objects in their boxes, as many levels as it takes.
    ///
    /// # Errors
    /// [`Stopped`].
    pub(super) fn build(mut items: Vec<Item>, stop: &AtomicBool) -> Result<Self, Stopped> {
        Self::of(Range::new(&mut items), 0, stop)
    }

    fn of(range: Range<'_>, depth: u32, stop: &AtomicBool) -> Result<Self, Stopped> {
        let ranges = range.open::<1>(MOST_MEMBERS, depth, stop)?;
        let member = |range: Range<'_>| {
            let bounds = range.bounds;
            let what = match *range.items {
                [object] => What::Object(object.id),
                _ => What::Branch(Self::of(range, depth + 1, stop)?),
            };
            Ok(Member { bounds, what })
        };
        let members = ranges.into_iter().map(member).collect::<Result<Vec<_>, _>>()?;
        let mut branch = Self { members, n_levels: 1 };
        branch.n_levels += branch.branches().map(Self::n_levels).max().unwrap_or(0);
        Ok(branch)
    }

    fn branches(&self) -> impl Iterator<Item = &Self> {
        self.members.iter().filter_map(|member| match &member.what {
            What::Object(_) => None,
            What::Branch(branch) => Some(branch),
        })
    }

    /// Levels of branches.
    pub(super) fn n_levels(&self) -> usize {
        self.n_levels
    }

    /// How many branches there are.
    pub(super) fn n_nodes(&self) -> usize {
        1 + self.branches().map(Self::n_nodes).sum::<usize>()
    }

    /// Their memory.
    pub(super) fn n_bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.members[..])
            + self.branches().map(Self::n_bytes).sum::<usize>()
    }

    /// The members as most rays of a batch may come to them, judged by the one in its middle; `order`
    /// is overwritten.
    pub(super) fn in_order<'a>(
        &'a self,
        rays: &RayBatch,
        order: &'a mut Vec<(f32, u32)>,
    ) -> impl Iterator<Item = &'a Member> {
        let direction =
            if rays.is_empty() { Vec3::ZERO } else { rays.ray(rays.len() / 2).direction };
        order.clear();
        let way = |member: &Member| (member.bounds.min + member.bounds.max).dot(direction);
        order.extend((0..).zip(&self.members).map(|(i, member)| (way(member), i)));
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.iter().map(|(_, i)| &self.members[*i as usize])
    }

    /// Hands the objects to `visit` that a ray may meet before its end, about as it comes to them.
    /// `visit` is given the parameter up to which the ray is of interest, and returns the new one;
    /// `enter` is told of every box.
    pub(super) fn walk(
        &self,
        ray: &mut Ray,
        enter: &mut impl FnMut(),
        visit: &mut impl FnMut(u32, f32) -> f32,
    ) {
        let mut near = [(0.0, 0); MOST_MEMBERS];
        let mut n_near = 0;
        for (i, member) in self.members.iter().enumerate() {
            enter();
            if let Some(walk) = Walk::new(ray, &member.bounds) {
                let place = near[..n_near].partition_point(|(t, _)| *t <= walk.enters_at());
                near.copy_within(place..n_near, place + 1);
                near[place] = (walk.enters_at(), i);
                n_near += 1;
            }
        }
        for (enters_at, i) in &near[..n_near] {
            if *enters_at > ray.t_max {
                return;
            }
            match &self.members[*i].what {
                What::Object(id) => ray.t_max = visit(*id, ray.t_max),
                What::Branch(branch) => branch.walk(ray, enter, visit),
            }
        }
    }
}
