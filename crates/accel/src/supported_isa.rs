//! The instruction set that queries of a hierarchy run on.

use crate::Isa;
use crate::simd::{Lanes, WIDE};

/// A level that was found to be supported by this machine, and how many rays a packet may have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SupportedIsa {
    level: Isa,
    width: u8,
}

impl SupportedIsa {
    /// The fastest one, with packets as wide as they may be.
    pub fn best() -> Self {
        Self { level: Isa::best(), width: WIDE as u8 }
    }

    /// Replaces the instruction set, if this machine supports the new one.
    pub fn with_level(self, level: Isa) -> Self {
        if level.is_supported() { Self { level, ..self } } else { self }
    }

    /// Limits packets to `width` rays, rounded up to a power of two from 4 to 32.
    pub fn with_width(self, width: usize) -> Self {
        Self { width: width.clamp(4, WIDE).next_power_of_two() as u8, ..self }
    }

    /// Which level it is.
    #[inline(always)]
    pub fn get(self) -> Isa {
        self.level
    }

    /// Most rays of a packet.
    #[inline(always)]
    pub fn width(self) -> usize {
        self.width.into()
    }

    /// Packet width for `count` rays: no more than one register has lanes where these hold all rays.
    #[inline(always)]
    pub fn for_rays<L: Lanes>(self, _: L, count: usize) -> Self {
        if count <= L::COUNT { self.with_width(self.width().min(L::COUNT)) } else { self }
    }

    /// True if packets need no more lanes than a register has.
    #[inline(always)]
    pub fn is_narrow<L: Lanes>(self, _: L) -> bool {
        self.width() <= L::COUNT
    }
}
