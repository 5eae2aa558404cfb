//! Mutations of bytes, lines and tokens.

use std::collections::BTreeSet;

use serde_json::Value as Json;

/// Tokens to insert into text, in addition to the words of the schema.
const TOKENS: &[&str] = &[
    "0",
    "-0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "1e19",
    "nan",
    "inf",
    "-inf",
    "0x7fffffffffffffff",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "9223372036854775808",
    "340282350000000000000000000000000000000",
    "1e15",
    "1e-15",
    "true",
    "1979-05-27",
    "\"\"",
    "\"x\"",
    "[]",
    "{}",
    "[",
    "]",
    "{",
    "}",
    "=",
    ",",
    ".",
    "\"",
    "'''",
    "#",
    "\n",
    "\r\n",
    "\\\n",
    "\u{feff}",
    "é",
    "\0",
    "[[shapes]]\n",
    "[[lights]]\n",
    "[materials.a]\n",
    "type = ",
    "/",
    "//",
    "..",
    "../..",
    "\nv 0 0 0\n",
    "\nf 1 2 3\n",
    "\nf 1/1/1 2/2/2 3/3/3 4/4/4\n",
    "\nf -1 -2 -3\n",
    "\nvt 0 0\n",
    "\nvn 0 0 1\n",
    "\no a\n",
    "\ng b\n",
    "\nusemtl a\n",
    "\nmtllib mesh.mtl\n",
    "\nl 1 2\n",
    "\ns 1\n",
    "\nnewmtl a\n",
    "\nKd 1 1 1\n",
    "\nKs 1 1 1\n",
    "\nKe 1 1 1\n",
    "\nNi 1.5\n",
    "\nd 0.5\n",
    "\nTr 1\n",
    "\nillum 5\n",
    "\nmap_Kd t.png\n",
    "\nmap_Ks t.png\n",
    "\nmap_Bump -bm 1 t.png\n",
    "\nnorm t.png\n",
    "\nNs 10\n",
];

/// Boundary values of one, two and four bytes.
const BORDERS: &[u32] = &[
    0,
    1,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0x8000,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    u32::MAX,
];

/// Mutator with a random number generator (SplitMix64; Steele, Lea & Flood 2014) and words of the
/// schema.
pub struct Mutator {
    state: u64,
    words: Vec<String>,
}

impl Mutator {
    /// Creates a mutator with a random seed.
    pub fn new(seed: u64) -> Self {
        let schema: Json =
            serde_json::from_str(&caustica::low_level::scene::schema_json()).expect("a schema");
        let mut words = BTreeSet::new();
        collect(&schema, &mut words);
        Self { state: seed, words: words.into_iter().collect() }
    }

    /// Random number below `end`, or 0 if `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((u128::from(z ^ (z >> 31)) * end as u128) >> 64) as usize
    }

    /// Applies one to four mutations to a random input of the corpus.
    pub fn mutate(&mut self, corpus: &[Vec<u8>], longest: usize) -> Vec<u8> {
        let pick = self.below(corpus.len());
        let mut input = corpus.get(pick).cloned().unwrap_or_default();
        for _ in 0..1 << self.below(3) {
            self.once(&mut input, corpus);
        }
        input.truncate(longest);
        input
    }

    fn once(&mut self, input: &mut Vec<u8>, corpus: &[Vec<u8>]) {
        let at = self.below(input.len() + 1);
        let longest = 2 << self.below(6);
        let length = 1 + self.below(longest);
        let end = (at + length).min(input.len());
        match self.below(12) {
            0 if at < input.len() => input[at] ^= 1 << self.below(8),
            1 if at < input.len() => input[at] = BORDERS[self.below(5)] as u8,
            2 => drop(input.drain(at..end)),
            3 => {
                let part = input[at..end].to_vec();
                let to = self.below(input.len() + 1);
                for _ in 0..=self.below(4) {
                    input.splice(to..to, part.iter().copied());
                }
            }
            4 | 5 => {
                let token = self.token();
                input.splice(at..at, token);
            }
            6 | 7 => self.replace_word(input),
            8 => {
                let bytes = BORDERS[self.below(BORDERS.len())];
                let bytes =
                    if self.below(2) == 0 { bytes.to_le_bytes() } else { bytes.to_be_bytes() };
                let width = [1, 2, 4][self.below(3)];
                for (byte, new) in input.iter_mut().skip(at).zip(bytes.into_iter().take(width)) {
                    *byte = new;
                }
            }
            9 => self.swap_lines(input),
            10 => {
                let pick = self.below(corpus.len());
                let other = corpus.get(pick).map_or(&[][..], Vec::as_slice);
                let from = self.below(other.len() + 1);
                let part = &other[from..(from + 4 * length).min(other.len())];
                input.splice(at..at, part.iter().copied());
            }
            _ => {
                if self.below(8) == 0 {
                    input.truncate(at);
                }
            }
        }
    }

    fn token(&mut self) -> Vec<u8> {
        if self.below(2) == 0 {
            let pick = self.below(self.words.len());
            return self.words.get(pick).map_or(Vec::new(), |word| word.clone().into_bytes());
        }
        let text = TOKENS[self.below(TOKENS.len())];
        text.as_bytes().to_vec()
    }

    /// Replaces a word or number by a token.
    fn replace_word(&mut self, input: &mut Vec<u8>) {
        let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"_.-+".contains(byte);
        let at = self.below(input.len());
        let Some(start) = (at..input.len()).find(|&at| is_word(&input[at])) else { return };
        let end = (start..input.len()).find(|&at| !is_word(&input[at])).unwrap_or(input.len());
        let token = self.token();
        input.splice(start..end, token);
    }

    fn swap_lines(&mut self, input: &mut Vec<u8>) {
        let mut lines: Vec<Vec<u8>> =
            input.split_inclusive(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
        let [a, b] = [self.below(lines.len()), self.below(lines.len())];
        if self.below(3) == 0 && a < lines.len() {
            lines.remove(a);
        } else if b < lines.len() {
            lines.swap(a, b);
        }
        *input = lines.concat();
    }
}

/// Collects the keys and constants of a schema.
fn collect(schema: &Json, words: &mut BTreeSet<String>) {
    match schema {
        Json::Object(table) => {
            for (key, value) in table {
                if key == "properties" {
                    words.extend(
                        value.as_object().into_iter().flat_map(|keys| keys.keys().cloned()),
                    );
                }
                if key == "const" || key == "enum" {
                    let texts = value.as_array().map_or(std::slice::from_ref(value), Vec::as_slice);
                    words.extend(
                        texts.iter().filter_map(Json::as_str).map(|text| format!("\"{text}\"")),
                    );
                }
                collect(value, words);
            }
        }
        Json::Array(elements) => elements.iter().for_each(|element| collect(element, words)),
        _ => {}
    }
}
