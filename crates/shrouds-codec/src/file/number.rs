//! Whole numbers of any size in as few bytes as they need.

use std::io::{self, Read};

/// Writes seven bits to a byte, the lowest first; the highest bit says that more follow (LEB128).
pub(crate) fn write(bytes: &mut Vec<u8>, mut number: u64) {
    while number > 127 {
        bytes.push(number as u8 | 128);
        number >>= 7;
    }
    bytes.push(number as u8);
}

/// Reads a number. One that is longer than it needs to be, or than 64 bits, is invalid.
pub(crate) fn read(bytes: &mut impl Read) -> io::Result<u64> {
    let mut number = 0;
    for place in (0..64).step_by(7) {
        let mut byte = [0];
        bytes.read_exact(&mut byte)?;
        let part = u64::from(byte[0] & 127);
        if part << place >> place != part || (byte[0] == 0 && place > 0) {
            break;
        }
        number |= part << place;
        if byte[0] < 128 {
            return Ok(number);
        }
    }
    Err(io::Error::new(io::ErrorKind::InvalidData, "a number is none"))
}

/// Signed numbers as unsigned ones: 0, −1, 1, −2, 2 …
pub(crate) fn fold(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

/// Undoes [`fold`].
pub(crate) fn unfold(number: u64) -> i64 {
    (number >> 1) as i64 ^ -((number & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        for number in [0, 1, 127, 128, 300, 1 << 32, u64::MAX] {
            let mut bytes = Vec::new();
            write(&mut bytes, number);
            assert_eq!(read(&mut &bytes[..]).unwrap(), number);
            assert!(read(&mut &bytes[..bytes.len() - 1]).is_err());
        }
        for number in [0, -1, 1, i64::MIN, i64::MAX] {
            assert_eq!(unfold(fold(number)), number);
        }
    }

    #[test]
    fn each_number_has_one_form() {
        assert!(read(&mut &[0x81, 0x00][..]).is_err());
        assert!(read(&mut &[0xff; 11][..]).is_err());
        assert!(
            read(&mut &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02][..]).is_err()
        );
    }
}
