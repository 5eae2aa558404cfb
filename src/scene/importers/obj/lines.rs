//! Statements of OBJ and MTL files: encoding, line ends, continued lines, comments, words and
//! names.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::scene::diagnostics::SourceFile;
use crate::scene::encoding::{Foreign, unmarked};
use crate::scene::limits::Allowance;

/// A word and its byte range in the file.
pub(super) type Word<'t> = (&'t str, Range<usize>);

/// The text of an OBJ or MTL file.
#[derive(Debug)]
pub(super) struct Text {
    pub source: SourceFile,
    /// The text with continued lines joined, if it has any.
    joined: Option<String>,
    /// True if each character stands for one byte, because the file is not UTF-8.
    single_byte: bool,
}

impl Text {
    /// Decodes a file as UTF-8 or, failing that, as one character per byte (Latin-1), which keeps
    /// different names distinct.
    ///
    /// # Errors
    /// UTF-16 and UTF-32.
    pub fn decode(path: &Path, bytes: &[u8]) -> Result<Self, Foreign> {
        let bytes = unmarked(bytes)?;
        let (text, single_byte) = match std::str::from_utf8(bytes) {
            Ok(text) => (text.to_owned(), false),
            Err(_) => (bytes.iter().map(|&byte| char::from(byte)).collect(), true),
        };
        let source = SourceFile::new(path, with_line_feeds(text));
        let joined = match joined(source.text()) {
            Cow::Owned(text) => Some(text),
            Cow::Borrowed(_) => None,
        };
        Ok(Self { source, joined, single_byte })
    }

    /// The text with continued lines joined; byte offsets are unchanged.
    pub fn lines(&self) -> &str {
        self.joined.as_deref().unwrap_or(self.source.text())
    }

    /// Bytes of a name in the file.
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        if self.single_byte {
            name.chars().map(|c| c as u8).collect()
        } else {
            name.as_bytes().to_vec()
        }
    }

    /// A name for display: a file that is not UTF-8 as a whole may contain names that are.
    pub fn shown(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap_or_else(|_| name.to_owned())
    }

    /// Path of a file in a folder. Tries the bytes of the name, then its characters, then slashes
    /// for backslashes.
    pub fn find(&self, allowance: &Allowance, folder: &Path, name: &str) -> PathBuf {
        let as_bytes = self.single_byte.then(|| path_of(self.bytes(name))).flatten();
        let as_bytes = as_bytes.map(|name| folder.join(name)).filter(|path| allowance.has(path));
        as_bytes.unwrap_or_else(|| allowance.find(folder, name))
    }
}

#[cfg(unix)]
fn path_of(bytes: Vec<u8>) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStringExt;
    Some(std::ffi::OsString::from_vec(bytes).into())
}

#[cfg(not(unix))]
fn path_of(bytes: Vec<u8>) -> Option<PathBuf> {
    String::from_utf8(bytes).ok().map(PathBuf::from)
}

/// Replaces carriage returns that no line feed follows by line feeds; byte offsets are unchanged.
fn with_line_feeds(text: String) -> String {
    if !text.contains('\r') {
        return text;
    }
    let mut made = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(at) = rest.find('\r') {
        made.push_str(&rest[..at]);
        let behind = rest[at..].trim_start_matches('\r');
        let returns = &rest[at..rest.len() - behind.len()];
        if behind.starts_with('\n') {
            made.push_str(returns);
        } else {
            made.extend(returns.chars().map(|_| '\n'));
        }
        rest = behind;
    }
    made + rest
}

/// Keywords of numeric statements, in which a backslash cannot belong to a name.
const NUMERIC: [&str; 30] = [
    "v", "vt", "vn", "vp", "f", "l", "p", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv",
    "sp", "bmat", "deg", "step", "con", "s", "Ka", "Kd", "Ks", "Ke", "Ni", "Ns", "d", "Tr", "Tf",
    "illum",
];

/// Joins lines that end in a backslash, with blanks in place of the backslash and the line end.
/// Comments do not continue, and a backslash at the end of a name belongs to the name.
fn joined(text: &str) -> Cow<'_, str> {
    if !text.contains("\\\n") && !text.contains("\\\r") {
        return Cow::Borrowed(text);
    }
    let mut made = String::with_capacity(text.len());
    let mut numeric = None;
    for line in text.split_inclusive('\n') {
        let numbers = *numeric.get_or_insert_with(|| {
            let first = line.split(blank).find(|word| !word.is_empty()).unwrap_or("");
            NUMERIC.contains(&first.trim_end_matches(['\\', '\n']))
        });
        let content = line.trim_end_matches(['\r', '\n']);
        match content.strip_suffix('\\') {
            Some(before) if line.len() > content.len() && goes_on(before, numbers) => {
                made.push_str(before);
                made.extend(line[before.len()..].chars().map(|_| ' '));
            }
            _ => {
                made.push_str(line);
                numeric = None;
            }
        }
    }
    Cow::Owned(made)
}

/// Returns whether a line continues on the next; `before` is the part before its last backslash,
/// and `numbers` says that its statement is numeric.
fn goes_on(before: &str, numbers: bool) -> bool {
    let comment = |(at, _)| numbers || before[..at].ends_with(blank) || at == 0;
    (numbers || before.is_empty() || before.ends_with(blank))
        && !before.match_indices('#').any(comment)
}

/// Returns whether a character separates words. Other Unicode blanks do not, because they may be
/// parts of names that are not UTF-8.
fn blank(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\r' | '\x0b' | '\x0c')
}

/// A keyword and its arguments.
#[derive(Clone, Debug)]
pub(super) struct Statement<'t> {
    pub keyword: &'t str,
    pub at: Range<usize>,
    rest: &'t str,
}

/// Statements in a part of a text that begins at the start of a line.
pub(super) fn statements(text: &str, part: Range<usize>) -> impl Iterator<Item = Statement<'_>> {
    let mut start = part.start;
    text[part].split_inclusive('\n').filter_map(move |line| {
        let begin = start;
        start += line.len();
        let line = line.strip_suffix('\n').unwrap_or(line);
        let indent = line.len() - line.trim_start_matches(blank).len();
        let words = &line[indent..];
        let keyword =
            words.split(blank).next().filter(|word| !word.is_empty() && !word.starts_with('#'))?;
        let at = begin + indent..begin + indent + keyword.len();
        Some(Statement { keyword, at, rest: &words[keyword.len()..] })
    })
}

impl<'t> Statement<'t> {
    /// The arguments as one name, which may contain blanks and `#`.
    pub fn name(&self) -> Word<'t> {
        let indent = self.rest.len() - self.rest.trim_start_matches(blank).len();
        let name = self.rest.trim_matches(blank);
        (name, self.at.end + indent..self.at.end + indent + name.len())
    }

    /// The arguments up to a comment, for numeric statements.
    pub fn words(&self) -> impl Iterator<Item = Word<'t>> + use<'t> {
        let (mut rest, mut at) = (self.rest, self.at.end);
        std::iter::from_fn(move || {
            let word = rest.trim_start_matches(blank);
            at += rest.len() - word.len();
            let word = word.split(blank).next().filter(|word| !word.is_empty())?;
            let kept = without_comment(word);
            let span = at..at + kept.len();
            (rest, at) = if kept.len() < word.len() {
                ("", at)
            } else {
                (&rest.trim_start_matches(blank)[word.len()..], at + word.len())
            };
            (!kept.is_empty()).then_some((kept, span))
        })
    }
}

/// The part of a word before a comment. The `#` of `1.#IND` does not start a comment.
fn without_comment(word: &str) -> &str {
    let not_a_number =
        |rest: &str| ["INF", "IND", "QNAN", "SNAN"].iter().any(|name| rest[1..].starts_with(name));
    match word.find('#') {
        Some(at) if !(word[..at].ends_with('.') && not_a_number(&word[at..])) => &word[..at],
        _ => word,
    }
}

/// Parses a finite number.
///
/// # Errors
/// A message that explains why the word is not a finite number.
pub(super) fn finite(word: &str) -> Result<f64, String> {
    if let Some(number) = word.parse().ok().filter(|number: &f64| number.is_finite()) {
        return Ok(number);
    }
    let why = if word.contains(".#") {
        ", but the result of an undefined computation"
    } else if word.contains(',') {
        "; decimals take a point, not a comma"
    } else {
        ""
    };
    Err(format!("`{word}` is not a finite number{why}"))
}

/// Most readings of a name with comments that are tried.
const MOST_READINGS: usize = 16;

/// Possible meanings of a name: all of it, or the part before a comment, longest first.
pub(super) fn readings(name: &str) -> impl Iterator<Item = &str> {
    let comments = name.match_indices('#').filter(|&(at, _)| name[..at].ends_with(blank));
    let cuts: Vec<_> =
        comments.take(MOST_READINGS).map(|(at, _)| name[..at].trim_end_matches(blank)).collect();
    std::iter::once(name).chain(cuts.into_iter().rev())
}

/// The part of a name before a comment whose `#` stands alone, if there is one.
pub(super) fn before_comment(name: &str) -> Option<&str> {
    let mut hashes = name.match_indices('#').filter(|&(at, _)| name[..at].ends_with(blank));
    let (at, _) =
        hashes.find(|(at, _)| name[at + 1..].is_empty() || name[at + 1..].starts_with(blank))?;
    Some(name[..at].trim_end_matches(blank))
}

/// The words of a name.
pub(super) fn parts(name: &str) -> impl Iterator<Item = &str> {
    name.split(blank).filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<(String, Vec<String>)> {
        let text = Text::decode("m.obj".as_ref(), text.as_bytes()).unwrap();
        let lines = text.lines();
        statements(lines, 0..lines.len())
            .map(|s| {
                for (word, at) in s.words() {
                    assert_eq!(&lines[at], word);
                }
                (s.keyword.to_owned(), s.words().map(|(word, _)| word.to_owned()).collect())
            })
            .collect()
    }

    fn list(statements: &[(&str, &[&str])]) -> Vec<(String, Vec<String>)> {
        let owned = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect();
        statements.iter().map(|(keyword, rest)| ((*keyword).to_owned(), owned(rest))).collect()
    }

    /// Theory: a backslash at the end of a line continues statements, but not comments or names.
    /// Line ends, blanks and comments do not change the statements.
    #[test]
    fn lines_go_on() {
        let plain = list(&[("v", &["0", "1", "2"]), ("f", &["1", "2", "3"])]);
        for text in [
            "v 0 1 2\nf 1 2 3",
            "\tv\t0  1\t2 \n f 1 2 3\n",
            "v 0 1 2\rf 1 2 3\r",
            "v 0 1 2\r\r\nf 1 2 3\r\n",
            "v 0 1\\\n2\nf \\\r\n1 2 \\\n3",
            "v 0 1 \\\r2\rf\\\r1 2 3",
            "# C:\\models\\\nv 0 1 2 # a \\\nf 1 2 3#b\\\n",
            "  # a \\\n\\\nv 0 1 2\n# b\\\n# c\nf 1 2 3 # \\",
            "v 0 1 2 \\\n# a \\\nf 1 2 3",
        ] {
            assert_eq!(words(text), plain, "{text:?}");
        }
        let named = words("g C:\\models\\\nv 0 1 2\nf 1 2 3");
        assert_eq!(named[1..], plain[..], "a name that ends in a backslash");
        assert_eq!(words("v -1.#IND 1.#QNAN 1.#x"), list(&[("v", &["-1.#IND", "1.#QNAN", "1."])]));
    }

    /// Theory: names with different bytes are different, in any encoding. 0x85 and 0xA0 are blanks
    /// in Unicode.
    #[test]
    fn bytes_are_kept() {
        let names: [&[u8]; 6] = [b"\xe9", b"\xe8", b"\xc3\xa9", b"a\x85", b"a\xa0", b"a"];
        let file = names.map(|name| [b"usemtl ", name, b"\n"].concat()).concat();
        let text = Text::decode("m.obj".as_ref(), &file).unwrap();
        let lines = text.lines();
        let found: Vec<_> =
            statements(lines, 0..lines.len()).map(|s| text.bytes(s.name().0)).collect();
        assert_eq!(found, names);
        assert_eq!(text.shown("\u{c3}\u{a9}"), "\u{e9}");
    }

    #[test]
    fn names_hold_hashes() {
        let all = |name| readings(name).collect::<Vec<_>>();
        assert_eq!(all("Grey #1"), ["Grey #1", "Grey"]);
        assert_eq!(all("a#1 # b # c"), ["a#1 # b # c", "a#1 # b", "a#1"]);
        assert_eq!(before_comment("a #1 # b # c"), Some("a #1"));
        assert_eq!(before_comment("a #1"), None);
    }
}
