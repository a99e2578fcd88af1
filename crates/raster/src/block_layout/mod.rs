//! Layout of the members of uniform and storage blocks (OpenGL 4.6, section 7.6.2.2: `std140` and `std430`).

mod members;

pub use members::{Block, BlockMember};

/// The type of a member.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BlockType {
    /// A float or an integer of 32 bits.
    Scalar,
    /// A number of 64 bits.
    Double,
    /// 2, 3 or 4 scalars.
    Vector(u32),
    /// Columns and rows; columns follow each other.
    Matrix(u32, u32),
    /// So many of a type.
    Array(Box<BlockType>, u32),
    /// Members in order.
    Struct(Vec<BlockType>),
}

/// The rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockRules {
    /// Uniform blocks: arrays and structures are aligned to 16 bytes.
    Std140,
    /// Storage blocks: they are not.
    Std430,
}

const fn round_up(x: u64, to: u64) -> u64 {
    x.div_ceil(to) * to
}

impl BlockRules {
    /// Alignment and size of a type in bytes. The size of a structure or array includes the padding at its end.
    pub fn alignment_and_size(self, of: &BlockType) -> (u64, u64) {
        match of {
            BlockType::Scalar => (4, 4),
            BlockType::Double => (8, 8),
            BlockType::Vector(n) => (if *n == 2 { 8 } else { 16 }, 4 * u64::from(*n)),
            BlockType::Matrix(columns, rows) => self.array(&BlockType::Vector(*rows), *columns),
            BlockType::Array(element, count) => self.array(element, *count),
            BlockType::Struct(members) => {
                let (offsets, alignment) = self.place(members);
                let end =
                    offsets.last().zip(members.last()).map_or(0, |(at, last)| at + self.alignment_and_size(last).1);
                (alignment, round_up(end, alignment))
            }
        }
    }

    /// Bytes from one element of an array, or column of a matrix, to the next.
    pub fn stride(self, element: &BlockType) -> u64 {
        let (alignment, size) = self.alignment_and_size(element);
        round_up(size, self.widened(alignment))
    }

    /// Offsets of the members of a block in bytes.
    pub fn offsets(self, members: &[BlockType]) -> Vec<u64> {
        self.place(members).0
    }

    fn widened(self, alignment: u64) -> u64 {
        if self == Self::Std140 { round_up(alignment, 16) } else { alignment }
    }

    fn array(self, element: &BlockType, count: u32) -> (u64, u64) {
        (self.widened(self.alignment_and_size(element).0), self.stride(element) * u64::from(count))
    }

    fn place(self, members: &[BlockType]) -> (Vec<u64>, u64) {
        let mut at = 0;
        let mut largest = self.widened(4);
        let mut offsets = Vec::with_capacity(members.len());
        for member in members {
            let (alignment, size) = self.alignment_and_size(member);
            at = round_up(at, alignment);
            offsets.push(at);
            at += size;
            largest = largest.max(alignment);
        }
        (offsets, largest)
    }
}

#[cfg(test)]
mod tests {
    use super::{BlockRules::*, BlockType::*, *};

    /// The example of the specification of `ARB_uniform_buffer_object` (its section "Standard Uniform Block Layout").
    #[test]
    fn the_example_of_the_specification() {
        let array = |of: BlockType, n: u32| Array(Box::new(of), n);
        let f = Struct(vec![Scalar, Vector(2), array(Scalar, 2), Vector(3), array(Matrix(2, 3), 2)]);
        // struct { int d; bvec2 e; } f; float g; float h[2]; mat2x3 i; struct { uvec3 j; vec2 k; float l[2]; vec2 m;
        // mat3 n[2]; } o[2];
        let o = Struct(vec![Vector(3), Vector(2), array(Scalar, 2), Vector(2), array(Matrix(3, 3), 2)]);
        let members = vec![
            Scalar,
            Vector(2),
            Vector(3),
            Struct(vec![Scalar, Vector(2)]),
            Scalar,
            array(Scalar, 2),
            Matrix(2, 3),
            array(o.clone(), 2),
        ];
        assert_eq!(Std140.offsets(&members), [0, 8, 16, 32, 48, 64, 96, 128]);
        let Struct(inside) = &o else { unreachable!() };
        assert_eq!(Std140.offsets(inside), [0, 16, 32, 64, 80]);
        assert_eq!((Std140.stride(&o), Std140.stride(&Scalar), Std140.stride(&Vector(3))), (176, 16, 16));
        assert_eq!(Std140.alignment_and_size(&f).0, 16);
    }

    #[test]
    fn storage_blocks_are_tighter() {
        let array = |of: BlockType, n: u32| Array(Box::new(of), n);
        assert_eq!(
            Std430.offsets(&[Scalar, array(Scalar, 3), Vector(2), Vector(3), Scalar, Double]),
            [0, 4, 16, 32, 44, 48]
        );
        assert_eq!(Std430.stride(&Scalar), 4);
        assert_eq!(Std430.stride(&Vector(3)), 16);
        assert_eq!(Std430.alignment_and_size(&Struct(vec![Scalar, Vector(2)])), (8, 16));
        assert_eq!(Std140.alignment_and_size(&Struct(vec![Scalar])), (16, 16));
        assert_eq!(Std430.alignment_and_size(&Matrix(3, 2)), (8, 24));
        assert_eq!(Std140.alignment_and_size(&Matrix(3, 2)), (16, 48));
    }
}
