//! Writes JPEG files of flat blocks (ITU-T T.81) with chosen scans and sampling.

/// Resolution of luminance over that of chroma, horizontally and vertically.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling(pub usize, pub usize);

/// Squares of the picture in a row and in a column; each is one block of chroma.
const SQUARES: usize = 3;

/// Y, Cb and Cr of a square.
fn color(square: (usize, usize)) -> [i32; 3] {
    let number = (square.1 * SQUARES + square.0) as i32;
    [90 + 10 * number, 80 + 11 * number, 170 - 9 * number]
}

fn rgb([y, cb, cr]: [i32; 3]) -> [i32; 3] {
    let (y, cb, cr) = (f64::from(y), f64::from(cb - 128), f64::from(cr - 128));
    [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb]
        .map(|value| value.round().clamp(0.0, 255.0) as i32)
}

#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    held: u32,
    count: u32,
}

impl Bits {
    fn put(&mut self, value: u32, length: u32) {
        for bit in (0..length).rev() {
            self.held = self.held << 1 | (value >> bit & 1);
            self.count += 1;
            if self.count == 8 {
                self.bytes.push(self.held as u8);
                if self.held == 0xff {
                    self.bytes.push(0);
                }
                (self.held, self.count) = (0, 0);
            }
        }
    }

    /// Writes a block of one value: its difference from the last one and, if all coefficients
    /// follow, the end-of-block code.
    fn block(&mut self, difference: i32, is_progressive: bool) {
        let category = u32::BITS - difference.unsigned_abs().leading_zeros();
        self.put(category, 4);
        let value = if difference < 0 { difference + (1 << category) - 1 } else { difference };
        self.put(value as u32, category);
        if !is_progressive {
            self.put(0, 1);
        }
    }
}

/// A pixel's place and colour.
pub type Pixel = (usize, usize, [i32; 3]);

/// Makes a file with these scans, each of components, and returns the colours of some pixels.
pub fn jpeg(
    Sampling(h, v): Sampling,
    scans: &[&[usize]],
    is_progressive: bool,
) -> (Vec<u8>, Vec<Pixel>) {
    let (width, height) = (8 * h * SQUARES, 8 * v * SQUARES);
    let mut file = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
    file.extend([1; 64]);
    let [high, low] = (height as u16).to_be_bytes();
    let [left, right] = (width as u16).to_be_bytes();
    file.extend([
        0xff,
        if is_progressive { 0xc2 } else { 0xc0 },
        0,
        17,
        8,
        high,
        low,
        left,
        right,
        3,
    ]);
    file.extend([1, (h << 4 | v) as u8, 0, 2, 0x11, 0, 3, 0x11, 0]);
    // Huffman codes: categories 0 to 11 in four bits each; the end of a block in one.
    file.extend([0xff, 0xc4, 0, 31, 0, 0, 0, 0, 12]);
    file.extend([0; 12]);
    file.extend(0..12);
    file.extend([0xff, 0xc4, 0, 20, 0x10, 1]);
    file.extend([0; 16]);
    for scan in scans {
        file.extend([0xff, 0xda, 0, 6 + 2 * scan.len() as u8, scan.len() as u8]);
        scan.iter().for_each(|&component| file.extend([component as u8 + 1, 0]));
        file.extend([0, if is_progressive { 0 } else { 63 }, 0]);
        let mut bits = Bits::default();
        let mut last = [0; 3];
        let mut put = |component: usize, square: (usize, usize)| {
            let value = 8 * (color(square)[component] - 128);
            bits.block(value - last[component], is_progressive);
            last[component] = value;
        };
        let blocks = |component: usize| if component == 0 { (h, v) } else { (1, 1) };
        if let [only] = scan[..] {
            // In a separate scan, a component's blocks come row by row.
            let (h, v) = blocks(only);
            for (y, x) in (0..v * SQUARES).flat_map(|y| (0..h * SQUARES).map(move |x| (y, x))) {
                put(only, (x / h, y / v));
            }
        } else {
            for (y, x) in (0..SQUARES).flat_map(|y| (0..SQUARES).map(move |x| (y, x))) {
                for &component in *scan {
                    let (h, v) = blocks(component);
                    (0..h * v).for_each(|_| put(component, (x, y)));
                }
            }
        }
        while bits.count > 0 {
            bits.put(1, 1);
        }
        file.extend(bits.bytes);
    }
    file.extend([0xff, 0xd9]);
    let squares = (0..SQUARES).flat_map(|y| (0..SQUARES).map(move |x| (x, y)));
    let centres = squares.map(|(x, y)| (8 * h * x + 4 * h, 8 * v * y + 4 * v, rgb(color((x, y)))));
    (file, centres.collect())
}
