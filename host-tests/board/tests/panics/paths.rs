//! Paths to a panic in a program's ELF file: functions that branch to an entry point of the panic machinery.
//!
//! A call through a pointer to an entry point is not found; the compiler makes none for a panic.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use addr2line::gimli::{self, Dwarf, EndianSlice, LittleEndian};
use addr2line::{Context, demangle_auto};
use object::{File, Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use crate::branches::{Branch, branches};

type Debug<'e> = Context<EndianSlice<'e, LittleEndian>>;

/// A path to a panic. Functions are named without the compiler's hash, and are those of the source: inlining does not
/// change them.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Path {
    /// The function that can panic, of this workspace or of a library other than `core`.
    pub caller: String,
    /// Entry point of the panic machinery.
    pub entry: String,
}

/// All paths to a panic.
///
/// # Panics
/// If it is not an ELF file with symbols, debug information, and entry points of panics.
pub fn paths(elf: &[u8]) -> BTreeSet<Path> {
    let file = File::parse(elf).expect("cargo built an ELF");
    let functions = functions(&file);
    assert!(functions.values().any(|name| is_entry(name)), "the program has symbols, and can panic");
    let debug = debug(elf, &file);
    let mut found = BTreeSet::new();
    for Branch { at, target } in all_branches(&file) {
        let Some(entry) = functions.get(&target).filter(|name| is_entry(name)) else { continue };
        let function = functions.range(..=at).next_back().map(|(_, name)| name.clone()).unwrap_or_default();
        if !is_entry(&function) {
            let caller = source_function(&debug, at).unwrap_or(function);
            found.insert(Path { caller, entry: entry.clone() });
        }
    }
    found
}

/// Entry points: the handler, and the functions of `core` that do nothing but panic.
fn is_entry(name: &str) -> bool {
    let is_of_core = name.starts_with("core::") && !name.starts_with("core::panic::");
    name.ends_with("rust_begin_unwind") || (is_of_core && (name.contains("panic") || name.contains("_fail")))
}

/// Functions by their address.
fn functions(file: &File) -> BTreeMap<u32, String> {
    let functions = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text);
    functions
        .filter_map(|symbol| {
            let name = symbol.name().ok().filter(|name| !name.starts_with('$'))?;
            // Bit 0 of a function's address is the instruction set, Thumb.
            Some((symbol.address() as u32 & !1, demangled(name.into())))
        })
        .collect()
}

fn demangled(name: Cow<'_, str>) -> String {
    demangle_auto(name, None).into_owned()
}

/// Branches of all code.
fn all_branches(file: &File) -> Vec<Branch> {
    let marks = marks(file);
    let mut found = Vec::new();
    for section in file.sections().filter(|section| section.kind() == SectionKind::Text) {
        let bytes = section.data().unwrap_or_default();
        for (start, code) in code(&marks, section.address() as u32, bytes) {
            found.extend(branches(start, code));
        }
    }
    found
}

/// Where code begins (`true`) and where data begins, by the mapping symbols (ELF for the Arm Architecture, 5.5.5).
fn marks(file: &File) -> BTreeMap<u32, bool> {
    let mark = |name: &str| match name.get(..2) {
        Some("$t") => Some(true),
        Some("$d") => Some(false),
        _ => None,
    };
    file.symbols().filter_map(|symbol| Some((symbol.address() as u32, mark(symbol.name().ok()?)?))).collect()
}

/// Pieces of a section that are code.
fn code<'b>(marks: &BTreeMap<u32, bool>, start: u32, bytes: &'b [u8]) -> Vec<(u32, &'b [u8])> {
    let end = start + bytes.len() as u32;
    let inside: Vec<(u32, bool)> = marks.range(start..end).map(|(address, is_code)| (*address, *is_code)).collect();
    let ends = inside.iter().skip(1).map(|(address, _)| *address).chain([end]);
    let pieces = inside.iter().zip(ends).filter(|((_, is_code), _)| *is_code);
    pieces
        .filter_map(|((from, _), to)| Some((*from, bytes.get((from - start) as usize..(to - start) as usize)?)))
        .collect()
}

fn debug<'e>(elf: &'e [u8], file: &File<'e>) -> Debug<'e> {
    let section = |name: &str| file.section_by_name(name).and_then(|section| section.file_range());
    let dwarf = Dwarf::load(|id| {
        let bytes = section(id.name()).and_then(|(from, size)| elf.get(from as usize..(from + size) as usize));
        Ok::<_, gimli::Error>(EndianSlice::new(bytes.unwrap_or_default(), LittleEndian))
    });
    let context = dwarf.and_then(Context::from_dwarf);
    context.expect("the firmware's profile has debug information")
}

/// The innermost function around an instruction that is not one of `core`, whose functions pass a panic on; `None` without
/// debug information.
fn source_function(debug: &Debug, at: u32) -> Option<String> {
    let mut frames = debug.find_frames(at.into()).skip_all_loads().ok()?;
    let mut name = None;
    // From the innermost function to the one that it was inlined into.
    while let Some(frame) = frames.next().ok()? {
        name = Some(demangled(frame.function?.raw_name().ok()?));
        if !frame.location.and_then(|location| location.file)?.contains("/library/core/src/") {
            break;
        }
    }
    name
}
