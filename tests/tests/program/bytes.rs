//! Bytes changed at random, the same in every run.

/// Xorshift.
pub struct Random(u64);

impl Random {
    /// Other numbers for each seed but 0.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A number from 0 to `end`, which is left out.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }
}

/// Words that mean trouble.
const TROUBLE: [&str; 16] = [
    "nan",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "0",
    "-1",
    "99999999999999999999",
    "#group_end",
    "#group_begin",
    "!",
    "\"",
    "/*",
    "#",
    "1e400",
    "4294967296",
];

/// Changes a few bytes or words.
pub fn changed(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut text = text.to_vec();
    if text.is_empty() {
        return text;
    }
    for _ in 0..=random.below(3) {
        let at = random.below(text.len());
        match random.below(6) {
            0 => text[at] = random.below(256) as u8,
            1 => text[at] ^= 1 << random.below(8),
            2 => {
                text.remove(at);
            }
            3 => text.insert(at, b"0123456789.-+e#! \n"[random.below(18)]),
            4 => {
                let end = (at + random.below(60)).min(text.len());
                let copy = text[at..end].to_vec();
                text.splice(at..at, copy);
            }
            _ => {
                // A whole word makes place for one that means trouble.
                let blank = |byte: &u8| byte.is_ascii_whitespace();
                let start = text[..at].iter().rposition(blank).map_or(0, |found| found + 1);
                let end = text[at..].iter().position(blank).map_or(text.len(), |found| at + found);
                text.splice(start..end, TROUBLE[random.below(TROUBLE.len())].bytes());
            }
        }
        if text.is_empty() {
            break;
        }
    }
    text
}
