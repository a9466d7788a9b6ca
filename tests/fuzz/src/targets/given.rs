//! Numbers and choices out of any bytes, so that every change of a byte changes one thing.

/// Numbers that have been trouble, or are next to such: near the speed of light, next to 1, at the ends of `f32`, of `f64`
/// and of what a source may hold.
const NUMBERS: [f64; 64] = [
    0.5,
    0.25,
    0.1,
    0.3,
    0.6,
    0.8,
    0.9,
    0.95,
    0.99,
    0.999_999,
    0.999_999_999_999,
    1.0 - f64::EPSILON / 2.0,
    1.0 + f64::EPSILON,
    1.5,
    2.5,
    std::f64::consts::PI,
    45.0,
    45.9,
    89.0,
    90.0,
    1e-3,
    1e-4,
    1e-5,
    1e-6,
    1.0004e-8,
    1e-9,
    1e-12,
    f64::EPSILON,
    1e-16,
    1e-20,
    1e-30,
    1e-37,
    1e-45,
    1e-65,
    1e-75,
    1e-100,
    1e-154,
    1e-200,
    1e-300,
    f64::MIN_POSITIVE,
    5e-324,
    40.0,
    60.0,
    100.0,
    300.0,
    350.0,
    1000.0,
    1e4,
    1e5,
    1e6,
    1e9,
    1e12,
    9_007_199_254_740_992.0,
    1e18,
    2.19e22,
    1e30,
    3.4e38,
    1e45,
    1e70,
    1e75,
    1e76,
    1e100,
    1e300,
    f64::MAX,
];

/// Bytes that are read from the front; where there are none left, zeros.
pub(crate) struct Given<'a>(&'a [u8]);

impl<'a> Given<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// The next byte.
    pub(crate) fn byte(&mut self) -> u8 {
        let [byte] = self.bytes();
        byte
    }

    /// One of `count` choices.
    pub(crate) fn choice(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    /// A finite number: a byte for one of [`NUMBERS`], of either sign, or a small integer; else an `f32` or an `f64` behind it.
    pub(crate) fn number(&mut self) -> f64 {
        let byte = self.byte();
        let number = match byte {
            0..64 => f64::from(byte) - 32.0,
            64..128 => NUMBERS[usize::from(byte) - 64],
            128..192 => -NUMBERS[usize::from(byte) - 128],
            192..224 => f32::from_le_bytes(self.bytes()).into(),
            224.. => f64::from_le_bytes(self.bytes()),
        };
        if number.is_finite() { number } else { 0.0 }
    }

    /// Three numbers.
    pub(crate) fn vector(&mut self) -> [f64; 3] {
        [self.number(), self.number(), self.number()]
    }

    /// A number of either sign as a positive one; 1 for 0.
    pub(crate) fn length(&mut self) -> f64 {
        match self.number().abs() {
            0.0 => 1.0,
            length => length,
        }
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let (now, rest) = self.0.split_at(N.min(self.0.len()));
        bytes[..now.len()].copy_from_slice(now);
        self.0 = rest;
        bytes
    }
}
