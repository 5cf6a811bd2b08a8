//! Numbers that look random and are the same every time.

/// A number in [0, 1) for any integer: `SplitMix64` (Steele, Lea and Flood 2014).
pub fn unit(n: u64) -> f64 {
    let mut z = n.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Point `n` of a sequence that fills [0, 1)³ evenly: multiples of powers of the root of x⁴ = x + 1 (Roberts 2018).
pub fn even3(n: u64) -> [f64; 3] {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    const WHOLE: f64 = 18_446_744_073_709_551_616.0;
    // Wrapping multiplication of fractions of 2⁶⁴ keeps all digits, however large `n` is.
    [1, 2, 3].map(|k| ((ROOT.powi(-k) * WHOLE) as u64).wrapping_mul(n + 1) as f64 / WHOLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_fill_the_unit_interval() {
        let n = 4096;
        let mean = |value: &dyn Fn(u64) -> f64| (0..n).map(value).sum::<f64>() / n as f64;
        assert!((mean(&unit) - 0.5).abs() < 0.02);
        for k in 0..3 {
            // Even points are far closer to the mean than random ones.
            assert!((mean(&|i| even3(i)[k]) - 0.5).abs() < 1e-3);
        }
        // No two axes go together.
        let product = mean(&|i| even3(i)[0] * even3(i)[2]);
        assert!((product - 0.25).abs() < 2e-3, "{product}");
    }
}
