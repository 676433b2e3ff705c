"""Code of kernels for NVIDIA's graphics processors, in their assembly language PTX.

The modules that become machine code of the processor become PTX here, by another part of the same
LLVM; so one source, one front end and one optimiser serve both, and no operation is fused, which
would give other bytes. Neither CUDA nor a graphics processor is needed for it.
"""

import re
from contextlib import nullcontext
from typing import Any

import llvmlite.binding as llvm
import numba

from eyas.lanes.calls import CompiledCall
from eyas.lanes.compilation import entry_module
from eyas.lanes.machine_code import improve
from eyas.lanes.targets import lanes_as_threads
from eyas.lanes.vector import BLOCK, WIDTH
from eyas.lanes.vector.threads import RECORD

_TRIPLE = "nvptx64-nvidia-cuda"

_REGISTERS = 128
"""Registers of a thread at most. A card that has 65,536 of them then runs 512 threads: with more
registers, pictures took a quarter longer on an H200, with 64 or 96 some percent."""

_INSTRUCTIONS = {
    "sqrt": ("double", "llvm.sqrt.f64"),
    "sqrtf": ("float", "llvm.sqrt.f32"),
    "floor": ("double", "llvm.floor.f64"),
    "floorf": ("float", "llvm.floor.f32"),
    "ceil": ("double", "llvm.ceil.f64"),
    "ceilf": ("float", "llvm.ceil.f32"),
}
"""Functions of the C library that are instructions, and LLVM's names for these."""


def ptx_of(
    call: CompiledCall,
    bundles: tuple[tuple[Any, ...], ...],
    name: str,
    processor: str = "sm_80",
    *,
    threads: int = 1,
) -> str:
    """Return the PTX of a compiled function and of all that it calls.

    Args:
        call: The function.
        bundles: What it is called with; only their types count.
        name: Of the entry. It takes the address of the table of pointers, the number of the first
            worker, and how many there are; threads beyond the last worker do nothing.
        processor: LLVM's name of the oldest graphics processor to serve.
        threads: Threads that are one worker, see `eyas.lanes.device.Device.launch`.
    """
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple(_TRIPLE)
    machine = target.create_target_machine(cpu=processor, features="+ptx80", opt=3)
    kinds = [numba.typeof(bundle) for bundle in bundles]
    with lanes_as_threads() if threads > 1 else nullcontext():
        module = entry_module(
            call.function, kinds, f"{name}_status", over_workers=call.over_workers
        )
    retargeted = _retargeted(str(module), name, str(machine.target_data), threads)
    module = llvm.parse_assembly(retargeted)
    module.verify()
    for function in module.functions:  # what threads do together may not be moved into branches
        function.add_function_attribute("convergent")
    # Loops that do several turns at once need more registers, which all threads share.
    improve(module, name, machine, loops=False)
    _without_failures(module, machine)
    module = llvm.parse_assembly(_with_shared_records(str(module)))
    module.verify()
    text: str = machine.emit_assembly(module)
    head, entry, body = text.partition(f".entry {name}(")
    limits = f".maxnreg {_REGISTERS}\n" + (f".maxntid {BLOCK}\n" if threads > 1 else "")
    return head + entry + body.replace("\n)\n", f"\n)\n{limits}", 1)


def _without_failures(module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Leave out what callers do if a function fails that, as it is now known, never does.

    A way out of a loop is more than an instruction: threads that have gone different ways would
    meet again where all ways end, not at the end of the turn.
    """
    passes = llvm.create_new_module_pass_manager()
    if not hasattr(passes, "add_ipsccp_pass"):  # llvmlite before 0.45: same bytes, longer waits
        return
    passes.add_ipsccp_pass()
    passes.add_simplify_cfg_pass()
    passes.add_instruction_combine_pass()
    passes.add_simplify_cfg_pass()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))


def _retargeted(text: str, name: str, layout: str, threads: int) -> str:
    """Return a module's text for the graphics processor, with its entry."""
    text = re.sub(r'target triple = "[^"]*"', f'target triple = "{_TRIPLE}"', text)
    text = re.sub(r'target datalayout = "[^"]*"', f'target datalayout = "{layout}"', text)
    text = re.sub(r'"target-(cpu|features)"="[^"]*"', "", text)
    parts = []
    for function, (kind, instruction) in _INSTRUCTIONS.items():
        text, found = re.subn(rf"declare[^\n]*@{function}\([^\n]*\n", "", text)
        if found and f"declare {kind} @{instruction}(" not in text:
            parts.append(f"declare {kind} @{instruction}({kind})")
        if found:
            parts.append(
                f"define {kind} @{function}({kind} %x) alwaysinline {{\n"
                f"  %y = call {kind} @{instruction}({kind} %x)\n  ret {kind} %y\n}}"
            )
    for register in ("tid", "ntid", "ctaid"):
        special = f"@llvm.nvvm.read.ptx.sreg.{register}.x("
        if special not in text:
            parts.append(f"declare i32 {special})")
    parts.append(_ENTRY.format(name=name, shift=threads.bit_length() - 1))
    return "\n".join([text, *parts])


def _with_shared_records(text: str) -> str:
    """Return a module's text in which records that are left on the stack are shared by the lanes of
    a worker. Each with its own copy, threads would need more memory than the fastest of the card.
    """
    globals_: list[str] = []

    def shared(found: re.Match[str]) -> str:
        record, kind = found[1], found[2]
        name = f"@shared.{len(globals_)}"
        # LLVM may have aligned the record to 16 bytes; the second part gives all places that.
        every = f"[{BLOCK // WIDTH} x {{ {kind}, i128 }}]"
        globals_.append(f"{name} = internal addrspace(3) global {every} undef, align 16\n")
        return (
            f"  {record}.thread = call i32 @llvm.nvvm.read.ptx.sreg.tid.x()\n"
            f"  {record}.worker = lshr i32 {record}.thread, {WIDTH.bit_length() - 1}\n"
            f"  {record}.place = getelementptr {every}, ptr addrspace(3) {name}, i32 0, "
            f"i32 {record}.worker, i32 0\n"
            f"  {record} = addrspacecast ptr addrspace(3) {record}.place to ptr\n"
        )

    # What marks from when to when a place on the stack is used says nothing of others.
    text = re.sub(rf"[^\n]*@llvm\.lifetime\.[^\n]*%{RECORD}[^\n]*\n", "", text)
    text = re.sub(rf"  (%{RECORD}[\w.]*) = alloca (.*), align \d+\n", shared, text)
    return text + "".join(globals_)


_ENTRY = """
define ptx_kernel void @{name}(ptr %parts, i64 %first, i64 %workers) {{
  %thread = call i32 @llvm.nvvm.read.ptx.sreg.tid.x()
  %threads = call i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
  %block = call i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
  %a = zext i32 %thread to i64
  %b = zext i32 %threads to i64
  %c = zext i32 %block to i64
  %d = mul i64 %b, %c
  %number = add i64 %a, %d
  %group = lshr i64 %number, {shift}
  %worker = add i64 %group, %first
  %in = icmp ult i64 %worker, %workers
  br i1 %in, label %work, label %end
work:
  %status = call i32 @{name}_status(ptr %parts, i64 %worker, i64 %workers)
  br label %end
end:
  ret void
}}
"""
"""The entry, in LLVM's language; `threads` of a worker is two to the power of `shift`."""
