//! What a tick was, gathered while it runs by plant, board and loop, and handed over when it has ended.

use std::cell::RefCell;

use eclss_core::mode::{Machine, Mode};
use eclss_core::{Signal, Simulator};
use eclss_target::account::Account;
use eclss_target::coupling::Coupling;

use super::handover::{Giver, Head, Layout};
use super::shot::Camera;

/// The present tick. Board and plant share it; both live in the loop's thread, one after the other.
#[derive(Debug)]
pub struct Tap {
    signals: Vec<Signal>,
    figures: Vec<f32>,
    /// Value and slope of every input slot that was set in this tick; NaN for one that was left as it is.
    inputs: Vec<[f32; 2]>,
    giver: Option<Giver>,
    camera: Option<Camera>,
    layout: Layout,
    plant_tick: u64,
    stepped: bool,
    mode: Mode,
    skipped: u32,
}

/// Nothing was set.
const LEFT: [f32; 2] = [f32::NAN; 2];

impl Tap {
    /// Gathers `signals` and `slots` inputs for `giver`, and shots for `camera`, if there are such.
    pub fn new(
        signals: Vec<Signal>,
        slots: usize,
        giver: Option<Giver>,
        camera: Option<Camera>,
    ) -> RefCell<Self> {
        let layout = Layout { inputs: slots, figures: signals.len() };
        RefCell::new(Self {
            figures: vec![f32::NAN; signals.len()],
            inputs: vec![LEFT; slots],
            signals,
            giver,
            camera,
            layout,
            plant_tick: 0,
            stepped: false,
            mode: Mode::PowerUp,
            skipped: 0,
        })
    }

    /// Takes note of an input that was set for the coming step.
    pub fn input(&mut self, slot: usize, value: f32, slope_per_s: f32) {
        if let Some(place) = self.inputs.get_mut(slot) {
            *place = [value, slope_per_s];
        }
    }

    /// Reads the figures.
    pub fn read(&mut self, simulator: &Simulator<'_>, stepped: bool) {
        if let Some(camera) = &mut self.camera {
            camera.read(simulator);
        }
        if self.giver.is_none() {
            return;
        }
        simulator.read_signals(&self.signals, &mut self.figures);
        self.plant_tick = simulator.tick();
        self.stepped |= stepped;
    }

    /// Takes note of the mode.
    pub fn mode(&mut self, mode: Mode) {
        self.mode = mode;
    }

    /// Returns the mode.
    pub fn present_mode(&self) -> Mode {
        self.mode
    }

    /// Ends a tick for the page.
    pub fn observe(&mut self, account: &Account, machine: &Machine, coupling: &Coupling<'_>) {
        if let Some(camera) = &mut self.camera {
            camera.observe(account, machine, coupling);
        }
    }

    /// Takes note of releases that the tick ran over.
    pub fn skipped(&mut self, releases: u32) {
        self.skipped = releases;
    }

    /// Hands the tick over and begins the next.
    pub fn finish(&mut self, tick: u64, begun_us: u64, late_ns: u64, tick_ns: u64) {
        let short = |ns: u64| u32::try_from(ns).unwrap_or(u32::MAX);
        let head = Head {
            tick,
            plant_tick: self.plant_tick,
            begun_us,
            late_ns: short(late_ns),
            tick_ns: short(tick_ns),
            skipped: self.skipped,
            mode: self.mode as u8,
            stepped: self.stepped,
            dropped: 0,
        };
        if let Some(camera) = &mut self.camera {
            camera.note(head.tick_ns);
        }
        if let Some(giver) = &mut self.giver {
            giver.give(head, self.inputs.iter().copied(), self.figures.iter().copied(), self.layout);
        }
        self.inputs.fill(LEFT);
        (self.stepped, self.skipped) = (false, 0);
    }

    /// Rows that could not be handed over.
    pub fn dropped(&self) -> u32 {
        self.giver.as_ref().map_or(0, Giver::dropped)
    }
}
