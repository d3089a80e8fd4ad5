//! Random generators, one for every name, so that one draw does not depend on another.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The generator of a seed and a name: a subject, a data set, a recording.
pub(super) fn generator(seed: u64, name: &str) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed ^ fnv_1a(name.bytes()))
}

/// FNV-1a, 64 bits: fixed over releases, unlike the standard library's hashes.
pub(super) fn fnv_1a(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        // Test vectors of Fowler, Noll and Vo for the 64-bit FNV-1a.
        assert_eq!(fnv_1a("".bytes()), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_1a("a".bytes()), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv_1a("foobar".bytes()), 0x8594_4171_f739_67e8);
    }
}
