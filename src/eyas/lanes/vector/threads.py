"""What lanes do together where each is a thread of a graphics processor: instructions of warps.

A warp has 32 threads; `WIDTH` of them in a row are the lanes of one worker. Its branches depend on
numbers that are the same in all its lanes, so these always go the same way.
"""

from typing import Any

from llvmlite import ir
from numba.core import cgutils

from eyas.lanes.vector import WIDTH

_I1, _I32, _I64, _VOID = ir.IntType(1), ir.IntType(32), ir.IntType(64), ir.VoidType()

RECORD = "worker_record"
"""Name of places on the stack that hold the same for all lanes, see `eyas.gpu.cuda.code`."""

_SEGMENT = ((32 - WIDTH) << 8) | 31
"""Operand of a shuffle that stays within the lanes of a worker (PTX ISA, `shfl.sync`)."""


def _call(builder: Any, name: str, kind: ir.FunctionType, *args: ir.Value) -> ir.Value:  # noqa: ANN401
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.nvvm.{name}")
    return builder.call(function, args)


def _thread(builder: Any) -> ir.Value:  # noqa: ANN401
    """Return the thread's number in its block, whose size is a multiple of 32."""
    return _call(builder, "read.ptx.sreg.tid.x", ir.FunctionType(_I32, []))


def lane_number(builder: Any) -> ir.Value:  # noqa: ANN401
    """Return the number of the thread's own lane."""
    return builder.and_(_thread(builder), _I32(WIDTH - 1))


def _first(builder: Any) -> ir.Value:  # noqa: ANN401
    """Return the thread of the warp that is lane 0."""
    return builder.and_(_thread(builder), _I32(32 - WIDTH))


def _members(builder: Any) -> ir.Value:  # noqa: ANN401
    """Return the threads of the warp that are the worker's lanes, a bit each."""
    return builder.shl(_I32((1 << WIDTH) - 1), _first(builder))


def ballot(builder: Any, mask: ir.Value) -> ir.Value:  # noqa: ANN401
    """Return the bits of all lanes, lane 0 in the lowest."""
    kind = ir.FunctionType(_I32, [_I32, _I1])
    bits = _call(builder, "vote.ballot.sync", kind, _members(builder), mask)
    return builder.trunc(builder.lshr(bits, _first(builder)), ir.IntType(WIDTH))


def from_lane(builder: Any, value: ir.Value, number: ir.Value) -> ir.Value:  # noqa: ANN401
    """Return the value that a lane has."""
    if value.type == _I64:
        halves = [builder.trunc(builder.lshr(value, _I64(k)), _I32) for k in (0, 32)]
        low, high = (builder.zext(from_lane(builder, half, number), _I64) for half in halves)
        return builder.or_(low, builder.shl(high, _I64(32)))
    if value.type == ir.DoubleType():
        bits = from_lane(builder, builder.bitcast(value, _I64), number)
        return builder.bitcast(bits, value.type)
    if value.type == ir.FloatType():
        bits = from_lane(builder, builder.bitcast(value, _I32), number)
        return builder.bitcast(bits, value.type)
    if value.type == _I1:
        return builder.trunc(from_lane(builder, builder.zext(value, _I32), number), _I1)
    kind = ir.FunctionType(_I32, [_I32, _I32, _I32, _I32])
    return _call(
        builder, "shfl.sync.idx.i32", kind, _members(builder), value, number, _I32(_SEGMENT)
    )


def agree(builder: Any) -> None:  # noqa: ANN401
    """Let all lanes see what each has written."""
    _call(builder, "bar.warp.sync", ir.FunctionType(_VOID, [_I32]), _members(builder))
