"""Machine code of kernels: made of LLVM's modules, kept in files, loaded without numba.

A file holds the code of a kernel with everything that it calls, for one kind of processor. Loading
it takes a millisecond; importing numba, which is needed only to compile, takes half a second.
"""

import itertools
import os
import threading
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import llvmlite
import llvmlite.binding as llvm

from eyas.lanes.identity import digest, language_hash
from eyas.lanes.trusted import read_trusted, write_trusted

SUFFIX = ".eyk"  # End of the names of files of machine code

_LOCK = threading.Lock()

_LOADED: list[llvm.ResourceTracker] = []  # Kernels loaded, kept until the process ends

_NUMBERS = itertools.count()  # Numbers of the kernels that this process has tried to load


class MachineCode(NamedTuple):
    """Machine code of a kernel."""

    entry: str
    """Name of the function to call; different for each kernel, as all are loaded together."""
    needs: tuple[str, ...]
    """Functions outside the kernel that it calls, such as those of the C library."""
    code: bytes | memoryview  # An object file


class Cpu(NamedTuple):
    """A kind of processor, as LLVM names it."""

    triple: str
    name: str
    features: str


@cache
def cpu() -> Cpu:
    """Return the processor to compile for: this one, unless numba's variables name another."""
    name = os.environ.get("NUMBA_CPU_NAME") or llvm.get_host_cpu_name()
    features = os.environ.get("NUMBA_CPU_FEATURES")
    if features is None:
        features = llvm.get_host_cpu_features().flatten()
    return Cpu(llvm.get_process_triple(), name, features)


@cache
def _machine() -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    triple, name, features = cpu()
    target = llvm.Target.from_triple(triple)
    # Code reaches constants, which lie close to it (see `_linker`), by their distances; by their
    # addresses, shading would take 5 % more instructions.
    return target.create_target_machine(
        cpu=name, features=features, opt=3, reloc="pic", codemodel="small", jit=True
    )


_ROOTS = """
declare double @llvm.sqrt.f64(double)
declare float @llvm.sqrt.f32(float)

define double @sqrt(double %x) alwaysinline {
  %root = call double @llvm.sqrt.f64(double %x)
  ret double %root
}

define float @sqrtf(float %x) alwaysinline {
  %root = call float @llvm.sqrt.f32(float %x)
  ret float %root
}
"""
"""Square roots as the processor's instructions; the C library's set `errno` too."""


def optimised(module: llvm.ModuleRef, entry: str) -> MachineCode:
    """Return the machine code of a module, of which only the function `entry` is called."""
    module.link_in(llvm.parse_assembly(_ROOTS))
    improve(module, entry, _machine(), loops=True)
    needs = (f.name for f in module.functions if f.is_declaration)
    needed = tuple(sorted(name for name in needs if not name.startswith("llvm.")))
    return MachineCode(entry, needed, _machine().emit_object(module))


def improve(
    module: llvm.ModuleRef,  # Changed in place
    entry: str,  # Name of the function
    machine: llvm.TargetMachine,  # The processor to optimise for
    *,
    loops: bool,  # Whether loops may do several of their turns at once
) -> None:
    """Optimise a module, of which only the function `entry` is called."""
    for value in (*module.functions, *module.global_variables):
        if not value.is_declaration and value.name != entry:
            value.linkage = "internal"
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.loop_vectorization, tuning.slp_vectorization = loops, False
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)


@cache
def _linker() -> llvm.LLJIT:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_triple(cpu().triple).create_target_machine(jit=True)
    # JITLink puts a kernel's code and constants side by side, as its code expects; LLVM's older
    # linker may put them more than 2 GiB apart.
    return llvm.create_lljit_compiler(machine, use_jit_link=True, suppress_errors=True)


def load(code: MachineCode) -> int | None:
    """Return the address of a kernel's entry.

    None if this process lacks a function it needs, or this version of LLVM cannot read it.
    """
    library = llvm.JITLibraryBuilder().add_current_process().add_object_img(bytes(code.code))
    library.export_symbol(code.entry)
    with _LOCK:
        linker = _linker()
        for name in code.needs:
            address = llvm.address_of_symbol(name)
            if not address:
                return None
            library.import_symbol(name, address)
        try:
            loaded = library.link(linker, f"{code.entry}-{next(_NUMBERS)}")
        except RuntimeError:
            return None
        _LOADED.append(loaded)
    return int(loaded[code.entry])


def code_file(
    folder: Path,  # The folder of kernels
    name: str,  # From `eyas.lanes.identity.code_name`
    made_by: Iterable[str],  # What else the code depends on, except the processor and llvmlite
) -> Path:
    """Return the file of a kernel's machine code, `<name>-<hash of made_by>`."""
    by = (*cpu(), llvmlite.__version__, language_hash(), *made_by)
    return folder / f"{name}-{digest(by)}{SUFFIX}"


def read_code(path: Path) -> MachineCode | None:
    """Return the content of a file, or None, see `read_trusted`."""
    found = read_trusted(path)
    if found is None:
        return None
    entry, needs = found.header
    return MachineCode(entry, tuple(needs), found.pieces[0])


def write_code(path: Path, code: MachineCode) -> None:
    """Write a file completely or not at all; not at all if the folder cannot be written to."""
    write_trusted(path, [code.entry, code.needs], [code.code])
