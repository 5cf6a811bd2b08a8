//! Random numbers, the same on every machine.

/// A stream of random numbers: `SplitMix64` (Steele, Lea and Flood 2014).
pub(super) struct Random(u64);

impl Random {
    /// Another stream for every `seed` and `stream`.
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        // Two rounds, so that neighbouring streams start far apart.
        let mut first = Self(seed);
        let mut second = Self(first.bits() ^ stream.wrapping_mul(0xd134_2543_de82_ef95));
        Self(second.bits())
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut h = self.0;
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        h ^ (h >> 31)
    }

    /// A number in [0, 1).
    pub(super) fn next(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Optical depth until something happens.
    pub(super) fn free_path(&mut self) -> f64 {
        -(1.0 - self.next()).ln()
    }

    /// Which of some weights, by chance; the weights are not negative and not all zero.
    pub(super) fn choose(&mut self, weights: &[f64]) -> usize {
        let mut left = self.next() * weights.iter().sum::<f64>();
        for (index, weight) in weights.iter().enumerate() {
            if left < *weight {
                return index;
            }
            left -= weight;
        }
        // Rounding has eaten the last of it.
        weights.iter().rposition(|weight| *weight > 0.0).unwrap_or(0)
    }
}
