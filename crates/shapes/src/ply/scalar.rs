//! The number types of a PLY file.

/// A property's number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// The order of a number's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl Scalar {
    /// The type of a name in a header; `None` for a name that PLY does not have.
    pub(super) fn from_name(name: &[u8]) -> Option<Scalar> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Scalar::I8 => "int8",
            Scalar::U8 => "uint8",
            Scalar::I16 => "int16",
            Scalar::U16 => "uint16",
            Scalar::I32 => "int32",
            Scalar::U32 => "uint32",
            Scalar::F32 => "float32",
            Scalar::F64 => "float64",
        }
    }

    /// Bytes a number takes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// Whether a number, rounded to the nearest that the type has, is finite and within its range.
    pub(super) fn holds(self, value: f64) -> bool {
        let (least, greatest) = match self {
            Scalar::I8 => (i8::MIN.into(), i8::MAX.into()),
            Scalar::U8 => (0.0, u8::MAX.into()),
            Scalar::I16 => (i16::MIN.into(), i16::MAX.into()),
            Scalar::U16 => (0.0, u16::MAX.into()),
            Scalar::I32 => (i32::MIN.into(), i32::MAX.into()),
            Scalar::U32 => (0.0, u32::MAX.into()),
            Scalar::F32 => return (value as f32).is_finite(),
            Scalar::F64 => return value.is_finite(),
        };
        (least..=greatest).contains(&value.round())
    }

    /// The number at the head of `bytes`, which must be long enough.
    #[inline]
    pub(super) fn get(self, bytes: &[u8], order: ByteOrder) -> f64 {
        macro_rules! get {
            ($type:ty) => {{
                let number = bytes[..size_of::<$type>()].try_into().expect("as long as the type");
                match order {
                    ByteOrder::Little => <$type>::from_le_bytes(number),
                    ByteOrder::Big => <$type>::from_be_bytes(number),
                }
                .into()
            }};
        }
        match self {
            Scalar::I8 => get!(i8),
            Scalar::U8 => get!(u8),
            Scalar::I16 => get!(i16),
            Scalar::U16 => get!(u16),
            Scalar::I32 => get!(i32),
            Scalar::U32 => get!(u32),
            Scalar::F32 => get!(f32),
            Scalar::F64 => get!(f64),
        }
    }

    /// Writes `value` at the head of `bytes`: rounded to the nearest, and clamped to the type's range.
    pub(super) fn put(self, value: f64, bytes: &mut [u8], order: ByteOrder) {
        macro_rules! put {
            ($number:expr) => {{
                let number = $number;
                bytes[..size_of_val(&number)].copy_from_slice(&match order {
                    ByteOrder::Little => number.to_le_bytes(),
                    ByteOrder::Big => number.to_be_bytes(),
                })
            }};
        }
        match self {
            Scalar::I8 => put!(value.round() as i8),
            Scalar::U8 => put!(value.round() as u8),
            Scalar::I16 => put!(value.round() as i16),
            Scalar::U16 => put!(value.round() as u16),
            Scalar::I32 => put!(value.round() as i32),
            Scalar::U32 => put!(value.round() as u32),
            Scalar::F32 => put!(value as f32),
            Scalar::F64 => put!(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_reads_what_it_wrote_in_both_orders() {
        for name in ["char", "uint8", "short", "uint16", "int", "uint32", "float", "float64"] {
            let scalar = Scalar::from_name(name.as_bytes()).unwrap();
            for order in [ByteOrder::Little, ByteOrder::Big] {
                let mut bytes = vec![0; scalar.size()];
                scalar.put(101.0, &mut bytes, order);
                assert_eq!(scalar.get(&bytes, order), 101.0, "{name}");
            }
        }
        let mut bytes = [0; 4];
        Scalar::I32.put(258.4, &mut bytes, ByteOrder::Big);
        assert_eq!(bytes, [0, 0, 1, 2]);
    }

    #[test]
    fn a_type_holds_what_rounds_into_its_range() {
        assert!(Scalar::U8.holds(-0.4) && Scalar::U8.holds(255.4) && !Scalar::U8.holds(255.6));
        assert!(Scalar::F32.holds(3e38) && !Scalar::F32.holds(3.5e38) && Scalar::F64.holds(3.5e38));
    }
}
