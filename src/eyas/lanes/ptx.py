"""Code of kernels for NVIDIA's graphics processors, in their assembly language PTX.

The modules that become machine code of the processor become PTX here, by another part of the same
LLVM; so one source, one front end and one optimiser serve both, and no operation is fused, which
would give other bytes. Neither CUDA nor a graphics processor is needed for it.
"""

import re
from typing import Any

import llvmlite.binding as llvm
import numba

from eyas.lanes.calls import CompiledCall
from eyas.lanes.compilation import entry_module
from eyas.lanes.machine_code import improve

__all__ = ["ptx_of"]

_TRIPLE = "nvptx64-nvidia-cuda"

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
    processor: str = "sm_90",
) -> str:
    """Return the PTX of a compiled function and of all that it calls.

    Args:
        call: The function.
        bundles: What it is called with; only their types count.
        name: Of the entry, which takes the address of the table of pointers and two numbers.
        processor: LLVM's name of the oldest graphics processor to serve.
    """
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple(_TRIPLE)
    machine = target.create_target_machine(cpu=processor, features="+ptx80", opt=3)
    kinds = [numba.typeof(bundle) for bundle in bundles]
    module = entry_module(call.function, kinds, f"{name}_status", over_workers=call.over_workers)
    module = llvm.parse_assembly(_retargeted(str(module), name, str(machine.target_data)))
    module.verify()
    # Loops that do several turns at once need more registers, which all threads share.
    improve(module, name, machine, loops=False)
    text: str = machine.emit_assembly(module)
    return text


def _retargeted(text: str, name: str, layout: str) -> str:
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
    parts.append(
        f"define ptx_kernel void @{name}(ptr %parts, i64 %a, i64 %b) {{\n"
        f"  %status = call i32 @{name}_status(ptr %parts, i64 %a, i64 %b)\n  ret void\n}}\n"
    )
    return "\n".join([text, *parts])
