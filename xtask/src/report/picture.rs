//! Pictures of a page, pixel by pixel.

use std::io::Cursor;

use anyhow::{Context, Result, ensure};

/// Red, green, blue.
type Pixel = [u8; 3];

/// A part of the page: left, top, right, bottom, pixels.
pub(super) type Place = [u32; 4];

/// A picture, row by row.
#[derive(Clone)]
pub(super) struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<Pixel>,
}

impl Picture {
    /// Reads a PNG.
    pub(super) fn read(png: &[u8]) -> Result<Self> {
        let mut reader = png::Decoder::new(Cursor::new(png)).read_info()?;
        let mut bytes = vec![0; reader.output_buffer_size().context("picture too large")?];
        let info = reader.next_frame(&mut bytes)?;
        let depth = info.color_type.samples();
        ensure!(depth >= 3, "a picture with {depth} channels");
        let pixels = bytes.chunks_exact(depth);
        Ok(Self {
            width: info.width,
            height: info.height,
            pixels: pixels.map(|p| [p[0], p[1], p[2]]).collect(),
        })
    }

    /// A part of it, as far as it is there.
    pub(super) fn part(&self, [left, top, right, bottom]: Place) -> Self {
        let (right, bottom) = (right.min(self.width), bottom.min(self.height));
        let row = |y: u32| {
            let start = (y * self.width) as usize;
            self.pixels[start..][left.min(right) as usize..right as usize].iter()
        };
        Self {
            width: right.saturating_sub(left),
            height: bottom.saturating_sub(top),
            pixels: (top..bottom).flat_map(row).copied().collect(),
        }
    }

    /// How many colours there are.
    pub(super) fn colors(&self) -> usize {
        let mut colors = self.pixels.clone();
        colors.sort_unstable();
        colors.dedup();
        colors.len()
    }

    /// How many pixels differ.
    pub(super) fn changed(&self, other: &Self) -> usize {
        let pairs = self.pixels.iter().zip(&other.pixels);
        pairs.filter(|(a, b)| a != b).count()
    }

    /// How many pixels are clearly of another colour than its first.
    pub(super) fn drawn(&self) -> usize {
        /// Steps of 255: what rounding does not make.
        const CLEAR: u8 = 8;
        let Some(back) = self.pixels.first() else {
            return 0;
        };
        let differs = |pixel: &&Pixel| {
            let mut channels = pixel.iter().zip(back);
            channels.any(|(a, b)| a.abs_diff(*b) > CLEAR)
        };
        self.pixels.iter().filter(differs).count()
    }
}

#[cfg(test)]
mod tests {
    use super::Picture;

    #[test]
    fn blank_and_still_are_seen() {
        let blank = Picture {
            width: 100,
            height: 10,
            pixels: vec![[255; 3]; 1000],
        };
        let mut drawn = blank.clone();
        for (i, pixel) in drawn.pixels.iter_mut().enumerate().skip(1).take(300) {
            *pixel = [(i % 240) as u8, 0, 0];
        }
        assert_eq!((blank.colors(), drawn.colors()), (1, 241));
        assert_eq!((blank.changed(&blank), blank.changed(&drawn)), (0, 300));
        assert_eq!((blank.drawn(), drawn.drawn()), (0, 300));
        // Rows 0 to 3 hold the pixels 1 to 300, of which the last is the first of row 3.
        assert_eq!(drawn.part([0, 3, 100, 99]).drawn(), 699);
        assert_eq!(drawn.part([1, 0, 100, 3]).pixels.len(), 297);
    }
}
