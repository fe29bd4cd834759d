//! The number by which two programs compare the layout of their messages.

use postcard_schema::Schema;
use postcard_schema::schema::{DataModelType, DataModelVariant, NamedType, NamedValue};

use crate::message::Message;
use crate::request::Request;

/// Hash of the layout of all messages: the types of their fields, and of their variants' fields, in the order on the line.
///
/// It covers no name, so that a renamed field changes nothing. Every [`Hello`](crate::Hello) has it: a host compares it by
/// [`is_same_layout`] before it reads any other message.
pub const SCHEMA: u32 = hash_layout::<(Message, Request)>();

/// Hashes of earlier releases whose messages this crate reads, all of protocol 2: one that covered the names too, one without
/// the messages about the table, and the last one.
pub const EARLIER_SCHEMAS: [u32; 3] = [0x03c8_8117, 0x666c_7703, 0x5b4d_1b8b];

/// Returns whether this crate reads messages of this `schema`.
#[must_use]
pub fn is_same_layout(schema: u32) -> bool {
    schema == SCHEMA || EARLIER_SCHEMAS.contains(&schema)
}

/// Hashes the layout of a type's postcard form.
const fn hash_layout<T: Schema>() -> u32 {
    hash_type(0x811c_9dc5, T::SCHEMA)
}

/// FNV-1a of one more byte.
const fn hash_byte(hash: u32, byte: u8) -> u32 {
    (hash ^ byte as u32).wrapping_mul(0x0100_0193)
}

/// Hashes one letter for each value on the line. Structs and tuples are their fields alone, as on the line; what is optional,
/// repeated or one of several is closed by `)`, so that different layouts have different letters.
const fn hash_type(hash: u32, named: &NamedType) -> u32 {
    let letter = match named.ty {
        DataModelType::Bool => b'b',
        DataModelType::U8 => b'B',
        DataModelType::I8 => b'c',
        DataModelType::U16 => b'H',
        DataModelType::I16 => b'h',
        DataModelType::U32 => b'I',
        DataModelType::I32 => b'i',
        DataModelType::U64 => b'Q',
        DataModelType::I64 => b'q',
        DataModelType::U128 => b'O',
        DataModelType::I128 => b'o',
        DataModelType::Usize => b'N',
        DataModelType::Isize => b'n',
        DataModelType::F32 => b'f',
        DataModelType::F64 => b'd',
        DataModelType::Char => b'C',
        DataModelType::String => b's',
        DataModelType::ByteArray => b'p',
        DataModelType::Schema => b'S',
        DataModelType::Unit | DataModelType::UnitStruct => return hash,
        DataModelType::NewtypeStruct(inner) => return hash_type(hash, inner),
        DataModelType::Tuple(types) | DataModelType::TupleStruct(types) => return hash_types(hash, types),
        DataModelType::Struct(fields) => return hash_fields(hash, fields),
        DataModelType::Option(inner) => return hash_byte(hash_type(hash_byte(hash, b'?'), inner), b')'),
        DataModelType::Seq(inner) => return hash_byte(hash_type(hash_byte(hash, b'*'), inner), b')'),
        DataModelType::Map { key, val } => {
            return hash_byte(hash_type(hash_type(hash_byte(hash, b'*'), key), val), b')');
        }
        DataModelType::Enum(variants) => {
            let mut hash = hash_byte(hash, b'(');
            let mut i = 0;
            while i < variants.len() {
                hash = hash_byte(hash, b'|');
                hash = match variants[i].ty {
                    DataModelVariant::UnitVariant => hash,
                    DataModelVariant::NewtypeVariant(inner) => hash_type(hash, inner),
                    DataModelVariant::TupleVariant(types) => hash_types(hash, types),
                    DataModelVariant::StructVariant(fields) => hash_fields(hash, fields),
                };
                i += 1;
            }
            return hash_byte(hash, b')');
        }
    };
    hash_byte(hash, letter)
}

const fn hash_types(mut hash: u32, types: &[&NamedType]) -> u32 {
    let mut i = 0;
    while i < types.len() {
        hash = hash_type(hash, types[i]);
        i += 1;
    }
    hash
}

const fn hash_fields(mut hash: u32, fields: &[&NamedValue]) -> u32 {
    let mut i = 0;
    while i < fields.len() {
        hash = hash_type(hash, fields[i].ty);
        i += 1;
    }
    hash
}

#[cfg(test)]
mod tests {
    #![allow(dead_code)]

    use postcard_schema::Schema;

    use super::hash_layout;

    #[derive(Schema)]
    struct Reading {
        tick: u32,
        volts: Option<u16>,
        state: State,
    }

    #[derive(Schema)]
    enum State {
        Ok,
        Off(u8),
        Slow { by_us: u16, since: u32 },
    }

    /// The same under other names.
    #[derive(Schema)]
    struct Measurement {
        number: u32,
        raw: Option<u16>,
        health: Health,
    }

    #[derive(Schema)]
    enum Health {
        Good,
        NoResponse(u8),
        Timeout { delay: u16, first: u32 },
    }

    #[test]
    fn other_names_have_the_same_hash() {
        assert_eq!(hash_layout::<Reading>(), hash_layout::<Measurement>());
    }

    #[test]
    fn types_that_have_the_same_bytes_have_the_same_hash() {
        assert_eq!(hash_layout::<Reading>(), hash_layout::<(u32, (Option<u16>, State), ())>());
        assert_eq!(hash_layout::<[u8; 4]>(), hash_layout::<(u8, [u8; 2], (u8,))>());
    }

    /// State, but for one thing each.
    #[derive(Schema)]
    enum OtherOrder {
        Off(u8),
        Ok,
        Slow { by_us: u16, since: u32 },
    }

    #[derive(Schema)]
    enum OtherPayload {
        Ok,
        Off(u16),
        Slow { by_us: u16, since: u32 },
    }

    #[derive(Schema)]
    enum OtherOrderOfFields {
        Ok,
        Off(u8),
        Slow { since: u32, by_us: u16 },
    }

    #[derive(Schema)]
    enum OneMore {
        Ok,
        Off(u8),
        Slow { by_us: u16, since: u32 },
        Stuck,
    }

    #[derive(Schema)]
    enum OneLess {
        Ok,
        Off(u8),
    }

    #[test]
    fn each_change_of_layout_changes_the_hash() {
        let hashes = [
            hash_layout::<(u32, Option<u16>, State)>(),
            hash_layout::<(Option<u16>, u32, State)>(),
            hash_layout::<(u32, u16, State)>(),
            hash_layout::<(u64, Option<u16>, State)>(),
            hash_layout::<(i32, Option<u16>, State)>(),
            hash_layout::<([u8; 4], Option<u16>, State)>(),
            hash_layout::<(u32, Option<u16>)>(),
            hash_layout::<(u32, Option<(u16, State)>)>(),
            hash_layout::<(u32, Option<u16>, Option<State>)>(),
            hash_layout::<(u32, Option<u16>, State, bool)>(),
            hash_layout::<(u32, Option<u16>, OtherOrder)>(),
            hash_layout::<(u32, Option<u16>, OtherPayload)>(),
            hash_layout::<(u32, Option<u16>, OtherOrderOfFields)>(),
            hash_layout::<(u32, Option<u16>, OneMore)>(),
            hash_layout::<(u32, Option<u16>, OneLess)>(),
            hash_layout::<(u32, heapless::Vec<u16, 1>, State)>(),
            hash_layout::<(u32, heapless::String<1>, State)>(),
        ];
        for (i, hash) in hashes.iter().enumerate() {
            assert!(!hashes[..i].contains(hash), "layout {i}");
        }
    }
}
