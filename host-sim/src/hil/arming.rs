//! `--arm`: hardware is armed once, as soon as that is granted, and never against the operator.

use eclss_core::mode::{Mode, Request};

/// Whether `--arm` still stands. It ends with the first arming, with SAFE, and with the operator's disarm or stop, so
/// that what comes after is the operator's to arm.
#[derive(Debug, Clone, Copy)]
pub struct Arming {
    stands: bool,
}

impl Arming {
    /// Starts as asked for on the command line.
    pub fn new(stands: bool) -> Self {
        Self { stands }
    }

    /// Takes note of the loop's mode.
    pub fn observe(&mut self, mode: Mode) {
        self.stands &= !mode.is_armed() && mode != Mode::Safe;
    }

    /// Takes note of an operator's request, which may not have reached the loop yet.
    pub fn request(&mut self, request: Request) {
        self.stands &= !matches!(request, Request::Disarm | Request::Stop);
    }

    /// Whether arming is to be requested in this mode.
    pub fn is_due(self, mode: Mode) -> bool {
        self.stands && mode == Mode::Ready
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hardware_is_armed_once() {
        let mut arming = Arming::new(true);
        for mode in [Mode::PowerUp, Mode::Init, Mode::Ready] {
            arming.observe(mode);
            assert_eq!(arming.is_due(mode), mode == Mode::Ready);
        }
        for ended in [Mode::Run, Mode::Hold, Mode::Safe] {
            let mut arming = arming;
            arming.observe(ended);
            assert!(!arming.is_due(Mode::Ready), "after {}", ended.name());
        }
        assert!(!Arming::new(false).is_due(Mode::Ready));
    }

    #[test]
    fn an_order_against_it_counts_before_it_is_done() {
        for (request, stands) in
            [(Request::Disarm, false), (Request::Stop, false), (Request::Restart, true), (Request::Arm, true)]
        {
            let mut arming = Arming::new(true);
            arming.request(request);
            assert_eq!(arming.is_due(Mode::Ready), stands, "{request:?}");
        }
    }
}
