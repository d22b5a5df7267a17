//! Vector instructions of the CPU back end.

use fearless_simd::{Level, Simd};

/// A set of vector instructions that this processor has.
///
/// ```
/// use tetlux_render::{Instructions, Renderer};
///
/// let all = Instructions::all();
/// assert_eq!(all[0].name(), Instructions::default().name());
/// // As if the processor had no more than every one of its kind.
/// let renderer = Renderer::new().with_instructions(all[all.len() - 1]);
/// # let _ = renderer;
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Instructions(pub(crate) Level);

impl Default for Instructions {
    /// The best.
    fn default() -> Self {
        Instructions(Level::new())
    }
}

impl Instructions {
    /// All that this processor has, the best first.
    pub fn all() -> Vec<Instructions> {
        let best = Level::new();
        let mut all = vec![best];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            all.extend(best.as_avx2().map(|simd| simd.level()));
            all.extend(best.as_sse4_2().map(|simd| simd.level()));
        }
        all.push(Level::baseline());
        let mut all: Vec<_> = all.into_iter().map(Instructions).collect();
        all.dedup_by_key(|instructions| instructions.name());
        all
    }

    /// As they are called: AVX-512, AVX2, SSE4.2, SSE2, NEON, or portable.
    pub fn name(self) -> &'static str {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            let known = [
                (self.0.as_avx512().is_some(), "AVX-512"),
                (self.0.as_avx2().is_some(), "AVX2"),
                (self.0.as_sse4_2().is_some(), "SSE4.2"),
                (self.0.as_sse2().is_some(), "SSE2"),
            ];
            if let Some((_, name)) = known.into_iter().find(|(has, _)| *has) {
                return name;
            }
        }
        #[cfg(target_arch = "aarch64")]
        if self.0.as_neon().is_some() {
            return "NEON";
        }
        "portable"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_has_a_name_of_its_own_and_the_best_is_first() {
        let all = Instructions::all();
        for (i, set) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|other| other.name() != set.name()), "{}", set.name());
        }
        assert_eq!(all[0].name(), Instructions::default().name());
    }
}
