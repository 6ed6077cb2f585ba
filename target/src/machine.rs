//! What every Cortex-M board shares: the fault record across a reset, the paths that end in one, the stack's
//! high-water mark.

use crate::board::StackUse;
use crate::boards::current::make_safe;
use crate::fault::{Fault, NO_RECORD, Record, decode, encode};
use core::panic::PanicInfo;
use core::ptr::{addr_of, addr_of_mut};

/// Lies where start-up code does not write, so that it outlives a reset.
#[unsafe(link_section = ".uninit.fault")]
#[allow(unsafe_code, reason = "placing a static")]
static mut RECORD: Record = NO_RECORD;

/// What stack memory is filled with before use. Unlikely as a value, invalid as an address.
const PAINT: u32 = 0xE0C1_55AA;
/// Left unpainted below the stack pointer, for the painting function itself \[bytes\].
const MARGIN: u32 = 256;

/// Addresses guarded below the stack \[bytes\]: a power of two, more than any one call's frame. The stack's lower
/// end, RAM's origin, is a multiple of it on every board.
const GUARD: u32 = 32 * 1024;
/// Fields of the memory protection unit's registers (ARM DDI 0403, B3.5).
const REGION_VALID: u32 = 1 << 4;
const EXECUTE_NEVER: u32 = 1 << 28;
const ENABLE_WITH_DEFAULT_MAP: u32 = 0b101;

#[allow(unsafe_code, reason = "symbols of the linker script")]
unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
}

/// Outputs safe, fault noted, processor reset.
pub fn stop(fault: Fault) -> ! {
    cortex_m::interrupt::disable();
    make_safe();
    // SAFETY: interrupts are off and this is the only core, so nobody else reads or writes the record.
    #[allow(unsafe_code, reason = "a static that outlives a reset has no initial value")]
    unsafe {
        addr_of_mut!(RECORD).write_volatile(encode(fault));
    }
    cortex_m::peripheral::SCB::sys_reset()
}

/// Clears the record without reading it.
pub fn forget_fault() {
    // SAFETY: called by start-up code, which runs alone.
    #[allow(unsafe_code, reason = "a static that outlives a reset has no initial value")]
    unsafe {
        addr_of_mut!(RECORD).write_volatile(NO_RECORD);
    }
}

/// The fault that the last run ended with, if it did; asking forgets it.
pub fn take_fault() -> Option<Fault> {
    cortex_m::interrupt::free(|_| {
        // SAFETY: three plain words, interrupts are off, one core.
        #[allow(unsafe_code, reason = "a static that outlives a reset has no initial value")]
        unsafe {
            let fault = decode(addr_of!(RECORD).read_volatile());
            addr_of_mut!(RECORD).write_volatile(NO_RECORD);
            fault
        }
    })
}

/// Guards and paints the stack; to be called first thing, before anything has gone deep.
pub fn prepare_stack() {
    guard_stack();
    paint_stack();
}

/// Forbids the memory protection unit every access just below the stack, so that an overflow traps even where
/// the bus would swallow it.
fn guard_stack() {
    let (end, _) = stack_bounds();
    // SAFETY: nobody else uses the unit, and the guarded addresses belong to nothing.
    #[allow(unsafe_code, reason = "the memory protection unit")]
    unsafe {
        let mpu = &*cortex_m::peripheral::MPU::PTR;
        mpu.rbar.write((end - GUARD) | REGION_VALID);
        mpu.rasr.write(EXECUTE_NEVER | ((GUARD.ilog2() - 1) << 1) | 1);
        mpu.ctrl.write(ENABLE_WITH_DEFAULT_MAP);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Fills the unused stack.
fn paint_stack() {
    let (end, _) = stack_bounds();
    let mut word = end;
    let limit = cortex_m::register::msp::read() - MARGIN;
    while word < limit {
        // SAFETY: [end, limit) is the stack's memory below everything in use.
        #[allow(unsafe_code, reason = "the stack has no name in Rust")]
        unsafe {
            (word as *mut u32).write_volatile(PAINT);
        }
        word += 4;
    }
}

/// How deep the stack has been: everything above the lowest word that lost its paint.
pub fn stack_use() -> StackUse {
    let (end, start) = stack_bounds();
    let mut word = end;
    // SAFETY: [end, start) is the stack's memory, all of it readable.
    #[allow(unsafe_code, reason = "the stack has no name in Rust")]
    while word < start && unsafe { (word as *const u32).read_volatile() } == PAINT {
        word += 4;
    }
    StackUse { size: start - end, deepest: start - word }
}

/// Lowest address of the stack, and the one just above it.
fn stack_bounds() -> (u32, u32) {
    (addr_of!(_stack_end) as u32, addr_of!(_stack_start) as u32)
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    stop(Fault::Panic { line: info.location().map_or(0, core::panic::Location::line) })
}

/// The processor's first step after a trap.
mod hard_fault {
    #![allow(unsafe_code, reason = "assembly")]

    // A stack overflow traps here with a stack pointer that is of no use, so the handler takes a fresh stack
    // before anything else. The old one is handed on: the processor left the trapped address on it.
    core::arch::global_asm!(
        ".section .HardFault.user,\"ax\",%progbits",
        ".global HardFault",
        ".type HardFault,%function",
        ".thumb_func",
        "HardFault:",
        "mrs r0, msp",
        "ldr r1, =_stack_start",
        "msr msp, r1",
        "b {trapped}",
        ".ltorg",
        trapped = sym super::trapped,
    );
}

extern "C" fn trapped(frame: u32) -> ! {
    let (end, start) = stack_bounds();
    if !(end..start - 28).contains(&frame) {
        stop(Fault::StackOverflow { sp: frame });
    }
    // SAFETY: the frame lies within the stack; its seventh word is the trapped instruction's address.
    #[allow(unsafe_code, reason = "the exception frame has no name in Rust")]
    let pc = unsafe { ((frame + 24) as *const u32).read_volatile() };
    stop(Fault::HardFault { pc })
}

#[cortex_m_rt::exception]
#[allow(unsafe_code, reason = "the attribute demands an unsafe function")]
unsafe fn DefaultHandler(number: i16) -> ! {
    stop(Fault::UnexpectedInterrupt { number: number.into() })
}
