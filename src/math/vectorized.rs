//! Loops over many numbers, compiled for the processor at hand.
//!
//! A function in [`vectorized!`] is compiled for AVX-512, for AVX2 and for any processor, and the
//! first that the machine can run is called. The compiler makes lanes of its loops; a loop over one
//! block of [`BLOCK`] numbers, without calls and early exits, comes out in whole registers. It may
//! neither fuse a product and a sum nor change their order, so that all versions give the same bits:
//! what is written once for one point serves a single point and a block alike.

use glam::{DVec3, Vec3};

/// Numbers in a block.
pub(crate) const BLOCK: usize = 32;

/// One number for each point of a block.
pub(crate) type Lane<T> = [T; BLOCK];

/// Vectors of a block, one array a component.
pub(crate) type Lane3 = [Lane<f32>; 3];

/// The same in double precision.
pub(crate) type DLane3 = [Lane<f64>; 3];

/// Zeros.
pub(crate) const NO_LANES: Lane3 = [[0.0; BLOCK]; 3];

/// The vector of one point.
#[inline(always)]
pub(crate) fn vec3(lanes: &Lane3, i: usize) -> Vec3 {
    Vec3::new(lanes[0][i], lanes[1][i], lanes[2][i])
}

/// Sets the vector of one point.
#[inline(always)]
pub(crate) fn set_vec3(lanes: &mut Lane3, i: usize, v: Vec3) {
    (lanes[0][i], lanes[1][i], lanes[2][i]) = (v.x, v.y, v.z);
}

/// The vector of one point.
#[inline(always)]
pub(crate) fn dvec3(lanes: &DLane3, i: usize) -> DVec3 {
    DVec3::new(lanes[0][i], lanes[1][i], lanes[2][i])
}

/// Sets the vector of one point.
#[inline(always)]
pub(crate) fn set_dvec3(lanes: &mut DLane3, i: usize, v: DVec3) {
    (lanes[0][i], lanes[1][i], lanes[2][i]) = (v.x, v.y, v.z);
}

/// What a processor can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    /// AVX-512 and everything before it.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// AVX2, with the bit operations that came along.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// What every processor of its kind can do.
    Portable,
}

impl Level {
    /// The best that this machine can do.
    pub(crate) fn of_machine() -> Self {
        static LEVEL: std::sync::OnceLock<Level> = std::sync::OnceLock::new();
        #[cfg(test)]
        if let Some(level) = FORCED.get() {
            return level;
        }
        *LEVEL.get_or_init(|| Self::all()[0])
    }

    /// All that this machine can do, the best first.
    pub(crate) fn all() -> Vec<Self> {
        let mut levels = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        {
            let has_avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("popcnt");
            let has_avx512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw");
            if has_avx2 {
                levels.insert(0, Self::Avx2);
            }
            if has_avx2 && has_avx512 {
                levels.insert(0, Self::Avx512);
            }
        }
        levels
    }
}

#[cfg(test)]
thread_local! {
    static FORCED: std::cell::Cell<Option<Level>> = const { std::cell::Cell::new(None) };
}

/// What `call` gives at every level of this machine, on this thread.
#[cfg(test)]
pub(crate) fn at_every_level<T>(call: impl Fn() -> T) -> Vec<(Level, T)> {
    let at = |level| {
        FORCED.set(Some(level));
        let result = call();
        FORCED.set(None);
        (level, result)
    };
    Level::all().into_iter().map(at).collect()
}

/// Compiles functions for every [`Level`] and calls the best.
macro_rules! vectorized {
    ($(
        $(#[$attribute:meta])*
        $visibility:vis fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? $body:block
    )+) => {$(
        $(#[$attribute])*
        $visibility fn $name($($argument: $type),*) $(-> $result)? {
            #[inline(always)]
            fn body($($argument: $type),*) $(-> $result)? $body
            #[cfg(target_arch = "x86_64")]
            #[target_feature(
                enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,popcnt"
            )]
            fn avx512($($argument: $type),*) $(-> $result)? {
                body($($argument),*)
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
            fn avx2($($argument: $type),*) $(-> $result)? {
                body($($argument),*)
            }
            match $crate::math::vectorized::Level::of_machine() {
                #[cfg(target_arch = "x86_64")]
                #[expect(unsafe_code, reason = "the processor was asked for these features")]
                // SAFETY: `Level::of_machine` gives only what the processor has.
                $crate::math::vectorized::Level::Avx512 => unsafe { avx512($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                #[expect(unsafe_code, reason = "the processor was asked for these features")]
                // SAFETY: as above.
                $crate::math::vectorized::Level::Avx2 => unsafe { avx2($($argument),*) },
                $crate::math::vectorized::Level::Portable => body($($argument),*),
            }
        }
    )+};
}
pub(crate) use vectorized;
