//! What the boards' programs are made of, read from their ELF files: a step that cannot panic, allocate or compute
//! in `f64`, and programs that leave a network the memory that the build promises it.

use std::collections::BTreeMap;

use crate::emulator::{MACHINES, elf, memory, run};
use eclss_target::fit::{MPS2, NUCLEO, Program};
use object::elf::FileHeader32;
use object::read::elf::{ElfFile32, ElfSymbol};
use object::{Endianness, Object as _, ObjectSymbol as _};

/// Programs for microcontrollers.
const PROGRAMS: [&str; 3] = ["qemu-mps2-an500", "qemu-mps2-an386", "nucleo-h743zi2"];
/// Beginnings of compiler-runtime functions that only move memory or divide integers.
const INTEGER_RUNTIME: [&str; 4] = ["__aeabi_mem", "__aeabi_uldivmod", "__aeabi_ldivmod", "__aeabi_llsl"];

/// Symbols of a program: name and size [bytes].
fn symbols(program: &str) -> BTreeMap<String, u64> {
    let bytes = std::fs::read(elf(program)).expect("just built");
    let file = ElfFile32::<Endianness>::parse(&*bytes).expect("an ELF file of a 32-bit processor");
    let named = |symbol: ElfSymbol<'_, '_, FileHeader32<Endianness>>| {
        Some((symbol.name().ok()?.to_owned(), symbol.size()))
    };
    file.symbols().filter_map(named).collect()
}

/// What the compiler adds where a panic can be reached; the handler itself goes by a reserved name.
fn can_panic(name: &str) -> bool {
    name.contains("9panicking") || name.contains("begin_unwind") || name.contains("5panic")
}

/// Arithmetic that the processor does not have: all of `f64`, and conversions of 64-bit integers.
fn in_software(name: &str) -> bool {
    let arithmetic =
        name.starts_with("__aeabi_") && !INTEGER_RUNTIME.iter().any(|start| name.starts_with(start));
    arithmetic
        || ["df2", "df3", "sf2", "sf3", "sidf", "didf", "disf", "dfsi", "dfdi", "sfdi"]
            .iter()
            .any(|part| name.starts_with("__") && name.contains(part))
}

fn allocates(name: &str) -> bool {
    ["__rust_alloc", "__rust_dealloc", "__rust_realloc", "__rg_alloc", "malloc", "GlobalAlloc"]
        .iter()
        .any(|part| name.contains(part))
}

fn named(symbols: &BTreeMap<String, u64>, what: fn(&str) -> bool) -> Vec<&str> {
    symbols.keys().map(String::as_str).filter(|name| what(name)).collect()
}

/// The image of nothing but steps, of every method, specialised and general, over all elements.
#[test]
fn a_step_cannot_panic_allocate_or_compute_in_software() {
    let bare = symbols("bare");
    assert_eq!(named(&bare, can_panic), [""; 0], "a panic can be reached");
    assert_eq!(named(&bare, in_software), [""; 0], "arithmetic in software");
    assert_eq!(named(&bare, allocates), [""; 0], "a heap");
    // The steps are there: square roots by the processor, and code of all methods.
    assert!(bare.contains_key("eclss_vsqrt_f32"));
    let (flash, _) = memory(&elf("bare"));
    assert!(flash > 20_000, "{flash} bytes hold no five methods");
}

/// The search finds what it searches for: firmware panics in places outside of the step.
#[test]
fn panics_are_found_where_there_are_some() {
    for program in PROGRAMS {
        assert!(!named(&symbols(program), can_panic).is_empty(), "{program}");
    }
    for name in ["__aeabi_dmul", "__aeabi_f2d", "__aeabi_ul2f", "__adddf3", "__floatundisf", "__fixsfdi"] {
        assert!(in_software(name), "{name}");
    }
    for name in ["__aeabi_memcpy4", "__aeabi_uldivmod", "_RNv5steps"] {
        assert!(!in_software(name), "{name}");
    }
}

/// A channel may carry the gap of a ledger, which is a sum in double precision: on request, and never in a step (see
/// [`a_step_cannot_panic_allocate_or_compute_in_software`]). Sums need no more than these.
const GAPS: [&str; 4] = ["__aeabi_d2f", "__aeabi_dadd", "__aeabi_dsub", "__aeabi_f2d"];

#[test]
fn no_firmware_has_a_heap_or_computes_in_software_but_for_gaps() {
    for program in PROGRAMS {
        let symbols = symbols(program);
        let beyond = |name: &str| in_software(name) && !GAPS.contains(&name);
        assert_eq!(named(&symbols, beyond), [""; 0], "{program}");
        assert_eq!(named(&symbols, allocates), [""; 0], "{program}");
    }
}

/// What the build keeps for a program when it decides whether a network fits is enough for the program.
#[test]
fn programs_take_no_more_than_is_kept_for_them() {
    let within = |name: &str, kept: Program, stack: u64| {
        let (flash, ram) = memory(&elf(name));
        assert!(flash <= kept.flash, "{name}: {flash} of {} bytes of flash", kept.flash);
        assert!(ram + stack <= kept.ram, "{name}: {ram} + {stack} of {} bytes of RAM", kept.ram);
        stack
    };
    let mut deepest = 0;
    for machine in MACHINES {
        let run = run(machine, &["seconds=2"]);
        let stack = run.after("stack ")[0].parse().expect("a number of bytes");
        deepest = within(&format!("qemu-{machine}"), MPS2, stack).max(deepest);
    }
    assert!(deepest > 500, "a stack of {deepest} bytes was not measured");
    // The same program on top of another board's drivers, whose stack only the board itself can measure.
    within("nucleo-h743zi2", NUCLEO, 2 * deepest);
}

/// On the board with tightly coupled memory the step runs from it.
#[test]
fn the_step_lies_in_tightly_coupled_memory() {
    let bytes = std::fs::read(elf("nucleo-h743zi2")).expect("just built");
    let file = ElfFile32::<Endianness>::parse(&*bytes).expect("an ELF file");
    let step = file.symbols().find(|symbol| {
        symbol.name().is_ok_and(|name| name.contains("NetworkPlant") && name.contains("4step"))
    });
    let step = step.expect("the step is a function of its own");
    assert!((1..0x1_0000).contains(&step.address()), "{:#x}", step.address());
}
