//! Pictures of 256 colours.
//!
//! Where a picture has more colours, boxes of them are divided until there are 256: always the box with the greatest sum
//! of squared distances from its mean, along the axis of its greatest variance, at the place that leaves the least. Colours
//! that many pixels have, such as a background, get boxes of their own and so stay as they are.
//!
//! Source: X. Wu, *Efficient Statistical Computations for Optimal Color Quantization* (1991).

use std::collections::HashMap;

/// Colours of a palette at most.
const MAX_COLORS: usize = 256;

/// Bits of each channel that tell colours apart while boxes are divided.
const BITS: u32 = 6;

/// A picture as numbers of colours.
pub(super) struct Paletted {
    /// Red, green and blue of each colour, one after another.
    pub(super) palette: Vec<u8>,
    /// The number of the colour of each pixel.
    pub(super) indices: Vec<u8>,
}

/// The pixels, three bytes each, in 256 colours: the same if there are no more.
pub(super) fn paletted(pixels: &[[u8; 3]]) -> Paletted {
    exact(pixels).unwrap_or_else(|| divided(pixels))
}

fn exact(pixels: &[[u8; 3]]) -> Option<Paletted> {
    let mut numbers = HashMap::new();
    let mut palette = vec![];
    let mut indices = Vec::with_capacity(pixels.len());
    let mut last = None;
    for &pixel in pixels {
        let number = match last {
            Some((color, number)) if color == pixel => number,
            _ => match numbers.get(&pixel) {
                Some(&number) => number,
                None => {
                    let number = u8::try_from(numbers.len()).ok()?;
                    numbers.insert(pixel, number);
                    palette.extend(pixel);
                    number
                }
            },
        };
        last = Some((pixel, number));
        indices.push(number);
    }
    Some(Paletted { palette, indices })
}

/// Pixels whose colours have the same first bits.
#[derive(Clone, Copy, Default)]
struct Bin {
    pixels: u64,
    sum: [u64; 3],
}

impl Bin {
    fn mean(&self) -> [f64; 3] {
        self.sum.map(|sum| sum as f64 / self.pixels as f64)
    }
}

fn bin_of(pixel: [u8; 3]) -> usize {
    let bits = pixel.map(|level| usize::from(level >> (8 - BITS)));
    bits.into_iter()
        .fold(0, |number, bits| number << BITS | bits)
}

/// The sum of the colours of some pixels, and of their squares.
#[derive(Clone, Copy, Default)]
struct Moments {
    pixels: f64,
    sum: [f64; 3],
    squares: [f64; 3],
}

impl Moments {
    fn with(mut self, bin: &Bin) -> Self {
        let (pixels, mean) = (bin.pixels as f64, bin.mean());
        self.pixels += pixels;
        for (channel, mean) in mean.into_iter().enumerate() {
            self.sum[channel] += pixels * mean;
            self.squares[channel] += pixels * mean * mean;
        }
        self
    }

    /// The sum of squared distances from the mean along each axis.
    fn scatter(&self) -> [f64; 3] {
        [0, 1, 2].map(|channel| {
            let sum = self.sum[channel];
            self.squares[channel] - sum * sum / self.pixels
        })
    }
}

/// Some bins, a range of all of them.
struct ColorBox {
    start: usize,
    end: usize,
    moments: Moments,
}

impl ColorBox {
    fn new(bins: &[(usize, Bin)], start: usize, end: usize) -> Self {
        let inside = bins[start..end].iter();
        let moments = inside.fold(Moments::default(), |all, (_, bin)| all.with(bin));
        Self {
            start,
            end,
            moments,
        }
    }

    fn scatter(&self) -> f64 {
        match self.end - self.start {
            1 => 0.0,
            _ => self.moments.scatter().iter().sum(),
        }
    }

    /// Two boxes of the bins of this one, which are sorted on the way.
    fn divide(&self, bins: &mut [(usize, Bin)]) -> [Self; 2] {
        let inside = &mut bins[self.start..self.end];
        let scatter = self.moments.scatter();
        let axis = (0..3).max_by(|&a, &b| scatter[a].total_cmp(&scatter[b]));
        let axis = axis.unwrap_or(0);
        inside.sort_unstable_by(|(a_id, a), (b_id, b)| {
            let by_place = a.mean()[axis].total_cmp(&b.mean()[axis]);
            by_place.then(a_id.cmp(b_id))
        });
        // The squares are the same wherever the box is divided: the rest decides.
        let gain = |sum: f64, pixels: f64| sum * sum / pixels;
        let (mut best, mut cut) = (f64::NEG_INFINITY, 1);
        let mut left = Moments::default();
        for (index, (_, bin)) in inside.iter().enumerate().take(inside.len() - 1) {
            left = left.with(bin);
            let right = self.moments.pixels - left.pixels;
            let gained: f64 = (0..3)
                .map(|channel| {
                    let rest = self.moments.sum[channel] - left.sum[channel];
                    gain(left.sum[channel], left.pixels) + gain(rest, right)
                })
                .sum();
            if gained > best {
                (best, cut) = (gained, index + 1);
            }
        }
        let middle = self.start + cut;
        [
            Self::new(bins, self.start, middle),
            Self::new(bins, middle, self.end),
        ]
    }
}

fn divided(pixels: &[[u8; 3]]) -> Paletted {
    let mut all = vec![Bin::default(); 1 << (3 * BITS)];
    for &pixel in pixels {
        let bin = &mut all[bin_of(pixel)];
        bin.pixels += 1;
        for (sum, level) in bin.sum.iter_mut().zip(pixel) {
            *sum += u64::from(level);
        }
    }
    let bins = all.into_iter().enumerate();
    let mut bins: Vec<(usize, Bin)> = bins.filter(|(_, bin)| bin.pixels > 0).collect();
    let mut boxes = vec![ColorBox::new(&bins, 0, bins.len())];
    while boxes.len() < MAX_COLORS {
        let scatters = boxes.iter().map(ColorBox::scatter).enumerate();
        let worst = scatters.max_by(|(_, a), (_, b)| a.total_cmp(b));
        let Some((number, _)) = worst.filter(|&(_, scatter)| scatter > 0.0) else {
            break;
        };
        let halves = boxes.swap_remove(number).divide(&mut bins);
        boxes.extend(halves);
    }
    let mut palette = vec![];
    let mut numbers = vec![0; 1 << (3 * BITS)];
    for (number, colors) in boxes.iter().enumerate() {
        let Moments { pixels, sum, .. } = colors.moments;
        palette.extend(sum.map(|sum| (sum / pixels).round() as u8));
        for (bin, _) in &bins[colors.start..colors.end] {
            numbers[*bin] = number as u8;
        }
    }
    let indices = pixels.iter().map(|&pixel| numbers[bin_of(pixel)]).collect();
    Paletted { palette, indices }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(paletted: &Paletted) -> Vec<[u8; 3]> {
        let colors = paletted.palette.as_chunks().0;
        let indices = paletted.indices.iter();
        indices.map(|&index| colors[usize::from(index)]).collect()
    }

    #[test]
    fn pictures_of_256_colours_stay_as_they_are() {
        let pixels: Vec<[u8; 3]> = (0..=255).map(|level| [level, 7, 255 - level]).collect();
        assert_eq!(shown(&paletted(&pixels)), pixels);
        assert_eq!(shown(&paletted(&[])), [[0; 3]; 0]);
    }

    /// A background beside a ball of 20,000 colours stays; no colour is off by more than a step of 12 in each channel.
    #[test]
    fn a_background_stays_and_all_else_is_near() {
        let mut pixels = vec![[0x14, 0x17, 0x1c]; 40_000];
        let shade = |n: u32| {
            [
                (n % 200) as u8 + 50,
                (n / 200) as u8 + 20,
                (n % 200 / 2) as u8,
            ]
        };
        pixels.extend((0..20_000).map(shade));
        let made = paletted(&pixels);
        assert_eq!(made.palette.len(), 3 * MAX_COLORS);
        let shown = shown(&made);
        assert!(shown[..40_000].iter().all(|pixel| *pixel == pixels[0]));
        for (a, b) in shown.iter().zip(&pixels) {
            for channel in 0..3 {
                assert!(a[channel].abs_diff(b[channel]) <= 12, "{a:?} {b:?}");
            }
        }
    }
}
