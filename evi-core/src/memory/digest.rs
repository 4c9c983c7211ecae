//! A digest of words, to find accidents.

/// The 64-bit FNV-1a hash of words (Fowler, Noll, Vo; IETF draft `draft-eastlake-fnv`), byte by byte: every change of a single byte changes it. Against
/// accidents, not against intent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    pub(crate) fn add(&mut self, word: u64) {
        self.add_bytes(&word.to_le_bytes());
    }

    /// A list, told from two shorter ones.
    #[cfg(feature = "std")]
    pub(crate) fn add_list(&mut self, words: &[u64]) {
        self.add(words.len() as u64);
        words.iter().for_each(|word| self.add(*word));
    }

    /// A text, told from two shorter ones.
    #[cfg(feature = "std")]
    pub(crate) fn add_text(&mut self, text: &str) {
        self.add(text.len() as u64);
        self.add_bytes(text.as_bytes());
    }

    fn add_bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    #[cfg(feature = "std")]
    pub(crate) const fn value(&self) -> u64 {
        self.0
    }
}
