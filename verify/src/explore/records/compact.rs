//! The compact protocol of Thrift, in which Parquet states where its columns are.

/// Kinds of fields.
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// The fields of a struct, written in the order of their numbers.
#[derive(Debug, Default)]
pub struct Compact {
    bytes: Vec<u8>,
    last: u8,
}

impl Compact {
    /// A struct that stands by itself.
    pub fn message(fill: impl FnOnce(&mut Compact)) -> Vec<u8> {
        let mut compact = Compact::default();
        compact.fields(fill);
        compact.bytes
    }

    /// A field with a number of 32 bits.
    pub fn i32(&mut self, field: u8, value: i32) {
        self.head(field, I32);
        self.zigzag(value.into());
    }

    /// A field with a number of 64 bits.
    pub fn i64(&mut self, field: u8, value: i64) {
        self.head(field, I64);
        self.zigzag(value);
    }

    /// A field with a text.
    pub fn text(&mut self, field: u8, text: &str) {
        self.head(field, BINARY);
        self.string(text);
    }

    /// A field with a struct.
    pub fn structure(&mut self, field: u8, fill: impl FnOnce(&mut Compact)) {
        self.head(field, STRUCT);
        self.fields(fill);
    }

    /// A field with a list of structs.
    pub fn structures<T>(&mut self, field: u8, of: &[T], fill: impl Fn(&mut Compact, &T)) {
        self.list(field, STRUCT, of.len());
        of.iter().for_each(|item| self.fields(|compact| fill(compact, item)));
    }

    /// A field with a list of numbers of 32 bits.
    pub fn i32s(&mut self, field: u8, values: &[i32]) {
        self.list(field, I32, values.len());
        values.iter().for_each(|value| self.zigzag((*value).into()));
    }

    /// A field with a list of texts.
    pub fn texts(&mut self, field: u8, texts: &[&str]) {
        self.list(field, BINARY, texts.len());
        texts.iter().for_each(|text| self.string(text));
    }

    fn fields(&mut self, fill: impl FnOnce(&mut Compact)) {
        let outer = std::mem::take(&mut self.last);
        fill(self);
        self.bytes.push(0);
        self.last = outer;
    }

    /// The distance to the last field, at most 15, and the kind.
    fn head(&mut self, field: u8, kind: u8) {
        self.bytes.push(((field - self.last) << 4) | kind);
        self.last = field;
    }

    fn list(&mut self, field: u8, kind: u8, length: usize) {
        self.head(field, LIST);
        match length < 15 {
            true => self.bytes.push(((length as u8) << 4) | kind),
            false => {
                self.bytes.push(0xf0 | kind);
                varint(&mut self.bytes, length as u64);
            }
        }
    }

    fn string(&mut self, text: &str) {
        varint(&mut self.bytes, text.len() as u64);
        self.bytes.extend(text.as_bytes());
    }

    /// Small numbers of either sign take few bytes.
    fn zigzag(&mut self, value: i64) {
        varint(&mut self.bytes, ((value << 1) ^ (value >> 63)) as u64);
    }
}

/// Seven bits to a byte, the lowest first.
pub fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_written_as_the_specification_of_thrift_shows() {
        let mut bytes = Vec::new();
        varint(&mut bytes, 50_399);
        assert_eq!(bytes, [0xdf, 0x89, 0x03]);
        let written = Compact::message(|compact| {
            compact.i32(1, -1);
            compact.structure(3, |inner| inner.text(1, "ab"));
            compact.i64(4, 1);
            compact.i32s(5, &[0; 15]);
        });
        let expected = [0x15, 1, 0x2c, 0x18, 2, b'a', b'b', 0, 0x16, 2, 0x19, 0xf5, 15];
        assert_eq!(written, [&expected[..], &[0; 15], &[0]].concat());
    }
}
