//! Reads what we need of a 32-bit little-endian ELF file: how much memory its sections take.

use crate::Outcome;
use std::path::Path;

/// One section of the file.
struct Section {
    kind: u32,
    flags: u32,
    address: u32,
    size: usize,
}

/// A firmware image.
pub(crate) struct Elf {
    sections: Vec<Section>,
}

const NO_BITS: u32 = 8;
const WRITABLE: u32 = 1;
const ALLOCATED: u32 = 2;

impl Elf {
    /// Reads the section table.
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let bytes = std::fs::read(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
        Self::parse(&bytes).ok_or_else(|| format!("{} is no 32-bit little-endian ELF file", path.display()))
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        if bytes.get(..6)? != b"\x7fELF\x01\x01" {
            return None;
        }
        let table = word(bytes, 32)? as usize;
        let (size, count) = (usize::from(half(bytes, 46)?), usize::from(half(bytes, 48)?));
        let section = |index: usize| {
            let at = table + index * size;
            Some(Section {
                kind: word(bytes, at + 4)?,
                flags: word(bytes, at + 8)?,
                address: word(bytes, at + 12)?,
                size: word(bytes, at + 20)? as usize,
            })
        };
        let sections = (0..count).map(section).collect::<Option<Vec<_>>>()?;
        Some(Self { sections })
    }

    /// Bytes in flash (code, constants, initial values) and bytes of statics in RAM, without the stack.
    pub(crate) fn memory_use(&self) -> (usize, usize) {
        let allocated = self.sections.iter().filter(|section| section.flags & ALLOCATED != 0);
        allocated.fold((0, 0), |(flash, ram), section| {
            let in_flash = if section.kind == NO_BITS { 0 } else { section.size };
            let in_ram = if section.flags & WRITABLE != 0 && section.address != 0 { section.size } else { 0 };
            (flash + in_flash, ram + in_ram)
        })
    }
}

fn half(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}
