"""Templates of `.proto` files, in JavaScript and in Lua."""
# ruff: noqa: E501  # a template is one line

import math

import pytest

from eyas.dat.proto_file import read_proto
from eyas.dat.proto_parser import parsed
from eyas.dat.proto_script import Limits
from eyas.engine.core.errors import EyasError
from eyas.engine.custom.mesh_file import read_mesh

FIELDS = """
  field SFFloat high 0.8
  field SFBool wide TRUE
  field SFString name "red player 7"
  field SFVec3f at 1 2 3
  field SFColor colour 1 0.5 0
  field MFFloat steps [ 1 2 4 ]
  field MFVec2f outline [ 0 0, 1 0, 1 2 ]
  field SFInt32 count 3
  field SFNode hat Cap { size 2 }
  field SFNode nothing NULL
"""


def shown(code, *, lua=False, fields=FIELDS, given=None):
    """Return the text that a template puts into the field `name` of a node."""
    language = "lua" if lua else "javascript"
    opened, closed = ("%{", "}%") if lua else ("%<", ">%")
    code = code.replace("<<", opened).replace(">>", closed)
    text = f"# template language: {language}\nPROTO T [{fields}] {{ Solid {{ name {code} }} }}"
    return parsed(text, given or {}, Limits(20_000)).body.fields["name"]


JAVASCRIPT = {
    "1 + 2 * 3": 7.0,
    "(1 + 2) * 3 % 4": 1.0,
    "2 ** 3 ** 2": 512.0,
    "-fields.high.value / 2": -0.4,
    "fields.at.value.x + fields.at.value.y * 10": 21.0,
    "fields.colour.value.g": 0.5,
    "fields.steps.value.length + fields.steps.value[2]": 7.0,
    "fields.outline.value[2].y": 2.0,
    "fields.wide.value ? 1 : 2": 1.0,
    "fields.wide.value && !fields.wide.value ? 1 : 2": 2.0,
    "fields.count.value === 3 ? 4 : 5": 4.0,
    "fields.count.defaultValue": 3.0,
    "fields.name.value.split(' ')[2] === '7' ? 8 : 9": 8.0,
    "'abc'.length + 'abc'.indexOf('c')": 5.0,
    "Math.max(1, Math.floor(2.7), Math.abs(-2))": 2.0,
    "Math.sin(Math.PI / 2) + Math.sqrt(4)": 3.0,
    "[3, 4, 5].map((a, i) => a * i)[2]": 10.0,
    "{a: 1, 'b': 2, 3: 5}[3]": 5.0,
    "[1, [2, 3]][1][0]": 2.0,
    "fields.hat.value.fields.size.value": 2.0,
    "fields.nothing.value === undefined ? 1 : 0": 1.0,
    "fields.nothing.value ?? 6": 6.0,
    "1e-7": 1e-7,
    "0x10": 16.0,
    "parseInt('12px') + parseFloat('0.5')": 12.5,
    "Number((1 / 3).toFixed(2))": 0.33,
    "new Array(4).length": 4.0,
    "1 / 0 > 5 ? 1 : 2": 1.0,
}


@pytest.mark.parametrize(("code", "value"), JAVASCRIPT.items())
def test_expressions_of_javascript(code, value):
    assert shown(f"<<= {code} >>") == pytest.approx([value], abs=1e-15)


LUA = {
    "1 + 2 * 3 ^ 2": 19.0,
    "-2 ^ 2": -4.0,
    "-7 % 3 + 7 // 2": 5.0,
    "fields.wide.value and 1 or 2": 1.0,
    "not fields.wide.value and 1 or 2": 2.0,
    "#fields.steps.value + fields.steps.value[3]": 7.0,
    "fields.name.value ~= '' and 3 or 4": 3.0,
    "fields.at.value.z": 3.0,
    "math.floor(math.rad(180))": 3.0,
    "tonumber('4') + tonumber(('x'):rep(2) == 'xx' and '1' or '2')": 5.0,
    "({4, 5, k = 6})[2] + ({k = 6}).k": 11.0,
    "fields.hat.value.node_name == 'Cap' and 1 or 2": 1.0,
    "string.len(string.format('%03d %.1f', 7, 0.25))": 7.0,
}


@pytest.mark.parametrize(("code", "value"), LUA.items())
def test_expressions_of_lua(code, value):
    assert shown(f"<<= {code} >>", lua=True) == pytest.approx([value], abs=1e-15)


def test_texts_are_joined():
    assert shown("""<<= '"' + fields.name.value + ' ' + 2 + '"' >>""") == "red player 7 2"
    assert shown("""<<= `"${fields.count.value * 2} of ${'it'}"` >>""") == "6 of it"
    assert shown("""<<= '"' .. fields.count.value .. '"' >>""", lua=True) == "3"


STATEMENTS = [
    (False, "[ << for (let i = 0; i < 3; ++i) { >> <<= i * i >> << } >> ]", [0.0, 1.0, 4.0]),
    (False, "[ << for (const s of fields.steps.value) { >> <<= s >> << } >> ]", [1.0, 2.0, 4.0]),
    (False, "[ << let a = 0; while (true) { a += 2; if (a > 5) break; >> <<= a >> << } >> ]", [2.0, 4.0]),
    (False, "<< if (fields.count.value > 5) { >> 1 << } else if (fields.wide.value) { >> 2 << } else { >> 3 << } >>", [2.0]),
    (False, "<< function f(a, b) { if (a > 1) return a * f(a - 1); return 1; } >> <<= f(5) >>", [120.0]),
    (False, "<< const f = (a, b) => a - b; const p = []; p.push(f(5, 2)); p[2] = 7; >> <<= p.length + p[0] + p[2] >>", [13.0]),
    (False, "<< let i = 5; let j = i++ + i--; /* a\nb */ // c\n >> <<= i * 100 + j >>", [511.0]),
    (False, "<< import * as wbrandom from 'https://x/wbrandom.js'; wbrandom.seed(3); >> <<= wbrandom.integer(2, 2) >>", [2.0]),
    (True, "[ << for i = 1, 5, 2 do >> <<= i >> << end >> ]", [1.0, 3.0, 5.0]),
    (True, "[ << for i, v in ipairs(fields.steps.value) do >> <<= i * v >> << end >> ]", [1.0, 4.0, 12.0]),
    (True, "<< local words = {} for w in fields.name.value:gmatch('%w+') do table.insert(words, w) end >> <<= words[3] >>", [7.0]),
    (True, "<< if fields.count.value == 1 then >> 1 << elseif fields.count.value == 3 then >> 2 << else >> 3 << end >>", [2.0]),
    (True, "<< local function f(a) if a > 1 then return a * f(a - 1) end return 1 end >> <<= f(4) >>", [24.0]),
    (True, "<< a, b = 1, 2 a, b = b, a repeat a = a + 1 until a > 4 -- x\n >> <<= a * 10 + b >>", [51.0]),
    (True, "<< local t = {} t.x = {y = 4} t[1] = 3 while #t < 3 do t[#t + 1] = t.x.y end >> <<= t[3] + #t >>", [7.0]),
    (True, "<< local r = require('wbrandom') r.seed(1) print('x') >> <<= r.integer(3, 3) >>", [3.0]),
]  # fmt: skip


@pytest.mark.parametrize(("lua", "code", "values"), STATEMENTS)
def test_statements_shape_the_text_between_them(lua, code, values):
    assert shown(code, lua=lua) == pytest.approx(values)


def test_fields_that_are_given_come_before_defaults():
    assert shown("<<= fields.high.value * 10 >>", given={"high": [0.3]}) == [3.0]


def test_the_language_is_that_of_the_head_else_that_of_the_mark():
    assert parsed("PROTO T [] { Solid { name %{= 1 .. 2 }% } }").body.fields["name"] == [12.0]
    assert parsed("PROTO T [] { Solid { name %<= 1 + '2' >% } }").body.fields["name"] == [12.0]
    lua = "# template language: lua\nPROTO T [] { Solid { name %<= 1 .. 2 >% } }"
    assert parsed(lua).body.fields["name"] == [12.0]


def test_sines_are_the_same_on_every_processor():
    (value,) = shown("<<= Math.sin(0.7) >>")
    assert value == pytest.approx(math.sin(0.7), abs=1e-15)


REFUSED = [
    ("<< while (true) { } >>", "computes for too long"),
    ("<< let a = 'x'; for (;;) a = a + a; >>", "computes for too long"),
    ("<< let a = [1]; for (;;) a = a.concat(a); >>", "computes for too long"),
    ("<< const a = []; a[1e12] = 1; >>", "computes for too long"),
    ("<<= 'x'.repeat(1e15) >>", "computes for too long"),
    ("<<= new Array(1e15) >>", "computes for too long"),
    ("<< function f(a) { return f(a); } f(1); >>", "calls functions too deep"),
    ("<<= window.alert(1) >>", "names window, which is not read"),
    ("<<= fields.high.value.__class__ >>", "asks for '__class__' of what is no list or node"),
    ("<<= 'x'.format(1) >>", "calls 'format', which is not read"),
    ("<<= fields.constructor('return 1')() >>", "calls 'constructor', which is not read"),
    ("<<= eval('1') >>", "names eval, which is not read"),
    ("<<= 1 + true >>", "computes with what is no number"),
    ("<<= fields.at.value >>", "puts out a list or a node"),
    ("<< switch (1) { } >>", "names switch|has '{'"),
    ("<< throw new Array(1); >>", "refuses its fields"),
    ("<< break; >>", "breaks off outside of a loop"),
    ("<<= 1 @ 2 >>", "has '@ 2 ', which is not read"),
    ("<< if (1) { >>", "breaks off before it is whole"),
    ("<<= " + "(" * 3000 + "1 >>", "nested too deep"),
    ("<<= " + "1 + " * 3000 + "1 >>", "nested too deep"),
    ("<<= 1", "a template without its end"),
]


@pytest.mark.parametrize(("code", "problem"), REFUSED)
def test_what_is_not_read_or_does_too_much_is_refused_in_one_line(code, problem):
    with pytest.raises(ValueError, match=problem) as caught:
        shown(code)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("code", "problem"),
    [
        ("<< while true do end >>", "computes for too long"),
        ("<< require('os').exit() >>", "needs the module 'os'"),
        ("<< os.execute('x') >>", "asks for 'execute' of what is no list"),
        ("<< for w in ('x'):gmatch('(%w+)*') do end >>", "looks for "),
        ("<<= ('x'):rep(1e15) >>", "computes for too long"),
    ],
)
def test_lua_is_refused_likewise(code, problem):
    with pytest.raises(ValueError, match=problem):
        shown(code, lua=True)


def test_a_template_makes_the_parts_of_a_shape(tmp_path):
    (tmp_path / "Stairs.proto").write_text(
        "# template language: javascript\n"
        "PROTO Stairs [ field SFInt32 steps 3 field SFFloat rise 0.2 ] { Solid { children [\n"
        "%< for (let k = 0; k < fields.steps.value; ++k) { >%\n"
        "Pose { translation %<= k * 0.3 >% 0 %<= (k + 0.5) * fields.rise.value >%\n"
        "children [ Shape { geometry Box { size 0.3 1 %<= fields.rise.value >% } } ] }\n"
        "%< } >% ] } }"
    )
    (tmp_path / "Hall.proto").write_text(
        "PROTO Hall [] { Group { children [ Stairs { steps 5 rise 0.1 } ] } }"
    )
    assert read_mesh(tmp_path / "Stairs.proto").size == pytest.approx((0.9, 1.0, 0.6))
    assert read_mesh(tmp_path / "Hall.proto").size == pytest.approx((1.5, 1.0, 0.5))


def test_templates_of_all_nodes_together_have_one_limit(tmp_path, monkeypatch):
    monkeypatch.setattr("eyas.dat.proto_file.Limits", lambda: Limits(20_000))
    busy = "%< for (let k = 0; k < 1000; ++k) { } >%"
    (tmp_path / "Busy.proto").write_text(f"PROTO Busy [] {{ {busy} Group {{ }} }}")
    many = "Busy { } " * 40
    (tmp_path / "Hall.proto").write_text(f"PROTO Hall [] {{ Group {{ children [ {many} ] }} }}")
    with pytest.raises(EyasError, match=r"Busy\.proto: its template computes for too long"):
        read_proto(tmp_path / "Hall.proto", lambda path: None)
