//! Damage to files, for tests that no content makes a reader panic or fill the memory: unit tests and integration tests
//! alike.

#[path = "damage/mutation.rs"]
pub(crate) mod mutation;

use mutation::{Damage, HOSTILE, NUMBERS};
use proptest::prelude::*;

/// A few damages, many of them in the first bytes, where headers are.
pub(crate) fn damages() -> impl Strategy<Value = Vec<Damage>> {
    let at = || prop_oneof![0.0..1.0, 0.0..0.1];
    let number = prop::sample::select(&NUMBERS[..]);
    let one = prop_oneof![
        1 => at().prop_map(Damage::Truncate),
        3 => (at(), 1u8..).prop_map(|(at, bits)| Damage::Flip(at, bits)),
        1 => (at(), at(), 1usize..64).prop_map(|(a, b, length)| Damage::Swap(a, b, length)),
        1 => (at(), prop::collection::vec(any::<u8>(), 1..20)).prop_map(|(at, more)| Damage::Insert(at, more)),
        1 => (at(), 1usize..64).prop_map(|(at, length)| Damage::Repeat(at, length)),
        2 => (0usize..60, prop::sample::select(&HOSTILE[..])).prop_map(|(n, text)| Damage::Digits(n, text)),
        3 => (at(), number, prop::sample::select(vec![4usize, 8]), any::<bool>())
            .prop_map(|(at, number, size, big)| Damage::Number(at, number, size, big)),
    ];
    prop::collection::vec(one, 1..4)
}

/// Some hundreds of cases, or as many as the environment variable `TETLUX_STRESS_CASES` says.
pub(crate) fn config() -> ProptestConfig {
    let cases = std::env::var("TETLUX_STRESS_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(400);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}
