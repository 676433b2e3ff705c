"""The card that is not there does what NVIDIA's manual says, and refuses what a card would."""

import struct
from ctypes import addressof, c_uint64, c_void_p

import numpy as np
import pytest

from eyas.gpu.cuda import CudaError, cuda_device
from eyas.gpu.cuda.code import Ptx
from eyas.gpu.cuda.device import function_of

PROGRAM = """
.version 8.0
.target sm_80
.address_size 64
.visible .entry tried(
	.param .b64 tried_param_0,
	.param .b64 tried_param_1,
	.param .b64 tried_param_2
)
{{
	.reg .pred 	%p<9>;
	.reg .b32 	%r<9>;
	.reg .b64 	%rd<9>;
	.shared .align 16 .b8 held[256];

	ld.param.b64 	%rd1, [tried_param_0];
	ld.param.b64 	%rd2, [tried_param_1];
	ld.param.b64 	%rd3, [tried_param_2];
	mov.u32 	%r1, %tid.x;
	mul.wide.u32 	%rd4, %r1, 8;
	add.s64 	%rd5, %rd1, %rd4;
{body}
	st.b64 	[%rd5], %rd6;
	ret;
}}
"""
"""Writes %rd6 of each thread to an array."""


def run(device, body, a=0, b=0, threads=32):
    array = device.zeros(threads, np.int64)
    function = function_of(device.context, Ptx("tried", PROGRAM.format(body=body).encode()), "t")
    numbers = (c_uint64 * 3)(array.address, a, b)
    first = addressof(numbers)
    given = (c_void_p * 3)(first, first + 8, first + 16)
    device.context.call(
        *("cuLaunchKernel", function.handle, 1, 1, 1, threads, 1, 1, 0, None, given, None)
    )
    return device.read(array)


def of_f64(value):
    return struct.unpack("<q", struct.pack("<d", value))[0]


def of_f32(value):
    return struct.unpack("<i", struct.pack("<f", value))[0]


@pytest.fixture
def device(emulated):
    with emulated() as card:
        found = cuda_device()
        found.card = card
        yield found


NAN = of_f64(float("nan"))


@pytest.mark.parametrize(
    ("line", "a", "b", "expected"),
    [
        ("shl.b64 %rd6, %rd2, %rd3;", 3, 64, 0),
        ("shl.b64 %rd6, %rd2, %rd3;", 3, 4, 48),
        ("shr.s64 %rd6, %rd2, %rd3;", -3, 200, -1),
        ("shr.u64 %rd6, %rd2, %rd3;", -3, 64, 0),
        ("mul.hi.s64 %rd6, %rd2, %rd3;", -1 << 62, 8, -2),
        ("bfe.u64 %rd6, %rd2, 4, 8;", 0xABCD, 0, 0xBC),
        ("bfe.s64 %rd6, %rd2, 4, 8;", 0xABCD, 0, 0xBC - 256),
        ("div.s64 %rd6, %rd2, %rd3;", -7, 2, -3),
        ("rem.s64 %rd6, %rd2, %rd3;", -7, 2, -1),
        ("copysign.f64 %rd6, %rd2, %rd3;", of_f64(-1.0), of_f64(2.5), of_f64(-2.5)),
        ("max.f64 %rd6, %rd2, %rd3;", NAN, of_f64(2.5), of_f64(2.5)),
        ("max.f64 %rd6, %rd2, %rd3;", of_f64(-0.0), of_f64(0.0), 0),
        ("min.f64 %rd6, %rd2, %rd3;", of_f64(0.0), of_f64(-0.0), of_f64(-0.0)),
        ("cvt.rzi.s64.f64 %rd6, %rd2;", of_f64(-2.9), 0, -2),
        ("cvt.rzi.s64.f64 %rd6, %rd2;", of_f64(1e300), 0, 2**63 - 1),
        ("cvt.rzi.s64.f64 %rd6, %rd2;", NAN, 0, 0),
        ("cvt.rmi.f64.f64 %rd6, %rd2;", of_f64(-2.1), 0, of_f64(-3.0)),
        ("cvt.rn.f32.f64 %rd6, %rd2;", of_f64(0.1), 0, of_f32(0.1)),
        ("cvt.s64.s16 %rd6, %rd2;", 0xFFFE, 0, -2),
        ("setp.ltu.f64 %p1, %rd2, %rd3;\n selp.b64 %rd6, 1, 0, %p1;", NAN, 0, 1),
        ("setp.lt.f64 %p1, %rd2, %rd3;\n selp.b64 %rd6, 1, 0, %p1;", NAN, 0, 0),
        ("setp.neu.f64 %p1, %rd2, %rd3;\n selp.b64 %rd6, 1, 0, %p1;", NAN, NAN, 1),
        ("mov.pred %p1, -1;\n not.pred %p1, %p1;\n selp.b64 %rd6, 1, 0, %p1;", 0, 0, 0),
        ("rcp.rn.f64 %rd6, %rd2;", of_f64(3.0), 0, of_f64(1.0 / 3.0)),
        (
            "cvt.u32.u64 %r2, %rd2;\n mov.b32 {_, %rs1}, %r2;\n cvt.u64.u16 %rd6, %rs1;",
            7 << 16,
            0,
            7,
        ),
        ("mov.b64 {_, %r2}, %rd2;\n cvt.u64.u32 %rd6, %r2;", 5 << 32 | 7, 0, 5),
    ],
)
def test_an_instruction_does_what_the_manual_says(device, line, a, b, expected):
    found = run(device, line, a & 2**64 - 1, b & 2**64 - 1)
    assert found.tolist() == [expected] * 32


def test_threads_vote_and_shuffle_within_eights(device):
    body = """
	and.b32 %r2, %r1, 24;
	shl.b32 %r3, 255, %r2;
	setp.gt.u32 %p1, %r1, 20;
	vote.sync.ballot.b32 %r4, %p1, %r3;
	shfl.sync.idx.b32 %r5, %r1, 3, 6175, %r3;
	cvt.u64.u32 %rd7, %r4;
	cvt.u64.u32 %rd8, %r5;
	shl.b64 %rd8, %rd8, 32;
	or.b64 %rd6, %rd7, %rd8;"""
    found = run(device, body)
    votes = [0] * 16 + [0b111 << 21] * 8 + [0xFF << 24] * 8
    assert (found & 0xFFFFFFFF).tolist() == votes
    assert (found >> 32).tolist() == [k // 8 * 8 + 3 for k in range(32)]


def test_threads_that_part_meet_again(device):
    body = """
	cvt.u64.u32 %rd6, %r1;
	mov.b64 %rd7, 0;
$L_turn:
	setp.ge.u64 %p1, %rd7, %rd6;
	@%p1 bra $L_out;
	add.s64 %rd7, %rd7, 1;
	bra.uni $L_turn;
$L_out:
	mul.lo.s64 %rd6, %rd7, %rd7;"""
    found = run(device, body)
    assert found.tolist() == [k * k for k in range(32)]
    (loaded,) = device.card.programs.values()
    lines = loaded.program.lines
    assert loaded.turns[lines.index("mul.lo.s64 %rd6, %rd7, %rd7")] == 1
    (inside,) = [k for k, line in enumerate(lines) if line == "add.s64 %rd7, %rd7, 1"]
    assert loaded.turns[inside] == 31
    assert loaded.threads[inside] == 31 * 32 // 2


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("ld.b64 %rd6, [%rd5+1099511627776];", "an address that is not the program's"),
        ("ld.b64 %rd6, [%rd5+4];", "a misaligned address"),
        ("mov.b64 %rd7, held;\n ld.shared.b64 %rd6, [%rd7+256];", "not the program's"),
        (
            "setp.gt.u32 %p1, %r1, 3;\n @%p1 bra $L_on;\n bar.warp.sync 255;\n$L_on:",
            "threads that wait for others, which are elsewhere",
        ),
    ],
)
def test_what_would_stop_a_card_is_told(device, body, told):
    with pytest.raises(CudaError, match="error 700"):
        run(device, body)
    assert told in device.card.wrong[0]


@pytest.mark.parametrize(
    "line",
    [
        "mov.b64 %rd6, {%r1, %r1};",
        "fma.rn.f64 %rd6, %rd2, %rd3, %rd3;",
        "mul.f32 %r2, %r2, %r2;",
        "@%p1 add.s64 %rd6, 1, 1;",
        'cvt.rzi.s64+system("false").f64 %rd6, %rd2;',
    ],
)
def test_what_is_not_known_is_refused(device, line):
    with pytest.raises(CudaError, match="the emulated card"):
        run(device, line)
