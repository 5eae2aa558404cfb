//! Named metals and glasses: optical constants from published measurements.

pub mod glasses;
pub mod metals;

/// Whether two names are the same, without regard to ASCII case, spaces, hyphens and underscores:
/// `N-BK7` is `nbk7`.
fn same_name(a: &str, b: &str) -> bool {
    fn letters(name: &str) -> impl Iterator<Item = u8> {
        let kept = name.bytes().filter(|byte| !matches!(byte, b' ' | b'-' | b'_'));
        kept.map(|byte| byte.to_ascii_lowercase())
    }
    letters(a).eq(letters(b))
}
