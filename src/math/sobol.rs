//! Sobol sequence in sixteen dimensions (Sobol 1967), with the direction numbers of Joe & Kuo 2008,
//! "Constructing Sobol sequences with better two-dimensional projections" (their table
//! new-joe-kuo-6).

use crate::math::rng::Points;

/// Degree of the primitive polynomial, its inner coefficients as bits, and the initial direction
/// numbers, for each dimension from the second on.
const JOE_KUO: [(u32, u32, [u32; 6]); 15] = [
    (1, 0, [1, 0, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0, 0]),
    (4, 4, [1, 3, 5, 13, 0, 0]),
    (5, 2, [1, 1, 5, 5, 17, 0]),
    (5, 4, [1, 1, 5, 5, 5, 0]),
    (5, 7, [1, 1, 7, 11, 19, 0]),
    (5, 11, [1, 1, 5, 1, 1, 0]),
    (5, 13, [1, 1, 1, 3, 11, 0]),
    (5, 14, [1, 3, 5, 5, 31, 0]),
    (6, 1, [1, 3, 3, 9, 7, 49]),
    (6, 13, [1, 1, 1, 15, 21, 21]),
    (6, 16, [1, 3, 1, 13, 27, 49]),
];

/// Coordinate `dimension` (below 16) of point `index`, in units of 2^-32.
fn coordinate(index: u32, dimension: usize) -> u32 {
    let mut v = [0u32; 32];
    match dimension.checked_sub(1) {
        None => (0..32).for_each(|i| v[i] = 1 << (31 - i)),
        Some(row) => {
            let (degree, inner, first) = JOE_KUO[row];
            let degree = degree as usize;
            for i in 0..32 {
                if i < degree {
                    v[i] = first[i] << (31 - i);
                    continue;
                }
                v[i] = v[i - degree] ^ (v[i - degree] >> degree);
                for k in 1..degree {
                    v[i] ^= (inner >> (degree - 1 - k) & 1) * v[i - k];
                }
            }
        }
    }
    (0..32).filter(|i| index >> i & 1 == 1).fold(0, |x, i| x ^ v[i])
}

/// All sixteen coordinates of point `index` in units of 2^-32, with their bits reversed.
pub fn points(index: u32) -> Points {
    std::array::from_fn(|k| std::array::from_fn(|i| coordinate(index, 4 * k + i).reverse_bits()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Theory: of the first 2^m points, each of the 2^m intervals of every dimension contains one;
    /// in the first two dimensions, so does each box of volume 2^-m that is 2^-a wide and 2^(a-m)
    /// high (Sobol 1967). A wrong direction number leaves some of them empty.
    #[test]
    fn nets() {
        let filled = |m: u32, cell: &dyn Fn(u32) -> u32| {
            let mut cells: Vec<u32> = (0..1 << m).map(cell).collect();
            cells.sort_unstable();
            cells.dedup();
            cells.len() == 1 << m
        };
        for m in 1..=10 {
            for dimension in 0..16 {
                assert!(filled(m, &|i| coordinate(i, dimension) >> (32 - m)), "{m} {dimension}");
            }
            for a in 0..=m {
                let part = |x: u32, bits: u32| x.checked_shr(32 - bits).unwrap_or(0);
                let cell = |x: u32, y: u32| part(x, a) << (m - a) | part(y, m - a);
                assert!(filled(m, &|i| cell(coordinate(i, 0), coordinate(i, 1))), "{m} {a}");
                if m == 10 && a == 5 {
                    assert!(!filled(m, &|i| cell(coordinate(i, 0), coordinate(i, 0) ^ (i << 31))));
                }
            }
        }
    }

    /// First points of the sequence as published: 0, 1/2, then 1/4 and 3/4 in alternation.
    #[test]
    fn first_points() {
        let at = |index| [0, 1, 2].map(|d| f64::from(coordinate(index, d)) / 2f64.powi(32));
        assert_eq!(at(0), [0.0; 3]);
        assert_eq!(at(1), [0.5; 3]);
        assert_eq!(at(2), [0.25, 0.75, 0.75]);
        assert_eq!(at(3), [0.75, 0.25, 0.25]);
    }
}
