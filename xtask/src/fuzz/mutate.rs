//! Changes to the repository's own files: mostly of whole tokens, so that what comes out is read far into the program.

use crate::random::Random;

/// What stands where a number stood, or an argument.
pub(super) const VALUES: &[&str] = &[
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-300",
    "1e-9",
    "1e9",
    "1e300",
    "-1e300",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "NaN",
    "255",
    "256",
    "-128",
    "1000",
    "4294967296",
    "1000000000",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "99999999999999999999999999",
    "0x10",
    "1_000",
    "1,5",
    "true",
    "\"\"",
    "[]",
    "{}",
    "",
    "'",
    "\u{0}",
    "é",
    "../../x",
    "%s%n",
];

/// How long lines that are repeated get, bytes.
const LONG: usize = 1 << 20;

/// A changed file.
pub(super) fn mutate(seed: &[u8], others: &[&[u8]], random: &mut Random) -> Vec<u8> {
    let mut out = seed.to_vec();
    let is_text = core::str::from_utf8(seed).is_ok();
    for _ in 0..=random.below(4) {
        out = if is_text {
            text(&out, others, random)
        } else {
            words(out, random)
        };
    }
    if random.once_in(8) {
        bytes(&mut out, random);
    }
    if !is_text && random.once_in(2) {
        mend(&mut out);
    }
    out
}

/// One change of tokens or lines.
fn text(seed: &[u8], others: &[&[u8]], random: &mut Random) -> Vec<u8> {
    let mut tokens = tokens(seed);
    let numbers: Vec<usize> = places(&tokens, |c| c.is_ascii_digit() || c == b'-');
    let names: Vec<usize> = places(&tokens, |c| c.is_ascii_alphabetic());
    let (i, j) = (random.below(tokens.len()), random.below(tokens.len()));
    match random.below(9) {
        0..=3 => replace(&mut tokens, &numbers, VALUES, random),
        4 => {
            // One name of the file where another stood: keys and values that are there, at the wrong place.
            let from = random.of(&names).map(|at| tokens[*at].clone());
            if let (Some(from), Some(at)) = (from, random.of(&names)) {
                tokens[*at] = from;
            }
        }
        5 if i < tokens.len() => drop(tokens.remove(i)),
        6 if i < tokens.len() && j < tokens.len() => tokens.swap(i, j),
        7 => return lines(seed, seed, random),
        _ => {
            let other = random.of(others).copied().unwrap_or(seed);
            return lines(seed, other, random);
        }
    }
    tokens.concat()
}

fn replace(tokens: &mut [Vec<u8>], at: &[usize], by: &[&str], random: &mut Random) {
    if let (Some(at), Some(by)) = (random.of(at), random.of(by)) {
        tokens[*at] = by.as_bytes().to_vec();
    }
}

/// Runs of letters and digits, and everything else byte by byte.
fn tokens(text: &[u8]) -> Vec<Vec<u8>> {
    let is_word = |c: u8| c.is_ascii_alphanumeric() || b"._+-".contains(&c);
    let parts = text.chunk_by(|a, b| is_word(*a) && is_word(*b));
    parts.map(<[u8]>::to_vec).collect()
}

fn places(tokens: &[Vec<u8>], first: impl Fn(u8) -> bool) -> Vec<usize> {
    let good = |i: &usize| tokens[*i].first().is_some_and(|c| first(*c));
    (0..tokens.len()).filter(good).collect()
}

/// Some lines of `from` stand in `text`: again, many times, or instead of its own.
fn lines(text: &[u8], from: &[u8], random: &mut Random) -> Vec<u8> {
    let own: Vec<&[u8]> = text.split_inclusive(|c| *c == b'\n').collect();
    let given: Vec<&[u8]> = from.split_inclusive(|c| *c == b'\n').collect();
    let begin = random.below(given.len());
    let end = (begin + 1 + random.below(8)).min(given.len());
    let some = given.get(begin..end).unwrap_or_default().concat();
    let room = LONG / some.len().max(1);
    let times = if random.once_in(20) { room.max(1) } else { 1 };
    let at = random.below(own.len() + 1);
    let rest = (at + random.below(4)).min(own.len());
    [own[..at].concat(), some.repeat(times), own[rest..].concat()].concat()
}

/// A word of 32 bits becomes another.
fn words(mut out: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let values = [f32::NAN, f32::INFINITY, 1e30, -1e30, 0.0, 1e-40, 0.1];
    let at = 4 * random.below(out.len() / 4);
    if let (Some(word), Some(value)) = (out.get_mut(at..at + 4), random.of(&values)) {
        word.copy_from_slice(&value.to_le_bytes());
    }
    out
}

/// Bytes change, or are lost at the end.
fn bytes(out: &mut Vec<u8>, random: &mut Random) {
    if random.once_in(3) {
        out.truncate(random.below(out.len()));
    }
    for _ in 0..random.below(6) {
        let (at, byte) = (random.below(out.len()), random.next());
        if let Some(old) = out.get_mut(at) {
            *old = byte.to_le_bytes()[0];
        }
    }
}

/// The checksum of a stored plan (CRC-32 of everything but itself, at byte 20), so that values are looked at.
fn mend(out: &mut [u8]) {
    let mut sum = u32::MAX;
    for (i, byte) in out.iter().enumerate() {
        if (20..24).contains(&i) {
            continue;
        }
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    if let Some(word) = out.get_mut(20..24) {
        word.copy_from_slice(&(!sum).to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::{mutate, tokens};
    use crate::random::Random;

    #[test]
    fn a_seed_says_what_comes_out() {
        let text = b"a = [1.5, -2e3]\nb = \"x\"\n";
        assert_eq!(tokens(text).concat(), text);
        let changed = |seed| mutate(text, &[text], &mut Random(seed));
        assert_eq!(changed(3), changed(3));
        let different = (0..50).filter(|seed| changed(*seed) != text);
        assert!(different.count() > 40);
    }
}
