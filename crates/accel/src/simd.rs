//! The only file that names `fearless_simd`: which level this machine has, and what kernels need of it.

pub use fearless_simd::prelude;
pub use fearless_simd::{Fallback, Level, Simd, dispatch};
pub use fearless_simd::{
    f32x4, f32x8, f32x16, f64x2, f64x4, f64x8, i32x4, i32x8, mask32x8, mask32x16, mask64x4, mask64x8, u32x4,
    u32x8,
};

use std::sync::OnceLock;

/// The environment variable that may lower the level.
pub const VARIABLE: &str = "DOTRAY_SIMD";

/// The level to use, found once: the best of this machine, or a lower one that the environment variable
/// `DOTRAY_SIMD` names (`scalar`, `sse2`, `sse4.2`, `avx2`, `avx512`, `neon`, `wasm`).
///
/// The variable can only lower the level: a name that this machine does not have, or that nobody knows, is ignored.
pub fn level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    *LEVEL.get_or_init(|| lowered(std::env::var(VARIABLE).ok().as_deref()))
}

/// The best level of this machine, unless `wanted` names a lower one.
fn lowered(wanted: Option<&str>) -> Level {
    let named = |wanted: &str| available_levels().into_iter().find(|&level| level_name(level) == wanted);
    wanted.and_then(named).unwrap_or_else(Level::new)
}

/// Every level that this machine can run, from the lowest to the best; tests go through all of them.
pub fn available_levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![Level::fallback()];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(Level::Sse2));
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_avx2().map(Level::Avx2));
        levels.extend(best.as_avx512().map(Level::Avx512));
    }
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    if !best.is_fallback() {
        levels.push(best);
    }
    levels
}

/// The name by which `DOTRAY_SIMD` calls a level.
pub fn level_name(level: Level) -> &'static str {
    if level.is_fallback() {
        return "scalar";
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        // A level can stand in for all below it, so the best is asked for first.
        if level.as_avx512().is_some() {
            return "avx512";
        }
        if level.as_avx2().is_some() {
            return "avx2";
        }
        if level.as_sse4_2().is_some() {
            return "sse4.2";
        }
        "sse2"
    }
    #[cfg(target_arch = "aarch64")]
    {
        "neon"
    }
    #[cfg(target_arch = "wasm32")]
    {
        "wasm"
    }
    #[cfg(not(any(
        target_arch = "x86",
        target_arch = "x86_64",
        target_arch = "aarch64",
        target_arch = "wasm32"
    )))]
    {
        "scalar"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variable_lowers_and_never_raises() {
        let best = level_name(Level::new());
        assert_eq!(level_name(lowered(None)), best);
        assert_eq!(level_name(lowered(Some("no such level"))), best);
        for level in available_levels() {
            assert_eq!(level_name(lowered(Some(level_name(level)))), level_name(level));
        }
        assert_eq!(level_name(lowered(Some("scalar"))), "scalar");
        let foreign = if cfg!(target_arch = "aarch64") { "avx2" } else { "neon" };
        assert_eq!(level_name(lowered(Some(foreign))), best);
    }

    #[test]
    fn the_levels_ascend_to_the_best() {
        let levels = available_levels();
        assert!(levels[0].is_fallback());
        assert_eq!(level_name(levels[levels.len() - 1]), level_name(Level::new()));
    }
}
