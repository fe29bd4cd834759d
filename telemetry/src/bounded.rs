//! Texts and vectors of limited length: what is too long is cut.

use heapless::Vec;

/// A short text, cut where it is too long.
pub type Text<const N: usize> = heapless::String<N>;

/// Cuts a text at N bytes, between two characters.
#[must_use]
pub fn text<const N: usize>(whole: &str) -> Text<N> {
    let cut = whole.get(..whole.floor_char_boundary(N)).unwrap_or_default();
    Text::try_from(cut).unwrap_or_default()
}

/// Collects the first N values; `collect` would panic at the next one.
pub fn vector<T, const N: usize>(values: impl IntoIterator<Item = T>) -> Vec<T, N> {
    let mut vector = Vec::new();
    for value in values {
        if vector.push(value).is_err() {
            break;
        }
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::{Text, text, vector};
    use heapless::Vec;

    #[test]
    fn a_text_is_cut_between_two_characters() {
        let cut: [Text<4>; 3] = [text("arm"), text("arm-6"), text("arm\u{b5}")];
        assert_eq!(cut, ["arm", "arm-", "arm"]);
    }

    #[test]
    fn values_past_the_capacity_are_left_out() {
        let vectors: [Vec<u8, 3>; 2] = [vector(0..2), vector(0..9)];
        assert_eq!(vectors, [&[0, 1][..], &[0, 1, 2]]);
    }
}
