//! CDR as ROS 2 writes messages: little-endian, every number aligned to its size.
//!
//! A message begins with four bytes that say so; alignment counts from behind them. A string is its
//! length with the closing NUL, its bytes, NUL; a list its count, then its elements.

/// `PLAIN_CDR`, little-endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// A message that is being written.
pub(crate) struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    pub fn new() -> Self {
        Self { bytes: HEADER.to_vec() }
    }

    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    fn align(&mut self, size: usize) {
        let length = self.bytes.len() - HEADER.len();
        self.bytes.resize(HEADER.len() + length.next_multiple_of(size), 0);
    }

    fn number<const SIZE: usize>(&mut self, little_endian: [u8; SIZE]) {
        self.align(SIZE);
        self.bytes.extend_from_slice(&little_endian);
    }

    pub fn bool(&mut self, value: bool) {
        self.u8(value.into());
    }

    pub fn u8(&mut self, value: u8) {
        self.number([value]);
    }

    pub fn i32(&mut self, value: i32) {
        self.number(value.to_le_bytes());
    }

    pub fn u32(&mut self, value: u32) {
        self.number(value.to_le_bytes());
    }

    pub fn f32(&mut self, value: f32) {
        self.number(value.to_le_bytes());
    }

    pub fn f64(&mut self, value: f64) {
        self.number(value.to_le_bytes());
    }

    /// Numbers one after the other, without a count: an array of fixed size, or a struct of them.
    pub fn f64s(&mut self, values: &[f64]) {
        values.iter().for_each(|&value| self.f64(value));
    }

    pub fn string(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    /// The count, then each element by `write`.
    pub fn list<T>(
        &mut self,
        elements: impl IntoIterator<Item = T, IntoIter: ExactSizeIterator>,
        mut write: impl FnMut(&mut Self, T),
    ) {
        let elements = elements.into_iter();
        self.count(elements.len());
        elements.for_each(|element| write(self, element));
    }

    pub fn numbers(&mut self, values: &[f64]) {
        self.list(values, |cdr, &value| cdr.f64(value));
    }

    pub fn empty_list(&mut self) {
        self.u32(0);
    }

    /// Texts and lists stay far below 4 GiB: plans are read within bounds.
    fn count(&mut self, count: usize) {
        self.u32(u32::try_from(count).unwrap_or(u32::MAX));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: impl FnOnce(&mut Cdr)) -> Vec<u8> {
        let mut cdr = Cdr::new();
        write(&mut cdr);
        let bytes = cdr.into_bytes();
        assert_eq!(bytes[..4], [0, 1, 0, 0]);
        bytes[4..].to_vec()
    }

    #[test]
    fn numbers_stand_at_multiples_of_their_size() {
        let bytes = written(|cdr| {
            cdr.u8(1);
            cdr.u32(2);
            cdr.bool(true);
            cdr.f64(1.0);
            cdr.f32(-2.0);
            cdr.i32(-1);
        });
        #[rustfmt::skip]
        assert_eq!(bytes, [
            1, 0, 0, 0,  2, 0, 0, 0,
            1, 0, 0, 0,  0, 0, 0, 0,
            0, 0, 0, 0,  0, 0, 0xf0, 0x3f,
            0, 0, 0, 0xc0,  0xff, 0xff, 0xff, 0xff,
        ]);
    }

    #[test]
    fn strings_are_counted_with_their_nul_and_lists_without_padding_behind_nothing() {
        let bytes = written(|cdr| {
            cdr.string("ab");
            cdr.string("");
            cdr.numbers(&[]);
            cdr.i32(7);
            cdr.numbers(&[0.5]);
        });
        #[rustfmt::skip]
        assert_eq!(bytes, [
            3, 0, 0, 0,  b'a', b'b', 0,  0,
            1, 0, 0, 0,  0,  0, 0, 0,
            0, 0, 0, 0,
            7, 0, 0, 0,
            1, 0, 0, 0,  0, 0, 0, 0,
            0, 0, 0, 0,  0, 0, 0xe0, 0x3f,
        ]);
    }
}
