//! The loop allocates nothing: counted in its own thread, with a link, a record and an armed peer.

use std::alloc::{GlobalAlloc, Layout as Memory, System};
use std::cell::Cell;

use crate::bench::{config, controller, job, network, place, settled};
use eclss_core::Signal;
use eclss_core::process::{InputState, OutputState, Process};
use eclss_core::protocol::{Link as Session, Role};
use eclss_core::signal::Owner;
use eclss_host_sim::HostBuffers;
use eclss_host_sim::hil::board::{Pc, note};
use eclss_host_sim::hil::handover::{Layout, ring};
use eclss_host_sim::hil::plant::HostPlant;
use eclss_host_sim::hil::runner::drive;
use eclss_host_sim::hil::shot::camera;
use eclss_host_sim::hil::tap::Tap;
use eclss_host_sim::trace::columns;
use eclss_target::control::Event;
use eclss_target::coupling::Coupling;
use eclss_target::wire::{Address, open};

/// Counts what the present thread asks of the system's allocator.
struct Counting;

thread_local! {
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    // A thread that is being torn down has nothing to count any more.
    let _ = CALLS.try_with(|calls| calls.set(calls.get() + 1));
}

// SAFETY: every call is the system allocator's, unchanged.
#[allow(unsafe_code, reason = "an allocator cannot be written otherwise")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, memory: Memory) -> *mut u8 {
        count();
        unsafe { System.alloc(memory) }
    }
    unsafe fn dealloc(&self, place: *mut u8, memory: Memory) {
        count();
        unsafe { System.dealloc(place, memory) }
    }
    unsafe fn realloc(&self, place: *mut u8, memory: Memory, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(place, memory, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn calls() -> u64 {
    CALLS.with(Cell::get)
}

#[test]
fn the_counter_counts() {
    let before = calls();
    drop(std::hint::black_box(Vec::<u8>::with_capacity(1_000)));
    assert_eq!(calls() - before, 2);
}

#[test]
fn the_loop_allocates_nothing() {
    let source = network("hil.toml");
    let step_us = 2_000;
    let path = place("allocations.sock");
    let address = |listens| Address::Unix { path: path.clone(), listens };
    let job = job(&source, step_us, 1_500);
    let loaded = &source.loaded;
    let described = loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator = buffers.simulator(&described, job.settings).unwrap();
    simulator.restore(&settled(&source, step_us)).unwrap();
    let signals: Vec<Signal> = columns(loaded).iter().map(|column| column.signal).collect();
    let layout = Layout { inputs: described.inputs.len(), figures: signals.len() };
    let (giver, mut taker) = ring(layout, 4_096);
    // Not every method has a bound of the spectral radius.
    let shown = loaded.standard_signals().into_iter().map(|named| named.signal);
    let shown = shown.filter(|signal| signal.output.owner() != Owner::Run).collect();
    let channels = loaded.process.inputs.len() + loaded.process.outputs.len();
    let (camera, mut album) = camera(loaded, shown, channels, 25);
    let (link, _keeper) = open(&address(true)).unwrap();
    // The controller's thread makes and cuts a session while the loop runs.
    let other = controller(&source, &address(false), step_us, 1_000);
    let (allocations, modes) = loaded.process.with_image(|image| {
        let mut inputs = vec![InputState::new(0.0); image.inputs.len()];
        let mut outputs = vec![OutputState::new(0.0); image.outputs.len()];
        let process = Process::new(image, 2e-3, &mut inputs, &mut outputs).unwrap();
        let session = Session::new(config(&source, Role::Plant, step_us), 5);
        let mut coupling = Coupling::new(process, 2e-3, Some(session));
        let tap = Tap::new(signals, layout.inputs, Some(giver), Some(camera));
        let mut plant = HostPlant::new(simulator, &tap);
        let (_orders_in, orders) = rtrb::RingBuffer::new(8);
        let mut board = Pc::new(&tap, Some(link), orders, (true, true), None);
        let mut modes = Vec::with_capacity(64);
        let before = calls();
        drive(&mut board, &mut plant, &mut coupling, &job, |event| {
            note(&tap, &event);
            if let Event::Mode { to, .. } = event {
                modes.push(to.name());
            } else if let Event::Safe { .. } = event {
                modes.push("SAFE");
            }
        });
        let allocations = calls() - before;
        // Hands the last tick over.
        board.measured();
        (allocations, modes)
    });
    other.join().unwrap();
    assert_eq!(allocations, 0);
    assert!(modes.contains(&"RUN") && modes.contains(&"SAFE"), "both were part of it: {modes:?}");
    let mut rows = 0;
    while taker.take().is_some() {
        rows += 1;
    }
    assert_eq!(rows, 1_500);
    // Nobody looked while it ran: four shots wait, and the others are counted.
    let mut shots = 0;
    album.look(|shot| {
        assert!(shot.values.iter().all(|value| value.is_finite()));
        shots += 1;
    });
    assert_eq!(shots, 4);
}
