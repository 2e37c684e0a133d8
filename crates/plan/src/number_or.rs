//! Values that may be written as one number or as something larger: read by hand, so that an error
//! says what was found instead of "matches no variant", and `.nan` arrives as the number it is.

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// One number, or a `T` out of a list or a mapping.
pub enum NumberOr<T> {
    Number(f64),
    Other(T),
}

/// Reads either; `expected` says in an error what either looks like.
pub fn number_or<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
    expected: &'static str,
) -> Result<NumberOr<T>, D::Error> {
    deserializer.deserialize_any(Either { expected, other: PhantomData })
}

struct Either<T> {
    expected: &'static str,
    other: PhantomData<T>,
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
    type Value = NumberOr<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
        Ok(NumberOr::Number(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
        Ok(NumberOr::Number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Self::Value, E> {
        Ok(NumberOr::Number(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
        T::deserialize(SeqAccessDeserializer::new(list)).map(NumberOr::Other)
    }

    fn visit_map<A: MapAccess<'de>>(self, mapping: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(mapping)).map(NumberOr::Other)
    }
}
