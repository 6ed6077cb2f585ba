//! What a board's program takes of its memory.

use std::path::Path;

use object::Endianness;
use object::elf::{FileHeader32, SHF_ALLOC, SHF_WRITE, SHT_NOBITS};
use object::read::elf::{FileHeader, SectionHeader as _};

/// Bytes in flash (code, constants, initial values) and of statics in RAM, without the stack.
pub(crate) fn memory(elf: &Path) -> (u64, u64) {
    let bytes = std::fs::read(elf).expect("just built");
    let header = FileHeader32::<Endianness>::parse(&*bytes).expect("an ELF file of a 32-bit processor");
    let endian = header.endian().expect("a byte order");
    let sections = header.sections(endian, &*bytes).expect("sections");
    let taken = sections.iter().filter(|section| section.sh_flags(endian) & SHF_ALLOC != 0);
    taken.fold((0, 0), |(flash, ram), section| {
        let size = u64::from(section.sh_size(endian));
        let stored = section.sh_type(endian) != SHT_NOBITS;
        let written = section.sh_flags(endian) & SHF_WRITE != 0;
        (flash + if stored { size } else { 0 }, ram + if written { size } else { 0 })
    })
}
