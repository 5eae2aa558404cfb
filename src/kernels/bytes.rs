//! Serialization of the per-pixel and per-visible-point buffers: fields in struct order, numbers
//! little-endian. In f32 these are exactly the bytes of the device's buffers.

use super::aov_trace::AovPixel;
use super::real::{Real, Vec3};
use super::records::{FilmPixel, Statistics};
use super::resolve_parts::PartsPixel;

const REAL: usize = size_of::<Real>();
/// Serialized size of a [`FilmPixel`], bytes.
pub const FILM_BYTES: usize = 12 * REAL + 4 * 4;
/// Serialized size of a [`Statistics`], bytes.
pub const STATISTICS_BYTES: usize = 2 * REAL + 2 * 4;
/// Serialized size of an [`AovPixel`], bytes.
pub const AOV_BYTES: usize = 19 * REAL + 5 * 4;
/// Serialized size of a [`PartsPixel`], bytes.
pub const PARTS_BYTES: usize = 7 * REAL + 4;

/// Serializes a film.
pub fn film_bytes(film: &[FilmPixel]) -> Vec<u8> {
    let mut out = Writer(Vec::with_capacity(film.len() * FILM_BYTES));
    for p in film {
        out.vector(p.mean);
        out.real(p.spread);
        out.vector(p.carry);
        out.real(p.mean_at_pow2);
        p.rejected.iter().for_each(|count| out.word(*count));
        [p.bias_probe, p.bias_probe_alternating, p.halves, p.mean_at_half_pow2]
            .into_iter()
            .for_each(|x| out.real(x));
    }
    out.0
}

/// Deserializes a film.
pub fn film_of(bytes: &[u8]) -> Vec<FilmPixel> {
    let pixel = |bytes| {
        let mut from = Reader(bytes);
        FilmPixel {
            mean: from.vector(),
            spread: from.real(),
            carry: from.vector(),
            mean_at_pow2: from.real(),
            rejected: [from.word(), from.word(), from.word(), from.word()],
            bias_probe: from.real(),
            bias_probe_alternating: from.real(),
            halves: from.real(),
            mean_at_half_pow2: from.real(),
        }
    };
    bytes.chunks_exact(FILM_BYTES).map(pixel).collect()
}

/// Serializes the statistics of visible points.
pub fn statistics_bytes(statistics: &[Statistics]) -> Vec<u8> {
    let mut out = Writer(Vec::with_capacity(statistics.len() * STATISTICS_BYTES));
    for s in statistics {
        out.real(s.scale_sq);
        out.real(s.drop);
        out.word(s.count_low);
        out.word(s.count_high);
    }
    out.0
}

/// Deserializes the statistics of visible points.
pub fn statistics_of(bytes: &[u8]) -> Vec<Statistics> {
    let point = |bytes| {
        let mut from = Reader(bytes);
        Statistics {
            scale_sq: from.real(),
            drop: from.real(),
            count_low: from.word(),
            count_high: from.word(),
        }
    };
    bytes.chunks_exact(STATISTICS_BYTES).map(point).collect()
}

/// Serializes the AOVs of pixels.
pub fn aov_bytes(aovs: &[AovPixel]) -> Vec<u8> {
    let mut out = Writer(Vec::with_capacity(aovs.len() * AOV_BYTES));
    for a in aovs {
        out.vector(a.albedo);
        out.real(a.depth);
        out.vector(a.normal);
        out.real(a.hits);
        out.vector(a.position);
        out.real(a.points);
        out.vector(a.emission);
        out.real(a.radius);
        out.vector(a.direct);
        [a.reference, a.material, a.state, 0, 0].into_iter().for_each(|x| out.word(x));
    }
    out.0
}

/// Deserializes the AOVs of pixels.
pub fn aovs_of(bytes: &[u8]) -> Vec<AovPixel> {
    let pixel = |bytes| {
        let mut from = Reader(bytes);
        AovPixel {
            albedo: from.vector(),
            depth: from.real(),
            normal: from.vector(),
            hits: from.real(),
            position: from.vector(),
            points: from.real(),
            emission: from.vector(),
            radius: from.real(),
            direct: from.vector(),
            reference: from.word(),
            material: from.word(),
            state: from.word(),
            pad: [0; 2],
        }
    };
    bytes.chunks_exact(AOV_BYTES).map(pixel).collect()
}

/// Serializes the caustic and indirect parts of pixels.
pub fn parts_bytes(parts: &[PartsPixel]) -> Vec<u8> {
    let mut out = Writer(Vec::with_capacity(parts.len() * PARTS_BYTES));
    for p in parts {
        out.vector(p.caustic);
        out.real(p.passes);
        out.vector(p.indirect);
        out.word(0);
    }
    out.0
}

/// Deserializes the caustic and indirect parts of pixels.
pub fn parts_of(bytes: &[u8]) -> Vec<PartsPixel> {
    let pixel = |bytes| {
        let mut from = Reader(bytes);
        PartsPixel { caustic: from.vector(), passes: from.real(), indirect: from.vector(), pad: 0 }
    };
    bytes.chunks_exact(PARTS_BYTES).map(pixel).collect()
}

struct Writer(Vec<u8>);

impl Writer {
    fn real(&mut self, x: Real) {
        self.0.extend(x.to_le_bytes());
    }

    fn word(&mut self, x: u32) {
        self.0.extend(x.to_le_bytes());
    }

    fn vector(&mut self, v: Vec3) {
        v.to_array().into_iter().for_each(|x| self.real(x));
    }
}

/// Sequential reader; returns zeros past the end.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.0.split_first_chunk().unwrap_or((&[0; N], &[]));
        self.0 = rest;
        *first
    }

    fn real(&mut self) -> Real {
        Real::from_le_bytes(self.take())
    }

    fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.real(), self.real(), self.real())
    }
}

/// Theory: reading restores the written values bit by bit, the f32 bytes equal those of a device's
/// buffer, and no field is omitted or swapped.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_the_fields_in_order() {
        let x = |k: u8| Real::from(k) + 0.1;
        let vector = |k: u8| Vec3::new(x(k), x(k + 1), x(k + 2));
        let pixel = FilmPixel {
            mean: vector(0),
            spread: x(3),
            carry: vector(4),
            mean_at_pow2: x(7),
            rejected: [8, 9, 10, 0x0102_0304],
            bias_probe: x(12),
            bias_probe_alternating: -x(13),
            halves: Real::MIN_POSITIVE,
            mean_at_half_pow2: Real::NAN,
        };
        let bytes = film_bytes(&[pixel, FilmPixel { spread: x(20), ..pixel }]);
        assert_eq!(bytes.len(), 2 * FILM_BYTES);
        let back = film_of(&bytes);
        assert_eq!(film_bytes(&back), bytes);
        assert_eq!(
            (back[0].mean, back[0].rejected, back[1].spread),
            (pixel.mean, pixel.rejected, x(20))
        );
        assert_eq!(bytes[..REAL], x(0).to_le_bytes());
        assert_eq!(bytes[8 * REAL + 12..8 * REAL + 16], [4, 3, 2, 1]);
        let point = Statistics { scale_sq: x(1), drop: x(2), count_low: u32::MAX, count_high: 7 };
        assert_eq!(statistics_bytes(&[point; 3]).len(), 3 * STATISTICS_BYTES);
        assert_eq!(statistics_of(&statistics_bytes(&[point; 3])), [point; 3]);
        assert_ne!(
            statistics_bytes(&[Statistics { count_high: 0, ..point }]),
            statistics_bytes(&[point])
        );
    }

    #[test]
    fn layers_are_the_fields_in_order() {
        let x = |k: u8| Real::from(k) + 0.1;
        let vector = |k: u8| Vec3::new(x(k), x(k + 1), x(k + 2));
        let aov = AovPixel {
            albedo: vector(0),
            depth: x(3),
            normal: vector(4),
            hits: x(7),
            position: vector(8),
            points: x(11),
            emission: vector(12),
            radius: x(15),
            direct: vector(16),
            reference: 20,
            material: u32::MAX,
            state: 22,
            pad: [0; 2],
        };
        let parts = PartsPixel { caustic: vector(1), passes: x(4), indirect: vector(5), pad: 0 };
        assert_eq!(aov_bytes(&[aov; 2]).len(), 2 * AOV_BYTES);
        assert_eq!(aovs_of(&aov_bytes(&[aov; 2])), [aov; 2]);
        assert_eq!(parts_bytes(&[parts; 2]).len(), 2 * PARTS_BYTES);
        assert_eq!(parts_of(&parts_bytes(&[parts; 2])), [parts; 2]);
        // in f32 the structs have no gaps, so these are a device's bytes
        if REAL == 4 {
            assert_eq!((size_of::<AovPixel>(), size_of::<PartsPixel>()), (AOV_BYTES, PARTS_BYTES));
            assert_eq!(aov_bytes(&[aov])[4 * 19..4 * 20], 20u32.to_le_bytes());
        }
    }
}
