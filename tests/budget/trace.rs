//! What a step does, instruction by instruction: cycles on a Cortex-M4, and which part of the source asked for it.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::Path;

use addr2line::Loader;
use object::read::elf::ElfFile32;
use object::{Endianness, Object as _, ObjectSection as _, ObjectSymbol as _};

use crate::emulator;
use crate::thumb::{Cost, cost};

/// Parts of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    /// The method's own arithmetic, with the operator φ and its loops.
    Equations,
    /// Laws of active elements.
    Laws,
    /// What is known of stability.
    Margin,
    /// Values of scheduled inputs.
    Schedule,
    /// Sums of what was moved.
    Ledger,
    /// Whether values are in range.
    Health,
    /// Counting time, finding buffers.
    Rest,
}

impl Part {
    /// All parts with their column's name.
    pub(crate) const ALL: [(Self, &'static str); 7] = [
        (Self::Equations, "equations"),
        (Self::Laws, "laws"),
        (Self::Margin, "margin"),
        (Self::Schedule, "schedule"),
        (Self::Ledger, "ledger"),
        (Self::Health, "health"),
        (Self::Rest, "rest"),
    ];
}

/// One traced step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Step {
    /// Instructions by part, in the order of [`Part::ALL`].
    pub(crate) parts: [u32; Part::ALL.len()],
    /// Estimated cycles.
    pub(crate) cycles: u32,
}

impl Step {
    /// All instructions.
    pub(crate) fn instructions(&self) -> u32 {
        self.parts.iter().sum()
    }
}

/// The program as the trace's addresses need it.
struct Program {
    source: Loader,
    /// Address and bytes of the sections with code.
    code: Vec<(u64, Vec<u8>)>,
    begin: (u64, u64),
    end: u64,
    known: HashMap<u64, (Cost, Option<Part>, bool)>,
}

/// Runs the fast scenario with a method and returns its steps.
pub(crate) fn steps(machine: &str, method: &str, folder: &Path) -> Vec<Step> {
    let file = folder.join(format!("{method}.trace"));
    let run = emulator::trace(machine, &[&format!("trace={method}")], &file);
    assert!(run.status.success(), "{}", run.log.join("\n"));
    let steps = Program::open(&emulator::elf("measure")).steps(&file);
    // Only ever of use to this run.
    std::fs::remove_file(&file).expect("just written");
    steps
}

impl Program {
    fn open(elf: &Path) -> Self {
        let bytes = std::fs::read(elf).expect("just built");
        let file = ElfFile32::<Endianness>::parse(&*bytes).expect("an ELF file of a 32-bit processor");
        let code = file.sections().filter(|section| section.kind() == object::SectionKind::Text);
        let code = code.map(|section| (section.address(), section.data().expect("code").to_vec())).collect();
        let symbol = |name: &str| {
            let found = file.symbols().find(|symbol| symbol.name() == Ok(name)).expect("it is a function");
            (found.address() & !1, found.size())
        };
        let (begin, end) = (symbol("trace_begin"), symbol("trace_end").0);
        Self { source: Loader::new(elf).expect("debug information"), code, begin, end, known: HashMap::new() }
    }

    /// Reads the trace and cuts it into steps.
    fn steps(&mut self, file: &Path) -> Vec<Step> {
        let (mut steps, mut inside) = (Vec::new(), false);
        let mut last: Option<(u64, Cost)> = None;
        let mut part = Part::Rest;
        for line in BufReader::new(File::open(file).expect("QEMU wrote it")).lines() {
            let line = line.expect("text");
            let Some(address) = address(&line) else { continue };
            if (self.begin.0..self.begin.0 + self.begin.1).contains(&address) {
                inside = true;
                last = None;
                steps.push(Step::default());
                continue;
            }
            if address == self.end {
                inside = false;
            }
            if !inside {
                continue;
            }
            let (cost, own, calling) = self.known(address);
            // Each instruction of `trace_begin` opens a step; the last one is the step.
            let Some(step) = steps.last_mut().filter(|_| !calling) else { continue };
            // Code without a source line of ours (a square root, a copy) belongs to whoever called it.
            part = own.unwrap_or(part);
            step.parts[part as usize] += 1;
            step.cycles += cost.cycles;
            if let Some((before, cost_before)) = last {
                if before + u64::from(cost_before.length) != address {
                    step.cycles += cost_before.when_taken;
                }
                if cost_before.writes.is_some() && cost.reads.contains(&cost_before.writes) {
                    step.cycles += 1;
                }
            }
            last = Some((address, cost));
        }
        steps.retain(|step| step.instructions() > 0);
        steps
    }

    /// Cost of the instruction at an address, the part that it belongs to, whether it only calls the step.
    fn known(&mut self, address: u64) -> (Cost, Option<Part>, bool) {
        if let Some(known) = self.known.get(&address) {
            return *known;
        }
        let mut own = None;
        let mut calling = false;
        let mut frames = self.source.find_frames(address).expect("debug information");
        while let Some(frame) = frames.next().expect("debug information") {
            let function =
                frame.function.and_then(|name| name.demangle().map(std::borrow::Cow::into_owned).ok());
            let function = function.unwrap_or_default();
            let file = frame.location.and_then(|place| place.file).unwrap_or_default();
            own = own.or_else(|| part_of(file, bare_name(&function)));
            calling = file.ends_with("measure/networks.rs") && function.contains("traced");
        }
        let known = (cost(self.half(address), self.half(address + 2)), own, calling);
        self.known.insert(address, known);
        known
    }

    /// The half word at an address.
    fn half(&self, address: u64) -> u16 {
        let section =
            self.code.iter().find(|(start, code)| (*start..start + code.len() as u64).contains(&address));
        let Some((start, code)) = section else { return 0 };
        let at = (address - start) as usize;
        code.get(at..at + 2).map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]))
    }
}

/// `Trace 0: 0x7f… [00400000/00000134/…] name` → 0x134.
fn address(line: &str) -> Option<u64> {
    let (_, rest) = line.split_once('[')?;
    u64::from_str_radix(rest.split('/').nth(1)?, 16).ok()
}

/// The last part of a function's path, without type parameters and hash.
fn bare_name(path: &str) -> &str {
    let path = path.split("::<").next().unwrap_or(path);
    let is_hash = |name: &str| name.len() == 17 && name.starts_with('h');
    path.rsplit("::").find(|name| !is_hash(name)).unwrap_or(path)
}

/// The part that a source line stands for; `None` where whoever inlined it decides.
fn part_of(file: &str, function: &str) -> Option<Part> {
    let place = file.split_once("core/src/").map(|(_, place)| place)?;
    if file.contains("library/") {
        return None;
    }
    match (place, function) {
        ("schedule.rs", _) | (_, "follow_schedules") => Some(Part::Schedule),
        ("math.rs", "beyond") | ("simulator/health.rs", _) => Some(Part::Health),
        ("operator.rs", "phi" | "stiffness") => Some(Part::Equations),
        ("operator.rs", _) => Some(Part::Margin),
        (_, "book" | "transfer" | "add_mass") => Some(Part::Ledger),
        _ if place.starts_with("simulator") => Some(Part::Rest),
        _ if place.starts_with("element") => Some(Part::Laws),
        _ if place.starts_with("method") => Some(Part::Equations),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_read_from_either_version_of_the_trace() {
        let line = "Trace 0: 0x7f43d8000100 [00400000/00000134/00000110/ff021201] main";
        assert_eq!(address(line), Some(0x134));
        assert_eq!(address("----------------"), None);
    }

    #[test]
    fn names_lose_types_and_hashes() {
        assert_eq!(bare_name("eclss_core::method::common::book::h104df6d0f70b0b69"), "book");
        assert_eq!(bare_name("eclss_core::method::relaxation::step::<AnyComponent, true>"), "step");
        assert_eq!(bare_name("trace_end"), "trace_end");
    }

    #[test]
    fn lines_belong_to_parts() {
        for (file, function, part) in [
            ("/x/core/src/element/valve.rs", "law", Some(Part::Laws)),
            ("/x/core/src/method/common.rs", "book", Some(Part::Ledger)),
            ("/x/core/src/math.rs", "pow", None),
            ("/rustc/src/library/core/src/num/f32.rs", "abs", None),
            ("/x/core/src/operator.rs", "margin", Some(Part::Margin)),
            ("/x/core/src/simulator/health.rs", "outside", Some(Part::Health)),
            ("/x/core/src/simulator/compiled.rs", "step", Some(Part::Rest)),
        ] {
            assert_eq!(part_of(file, function), part, "{file}");
        }
    }
}
