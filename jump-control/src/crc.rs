//! The CRC-32 of Ethernet and zip (ISO-HDLC): reflected polynomial 0xEDB88320, begun and ended with all bits inverted. It detects every
//! burst of up to 32 bits.
//!
//! Four bytes are taken at once: what a byte does to the remainder is linear, so what it does with one, two or three bytes behind it is a table of
//! its own, and four entries are added.

/// Entry `[k][x]`: what the byte x does to the remainder when k bytes follow.
static TABLES: [[u32; 256]; 4] = tables();

const fn tables() -> [[u32; 256]; 4] {
    let mut tables = [[0; 256]; 4];
    let mut byte = 0;
    while byte < 256 {
        let mut remainder = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            let divisor = if remainder & 1 == 1 { 0xEDB8_8320 } else { 0 };
            remainder = (remainder >> 1) ^ divisor;
            bit += 1;
        }
        tables[0][byte] = remainder;
        byte += 1;
    }
    let mut behind = 1;
    while behind < 4 {
        let mut byte = 0;
        while byte < 256 {
            let before = tables[behind - 1][byte];
            tables[behind][byte] = (before >> 8) ^ tables[0][(before & 0xff) as usize];
            byte += 1;
        }
        behind += 1;
    }
    tables
}

/// A checksum that grows with the bytes it is told.
#[derive(Clone, Copy, Debug)]
pub struct Crc32(u32);

impl Crc32 {
    /// Before the first byte.
    pub const START: Self = Self(!0);

    /// With these bytes behind those that it was told.
    ///
    /// Not inlined: two copies of the loop leave too few registers for the tables' addresses, which cost a third more instructions then.
    #[inline(never)]
    #[must_use]
    pub const fn with(self, bytes: &[u8]) -> Self {
        let Self(mut remainder) = self;
        let [last, third, second, first] = &TABLES;
        let (mut fours, mut bytes) = bytes.as_chunks::<4>();
        while let Some((four, rest)) = fours.split_first() {
            let x = remainder ^ u32::from_le_bytes(*four);
            remainder = first[(x & 0xff) as usize]
                ^ second[(x >> 8 & 0xff) as usize]
                ^ third[(x >> 16 & 0xff) as usize]
                ^ last[(x >> 24) as usize];
            fours = rest;
        }
        while let Some((byte, rest)) = bytes.split_first() {
            let i = (remainder ^ *byte as u32) & 0xff;
            remainder = (remainder >> 8) ^ last[i as usize];
            bytes = rest;
        }
        Self(remainder)
    }

    /// The checksum of all bytes so far.
    #[must_use]
    pub const fn value(self) -> u32 {
        !self.0
    }
}

#[cfg(test)]
mod tests {
    use super::Crc32;

    /// The check value of the catalogue of CRCs, in one piece and in two of any length.
    #[test]
    fn it_is_the_catalogues() {
        let text = b"123456789";
        for cut in 0..=text.len() {
            let (first, rest) = text.split_at(cut);
            assert_eq!(Crc32::START.with(first).with(rest).value(), 0xCBF4_3926);
        }
    }
}
