//! Little-endian numbers one after the other, read and written without a panic; reading is `const`, because the compiler reads plans too.

/// Reads from the front of bytes. Beyond their end there are zeros: whoever reads has compared the lengths before.
pub(super) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub(super) const fn take<const K: usize>(&mut self) -> [u8; K] {
        match self.0.split_first_chunk() {
            Some((chunk, rest)) => {
                self.0 = rest;
                *chunk
            }
            None => {
                self.0 = &[];
                [0; K]
            }
        }
    }

    /// Leaves out so many bytes.
    pub(super) const fn skip(&mut self, bytes: usize) {
        self.0 = match self.0.split_at_checked(bytes) {
            Some((_, rest)) => rest,
            None => &[],
        };
    }

    pub(super) const fn number(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    pub(super) const fn numbers<const K: usize>(&mut self) -> [f32; K] {
        let mut out = [0.0; K];
        let mut i = 0;
        while i < K {
            out[i] = self.number();
            i += 1;
        }
        out
    }

    pub(super) const fn rows<const R: usize, const K: usize>(&mut self) -> [[f32; K]; R] {
        let mut out = [[0.0; K]; R];
        let mut i = 0;
        while i < R {
            out[i] = self.numbers();
            i += 1;
        }
        out
    }

    /// A text of up to `ROOM` bytes: its length, and its field. None where the length is beyond the field, or the text is no UTF-8.
    pub(super) const fn text<const ROOM: usize>(&mut self) -> Option<&'a str> {
        let [length] = self.take();
        let Some((field, rest)) = self.0.split_first_chunk::<ROOM>() else {
            return None;
        };
        self.0 = rest;
        let Some((text, _)) = field.split_at_checked(length as usize) else {
            return None;
        };
        match core::str::from_utf8(text) {
            Ok(text) => Some(text),
            Err(_) => None,
        }
    }
}

/// Writes to the front of bytes. What is beyond their end is lost: whoever writes has compared the lengths before.
pub(super) struct Writer<'a>(&'a mut [u8]);

impl<'a> Writer<'a> {
    pub(super) const fn new(bytes: &'a mut [u8]) -> Self {
        Self(bytes)
    }

    pub(super) fn put<const K: usize>(&mut self, bytes: [u8; K]) {
        let all = core::mem::take(&mut self.0);
        if let Some((slot, rest)) = all.split_first_chunk_mut() {
            *slot = bytes;
            self.0 = rest;
        }
    }

    pub(super) fn numbers<'x>(&mut self, numbers: impl IntoIterator<Item = &'x f32>) {
        for x in numbers {
            self.put(x.to_le_bytes());
        }
    }

    /// A text of up to `ROOM` bytes, at most 255; what is longer was refused before.
    pub(super) fn text<const ROOM: usize>(&mut self, text: &str) {
        let mut field = [0; ROOM];
        for (to, from) in field.iter_mut().zip(text.bytes()) {
            *to = from;
        }
        self.put([text.len() as u8]);
        self.put(field);
    }
}
