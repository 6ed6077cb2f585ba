//! Nothing but steps: an image in which every symbol is one that a step needs. It is never run; its symbols are
//! read by `tests/tests/qemu_elf.rs`, which finds out whether a step can panic, allocate or compute in `f64`.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;
use eclss_core::{AnyComponent, Compiled, CompiledSimulator, Health, Method, Network, Settings, Simulator};

#[allow(clippy::unreadable_literal, clippy::excessive_precision, reason = "generated")]
#[allow(missing_docs, dead_code, unreachable_pub, reason = "generated")]
mod table {
    include!(concat!(env!("OUT_DIR"), "/network.rs"));
}

/// The network under any of the methods.
struct With<const METHOD: usize>;

impl<const METHOD: usize> Compiled for With<METHOD> {
    type Element = AnyComponent;
    const NETWORK: Network<'static> = table::Configured::NETWORK;
    const SETTINGS: Settings = Settings { method: Method::ALL[METHOD], step_us: table::STEP_US };
}

fn specialised<const METHOD: usize>(address: usize) -> Health {
    // SAFETY: never run. Where the simulator comes from must not be seen by the compiler.
    #[allow(unsafe_code, reason = "a simulator from nowhere, so that nothing but the step is linked")]
    let simulator = unsafe { &mut *(black_box(address) as *mut CompiledSimulator<'static, With<METHOD>>) };
    simulator.step()
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut address = 0x2000_0000;
    loop {
        let health = [
            specialised::<0>(address),
            specialised::<1>(address),
            specialised::<2>(address),
            specialised::<3>(address),
            specialised::<4>(address),
        ];
        black_box(health);
        // SAFETY: as above; the step of a network that is loaded at run time, with any method and element.
        #[allow(unsafe_code, reason = "a simulator from nowhere, so that nothing but the step is linked")]
        let simulator = unsafe { &mut *(black_box(address) as *mut Simulator<'static>) };
        black_box(simulator.step());
        address += 4;
    }
}

/// Linked only if something can panic; the test looks for what calls it.
#[panic_handler]
fn panic(_info: &PanicInfo) -> ! {
    loop {}
}
