//! Rust structs as uniform and storage blocks: values to bytes and back.

use glam::{IVec2, IVec3, IVec4, Mat2, Mat3, Mat4, UVec2, UVec3, UVec4, Vec2, Vec3, Vec4};

use super::{BlockRules, BlockType};
use crate::error::{Result, refuse};

/// A type of members of blocks. Bytes beyond the end are neither written nor read; what is not there is zero.
pub trait BlockMember: Sized {
    /// The type in a block.
    fn block_type() -> BlockType;
    /// Writes the value from the first byte on. Padding stays.
    fn write(&self, rules: BlockRules, bytes: &mut [u8]);
    /// Reads the value from the first byte on.
    fn read(rules: BlockRules, bytes: &[u8]) -> Self;
}

/// A struct of members; [`block!`](crate::block!) declares one.
pub trait Block: BlockMember {
    /// Names and types of the members, in order.
    fn members() -> Vec<(&'static str, BlockType)>;

    /// Names of the members with their offsets in bytes.
    fn offsets(rules: BlockRules) -> Vec<(&'static str, u64)> {
        let (names, types): (Vec<_>, Vec<_>) = Self::members().into_iter().unzip();
        names.into_iter().zip(rules.offsets(&types)).collect()
    }

    /// Bytes of the block, its padding at the end included.
    fn size(rules: BlockRules) -> usize {
        rules.alignment_and_size(&Self::block_type()).1 as usize
    }

    /// The block as bytes; padding is zero.
    fn to_bytes(&self, rules: BlockRules) -> Vec<u8> {
        let mut bytes = vec![0; Self::size(rules)];
        self.write(rules, &mut bytes);
        bytes
    }

    /// The block of these bytes.
    ///
    /// # Errors
    /// For fewer bytes than the block has.
    fn from_bytes(rules: BlockRules, bytes: &[u8]) -> Result<Self> {
        let size = Self::size(rules);
        if bytes.len() < size {
            return refuse("Block::from_bytes", format!("{} bytes for a block of {size}", bytes.len()));
        }
        Ok(Self::read(rules, bytes))
    }
}

/// The first bytes, zero beyond the end.
fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut all = [0; N];
    all.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    all
}

fn put(bytes: &mut [u8], value: &[u8]) {
    bytes.iter_mut().zip(value).for_each(|(to, from)| *to = *from);
}

fn put_from(bytes: &mut [u8], at: usize, value: &impl BlockMember, rules: BlockRules) {
    value.write(rules, bytes.get_mut(at..).unwrap_or_default());
}

macro_rules! scalars {
    ($($scalar:ty => $type:ident,)*) => { $(
        impl BlockMember for $scalar {
            fn block_type() -> BlockType {
                BlockType::$type
            }
            fn write(&self, _: BlockRules, bytes: &mut [u8]) {
                put(bytes, &self.to_le_bytes());
            }
            fn read(_: BlockRules, bytes: &[u8]) -> Self {
                Self::from_le_bytes(first(bytes))
            }
        }
    )* };
}

scalars! { f32 => Scalar, i32 => Scalar, u32 => Scalar, f64 => Double, }

impl BlockMember for bool {
    fn block_type() -> BlockType {
        BlockType::Scalar
    }
    fn write(&self, rules: BlockRules, bytes: &mut [u8]) {
        u32::from(*self).write(rules, bytes);
    }
    fn read(rules: BlockRules, bytes: &[u8]) -> Self {
        u32::read(rules, bytes) != 0
    }
}

macro_rules! vectors {
    ($($vector:ty => $count:literal,)*) => { $(
        impl BlockMember for $vector {
            fn block_type() -> BlockType {
                BlockType::Vector($count)
            }
            fn write(&self, rules: BlockRules, bytes: &mut [u8]) {
                self.to_array().iter().enumerate().for_each(|(i, x)| put_from(bytes, 4 * i, x, rules));
            }
            fn read(rules: BlockRules, bytes: &[u8]) -> Self {
                let component = |i: usize| BlockMember::read(rules, bytes.get(4 * i..).unwrap_or_default());
                Self::from_array(std::array::from_fn(component))
            }
        }
    )* };
}

vectors! {
    Vec2 => 2, Vec3 => 3, Vec4 => 4, IVec2 => 2, IVec3 => 3, IVec4 => 4, UVec2 => 2, UVec3 => 3, UVec4 => 4,
}

macro_rules! matrices {
    ($($matrix:ident of $column:ident => $count:literal,)*) => { $(
        impl BlockMember for $matrix {
            fn block_type() -> BlockType {
                BlockType::Matrix($count, $count)
            }
            fn write(&self, rules: BlockRules, bytes: &mut [u8]) {
                std::array::from_fn::<$column, $count, _>(|i| self.col(i)).write(rules, bytes);
            }
            fn read(rules: BlockRules, bytes: &[u8]) -> Self {
                let columns = <[$column; $count]>::read(rules, bytes);
                Self::from_cols_array_2d(&columns.map(|column| column.to_array()))
            }
        }
    )* };
}

matrices! { Mat2 of Vec2 => 2, Mat3 of Vec3 => 3, Mat4 of Vec4 => 4, }

impl<T: BlockMember, const N: usize> BlockMember for [T; N] {
    fn block_type() -> BlockType {
        const { assert!(N > 0 && N <= u32::MAX as usize, "an array of a block has an element") }
        BlockType::Array(Box::new(T::block_type()), N as u32)
    }
    fn write(&self, rules: BlockRules, bytes: &mut [u8]) {
        let stride = rules.stride(&T::block_type()) as usize;
        self.iter().enumerate().for_each(|(i, element)| put_from(bytes, i * stride, element, rules));
    }
    fn read(rules: BlockRules, bytes: &[u8]) -> Self {
        let stride = rules.stride(&T::block_type()) as usize;
        std::array::from_fn(|i| T::read(rules, bytes.get(i * stride..).unwrap_or_default()))
    }
}

/// Declares a struct that is laid out as a uniform or storage block, by [`Block`]. Members are floats, integers and
/// booleans of 32 bits, doubles, vectors and square matrices of glam, arrays of members, and other such structs.
///
/// ```
/// use steradian_raster::{Block, BlockRules, block, glam::Vec3};
///
/// block! {
///     /// A point light.
///     pub struct Light {
///         pub place: Vec3,
///         pub power: f32,
///     }
/// }
/// block! { struct Lights { count: u32, lights: [Light; 2], } }
///
/// assert_eq!(Light::offsets(BlockRules::Std140), [("place", 0), ("power", 12)]);
/// assert_eq!(Lights::offsets(BlockRules::Std430), [("count", 0), ("lights", 16)]);
/// assert_eq!(Lights::size(BlockRules::Std430), 48);
/// ```
///
/// Other types do not compile, nor do arrays without elements:
///
/// ```compile_fail
/// steradian_raster::block! { struct Named { name: String, } }
/// ```
///
/// ```compile_fail
/// steradian_raster::block! { struct Empty { none: [f32; 0], } }
/// <Empty as steradian_raster::BlockMember>::block_type();
/// ```
#[macro_export]
macro_rules! block {
    ($(#[$meta:meta])* $vis:vis struct $name:ident {
        $($(#[$field_meta:meta])* $field_vis:vis $field:ident : $type:ty),+ $(,)?
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $name { $($(#[$field_meta])* $field_vis $field: $type,)+ }

        impl $crate::BlockMember for $name {
            fn block_type() -> $crate::BlockType {
                let members = <Self as $crate::Block>::members();
                $crate::BlockType::Struct(members.into_iter().map(|(_, member)| member).collect())
            }
            fn write(&self, rules: $crate::BlockRules, bytes: &mut [u8]) {
                let mut offsets = <Self as $crate::Block>::offsets(rules).into_iter();
                $(
                    let at = offsets.next().map_or(usize::MAX, |(_, at)| at as usize);
                    $crate::BlockMember::write(&self.$field, rules, bytes.get_mut(at..).unwrap_or_default());
                )+
            }
            fn read(rules: $crate::BlockRules, bytes: &[u8]) -> Self {
                let mut offsets = <Self as $crate::Block>::offsets(rules).into_iter();
                Self { $($field: {
                    let at = offsets.next().map_or(usize::MAX, |(_, at)| at as usize);
                    $crate::BlockMember::read(rules, bytes.get(at..).unwrap_or_default())
                },)+ }
            }
        }

        impl $crate::Block for $name {
            fn members() -> Vec<(&'static str, $crate::BlockType)> {
                vec![$((stringify!($field), <$type as $crate::BlockMember>::block_type()),)+]
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::{BlockRules::*, *};

    block! { struct Inner { direction: Vec3, sharp: bool, at: Vec2, } }
    block! {
        struct Outer {
            scale: f32,
            color: Vec3,
            after: f32,
            weights: [f32; 3],
            turn: Mat3,
            inner: [Inner; 2],
            flat: Mat2,
            precise: f64,
            ids: [UVec2; 2],
            last: IVec3,
        }
    }

    /// Offsets by rules 1 to 10 of section 7.6.2.2, by hand.
    #[test]
    fn offsets_are_those_of_the_rules() {
        // A vec3 is aligned to 16 and has 12 bytes, so that a float follows in the fourth. Arrays and matrices of
        // std140 have 16 bytes for each element or column; a struct ends at a multiple of its alignment.
        assert_eq!(Inner::offsets(Std140), [("direction", 0), ("sharp", 12), ("at", 16)]);
        assert_eq!((Inner::size(Std140), Inner::size(Std430)), (32, 32));
        let offsets = |rules| Outer::offsets(rules).into_iter().map(|(_, at)| at).collect::<Vec<_>>();
        assert_eq!(offsets(Std140), [0, 16, 28, 32, 80, 128, 192, 224, 240, 272]);
        assert_eq!(Outer::size(Std140), 288);
        assert_eq!(offsets(Std430), [0, 16, 28, 32, 48, 96, 160, 176, 184, 208]);
        assert_eq!(Outer::size(Std430), 224);
    }

    #[test]
    fn values_lie_at_their_offsets_and_return() {
        let inner = |x: f32| Inner { direction: Vec3::new(x, 2.0, 3.0), sharp: x > 5.0, at: Vec2::new(7.0, x) };
        let outer = Outer {
            scale: 0.5,
            color: Vec3::new(1.0, 2.0, 3.0),
            after: 4.0,
            weights: [5.0, 6.0, 7.0],
            turn: Mat3::from_cols_array(&std::array::from_fn(|i| i as f32)),
            inner: [inner(4.0), inner(8.0)],
            flat: Mat2::from_cols_array(&[1.0, 2.0, 3.0, 4.0]),
            precise: 0.1,
            ids: [UVec2::new(9, 10), UVec2::new(11, u32::MAX)],
            last: IVec3::new(-1, 2, -3),
        };
        for rules in [Std140, Std430] {
            let bytes = outer.to_bytes(rules);
            let float = |at: usize| f32::from_le_bytes(first(&bytes[at..]));
            let at = |name: &str| Outer::offsets(rules).iter().find(|(n, _)| *n == name).unwrap().1 as usize;
            let stride = if rules == Std140 { 16 } else { 4 };
            assert_eq!([0, 1, 2].map(|i| float(at("weights") + stride * i)), [5.0, 6.0, 7.0]);
            assert_eq!([0, 1, 2].map(|i| float(at("turn") + 16 * i + 8)), [2.0, 5.0, 8.0]);
            assert_eq!((float(at("inner") + 32), float(at("inner") + 16)), (8.0, 7.0));
            assert_eq!(bytes[at("inner") + 12..][..4], [0; 4]);
            assert_eq!(bytes[at("inner") + 32 + 12..][..4], [1, 0, 0, 0]);
            assert_eq!(bytes[at("precise")..][..8], 0.1f64.to_le_bytes());
            let columns = if rules == Std140 { 16 } else { 8 };
            assert_eq!((float(at("flat") + columns), float(at("flat") + columns + 4)), (3.0, 4.0));
            assert_eq!(Outer::from_bytes(rules, &bytes).unwrap(), outer);
            let error = Outer::from_bytes(rules, &bytes[1..]).unwrap_err();
            assert_eq!(error.rule, format!("{} bytes for a block of {}", bytes.len() - 1, bytes.len()));
        }
        // Too few bytes are no panic.
        outer.write(Std140, &mut [0; 13]);
        assert_eq!(Outer::read(Std430, &outer.to_bytes(Std430)[..4]).scale, 0.5);
    }
}
