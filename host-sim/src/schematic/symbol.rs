//! Symbols of elements, after ISO 10628-2 and ISO 14617 where these have one.
//!
//! Each is drawn around the origin for a flow to the right, in a square of side 2.

/// Draws the symbol of `kind`; `None` for a kind that has none.
pub(super) fn symbol(kind: &str) -> Option<&'static str> {
    Some(match kind {
        "pipe" => r#"<path class="body" d="M-1-.4H1V.4H-1Z"/>"#,
        // A duct with the two taps of a pressure measurement.
        "reference_pipe" => {
            r#"<path class="body" d="M-1-.4H1V.4H-1Z"/><path d="M-.55-.4V-.85M.55-.4V-.85M-.7-.85H-.4M.4-.85H.7"/>"#
        }
        "valve" => r#"<path class="body" d="M-.95-.6L.95.6V-.6L-.95.6Z"/><path d="M0 0V-.8M-.4-.8H.4"/>"#,
        "fan" => {
            r#"<circle class="body" r=".95"/><path d="M-.62-.72L.86-.4M-.62.72L.86.4"/><circle class="hub" r=".16"/>"#
        }
        "pump" => r#"<circle class="body" r=".95"/><path class="hub" d="M-.5-.8L.95 0L-.5.8Z"/>"#,
        // A condensing heat exchanger: coil, and a drop that leaves.
        "heat_exchanger" | "condenser" => {
            r#"<path class="body" d="M-.95-.75H.95V.75H-.95Z"/><path d="M-.95 0H-.6L-.35-.5L0 .5L.35-.5L.6 0H.95"/><path class="hub" d="M.62.28C.9.62.78.68.62.68C.46.68.34.62.62.28Z"/>"#
        }
        // Its other side, or one between liquids: the coil alone.
        "coolant_side" | "interface_exchanger" => {
            r#"<path class="body" d="M-.95-.75H.95V.75H-.95Z"/><path d="M-.95 0H-.6L-.35-.5L0 .5L.35-.5L.6 0H.95"/>"#
        }
        // A heater, or with negative power a cold plate.
        "heater" => {
            r#"<path class="body" d="M-.95-.6H.95V.6H-.95Z"/><path d="M-.7 .3L-.45-.3L-.15 .3L.15-.3L.45 .3L.7-.3"/>"#
        }
        "bed" => {
            r#"<path class="body" d="M-.8-.7Q-.8-.95 0-.95T.8-.7V.7Q.8.95 0 .95T-.8.7Z"/><path d="M-.8-.5H.8M-.8.5H.8M-.8-.1L-.2-.5M-.8.4L.55-.5M-.55.5L.8-.4M.2.5L.8.1"/>"#
        }
        "orifice" => r#"<path class="body" d="M-.9-.6H.9V.6H-.9Z"/><path d="M0-.6V-.18M0 .6V.18"/>"#,
        "check_valve" => r#"<path class="body" d="M-.8-.65L.7 0L-.8.65Z"/><path d="M.75-.65V.65"/>"#,
        "relief_valve" => {
            r#"<path class="body" d="M-.95-.6L.95.6V-.6L-.95.6Z"/><path d="M0 0V-.35L-.25-.5L.25-.65L-.25-.8L0-.95"/>"#
        }
        "pressure_regulator" => {
            r#"<path class="body" d="M-.95-.5L.95.7V-.5L-.95.7Z"/><path class="body" d="M-.5-.4A.5.5 0 0 1 .5-.4Z"/><path d="M0 .1V-.4"/>"#
        }
        "hatch" => {
            r#"<path class="body" d="M-.5-.9H.5V.9H-.5Z"/><path d="M-.5-.9L.2-.6V.6L-.5.9"/><circle class="hub" cx="-.02" r=".1"/>"#
        }
        "leak" => {
            r#"<path class="body" d="M-.9-.45H.9V.45H-.9Z"/><path d="M-.2-.45L.1-.1L-.1.1L.2.45M.35-.6L.6-.95M0-.6V-.95M-.35-.6L-.6-.95"/>"#
        }
        _ => return None,
    })
}

/// A box for what has no symbol; its name is written into it.
pub(super) const NAMELESS: &str = r#"<path class="body" d="M-1-.7H1V.7H-1Z"/>"#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_that_a_file_can_name_has_a_symbol() {
        for kind in [
            "pipe",
            "reference_pipe",
            "valve",
            "fan",
            "pump",
            "heat_exchanger",
            "bed",
            "condenser",
            "coolant_side",
            "interface_exchanger",
            "heater",
            "orifice",
            "leak",
            "check_valve",
            "relief_valve",
            "pressure_regulator",
            "hatch",
        ] {
            assert!(symbol(kind).is_some(), "{kind}");
        }
        assert_eq!(symbol("flux_capacitor"), None);
    }
}
